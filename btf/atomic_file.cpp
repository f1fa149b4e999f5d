#include "btf/atomic_file.h"

#include <fcntl.h>
#include <fmt/core.h>
#include <unistd.h>
#include <xxhash.h>

#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstring>
#include <fstream>
#include <memory>
#include <new>
#include <regex>
#include <sstream>
#include <system_error>
#include <vector>

#include "btf/error.h"

namespace weft {

namespace fs = std::filesystem;

namespace {

// Where a process's number means this process: host and PID namespace, since machines and
// containers may share a folder.
std::string machine() {
  std::string name(512, '\0');
  if (gethostname(name.data(), 255) != 0) name[0] = '\0';
  std::string identity = name.c_str();
  const ssize_t length = readlink("/proc/self/ns/pid", name.data(), name.size());
  if (length > 0) identity += name.substr(0, static_cast<std::size_t>(length));
  return fmt::format("{:016x}", XXH3_64bits(identity.data(), identity.size())).substr(0, 8);
}

// In the same folder, with the same extension: writers choose their format by it. Machine and
// process number keep two runs apart.
fs::path aside(const fs::path& path) {
  fs::path name = path.stem();
  name += fmt::format(".part{}-{}", machine(), getpid());
  name += path.extension();
  return path.parent_path() / ("." + name.string());
}

// Gives `temporary` its name unless that is taken. A hard link does so in one step, over NFS too; a
// file system without them leaves a moment between asking and renaming.
bool link_or_rename(const fs::path& temporary, const fs::path& path) {
  if (link(temporary.c_str(), path.c_str()) == 0) {
    fs::remove(temporary);
    return true;
  }
  if (errno == EEXIST || fs::exists(path)) {
    fs::remove(temporary);
    return false;
  }
  fs::rename(temporary, path);
  return true;
}

void sync(const fs::path& path, const fs::path& final_path) {
  const int file = open(path.c_str(), O_RDONLY | O_CLOEXEC);
  if (file < 0) throw failed(final_path.string(), "cannot be written: " + system_reason(errno));
  const int result = fsync(file);
  const int code = errno;
  close(file);
  if (result != 0) throw failed(final_path.string(), "cannot be synced: " + system_reason(code));
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
    throw failed(name.string(), "cannot be synced: " + system_reason(code));
  }
}

namespace {

/// `publish` gives the temporary file its name.
void write_aside(const fs::path& path, const std::function<void(const fs::path&)>& write,
                 const std::function<void(const fs::path&)>& publish) {
  const fs::path temporary = aside(path);
  std::error_code ignored;
  try {
    write(temporary);
    sync(temporary, path);
    publish(temporary);
    sync_folder(path.parent_path());
  } catch (const fs::filesystem_error& error) {
    fs::remove(temporary, ignored);
    throw failed(path.string(), "cannot be written: " + error.code().message());
  } catch (...) {
    fs::remove(temporary, ignored);
    throw;
  }
}

std::function<void(const fs::path&)> text_writer(const fs::path& path, std::string_view text) {
  return [&path, text](const fs::path& temporary) {
    errno = 0;
    std::ofstream out(temporary, std::ios::binary);
    out.write(text.data(), static_cast<std::streamsize>(text.size()));
    out.close();
    if (!out) throw failed(path.string(), "cannot be written: " + system_reason(errno));
  };
}

bool is_old(const fs::path& path) {
  std::error_code error;
  const auto written = fs::last_write_time(path, error);
  return !error && fs::file_time_type::clock::now() - written > std::chrono::hours(1);
}

}  // namespace

void write_atomically(const fs::path& path, const std::function<void(const fs::path&)>& write) {
  write_aside(path, write, [&](const fs::path& temporary) { fs::rename(temporary, path); });
}

void write_text_atomically(const fs::path& path, std::string_view text) {
  write_atomically(path, text_writer(path, text));
}

bool create_text_atomically(const fs::path& path, std::string_view text) {
  bool created = false;
  write_aside(path, text_writer(path, text),
              [&](const fs::path& temporary) { created = link_or_rename(temporary, path); });
  return created;
}

void remove_abandoned(const fs::path& folder) {
  static const std::regex name(R"(\..*\.part([0-9a-f]{8})-([0-9]{1,9})(\..*)?)");
  const std::string here = machine();
  std::vector<fs::path> abandoned;
  for (const auto& entry : fs::directory_iterator(folder)) {
    const std::string file = entry.path().filename().string();
    std::smatch match;
    if (!std::regex_match(file, match, name)) continue;
    const bool dead = match[1].str() == here
                          ? kill(std::stoi(match[2].str()), 0) != 0 && errno == ESRCH
                          : is_old(entry.path());
    if (dead) abandoned.push_back(entry.path());
  }
  std::error_code ignored;
  for (const fs::path& path : abandoned) fs::remove(path, ignored);
}

namespace {

std::ifstream opened(const fs::path& path) {
  errno = 0;
  std::ifstream in(path, std::ios::binary);
  if (!in || fs::is_directory(path)) {
    throw bad_input(path.string(),
                    "cannot be read: " + (errno != 0 ? system_reason(errno) : "not a file"));
  }
  return in;
}

}  // namespace

std::string read_text(const fs::path& path) {
  const std::ifstream in = opened(path);
  std::ostringstream text;
  text << in.rdbuf();
  return text.str();
}

namespace {

std::string hexadecimal(const XXH128_hash_t& hash) {
  return fmt::format("{:016x}{:016x}", hash.high64, hash.low64);
}

}  // namespace

std::string checksum(std::span<const std::byte> bytes) {
  return hexadecimal(XXH3_128bits(bytes.data(), bytes.size()));
}

std::string file_checksum(const fs::path& path) {
  constexpr std::size_t block = std::size_t{1} << 20;
  std::ifstream in = opened(path);
  const std::unique_ptr<XXH3_state_t, decltype(&XXH3_freeState)> state(XXH3_createState(),
                                                                       &XXH3_freeState);
  if (!state) throw std::bad_alloc();
  XXH3_128bits_reset(state.get());
  std::vector<char> bytes(block);
  do {
    in.read(bytes.data(), static_cast<std::streamsize>(block));
    XXH3_128bits_update(state.get(), bytes.data(), static_cast<std::size_t>(in.gcount()));
  } while (in);
  return hexadecimal(XXH3_128bits_digest(state.get()));
}

}  // namespace weft
