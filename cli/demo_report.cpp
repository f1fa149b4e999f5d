#include "cli/demo_report.h"

#include <fmt/core.h>

#include <cctype>
#include <cmath>

#include "study/colour_map.h"

namespace weft::cli {

namespace {

std::string megabytes(double bytes) {
  return fmt::format("{:.2f}", bytes / 1e6);
}

std::string decibels(double psnr) {
  return std::isinf(psnr) ? "equal" : fmt::format("{:.1f}", psnr);
}

std::string percent(double part) {
  return fmt::format("{:.2f}", 100 * part);
}

/// The error of `compressed` in colours, with its numbers below.
ReportPicture error_picture(const std::string& name, const Image& raw, const Image& compressed,
                            const ImageDifference& difference) {
  const Image errors = error_per_pixel(raw, compressed);
  return {
      name, "Error",
      fmt::format("RMSE {} % of the mean, PSNR {} dB, SSIM {:.4f}",
                  percent(difference.relative_rmse), decibels(difference.psnr), difference.ssim),
      draw_colour_map(errors, scale_top(errors), "abs. error")};
}

ReportRow traced_row(const DemoResult& r) {
  const auto picture = [&](const DemoVariant& v, const std::string& caption) {
    const RenderStatistics& s = v.traced.statistics;
    return ReportPicture{
        r.item.name + "_traced_" + v.codec, caption,
        fmt::format("{:.1f} s, {:.2f} million rays/s", s.seconds,
                    s.seconds > 0 ? 1e-6 * static_cast<double>(s.rays) / s.seconds : 0.0),
        v.traced.image};
  };
  return {"Path tracer",
          {picture(r.raw, "Raw"), picture(r.compressed, "Compressed, " + r.compressed.codec),
           error_picture(r.item.name + "_traced_error", r.raw.traced.image,
                         r.compressed.traced.image, r.traced)}};
}

ReportRow previewed_row(const DemoResult& r) {
  const auto picture = [&](const DemoVariant& v, const std::string& caption) {
    return ReportPicture{r.item.name + "_preview_" + v.codec, caption,
                         fmt::format("{:.1f} ms a frame", v.previewed.ms_per_frame),
                         v.previewed.image};
  };
  return {"OpenGL preview",
          {picture(r.raw, "Raw"), picture(r.compressed, "Compressed, " + r.compressed.codec),
           error_picture(r.item.name + "_preview_error", r.raw.previewed.image,
                         r.compressed.previewed.image, r.previewed)}};
}

ReportSection section_of(const DemoResult& r) {
  std::string title = r.item.name + " on a " + r.item.shape;
  title[0] = static_cast<char>(std::toupper(static_cast<unsigned char>(title[0])));
  return {title,
          fmt::format("Raw: {} MB, traced in {:.1f} s at {:.1f} million rays/s. Compressed with "
                      "{}: {} MB, {:.0f} "
                      "times smaller than 24-bit pictures, fitted in {:.1f} s.",
                      megabytes(static_cast<double>(r.raw.bytes)), r.raw.seconds,
                      1e-6 * r.acquired.at("rays_per_second").get<double>(), r.compressed.codec,
                      megabytes(static_cast<double>(r.compressed.bytes)), r.compressed.ratio,
                      r.compressed.seconds),
          {traced_row(r), previewed_row(r)},
          {}};
}

std::vector<std::string> table_row(const DemoResult& r, const DemoVariant& v, bool is_reference) {
  const RenderStatistics& s = v.traced.statistics;
  const auto error = [&](const std::string& text) {
    return is_reference ? std::string("\u2013") : text;
  };
  return {
      r.item.name + " / " + r.item.shape,
      v.codec,
      fmt::format("{:.1f}", v.seconds),
      megabytes(static_cast<double>(v.bytes)),
      megabytes(static_cast<double>(v.file_bytes)),
      fmt::format("{:.{}f}", v.ratio, v.ratio < 10 ? 2 : 0),
      fmt::format("{:.1f}", s.seconds),
      fmt::format("{:.2f}", s.seconds > 0 ? 1e-6 * static_cast<double>(s.rays) / s.seconds : 0.0),
      fmt::format("{:.1f}", v.previewed.ms_per_frame > 0 ? 1000 / v.previewed.ms_per_frame : 0.0),
      error(percent(r.traced.relative_rmse)),
      error(decibels(r.traced.psnr)),
      error(fmt::format("{:.4f}", r.traced.ssim)),
      error(percent(r.previewed.relative_rmse)),
      error(decibels(r.previewed.psnr))};
}

ReportTable table_of(std::span<const DemoResult> results) {
  ReportTable table;
  table.columns = {{"BTF / shape", "", false},
                   {"codec", "", false},
                   {"made in", "s"},
                   {"size", "MB on the GPU"},
                   {"files", "MB"},
                   {"ratio", "to 24 bit"},
                   {"path tracer", "s"},
                   {"path tracer", "million rays/s"},
                   {"preview", "frames/s"},
                   {"RMSE", "path tracer, %"},
                   {"PSNR", "path tracer, dB"},
                   {"SSIM", "path tracer"},
                   {"RMSE", "preview, %"},
                   {"PSNR", "preview, dB"}};
  for (const DemoResult& r : results) {
    table.rows.push_back(table_row(r, r.raw, true));
    table.rows.push_back(table_row(r, r.compressed, false));
  }
  table.note =
      "Errors are those of the compressed picture against the raw one, in linear values: RMSE in "
      "per cent of the "
      "raw picture's mean, PSNR with the raw picture's largest value as peak. Made in: seconds of "
      "tracing for raw, "
      "of fitting for the codec. MB are millions of bytes. Ratio: 24-bit pictures of every light "
      "and view over the "
      "bytes on the GPU; below 1 for raw, which is half floats with coarser levels of detail.";
  return table;
}

}  // namespace

Report demo_report(std::span<const DemoResult> results, const DemoSettings& settings,
                   const std::string& footer) {
  Report report;
  report.title = "Weft: from mesostructure to picture";
  report.text = fmt::format(
      "Each mesostructure was traced to a bidirectional texture function of {0} x {0} texels ({1} "
      "views and lights, {2} "
      "paths a texel and view, up to {3} further bounces), compressed, and put on a shape. Both "
      "the raw and the "
      "compressed data were rendered with the path tracer ({4} samples a pixel, global "
      "illumination) and with the "
      "OpenGL preview (one sample at each pixel's centre, direct light without shadows), all at "
      "the finest level of "
      "detail.",
      settings.texels, settings.directions, settings.spp, settings.max_bounces,
      settings.picture_spp);
  ReportSection summary;
  summary.title = "Speed, size, error";
  summary.tables.push_back(table_of(results));
  report.sections.push_back(std::move(summary));
  for (const DemoResult& r : results) report.sections.push_back(section_of(r));
  report.footer = footer;
  return report;
}

}  // namespace weft::cli
