// What every subcommand shares: the global options, and the JSON object that `--json` prints.
#pragma once

#include <CLI/CLI.hpp>
#include <cstdint>
#include <nlohmann/json.hpp>

namespace weft::cli {

/// Exit codes of the program.
enum ExitCode { ok = 0, failure = 1, usage = 2, difference = 3 };

struct Session {
  bool json = false;
  bool quiet = false;
  int threads = 0;  ///< 0: all cores
  std::uint64_t seed = 0;
  std::string command_line;  ///< as it was typed, for records of a run
  /// What the command measured; printed as one object with `--json`.
  nlohmann::ordered_json measured = nlohmann::ordered_json::object();
  int exit_code = ok;
  /// Prints a line for people: nothing with --json or --quiet.
  void say(const std::string& line) const;
  /// Prints a warning to stderr: nothing with --quiet.
  void warn(const std::string& line) const;
};

// Each adds one subcommand; its callback does the work when it was chosen.
void add_acquire(CLI::App& app, Session& session);
void add_bench(CLI::App& app, Session& session);
void add_compare(CLI::App& app, Session& session);
void add_compress(CLI::App& app, Session& session);
void add_demo(CLI::App& app, Session& session);
void add_extract(CLI::App& app, Session& session);
void add_info(CLI::App& app, Session& session);
void add_list(CLI::App& app, Session& session);
void add_preview(CLI::App& app, Session& session);
void add_render(CLI::App& app, Session& session);
void add_validate(CLI::App& app, Session& session);

// Each adds one subcommand of `bench`.
void add_bench_acquire(CLI::App& bench, Session& session);
void add_bench_codecs(CLI::App& bench, Session& session);

}  // namespace weft::cli
