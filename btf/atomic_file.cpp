#include "btf/atomic_file.h"

#include <fcntl.h>
#include <fmt/core.h>
#include <unistd.h>
#include <xxhash.h>

#include <cerrno>
#include <csignal>
#include <cstring>
#include <fstream>
#include <regex>
#include <sstream>
#include <system_error>
#include <vector>

#include "btf/error.h"

namespace weft {

namespace fs = std::filesystem;

namespace {

std::string reason(int code) {
  return std::generic_category().message(code);
}

// In the same folder, with the same extension: writers choose their format by it. The process's
// number keeps two runs apart.
fs::path aside(const fs::path& path) {
  fs::path name = path.stem();
  name += fmt::format(".part{}", getpid());
  name += path.extension();
  return path.parent_path() / ("." + name.string());
}

void sync(const fs::path& path, const fs::path& final_path) {
  const int file = open(path.c_str(), O_RDONLY | O_CLOEXEC);
  if (file < 0) throw failed(final_path.string(), "cannot be written: " + reason(errno));
  const int result = fsync(file);
  const int code = errno;
  close(file);
  if (result != 0) throw failed(final_path.string(), "cannot be synced: " + reason(code));
}

}  // namespace

void sync_folder(const fs::path& folder) {
  const fs::path name = folder.empty() ? fs::path(".") : folder;
  const int file = open(name.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (file < 0) return;  // one that may be written to and not be read
  const int result = fsync(file);
  const int code = errno;
  close(file);
  // Some network file systems cannot sync a folder, and say EINVAL.
  if (result != 0 && code != EINVAL) {
    throw failed(name.string(), "cannot be synced: " + reason(code));
  }
}

void write_atomically(const fs::path& path, const std::function<void(const fs::path&)>& write) {
  const fs::path temporary = aside(path);
  std::error_code ignored;
  try {
    write(temporary);
    sync(temporary, path);
    fs::rename(temporary, path);
    sync_folder(path.parent_path());
  } catch (const fs::filesystem_error& error) {
    fs::remove(temporary, ignored);
    throw failed(path.string(), "cannot be written: " + error.code().message());
  } catch (...) {
    fs::remove(temporary, ignored);
    throw;
  }
}

void write_text_atomically(const fs::path& path, std::string_view text) {
  write_atomically(path, [&](const fs::path& temporary) {
    errno = 0;
    std::ofstream out(temporary, std::ios::binary);
    out.write(text.data(), static_cast<std::streamsize>(text.size()));
    out.close();
    if (!out) throw failed(path.string(), "cannot be written: " + reason(errno));
  });
}

void remove_abandoned(const fs::path& folder) {
  static const std::regex name(R"(\..*\.part([0-9]{1,9})(\..*)?)");
  std::vector<fs::path> abandoned;
  for (const auto& entry : fs::directory_iterator(folder)) {
    const std::string file = entry.path().filename().string();
    std::smatch match;
    if (!std::regex_match(file, match, name)) continue;
    const bool alive = kill(std::stoi(match[1].str()), 0) == 0 || errno != ESRCH;
    if (!alive) abandoned.push_back(entry.path());
  }
  std::error_code ignored;
  for (const fs::path& path : abandoned) fs::remove(path, ignored);
}

std::string read_text(const fs::path& path) {
  errno = 0;
  std::ifstream in(path, std::ios::binary);
  if (!in || fs::is_directory(path)) {
    throw bad_input(path.string(),
                    "cannot be read: " + (errno != 0 ? reason(errno) : "not a file"));
  }
  std::ostringstream text;
  text << in.rdbuf();
  return text.str();
}

std::string file_checksum(const fs::path& path) {
  const std::string bytes = read_text(path);
  const XXH128_hash_t hash = XXH3_128bits(bytes.data(), bytes.size());
  return fmt::format("{:016x}{:016x}", hash.high64, hash.low64);
}

}  // namespace weft
