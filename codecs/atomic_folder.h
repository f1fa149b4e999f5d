// Folders of a codec that appear whole or not at all, and whose files are checked when they are
// read.
#pragma once

#include <filesystem>
#include <functional>
#include <nlohmann/json.hpp>
#include <string>

namespace weft {

/// What `write_folder_atomically` would refuse, told before the work is done.
/// @throws Error  bad_input where `folder` is there and neither empty nor a codec's.
void check_replaceable(const std::filesystem::path& folder);

/// Calls `write` with a new folder beside, which is renamed to `folder` when it is done; nothing is
/// left where it throws. A codec's folder or an empty one that is there already is replaced.
/// @throws Error  bad_input where something else is there; failed where the disk refuses.
void write_folder_atomically(const std::filesystem::path& folder,
                             const std::function<void(const std::filesystem::path&)>& write);

/// {"NAME": "xxh3-128 in hex", …} of the folder's files but `codec.json`, sorted.
nlohmann::ordered_json folder_checksums(const std::filesystem::path& folder);

/// Reads `codec.json` and holds every file that its `files` names against its checksum.
/// @throws Error  naming the file that is missing, broken or differs.
nlohmann::ordered_json read_checked_codec_json(const std::filesystem::path& folder);

}  // namespace weft
