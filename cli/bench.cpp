// weft bench: how fast the parts are, and what they lose; a file a part.
#include "cli/command.h"

namespace weft::cli {

void add_bench(CLI::App& app, Session& session) {
  CLI::App* bench = app.add_subcommand("bench", "Measure how fast the parts are");
  bench->require_subcommand(1);
  add_bench_acquire(*bench, session);
  add_bench_codecs(*bench, session);
}

}  // namespace weft::cli
