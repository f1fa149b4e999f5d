// What holds for every codec of the registry: round trips, refusals, the same bytes for any number
// of threads, hard cases.

#include <tbb/global_control.h>

#include <catch2/catch.hpp>
#include <cmath>
#include <fstream>
#include <functional>
#include <limits>
#include <string>
#include <vector>

#include "btf/atomic_file.h"
#include "btf/error.h"
#include "codecs/representation.h"
#include "codecs/sample_error.h"
#include "tests/codecs/synthetic_btf.h"
#include "tests/temporary_folder.h"

using namespace weft;
namespace fs = std::filesystem;

namespace {

std::unique_ptr<Representation> fit(const Codec& codec, const std::shared_ptr<const Btf>& btf,
                                    const std::vector<std::string>& parameters = {}) {
  Progress progress;
  return codec.fit(btf, Settings::from_text("", "test", parameters), progress);
}

struct Case {
  std::string codec;
  std::vector<std::string> parameters;
};

/// Every codec with its defaults (but SRBF, whose hundred iterations would take most of the time
/// and whose own tests run them), and the variants that store something else.
/// @param resolution  of the variants' factor maps: half the default's is found in a fraction of
///                    the time.
std::vector<Case> cases(const std::string& resolution = "resolution=16") {
  std::vector<Case> all;
  for (const Codec& codec : codecs()) {
    all.push_back({codec.name, {}});
    if (codec.name == "srbf") all.back().parameters = {"iterations=30"};
  }
  all.push_back({"cmf", {"bits=float"}});
  all.push_back({"cmf", {"rotate=false"}});
  all.push_back({"cmf", {"clustered=false"}});
  all.push_back({"cmf", {"clustered=false", "bits=float", "rotate=true"}});
  all.push_back({"cmf", {"clustered=false", "bits=float", "factors=light,view", "resolution=31"}});
  all.push_back({"pca", {"bits=8", "components=3"}});
  all.push_back({"pca-view", {"bits=float"}});
  all.push_back({"dfmf", {"bits=8", "components_u=3"}});
  all.push_back({"laplacian", {"bits=half", "directions=interpolated", "filters=box2"}});
  all.push_back({"laplacian", {"bits=8", "filters=linear", "components_cb=3", "levels=1"}});
  all.push_back({"laplacian", {"components_y=3", "components_cb=3", "components_cr=4"}});
  all.push_back({"laplacian", {"chroma_mean=cosine", "components_y=12", "prediction=open"}});
  all.push_back({"cmf", {"clusters=17", "refine=0", "levels=false", "clustering=tree"}});
  all.push_back({"cmf", {"factors=light,half,difference,view", "terms=2", "metric=cosine"}});
  all.push_back({"hf", {"bits=float", "clustered=false"}});
  all.push_back({"srbf",
                 {"bits=8", "kernels=5", "modes=in-out", "quantity=f", "filtering=numbers",
                  "smooth_weight=0", "mip_weight=0", "sweeps=1"}});
  all.push_back({"srbf", {"bits=float", "kernels=17", "iterations=10", "multivariate=false"}});
  all.push_back({"cmf", {"terms=3", "bits=float", "rotate=true", "order=half-last"}});
  all.push_back({"lobes", {"bits=float", "lobes=1"}});
  all.push_back({"lobes", {"lobes=4"}});
  all.push_back({"ptm", {"colour=channels"}});
  all.push_back({"ptm", {"bits=float"}});
  all.push_back({"lafortune", {"bits=float", "lobes=3"}});
  for (Case& c : all) {
    const bool has_maps = c.codec == "cmf" || c.codec == "hf";
    if (has_maps && !c.parameters.empty() && c.parameters.back() != "resolution=31")
      c.parameters.insert(c.parameters.begin(), resolution);
  }
  return all;
}

/// And what a single texel or two are too few for.
std::vector<Case> cases_of_tiles() {
  std::vector<Case> all = cases();
  all.push_back({"laplacian", {"levels=3"}});
  return all;
}

std::string label(const Case& c) {
  std::string text = c.codec;
  for (const std::string& parameter : c.parameters) text += " " + parameter;
  return text;
}

std::vector<AppearanceQuery> queries() {
  std::vector<AppearanceQuery> queries;
  for (int i = 0; i < 500; ++i) {
    const auto angle = [&](double a, double top) { return std::fmod(a * (i + 1), 1.0) * top; };
    queries.push_back(
        {Texcoord(static_cast<float>(angle(0.618, 4)) - 2, static_cast<float>(angle(0.755, 4)) - 2),
         from_spherical(angle(0.414, radians(89.9)), angle(0.303, radians(360.0))),
         from_spherical(angle(0.732, radians(89.9)), angle(0.236, radians(360.0))),
         static_cast<float>(angle(0.87, 3))});
  }
  return queries;
}

std::vector<Rgb> answers(const Appearance& appearance) {
  const std::vector<AppearanceQuery> asked = queries();
  std::vector<Rgb> answered(asked.size());
  appearance.evaluate(asked, answered);
  return answered;
}

std::vector<std::pair<std::string, std::string>> file_contents(const fs::path& folder) {
  std::vector<std::pair<std::string, std::string>> files;
  for (const auto& entry : fs::directory_iterator(folder)) {
    files.emplace_back(entry.path().filename(), read_text(entry.path()));
  }
  std::ranges::sort(files);
  return files;
}

std::string message(const std::function<void()>& action) {
  try {
    action();
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}

}  // namespace

TEST_CASE("Every codec: saved and loaded, it answers the same bits, and saves the same bytes") {
  const auto btf = realistic_btf(6, "regular:3x6");
  for (const Case& c : cases_of_tiles()) {
    INFO(label(c));
    const TemporaryFolder folder;
    const auto fitted = fit(codec_named(c.codec), btf, c.parameters);
    fitted->save(folder.path / "a");
    const auto loaded = open_representation(folder.path / "a");
    CHECK(loaded->codec() == c.codec);
    CHECK(loaded->bytes() == fitted->bytes());
    CHECK(loaded->texels() == fitted->texels());
    CHECK(loaded->lights().size() == btf->lights().size());
    const bool same_answers = answers(*loaded) == answers(*fitted);
    CHECK(same_answers);
    loaded->save(folder.path / "b");
    const bool same_files = file_contents(folder.path / "a") == file_contents(folder.path / "b");
    CHECK(same_files);
  }
}

TEST_CASE("Every codec: many queries at once are answered as one by one") {
  const auto btf = realistic_btf(6, "regular:3x6");
  for (const Case& c : cases_of_tiles()) {
    INFO(label(c));
    const auto fitted = fit(codec_named(c.codec), btf, c.parameters);
    std::vector<AppearanceQuery> asked = queries();
    for (std::size_t i = 0; i < asked.size(); i += 7) asked[i].light.z *= -1;
    for (std::size_t i = 0; i < asked.size(); i += 3) asked[i].lod = 0;
    std::vector<Rgb> together(asked.size());
    fitted->evaluate(asked, together);
    float worst = 0;
    for (std::size_t i = 0; i < asked.size(); ++i) {
      const AppearanceQuery& q = asked[i];
      const Rgb alone = fitted->evaluate(q.uv, q.light, q.view, q.lod);
      worst = std::max(worst, (together[i] - alone).length() / (1e-3F + alone.length()));
    }
    CHECK(worst < 1e-4F);
  }
}

TEST_CASE("Every codec: bytes are what its program uploads") {
  const auto btf = realistic_btf(5, "regular:3x6");
  for (const Case& c : cases()) {
    INFO(label(c));
    const auto fitted = fit(codec_named(c.codec), btf, c.parameters);
    std::size_t uploaded = 0;
    for (const GlTexture& texture : fitted->gl_program().textures) {
      INFO(texture.name);
      CHECK(texture.bytes.size() == bytes_per_texel(texture.format) * texel_count(texture));
      uploaded += texture.bytes.size();
    }
    CHECK(uploaded <= fitted->bytes() + fitted->constant_bytes());
    CHECK(uploaded >= fitted->bytes());
    CHECK(compression_ratio(*fitted) ==
          Approx(3.0 * 25 * 18 * 18 / static_cast<double>(fitted->bytes())));
  }
}

TEST_CASE("Every codec: the same bytes with one thread and with two", "[heavy]") {
  const auto btf = realistic_btf(7, "regular:3x6");
  for (const Case& c : cases()) {
    INFO(label(c));
    const TemporaryFolder folder;
    for (const std::size_t threads : {1, 2}) {
      const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
      fit(codec_named(c.codec), btf, c.parameters)->save(folder.path / std::to_string(threads));
    }
    const bool same_files = file_contents(folder.path / "1") == file_contents(folder.path / "2");
    CHECK(same_files);
  }
}

TEST_CASE("Every codec: the same bytes from a scratch file as from memory", "[heavy]") {
  const auto btf = realistic_btf(6, "regular:3x6");
  const TemporaryFolder scratch;
  for (const Case& c : cases()) {
    INFO(label(c));
    const TemporaryFolder folder;
    fit(codec_named(c.codec), btf, c.parameters)->save(folder.path / "memory");
    // There is room for a few views, and not for what is made of all of them.
    const std::size_t memory = btf->bytes() / btf->views().size() * 4;
    Btf mapped(btf->width(), btf->height(), btf->views(), btf->lights(), btf->pixel_type(),
               std::make_shared<MemoryBudget>(memory, scratch.path));
    mapped.set_views(0, *btf);
    REQUIRE(mapped.mapped());
    fit(codec_named(c.codec), std::make_shared<const Btf>(std::move(mapped)), c.parameters)
        ->save(folder.path / "mapped");
    const bool same_files =
        file_contents(folder.path / "memory") == file_contents(folder.path / "mapped");
    CHECK(same_files);
  }
}

TEST_CASE("Every codec: below the horizon there is nothing, and uv repeat") {
  const auto btf = realistic_btf(4, "regular:3x6");
  for (const Codec& codec : codecs()) {
    INFO(codec.name);
    const auto fitted = fit(codec, btf);
    const Direction up(0, 0, 1);
    CHECK(fitted->evaluate({0.3F, 0.4F}, Direction(1, 0, 0), up, 0) == Rgb(0, 0, 0));
    CHECK(fitted->evaluate({0.3F, 0.4F}, up, Direction(0, -0.6F, -0.8F), 0) == Rgb(0, 0, 0));
    const Rgb here = fitted->evaluate({0.25F, 0.5F}, up, up, 0);
    const Rgb there = fitted->evaluate({-2.75F, 7.5F}, up, up, 0);
    CHECK((here - there).length() < 1e-6F);
    CHECK(here.x > 0);
  }
}

namespace {

struct Hard {
  std::string name;
  std::shared_ptr<const Btf> btf;
  double tolerance;
  double tolerance_of_smooth = tolerance;    // of `hf`, `ptm` and `lafortune`
  const char* resolution = "resolution=16";  // of the variants' maps
};

Rgb constant(int, int, const Direction&, const Direction&) {
  return {0.5F, 0.25F, 1};
}

void check_answers(const Hard& data) {
  for (const Case& c : cases(data.resolution)) {
    INFO(data.name << ", " << label(c));
    const auto fitted = fit(codec_named(c.codec), data.btf, c.parameters);
    const bool is_smooth = c.codec == "hf" || c.codec == "ptm" || c.codec == "lafortune";
    CHECK(sample_error(*data.btf, *fitted).relative_rmse <=
          (is_smooth ? data.tolerance_of_smooth : data.tolerance));
    for (const Rgb& answer : answers(*fitted)) {
      if (!(std::isfinite(answer.x + answer.y + answer.z) && answer.x >= 0 && answer.y >= 0 &&
            answer.z >= 0)) {
        FAIL("not finite and >= 0: " << answer.x << ' ' << answer.y << ' ' << answer.z);
      }
    }
  }
}

}  // namespace

TEST_CASE("Every codec: black, constant and dark data give finite, right answers", "[heavy]") {
  const auto black = [](int, int, const Direction&, const Direction&) { return Rgb(0, 0, 0); };
  const auto half_black = [](int x, int, const Direction&, const Direction&) {
    return x % 2 == 0 ? Rgb(0, 0, 0) : Rgb(0.5F, 0, 0.5F);
  };
  const auto dark = [](int, int, const Direction&, const Direction&) {
    return Rgb(1e-7F, 1e-7F, 1e-7F);
  };
  check_answers({"constant", synthetic_btf(3, 3, "ubo81", "ubo81", constant), 0.004});
  check_answers({"black", synthetic_btf(3, 3, "ubo81", "ubo81", black), 0});
  check_answers(
      {"black columns, a black channel", synthetic_btf(4, 2, "ubo81", "ubo81", half_black), 0.004});
  check_answers({"dark", synthetic_btf(2, 2, "ubo81", "ubo81", dark), 0.004});
}

// A sum of logarithms knows no lone pair, and a coarse map no lone light. Nor do the six numbers of
// a biquadratic (whose best errs 96 %), or lobes of lx vx, ly vy and lz vz alone.
TEST_CASE("Every codec: one bright pair, or light, gives finite, right answers", "[heavy]") {
  const auto spike = [](int, int, const Direction& l, const Direction& v) {
    return l.z > 0.99F && v.z > 0.99F ? Rgb(10, 10, 10) : Rgb(0, 0, 0);
  };
  const auto bright = [](int, int, const Direction& l, const Direction&) {
    return l.z > 0.99F ? Rgb(1e8F, 1e8F, 1e8F) : Rgb(1, 1, 1);
  };
  const char* fine = "resolution=32";
  check_answers({"one bright pair", synthetic_btf(2, 2, "ubo81", "ubo81", spike), 0.1, 1, fine});
  check_answers({"a light 1e8 times the others", synthetic_btf(2, 2, "ubo81", "ubo81", bright), 0.1,
                 1, fine});
}

TEST_CASE("Every codec: one texel, view or light gives finite, right answers") {
  check_answers({"one texel", synthetic_btf(1, 1, "ubo81", "ubo81", constant), 0.004});
  check_answers({"one view", synthetic_btf(2, 2, "ubo81", "fibonacci:1", constant), 0.004});
  check_answers({"one light", synthetic_btf(2, 2, "fibonacci:1", "ubo81", constant), 0.004});
  check_answers({"two lights", synthetic_btf(2, 2, "fibonacci:2", "ubo81", constant), 0.004});
}

TEST_CASE("Names and parameters that are mistyped are told with what is valid") {
  const auto btf = realistic_btf(1, "regular:3x6");
  CHECK_THAT(message([] { codec_named("cmv"); }), Catch::Contains("cmf") && Catch::Contains("raw"));
  for (const Codec& codec : codecs()) {
    CHECK_THAT(message([&] { fit(codec, btf, {"no_such_key=1"}); }),
               Catch::Contains("no_such_key"));
  }
  CHECK_THAT(message([&] { fit(codec_named("cmf"), btf, {"bits=16"}); }), Catch::Contains("float"));
  CHECK_THAT(message([&] { fit(codec_named("cmf"), btf, {"clusters=300"}); }),
             Catch::Contains("256"));
  CHECK_THAT(message([&] { fit(codec_named("hf"), btf, {"lambda=otto"}); }),
             Catch::Contains("lambda") && Catch::Contains("auto"));
  CHECK_THAT(message([&] { fit(codec_named("cmf"), btf, {"resolution=1"}); }),
             Catch::Contains("resolution"));
}

TEST_CASE("CMF refuses parameters of the half factor where there is none") {
  const auto btf = realistic_btf(1, "regular:3x6");
  for (const std::string key : {"refine", "difference_rings", "order"}) {
    const std::string value = key == "order" ? "half-last" : "2";
    CHECK_THAT(message([&] {
                 fit(codec_named("cmf"), btf, {"factors=light,view", key + "=" + value});
               }),
               Catch::Contains(key) && Catch::Contains("light,view"));
  }
}

TEST_CASE("A codec.json that says what its files are not is refused") {
  const TemporaryFolder folder;
  const fs::path path = folder.path / "a.cmf";
  fit(codec_named("cmf"), realistic_btf(3, "regular:3x6"))->save(path);
  const std::string whole = read_text(path / "codec.json");
  const auto with = [&](const std::string& old, const std::string& by) {
    std::string text = whole;
    text.replace(text.find(old), old.size(), by);
    std::ofstream(path / "codec.json") << text;
    return message([&] { open_representation(path); });
  };
  CHECK_THAT(with("8-bit index", "float"), Catch::Contains("index") && Catch::Contains("float"));
  CHECK_THAT(with("\"cmf\"", "\"cmg\""), Catch::Contains("codec.json") && Catch::Contains("cmg"));
}

TEST_CASE("Every codec: a missing, truncated or changed file is named") {
  const auto btf = realistic_btf(3, "regular:3x6");
  for (const Codec& codec : codecs()) {
    const TemporaryFolder folder;
    fit(codec, btf)->save(folder.path / "whole");
    for (const auto& entry : fs::directory_iterator(folder.path / "whole")) {
      const fs::path name = entry.path().filename();
      if (name == "run.json") continue;
      INFO(codec.name << ": " << name);
      const fs::path damaged = folder.path / "damaged";
      const auto start = [&] {
        fs::remove_all(damaged);
        fs::copy(folder.path / "whole", damaged);
      };
      const auto opening = [&] { return message([&] { open_representation(damaged); }); };
      start();
      fs::resize_file(damaged / name, fs::file_size(damaged / name) / 2);
      CHECK_THAT(opening(), Catch::Contains(name.string()));
      start();
      fs::remove(damaged / name);
      CHECK_THAT(opening(), Catch::Contains(name.string()));
    }
    CHECK_THAT(message([&] { open_representation(folder.path / "nowhere"); }),
               Catch::Contains("nowhere"));
  }
}

TEST_CASE("Saving replaces a codec's folder, and nothing else") {
  const TemporaryFolder folder;
  const auto btf = realistic_btf(2, "regular:3x6");
  const auto fitted = fit(codec_named("cmf"), btf);
  fitted->save(folder.path / "a.cmf");
  fit(codec_named("cmf"), btf, {"bits=float"})->save(folder.path / "a.cmf/");
  CHECK(!fs::exists(folder.path / "a.cmf" / "light.png"));
  CHECK(fs::exists(folder.path / "a.cmf" / "light.exr"));
  fs::create_directory(folder.path / "mine");
  std::ofstream(folder.path / "mine" / "letter.txt") << "dear";
  CHECK_THAT(message([&] { fitted->save(folder.path / "mine"); }), Catch::Contains("mine"));
  CHECK(fs::exists(folder.path / "mine" / "letter.txt"));
  CHECK(std::distance(fs::directory_iterator(folder.path), {}) ==
        2);  // nothing half written beside
}
