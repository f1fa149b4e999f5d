// A BTF dataset on disk: a folder with one multi-part EXR a view and a `btf.json` that comes last.
#pragma once

#include <filesystem>
#include <memory>
#include <string>

#include "btf/btf.h"
#include "btf/view_file.h"

namespace weft {

/// The quantity that Weft traces.
inline constexpr const char* traced_quantity =
    "radiance per perpendicular irradiance, 1/sr, cosine included";

/// What `btf.json` tells, without the pixels.
struct BtfHeader {
  int version = 1;
  std::string quantity = traced_quantity;
  int width = 0;
  int height = 0;
  HemisphereSampling views;
  HemisphereSampling lights;
  PixelType pixel_type = PixelType::half;
  float tile_size = 1;
  std::string provenance = "{}";  ///< canonical JSON: settings only, no paths, threads or shards
  /// Standard error of each pair's tile mean (mean of RGB), [view][light]; empty where it is not
  /// known.
  std::vector<float> standard_errors;
};

/// Views of which `folder` has no file yet, ascending; all where there is no such folder.
/// @throws Error  bad_input where it holds views of other settings or a compressed dataset, or is a
/// file.
std::vector<std::size_t> missing_views(const std::filesystem::path& folder,
                                       const BtfHeader& header);

/// Checksums every view's file and writes `btf.json`. What a view's own writer knew (its standard
/// errors) is read from its file, so that it does not matter who wrote which view.
/// @throws Error  bad_input where a view is missing, or of other settings.
void finish_btf(const std::filesystem::path& folder, const BtfHeader& header);

/// Writes a dataset view by view; each file appears whole or not at all, and the JSON comes last.
/// Several writers of one dataset may work in one folder at once, on several machines too.
class BtfWriter {
 public:
  /// Creates the folder, and `unfinished.json` in it, which names the settings before the first
  /// view does. Views that are there already, whole and of the same settings, are kept
  /// (`has_view`), so that an interrupted run continues.
  /// @throws Error  where the folder holds another dataset, raw or compressed, is a file, or cannot
  /// be written.
  BtfWriter(std::filesystem::path folder, BtfHeader header);
  /// Where an exception ends it, a folder that it made goes again, unless a view is in it.
  ~BtfWriter();
  BtfWriter(const BtfWriter&) = delete;
  BtfWriter& operator=(const BtfWriter&) = delete;

  bool has_view(std::size_t view) const;

  /// @param data  `values` are finite and >= 0.
  /// @throws Error  bad_input where a half would overflow (count and the worst sample named) or a
  /// value is NaN,
  ///                infinite or negative; failed where the disk is full.
  void write_view(std::size_t view, const ViewData& data);

  /// `finish_btf` of this dataset.
  void finish() const { finish_btf(folder_, header_); }

 private:
  std::filesystem::path view_path(std::size_t view) const;

  std::filesystem::path folder_;
  BtfHeader header_;
  int exceptions_;  ///< under way when it was made
  bool made_folder_ = false;
};

/// Path of `btf.json`'s view file: "view_000.exr", at least three digits.
std::string view_file_name(std::size_t view);

/// @throws Error  naming the file and field that is missing, truncated or of another size.
BtfHeader read_btf_header(const std::filesystem::path& folder);
/// Each view's file is read once, also where the data are larger than `memory` (see `Btf`).
Btf read_btf(const std::filesystem::path& folder, std::shared_ptr<MemoryBudget> memory = nullptr);

/// Writes a whole BTF.
void write_btf(const std::filesystem::path& folder, const Btf& btf);

/// Recomputes each file's xxh3-128 and returns the names of those that differ from `btf.json`.
std::vector<std::string> corrupted_files(const std::filesystem::path& folder);

}  // namespace weft
