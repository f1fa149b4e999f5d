#include "cli/bar_report.h"

#include <fmt/format.h>

namespace weft::cli {

void report_bars(std::span<const Bar> bars, Session& session) {
  session.measured["bars"] = nlohmann::ordered_json::array();
  session.say("");
  for (const Bar& bar : bars) {
    session.measured["bars"].push_back({{"what", bar.what},
                                        {"value", bar.value},
                                        {bar.at_least ? "at_least" : "below", bar.limit},
                                        {"unit", bar.unit},
                                        {"met", bar.met()}});
    session.say(fmt::format("{}  {:70} {:8.2f} {} ({} {:g})", bar.met() ? "met   " : "MISSED",
                            bar.what, bar.value, bar.unit, bar.at_least ? "at least" : "below",
                            bar.limit));
  }
}

}  // namespace weft::cli
