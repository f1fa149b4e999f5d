// One view of a dataset as a multi-part EXR: a part a light, RGB, angles as attributes.
#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "btf/btf.h"

namespace weft {

/// What is the same in all parts of a view's file.
struct ViewFileHeader {
  int width = 0;
  int height = 0;
  PixelType pixel_type = PixelType::half;
  std::string provenance;  ///< of the run that wrote it
};

/// What is known of one view; all but `values` may be empty.
struct ViewData {
  std::span<const float> values = {};           ///< [light][y][x][rgb]
  std::span<const float> standard_errors = {};  ///< of each light's tile mean (mean of RGB)
  std::span<const float> texel_errors = {};     ///< standard error of every value, as `values`
  std::span<const float> coverage = {};         ///< [y][x], 0 to 1
};

/// Parts light_000 ..., then light_000.error ... and alpha (one channel A) where they are known.
/// The file appears whole or not at all.
/// @throws Error  failed, where the file cannot be written whole.
void write_view_file(const std::filesystem::path& path, const ViewFileHeader& header,
                     const Direction& view, std::span<const Direction> lights,
                     const ViewData& data);

/// @throws Error  naming the file: missing, truncated, not such a file.
ViewFileHeader read_view_header(const std::filesystem::path& path);

/// What a view's file tells beside its texels.
struct ViewNotes {
  std::string provenance;
  std::vector<float> standard_errors;  ///< of the lights' tile means; empty where it has none
};
ViewNotes read_view_notes(const std::filesystem::path& path);

/// Standard errors of the values, as they lie in `read_view_values`; empty where the file has none.
std::vector<float> read_texel_errors(const std::filesystem::path& path, int width, int height,
                                     std::size_t lights);

/// [y][x]; empty where the file has none.
std::vector<float> read_coverage(const std::filesystem::path& path, int width, int height);

/// [light][y][x][rgb]. @throws Error  where the file is truncated, or not of this size and number
/// of lights.
std::vector<float> read_view_values(const std::filesystem::path& path, int width, int height,
                                    std::size_t lights);

}  // namespace weft
