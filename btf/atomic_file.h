// Files that appear whole or not at all: written aside, synced, renamed.
#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <span>
#include <string>
#include <string_view>

namespace weft {

/// Lasting on disk: the names in a folder, after a rename. @throws Error failed.
void sync_folder(const std::filesystem::path& folder);

/// Calls `write` with a temporary path in the same folder, syncs what it wrote, renames it to
/// `path`, and syncs the folder. Nothing is left where `write` throws. @throws Error failed, naming
/// `path`, where the disk refuses.
void write_atomically(const std::filesystem::path& path,
                      const std::function<void(const std::filesystem::path&)>& write);

/// The same for a text.
void write_text_atomically(const std::filesystem::path& path, std::string_view text);

/// The same where there is no `path` yet; false, and nothing is changed, where there is one. Of
/// several processes that try, on several machines too, one succeeds.
bool create_text_atomically(const std::filesystem::path& path, std::string_view text);

/// Removes what killed processes left beside files that they were writing in `folder`. What a
/// living process of this machine writes stays, and so does what another machine has touched within
/// the last hour.
void remove_abandoned(const std::filesystem::path& folder);

/// Whole contents. @throws Error bad_input, naming `path`, where it cannot be read.
std::string read_text(const std::filesystem::path& path);

/// xxh3-128, 32 hex digits.
std::string checksum(std::span<const std::byte> bytes);
/// The same of a file's bytes.
std::string file_checksum(const std::filesystem::path& path);

}  // namespace weft
