#include "study/dataset_cache.h"

#include <fmt/core.h>

#include <cstdlib>
#include <string>

#include "btf/error.h"
#include "btf/random.h"

namespace weft {

namespace fs = std::filesystem;

fs::path cache_folder() {
  if (const char* chosen = std::getenv("XDG_CACHE_HOME"); chosen && fs::path(chosen).is_absolute())
    return fs::path(chosen) / "weft";
  if (const char* home = std::getenv("HOME"); home && *home != '\0')
    return fs::path(home) / ".cache" / "weft";
  throw bad_input("HOME", "is not set, and XDG_CACHE_HOME neither",
                  "set one of them: traced datasets are kept in a folder below it");
}

fs::path cached_dataset(const fs::path& cache, const Mesostructure& mesostructure,
                        const AcquisitionSettings& settings, Progress& progress) {
  std::uint64_t hash = 0;
  for (const char c : provenance_of(mesostructure, settings)) hash = hash_coordinates(hash, c);
  const fs::path folder = cache / fmt::format("{:016x}.btf", hash);
  if (fs::exists(folder / "btf.json")) return folder;  // a dataset's JSON comes last
  std::error_code refused;
  fs::create_directories(cache, refused);
  if (refused) throw failed(cache.string(), "cannot be made: " + refused.message());
  acquire(mesostructure, settings, folder, progress);
  return folder;
}

}  // namespace weft
