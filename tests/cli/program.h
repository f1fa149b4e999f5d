// Runs the program as a user does, and says what came of it.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

struct Outcome {
  int exit_code = -1;
  std::string out;
  std::string err;
  long peak_kibibytes = 0;  ///< resident set at its largest
};

/// Runs `weft ARGUMENTS`; `folder` is where it runs. Arguments are passed as they are, no shell
/// between.
Outcome run_weft(const std::vector<std::string>& arguments, const std::filesystem::path& folder);

/// The same for another program, found on PATH.
Outcome run_program(const std::vector<std::string>& command, const std::filesystem::path& folder);

/// Everything below a folder, hidden files too, relative and sorted.
std::vector<std::string> files_below(const std::filesystem::path& folder);
