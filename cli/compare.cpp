// weft compare REF TEST: how far one picture is from another, in numbers and as a map; or how far a
// BTF is from a raw one, over all pairs of light and view.

#include <fmt/core.h>

#include <array>
#include <cmath>
#include <filesystem>
#include <limits>
#include <memory>

#include "btf/btf_file.h"
#include "btf/error.h"
#include "cli/command.h"
#include "cli/option_checks.h"
#include "codecs/representation.h"
#include "codecs/sample_error.h"
#include "images/image_file.h"
#include "study/colour_map.h"
#include "study/metrics.h"
#include "study/pair_errors.h"

namespace weft::cli {

namespace {

struct CompareOptions {
  std::string reference;
  std::string test;
  std::string map;
  double map_top = 0;
  double max_rmse = std::numeric_limits<double>::infinity();
};

const char* channel_name(const ImageDifference& d, int channels) {
  static constexpr const char* names[] = {"red", "green", "blue"};
  return channels < 3 ? "grey" : names[d.largest_channel];
}

void report(const ImageDifference& d, const char* channel, Session& session) {
  // JSON has no infinity: null stands for the PSNR of equal pictures.
  session.measured["rmse"] = d.rmse;
  session.measured["relative_rmse"] = d.relative_rmse;
  session.measured["mae"] = d.mae;
  session.measured["psnr"] = d.psnr;
  session.measured["peak"] = d.peak;
  session.measured["ssim"] = d.ssim;
  session.measured["largest"] = {
      {"error", d.largest}, {"x", d.largest_x}, {"y", d.largest_y}, {"channel", channel}};
  session.say(fmt::format("RMSE           {:.6g}   ({:.4g} % of the reference's mean)", d.rmse,
                          100 * d.relative_rmse));
  session.say(fmt::format("MAE            {:.6g}", d.mae));
  session.say(
      std::isinf(d.psnr) && d.psnr > 0
          ? std::string("PSNR           infinite: the pictures are equal")
          : fmt::format("PSNR           {:.2f} dB   (peak {:.6g}, the largest reference value)",
                        d.psnr, d.peak));
  session.say(fmt::format("SSIM           {:.6f}", d.ssim));
  session.say(fmt::format("largest error  {:.6g}   at x {}, y {}, {}", d.largest, d.largest_x,
                          d.largest_y, channel));
}

void write_map(const CompareOptions& options, const Image& reference, const Image& test,
               Session& session) {
  const Image errors = error_per_pixel(reference, test, options.reference, options.test);
  const double top = options.map_top > 0 ? options.map_top : scale_top(errors);
  write_image(options.map, draw_colour_map(errors, top, "abs. error"), Encoding::colour);
  session.measured["map"] = options.map;
  session.measured["map_top"] = top;
}

void hold_to_limit(double rmse, const CompareOptions& options, Session& session) {
  if (!(rmse > options.max_rmse)) return;
  session.exit_code = ExitCode::difference;
  if (!session.quiet) {
    fmt::print(stderr, "weft: RMSE {:.6g} is above --max-rmse {:.6g}\n", rmse, options.max_rmse);
  }
}

void compare_pictures(const CompareOptions& options, Session& session) {
  if (!options.map.empty()) check_image_path(options.map);
  const Image reference = read_image(options.reference, Encoding::colour);
  const Image test = read_image(options.test, Encoding::colour);
  const ImageDifference difference =
      compare_images(reference, test, options.reference, options.test);
  report(difference, channel_name(difference, reference.channels), session);
  if (!options.map.empty()) write_map(options, reference, test, session);
  hold_to_limit(difference.rmse, options, session);
}

nlohmann::ordered_json json_of(const PairSpread& spread) {
  return {{"average", spread.average}, {"least", spread.least}, {"greatest", spread.greatest}};
}

void report(const PairErrors& errors, Session& session) {
  static constexpr std::array<const char*, 3> names = {"y", "cb", "cr"};
  session.measured["pairs"] = errors.pairs;
  session.say(
      fmt::format("{} pairs     MSE: average, least, greatest        mean abs. difference: "
                  "average, least, greatest",
                  errors.pairs));
  for (std::size_t c = 0; c < names.size(); ++c) {
    const auto& [mse, mae] = errors.channels[c];
    session.measured[names[c]] = {{"mse", json_of(mse)}, {"mae", json_of(mae)}};
    session.say(fmt::format("{:10}  {:10.3e} {:10.3e} {:10.3e}    {:10.3e} {:10.3e} {:10.3e}",
                            names[c], mse.average, mse.least, mse.greatest, mae.average, mae.least,
                            mae.greatest));
  }
}

void compare_datasets(const CompareOptions& options, Session& session) {
  if (!options.map.empty()) {
    throw bad_input("--map",
                    "draws the error of a picture, but " + options.reference + " is a dataset",
                    "weft extract makes pictures of datasets");
  }
  const Btf reference = read_btf(options.reference);
  const auto test = open_representation(options.test);
  const PairErrors errors = pair_errors(reference, *test, options.test);
  const SampleError error = sample_error(reference, *test);
  session.measured["rmse"] = error.rmse;
  session.measured["relative_rmse"] = error.relative_rmse;
  session.say(
      fmt::format("RMSE        {:.6g} 1/sr over RGB at the samples ({:.4g} % of the "
                  "reference's RMS)",
                  error.rmse, 100 * error.relative_rmse));
  report(errors, session);
  hold_to_limit(error.rmse, options, session);
}

void compare(const CompareOptions& options, Session& session) {
  const bool dataset = std::filesystem::is_directory(options.reference);
  (dataset ? compare_datasets : compare_pictures)(options, session);
}

}  // namespace

void add_compare(CLI::App& app, Session& session) {
  CLI::App* command = app.add_subcommand(
      "compare",
      "Measure how far picture TEST is from REF, in linear values (8-bit files are decoded from "
      "sRGB): "
      "RMSE, MAE, PSNR, SSIM, largest error; or a BTF, raw or compressed, from the raw one that it "
      "was made from, at its samples: RMSE, and of Y, Cb and Cr (linear, BT.601's weights) mean "
      "square error and mean absolute difference of each pair of light and view, 1/sr: average, "
      "least and greatest. Exit code 3 where --max-rmse is exceeded");
  auto options = std::make_shared<CompareOptions>();
  command->add_option("reference", options->reference, "Picture or raw BTF that is taken as true")
      ->option_text("REF")
      ->required();
  command->add_option("test", options->test, "Picture or BTF to judge")
      ->option_text("TEST")
      ->required();
  command
      ->add_option("--map", options->map,
                   "Write the error of each pixel (mean of |TEST - REF| over R, G, B) in colours, "
                   "with a legend")
      ->option_text("FILE.png");
  command
      ->add_option(
          "--map-top", options->map_top,
          "Error that has the map's brightest colour; default: the 99.5th percentile, rounded up")
      ->option_text("X")
      ->check(above(0));
  command
      ->add_option("--max-rmse", options->max_rmse,
                   "Exit with 3 where the RMSE is above X (linear values)")
      ->option_text("X")
      ->check(at_least(0));
  command->callback([options, &session] { compare(*options, session); });
}

}  // namespace weft::cli
