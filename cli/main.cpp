// weft: parses the command line, runs one subcommand, turns exceptions into a sentence and an exit
// code.

#include <fmt/core.h>
#include <oneapi/tbb/global_control.h>

#include <exception>
#include <new>
#include <optional>
#include <string>
#include <thread>

#include "btf/error.h"
#include "cli/command.h"

namespace weft::cli {

void Session::say(const std::string& line) const {
  if (!json && !quiet) fmt::print("{}\n", line);
}

namespace {

/// One sentence for a command line that cannot be understood; lists the subcommands where none was
/// chosen.
std::string explain(const CLI::App* app, const CLI::Error& error) {
  const auto chosen = app->get_subcommands();
  if (!chosen.empty()) {
    return fmt::format("weft: {} (weft {} --help)\n", error.what(), chosen[0]->get_name());
  }
  std::string names;
  for (const CLI::App* each : app->get_subcommands([](const CLI::App*) { return true; })) {
    names += (names.empty() ? "" : ", ") + each->get_name();
  }
  const auto rest = app->remaining();
  const std::string what =
      rest.empty() ? error.what() : fmt::format("there is no subcommand '{}'", rest[0]);
  return fmt::format("weft: {} (subcommands: {})\n", what, names);
}

int run(int argc, char** argv) {
  CLI::App app{"Makes, compresses, renders and judges bidirectional texture functions."};
  app.require_subcommand(1);
  app.fallthrough();
  app.failure_message(explain);
  Session session;
  for (int i = 0; i < argc; ++i) session.command_line += (i > 0 ? " " : "") + std::string(argv[i]);
  app.add_flag("--json", session.json, "Print one JSON object of what was measured");
  app.add_flag("--quiet", session.quiet, "Print nothing but errors");
  app.add_option("--threads", session.threads, "Threads; 0: all cores")
      ->capture_default_str()
      ->check(CLI::NonNegativeNumber);
  app.add_option("--seed", session.seed, "Seed of every random number")->capture_default_str();

  std::optional<oneapi::tbb::global_control> threads;
  app.parse_complete_callback([&] {
    if (session.threads > 0)
      threads.emplace(oneapi::tbb::global_control::max_allowed_parallelism, session.threads);
  });
  for (const auto add : {add_acquire, add_compress, add_render, add_preview, add_extract,
                         add_compare, add_info, add_list, add_validate, add_demo}) {
    add(app, session);
  }
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? ok : usage;
  }
  if (session.json) fmt::print("{}\n", session.measured.dump(2));
  return session.exit_code;
}

}  // namespace
}  // namespace weft::cli

int main(int argc, char** argv) {
  try {
    return weft::cli::run(argc, argv);
  } catch (const weft::Error& error) {
    fmt::print(stderr, "weft: {}\n", error.what());
    return error.kind() == weft::Error::Kind::bad_input ? weft::cli::usage : weft::cli::failure;
  } catch (const std::bad_alloc&) {
    fmt::print(stderr, "weft: out of memory\n");
    return weft::cli::failure;
  } catch (const std::exception& error) {
    fmt::print(stderr, "weft: {}\n", error.what());
    return weft::cli::failure;
  }
}
