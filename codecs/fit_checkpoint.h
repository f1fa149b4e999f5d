// What a long fit has done so far, kept on disk piece by piece, so that an interrupted run
// continues.
//
// A folder beside the output: `checkpoint.json` names codec, version, parameters and data; each
// piece (a view, a mip level) is a file of doubles. Pieces of another fit are thrown away, and so
// is a damaged one: it is fitted again.
#pragma once

#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "btf/btf.h"

namespace weft {

/// Names a fit: canonical JSON of codec, version, parameters, and a checksum of directions and
/// values, which takes a reading of all the data. The version is raised by whoever changes what a
/// fit makes of the same data.
/// @param parameters  JSON: every parameter of the fit, defaults too.
std::string fit_key(const Btf& btf, const std::string& codec, int version,
                    const std::string& parameters);

class FitCheckpoint {
 public:
  /// Keeps nothing.
  FitCheckpoint() = default;
  /// Keeps pieces in `folder`, or nothing where it is empty. The folder comes with its first piece.
  /// @throws Error  bad_input where something else than a checkpoint is there.
  FitCheckpoint(std::filesystem::path folder, std::string key);

  /// For `Progress::kept_in()`: the data are read for their checksum only where something is kept.
  static FitCheckpoint of_fit(const std::filesystem::path& folder, const Btf& btf,
                              const std::string& codec, int version, const std::string& parameters);

  /// Keeps one piece. Not synced: what a power cut damages is made again.
  /// @param name    of a file: letters, digits and underscores.
  /// @throws Error  failed where the disk refuses.
  void keep(const std::string& name, std::span<const double> values) const;

  /// The piece as it was kept; none where it is not there, damaged, or has not `count` values.
  std::optional<std::vector<double>> find(const std::string& name, std::size_t count) const;

  /// How many pieces were found so far: what an earlier run had done.
  std::size_t found() const { return found_; }

 private:
  std::filesystem::path folder_;
  std::string key_;
  mutable std::size_t found_ = 0;
};

/// Removes a checkpoint's folder, where there is one, when the fit's result is on disk.
void remove_checkpoint(const std::filesystem::path& folder);

}  // namespace weft
