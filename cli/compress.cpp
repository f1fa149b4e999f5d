// weft compress IN.btf: fits a codec to a raw BTF, writes it, and tells its size and its error at
// the samples.

#include <fmt/core.h>

#include <chrono>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "btf/btf_file.h"
#include "btf/error.h"
#include "cli/command.h"
#include "cli/memory_option.h"
#include "codecs/atomic_folder.h"
#include "codecs/fit_checkpoint.h"
#include "codecs/fit_memory.h"
#include "codecs/representation.h"
#include "codecs/sample_error.h"

namespace weft::cli {

namespace fs = std::filesystem;

namespace {

struct CompressOptions {
  std::string input;
  std::string output;
  std::string codec = "cmf";
  std::vector<std::string> parameters;
  std::uint64_t memory = 0;
};

std::string codec_names() {
  std::string names;
  for (const Codec& codec : codecs()) names += (names.empty() ? "" : ", ") + codec.name;
  return names;
}

std::string parameter_table() {
  std::string table;
  for (const Codec& codec : codecs()) {
    if (!codec.parameters.empty()) {
      table +=
          fmt::format("\nParameters of {} (--set KEY=VALUE):\n{}", codec.name, codec.parameters);
    }
  }
  return table;
}

/// Whether a codec draws random numbers: one of its lines of parameters is `seed = 0 ...`.
bool takes_seed(const Codec& codec) {
  return codec.parameters.starts_with("seed ") ||
         codec.parameters.find("\nseed ") != std::string::npos;
}

std::uintmax_t size_on_disk(const fs::path& folder) {
  std::uintmax_t bytes = 0;
  for (const auto& entry : fs::directory_iterator(folder)) bytes += entry.file_size();
  return bytes;
}

// A dataset that is read here would vanish under its reader.
void refuse_same_folder(const CompressOptions& options) {
  std::error_code ignored;
  if (fs::equivalent(options.input, options.output, ignored)) {
    throw bad_input("--output", fmt::format("'{}' is the input itself", options.output));
  }
}

// Without a slash at its end.
fs::path output_folder(const std::string& output) {
  const fs::path normal = fs::path(output).lexically_normal();
  return normal.has_filename() ? normal : normal.parent_path();
}

// Beside the output: what a codec that takes long has done so far.
fs::path checkpoint_folder(const std::string& output) {
  return output_folder(output).string() + ".partial";
}

// Where people put what is large and short-lived; else where there is to be room for the result.
fs::path scratch_folder(const CompressOptions& options) {
  const char* named = std::getenv("TMPDIR");
  if (named != nullptr && *named != 0) return named;
  return fs::absolute(output_folder(options.output)).parent_path();
}

std::shared_ptr<const Btf> read_input(const CompressOptions& options, const Codec& codec,
                                      const Session& session) {
  std::shared_ptr<MemoryBudget> memory;
  if (options.memory > 0) {
    memory =
        fit_budget(options.memory, read_btf_header(options.input), codec, scratch_folder(options));
  }
  const auto btf = std::make_shared<const Btf>(read_btf(options.input, memory));
  if (btf->mapped() && lies_in_memory(memory->scratch_folder())) {
    session.warn(
        fmt::format("{} lies in memory: --memory saves none; name a folder on a disk in TMPDIR",
                    memory->scratch_folder().string()));
  }
  return btf;
}

void compress(const CompressOptions& options, Session& session, bool seed_given) {
  const Codec& codec = codec_named(options.codec);
  refuse_same_folder(options);
  // Before minutes of fitting. A raw dataset has another folder, whose writer looks itself.
  if (codec.name != "raw") check_replaceable(options.output);
  std::vector<std::string> overrides = options.parameters;
  if (seed_given && takes_seed(codec))
    overrides.insert(overrides.begin(), fmt::format("seed={}", session.seed));
  const Settings parameters = Settings::from_text("", "--set", overrides);
  const auto btf = read_input(options, codec, session);

  Progress progress("compress " + options.codec, session.quiet);
  progress.keep_in(checkpoint_folder(options.output));
  const auto begin = std::chrono::steady_clock::now();
  const auto fitted = codec.fit(btf, parameters, progress);
  const std::chrono::duration<double> fit_time = std::chrono::steady_clock::now() - begin;
  progress.finish();
  fitted->save(options.output);
  remove_checkpoint(progress.kept_in());
  const SampleError error = sample_error(*btf, *fitted);
  const std::uintmax_t file_bytes = size_on_disk(options.output);

  session.measured["codec"] = options.codec;
  session.measured["input"] = options.input;
  session.measured["output"] = options.output;
  session.measured["bytes"] = fitted->bytes();
  session.measured["constant_bytes"] = fitted->constant_bytes();
  session.measured["file_bytes"] = file_bytes;
  session.measured["ratio"] = compression_ratio(*fitted);
  session.measured["fit_seconds"] = fit_time.count();
  session.measured["rmse"] = error.rmse;
  session.measured["relative_rmse"] = error.relative_rmse;
  session.measured["luminance_difference"] = error.luminance_difference;
  session.say(fmt::format("{}  {}", options.output, codec.summary));
  session.say(fmt::format("textures    {} bytes, {:.1f} times below 24-bit input", fitted->bytes(),
                          compression_ratio(*fitted)));
  session.say(fmt::format("on disk     {} bytes", file_bytes));
  session.say(fmt::format("fitted in   {:.2f} s", fit_time.count()));
  for (const auto& [name, value] : progress.reported()) {
    session.measured["fit"][name] = value;
    session.say(fmt::format("{:<11} {:.6g}", name, value));
  }
  session.say(fmt::format("RMSE        {:.6g} 1/sr at the samples ({:.2f} % of the data's RMS)",
                          error.rmse, 100 * error.relative_rmse));
}

}  // namespace

void add_compress(CLI::App& app, Session& session) {
  auto options = std::make_shared<CompressOptions>();
  CLI::App* command = app.add_subcommand("compress", "Fit a codec to a raw BTF");
  command->add_option("input", options->input, "Folder of the raw BTF (NAME.btf)")->required();
  command->add_option("--codec", options->codec, "One of " + codec_names())->capture_default_str();
  command->add_option("-o,--output", options->output, "Folder to write, e.g. NAME.cmf")->required();
  command
      ->add_option("--set", options->parameters,
                   "A parameter of the codec, KEY=VALUE; may be repeated")
      ->allow_extra_args(false);
  add_memory_option(
      *command, options->memory,
      "Most memory, e.g. 2GiB: what does not fit lies in a scratch file in TMPDIR, or "
      "beside the output; 0: all in memory");
  command->footer(parameter_table());
  command->callback([&app, &session, options] {
    compress(*options, session, app.get_option("--seed")->count() > 0);
  });
}

}  // namespace weft::cli
