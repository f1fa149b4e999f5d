#include "cli/run_record.h"

#include <unistd.h>

#include <ctime>
#include <string>
#include <thread>

#include "btf/atomic_file.h"

namespace weft::cli {

namespace {

using Json = nlohmann::ordered_json;

std::string host_name() {
  std::string name(256, '\0');
  if (gethostname(name.data(), name.size() - 1) != 0) return "unknown";
  return name.c_str();
}

/// What `path` holds, or an empty array: a damaged record must not stop a run that went well.
Json earlier_runs(const std::filesystem::path& path) {
  if (!std::filesystem::exists(path)) return Json::array();
  Json runs = Json::parse(read_text(path), nullptr, false);
  return runs.is_array() ? runs : Json::array();
}

}  // namespace

void append_run(const std::filesystem::path& path, const Session& session) {
  Json runs = earlier_runs(path);
  runs.push_back(
      {{"command", session.command_line},
       {"host", host_name()},
       {"threads", session.threads > 0 ? session.threads
                                       : static_cast<int>(std::thread::hardware_concurrency())},
       {"finished_unix", static_cast<std::int64_t>(std::time(nullptr))},
       {"measured", session.measured}});
  write_text_atomically(path, runs.dump(1) + "\n");
}

}  // namespace weft::cli
