// weft: parses the command line, runs one subcommand, turns exceptions into a sentence and an exit
// code.

#include <fmt/core.h>
#include <oneapi/tbb/global_control.h>

#include <exception>
#include <limits>
#include <new>
#include <optional>
#include <string>
#include <vector>

#include "btf/error.h"
#include "cli/command.h"
#include "cli/option_checks.h"
#include "settings/nearest_name.h"

namespace weft::cli {

void Session::say(const std::string& line) const {
  if (!json && !quiet) fmt::print("{}\n", line);
}

void Session::warn(const std::string& line) const {
  if (!quiet) fmt::print(stderr, "weft: warning: {}\n", line);
}

namespace {

/// The subcommand that was typed last, and how one gets to it ("weft list").
struct Chosen {
  const CLI::App* app;
  std::string typed;
};

Chosen deepest_chosen(const CLI::App* app) {
  Chosen chosen{app, "weft"};
  for (auto next = app->get_subcommands(); !next.empty(); next = chosen.app->get_subcommands()) {
    chosen = {next.back(), chosen.typed + " " + next.back()->get_name()};
  }
  return chosen;
}

std::vector<std::string> subcommands_of(const CLI::App* app) {
  std::vector<std::string> names;
  for (const CLI::App* each : app->get_subcommands([](const CLI::App*) { return true; })) {
    names.push_back(each->get_name());
  }
  return names;
}

/// One sentence for a command line that cannot be understood; lists the subcommands where one is
/// missing or mistyped.
std::string explain(const CLI::App* app, const CLI::Error& error) {
  const Chosen chosen = deepest_chosen(app);
  const std::vector<std::string> names = subcommands_of(chosen.app);
  const std::string kind = error.get_name();
  const auto rest = app->remaining();
  const bool option = !rest.empty() && rest[0].starts_with('-');
  if (names.empty() || option || (kind != "RequiredError" && kind != "ExtrasError")) {
    const std::string what = option && !names.empty()
                                 ? fmt::format("there is no option '{}'", rest[0])
                                 : std::string(error.what());
    return fmt::format("weft: {} ({} --help)\n", what, chosen.typed);
  }
  if (rest.empty()) {
    return fmt::format("weft: '{}' needs a subcommand ({})\n", chosen.typed, name_hint("", names));
  }
  return fmt::format("weft: '{}' has no subcommand '{}' ({})\n", chosen.typed, rest[0],
                     name_hint(rest[0], names));
}

/// A subcommand's help lists its own options only; this adds what every one of them takes.
void append_to_help(CLI::App& app, const std::string& text) {
  for (CLI::App* command : app.get_subcommands([](CLI::App*) { return true; })) {
    const std::string own = command->get_footer();
    command->footer(text + (own.empty() ? "" : "\n" + own));
    append_to_help(*command, text);
  }
}

std::string global_options(const CLI::App& app) {
  return CLI::Formatter().make_group(
      "Options of every command", false,
      app.get_options([&](const CLI::Option* option) { return option != app.get_help_ptr(); }));
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
      ->check(whole_number(1024));
  app.add_option("--seed", session.seed, "Seed of every random number")
      ->capture_default_str()
      ->check(whole_number(std::numeric_limits<std::uint64_t>::max()));

  std::optional<oneapi::tbb::global_control> threads;
  app.parse_complete_callback([&] {
    if (session.threads > 0)
      threads.emplace(oneapi::tbb::global_control::max_allowed_parallelism, session.threads);
  });
  for (const auto add : {add_acquire, add_compress, add_render, add_preview, add_extract,
                         add_compare, add_info, add_list, add_validate, add_bench, add_demo}) {
    add(app, session);
  }
  append_to_help(app, global_options(app));
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
