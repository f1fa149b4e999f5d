#include "cli/demo_job.h"

#include <fmt/core.h>

#include <chrono>
#include <memory>
#include <system_error>

#include "acquisition/acquire.h"
#include "btf/atomic_file.h"
#include "btf/btf_file.h"
#include "btf/error.h"
#include "btf/progress.h"
#include "codecs/representation.h"
#include "tracer/scene_file.h"

namespace weft::cli {

namespace {

namespace fs = std::filesystem;
using nlohmann::ordered_json;
using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point begin) {
  return std::chrono::duration<double>(Clock::now() - begin).count();
}

/// What the demo noted beside a dataset: how it was made, and what that measured. It also marks the
/// dataset as the demo's own, which may be replaced when the settings change.
class Record {
 public:
  explicit Record(const fs::path& dataset) : dataset_(dataset), file_(dataset) {
    file_ += ".json";
    if (fs::exists(file_)) content_ = ordered_json::parse(read_text(file_), nullptr, false);
  }

  /// Whether the dataset is whole and was made so. `last_file` is what its writer writes last.
  bool holds(const ordered_json& settings, const char* last_file) const {
    return is_of(settings) && content_.contains("measured") && fs::exists(dataset_ / last_file);
  }
  /// Before making it: removes what another run of the demo made otherwise, and notes the settings.
  void begin(const ordered_json& settings) {
    if (content_.is_object() && !is_of(settings)) fs::remove_all(dataset_);
    content_ = {{"settings", settings}};
    write_text_atomically(file_, content_.dump(2) + "\n");
  }
  void end(const ordered_json& measured) {
    content_["measured"] = measured;
    write_text_atomically(file_, content_.dump(2) + "\n");
  }
  ordered_json measured() const { return content_.at("measured"); }

 private:
  bool is_of(const ordered_json& settings) const {
    return content_.is_object() && content_.contains("settings") &&
           content_["settings"] == settings;
  }

  fs::path dataset_;
  fs::path file_;
  ordered_json content_;
};

std::uintmax_t bytes_in(const fs::path& folder) {
  std::uintmax_t sum = 0;
  for (const auto& entry : fs::directory_iterator(folder)) {
    if (entry.is_regular_file()) sum += entry.file_size();
  }
  return sum;
}

ordered_json measured_of(const AcquisitionReport& report) {
  const auto rays = report.statistics.rays();
  return {
      {"seconds", report.seconds},
      {"rays", rays},
      {"rays_per_second", report.seconds > 0 ? static_cast<double>(rays) / report.seconds : 0.0},
      {"paths", report.statistics.paths},
      {"paths_missed", report.statistics.missed},
      {"views_kept", report.views_kept}};
}

/// Traces the raw dataset where it is not there. @return whether it was.
bool make_raw(const DemoItem& item, const DemoSettings& settings, const fs::path& folder,
              ordered_json& measured) {
  const Mesostructure mesostructure =
      read_mesostructure(settings.scenes / "mesostructures" / (item.name + ".toml"));
  AcquisitionSettings acquisition;
  acquisition.views = acquisition.lights = settings.directions;
  acquisition.trace.width = acquisition.trace.height = settings.texels;
  acquisition.trace.spp = settings.spp;
  acquisition.trace.max_bounces = settings.max_bounces;
  acquisition.trace.seed = settings.seed;
  const auto made_with = ordered_json::parse(provenance_of(mesostructure, acquisition));

  Record record(folder);
  const bool whole = record.holds(made_with, "btf.json");
  if (!whole) {
    record.begin(made_with);
    Progress progress(item.name + ": tracing", settings.quiet);
    record.end(measured_of(acquire(mesostructure, acquisition, folder, progress)));
  }
  measured = record.measured();
  return whole;
}

/// Fits and saves where it is not there. @return seconds of fitting.
double make_compressed(const DemoItem& item, const DemoSettings& settings, const fs::path& raw,
                       const fs::path& folder) {
  const Codec& codec = codec_named(settings.codec);
  const ordered_json made_with = {{"codec", codec.name},
                                  {"checksum", file_checksum(raw / "btf.json")}};
  Record record(folder);
  if (!record.holds(made_with, "codec.json")) {
    record.begin(made_with);
    const auto btf = std::make_shared<const Btf>(read_btf(raw));
    Progress progress(item.name + ": compressing", settings.quiet);
    const Clock::time_point begin = Clock::now();
    const auto representation = codec.fit(btf, Settings(), progress);
    const double seconds = seconds_since(begin);
    representation->save(folder);
    record.end({{"seconds", seconds}});
  }
  return record.measured().at("seconds").get<double>();
}

/// Renders a dataset on its shape in both renderers.
DemoVariant draw(const DemoItem& item, const DemoSettings& settings, const fs::path& dataset) {
  const std::shared_ptr<const Representation> representation = open_representation(dataset);
  DemoVariant variant;
  variant.codec = representation->codec();
  variant.bytes = representation->bytes();
  variant.constant_bytes = representation->constant_bytes();
  variant.file_bytes = bytes_in(dataset);
  variant.ratio = compression_ratio(*representation);

  // Every BTF of the scene is replaced by this one, which is open already.
  const OpenAppearance open = [&](const fs::path&) { return representation; };
  const Scene scene = read_scene(settings.scenes / item.scene, open, {{"", dataset}},
                                 {fmt::format("camera.size=[{0}, {0}]", settings.picture_size)});
  RenderSettings render_settings;
  render_settings.samples_per_pixel = settings.picture_spp;
  render_settings.max_bounces = settings.max_bounces;
  render_settings.seed = settings.seed;
  render_settings.lod = 0.0F;  // for all alike: not every codec has levels
  Progress progress(item.name + ": rendering " + variant.codec, settings.quiet);
  variant.traced = render(scene, render_settings, progress);
  progress.finish();
  HeadlessOptions preview;
  preview.lod = 0.0F;
  preview.timed_frames = settings.frames;
  variant.previewed = preview_headless(scene, preview);
  return variant;
}

ordered_json measured_of(const ImageDifference& d) {
  return {{"rmse", d.rmse}, {"relative_rmse", d.relative_rmse},
          {"mae", d.mae},   {"psnr", d.psnr},
          {"ssim", d.ssim}, {"largest", d.largest}};
}

ordered_json measured_of(const DemoVariant& v) {
  const RenderStatistics& s = v.traced.statistics;
  return {{"seconds_to_make", v.seconds},
          {"bytes", v.bytes},
          {"constant_bytes", v.constant_bytes},
          {"file_bytes", v.file_bytes},
          {"ratio", v.ratio},
          {"render",
           {{"seconds", s.seconds},
            {"build_seconds", s.build_seconds},
            {"samples", s.samples},
            {"rays", s.rays},
            {"rays_per_second", s.seconds > 0 ? static_cast<double>(s.rays) / s.seconds : 0.0},
            {"evaluations", s.evaluations},
            {"invalid", s.invalid.not_finite},
            {"negative", s.invalid.negative}}},
          {"preview",
           {{"ms_per_frame", v.previewed.ms_per_frame},
            {"best_ms", v.previewed.best_ms},
            {"fps", v.previewed.ms_per_frame > 0 ? 1000 / v.previewed.ms_per_frame : 0.0},
            {"upload_ms", v.previewed.upload_ms},
            {"bytes", v.previewed.bytes},
            {"renderer", v.previewed.renderer}}}};
}

}  // namespace

DemoResult run_demo_item(const DemoItem& item, const DemoSettings& settings) {
  const fs::path data = settings.folder / "data";
  std::error_code error;
  fs::create_directories(data, error);
  if (error) throw failed(data.string(), "cannot be made: " + error.message());
  const fs::path raw = data / (item.name + ".btf");
  const fs::path compressed = data / (item.name + "." + settings.codec);
  DemoResult result;
  result.item = item;
  result.kept = make_raw(item, settings, raw, result.acquired);
  const double fit_seconds = make_compressed(item, settings, raw, compressed);
  result.raw = draw(item, settings, raw);
  result.raw.seconds = result.acquired.at("seconds").get<double>();
  result.compressed = draw(item, settings, compressed);
  result.compressed.seconds = fit_seconds;
  result.traced =
      compare_images(result.raw.traced.image, result.compressed.traced.image,
                     item.name + ", path tracer, raw", item.name + ", path tracer, compressed");
  result.previewed =
      compare_images(result.raw.previewed.image, result.compressed.previewed.image,
                     item.name + ", preview, raw", item.name + ", preview, compressed");
  return result;
}

ordered_json measured_of(const DemoResult& result) {
  return {{"shape", result.item.shape},
          {"acquire", result.acquired},
          {"acquire_kept", result.kept},
          {"raw", measured_of(result.raw)},
          {result.compressed.codec, measured_of(result.compressed)},
          {"error",
           {{"render", measured_of(result.traced)}, {"preview", measured_of(result.previewed)}}}};
}

}  // namespace weft::cli
