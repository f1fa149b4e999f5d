#include "codecs/atomic_folder.h"

#include <fcntl.h>
#include <fmt/core.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <system_error>
#include <vector>

#include "btf/atomic_file.h"
#include "btf/error.h"

namespace weft {

namespace fs = std::filesystem;

namespace {

fs::path without_trailing_slash(const fs::path& folder) {
  const fs::path normal = folder.lexically_normal();
  return normal.has_filename() ? normal : normal.parent_path();
}

// What stood at `folder` is at `by` afterwards. Answers false where the file system cannot do it.
bool exchange(const fs::path& folder, const fs::path& by) {
  if (renameat2(AT_FDCWD, by.c_str(), AT_FDCWD, folder.c_str(), RENAME_EXCHANGE) == 0) return true;
  const int code = errno;
  if (code == EINVAL || code == ENOSYS || code == ENOTSUP) return false;
  throw fs::filesystem_error("exchange", by, folder,
                             std::error_code(code, std::generic_category()));
}

// Where two renames must do, the second may fail: the old folder comes back then.
void rename_twice(const fs::path& folder, const fs::path& by, const fs::path& old) {
  fs::rename(folder, old);
  try {
    fs::rename(by, folder);
  } catch (const fs::filesystem_error&) {
    std::error_code ignored;
    fs::rename(old, folder, ignored);
    throw;
  }
}

void replace(const fs::path& folder, const fs::path& by, const fs::path& old) {
  if (!fs::exists(folder)) {
    fs::rename(by, folder);
  } else if (!exchange(folder, by)) {
    rename_twice(folder, by, old);
  }
  sync_folder(folder.parent_path());
  fs::remove_all(by);
  fs::remove_all(old);
}

}  // namespace

void check_replaceable(const fs::path& folder) {
  if (!fs::exists(folder)) return;
  if (fs::is_directory(folder) && (fs::is_empty(folder) || fs::exists(folder / "codec.json")))
    return;
  throw bad_input(folder.string(), "is there already and is not a codec's folder",
                  "choose another name, or remove it");
}

void write_folder_atomically(const fs::path& folder,
                             const std::function<void(const fs::path&)>& write) {
  const fs::path target = without_trailing_slash(folder);
  check_replaceable(target);
  const std::string name = target.filename().string();
  const fs::path aside = target.parent_path() / fmt::format(".{}.part{}", name, getpid());
  const fs::path old = target.parent_path() / fmt::format(".{}.old{}", name, getpid());
  std::error_code ignored;
  try {
    fs::remove_all(aside);
    fs::create_directories(aside);
    write(aside);
    replace(target, aside, old);
  } catch (const fs::filesystem_error& error) {
    fs::remove_all(aside, ignored);
    throw failed(target.string(), "cannot be written: " + error.code().message());
  } catch (...) {
    fs::remove_all(aside, ignored);
    throw;
  }
}

nlohmann::ordered_json folder_checksums(const fs::path& folder) {
  std::vector<std::string> names;
  for (const auto& entry : fs::directory_iterator(folder)) names.push_back(entry.path().filename());
  std::ranges::sort(names);
  auto checksums = nlohmann::ordered_json::object();
  for (const std::string& name : names) {
    if (name != "codec.json") checksums[name] = file_checksum(folder / name);
  }
  return checksums;
}

nlohmann::ordered_json read_checked_codec_json(const fs::path& folder) {
  const fs::path path = folder / "codec.json";
  auto json = nlohmann::ordered_json::parse(read_text(path), nullptr, false);
  if (!json.is_object() || !json.contains("files") || !json["files"].is_object()) {
    throw bad_input(path.string(), "is not a JSON object with `files` and their checksums",
                    "the file is truncated or not Weft's");
  }
  for (const auto& [name, checksum] : json["files"].items()) {
    const fs::path file = folder / name;
    if (!fs::exists(file)) throw bad_input(file.string(), "is missing", "codec.json names it");
    if (file_checksum(file) != checksum) {
      throw bad_input(file.string(),
                      "is corrupted: its checksum differs from the one in codec.json");
    }
  }
  return json;
}

}  // namespace weft
