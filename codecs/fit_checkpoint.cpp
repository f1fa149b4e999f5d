#include "codecs/fit_checkpoint.h"

#include <fmt/core.h>
#include <tbb/parallel_for.h>
#include <unistd.h>

#include <cstring>
#include <fstream>
#include <nlohmann/json.hpp>

#include "btf/atomic_file.h"
#include "btf/error.h"

namespace weft {

namespace fs = std::filesystem;

namespace {

constexpr const char* key_file = "checkpoint.json";
constexpr std::size_t checksum_size = 32;

std::string data_checksum(const Btf& btf) {
  const auto texels = static_cast<std::size_t>(btf.width()) * btf.height();
  const std::size_t values = 3 * btf.views().size() * btf.lights().size();
  std::vector<std::string> parts(texels);
  tbb::parallel_for(std::size_t{0}, texels, [&](std::size_t texel) {
    std::vector<float> abrdf(values);
    const auto width = static_cast<std::size_t>(btf.width());
    btf.abrdf(static_cast<int>(texel % width), static_cast<int>(texel / width), abrdf);
    parts[texel] = checksum(std::as_bytes(std::span(abrdf)));
  });
  std::string all = fmt::format("{} x {}", btf.width(), btf.height());
  for (const HemisphereSampling* sampling : {&btf.views(), &btf.lights()})
    all += checksum(std::as_bytes(sampling->directions()));
  for (const std::string& part : parts) all += part;
  return checksum(std::as_bytes(std::span(all)));
}

bool is_checkpoint(const fs::path& folder) {
  return fs::is_directory(folder) && (fs::is_empty(folder) || fs::exists(folder / key_file));
}

fs::path piece(const fs::path& folder, const std::string& name) {
  return folder / (name + ".f64");
}

}  // namespace

std::string fit_key(const Btf& btf, const std::string& codec, int version,
                    const std::string& parameters) {
  const nlohmann::json json{{"codec", codec},
                            {"version", version},
                            {"parameters", nlohmann::json::parse(parameters)},
                            {"data", data_checksum(btf)}};
  return json.dump(2) + "\n";
}

FitCheckpoint::FitCheckpoint(fs::path folder, std::string key)
    : folder_(std::move(folder)), key_(std::move(key)) {
  if (folder_.empty() || !fs::exists(folder_)) return;
  if (!is_checkpoint(folder_)) {
    throw bad_input(folder_.string(), "is there already and is not a fit's checkpoint",
                    "choose another name for the output, or remove it");
  }
  if (fs::exists(folder_ / key_file) && read_text(folder_ / key_file) == key_) return;
  remove_checkpoint(folder_);
}

FitCheckpoint FitCheckpoint::of_fit(const fs::path& folder, const Btf& btf,
                                    const std::string& codec, int version,
                                    const std::string& parameters) {
  if (folder.empty()) return {};
  return {folder, fit_key(btf, codec, version, parameters)};
}

void FitCheckpoint::keep(const std::string& name, std::span<const double> values) const {
  if (folder_.empty()) return;
  const fs::path path = piece(folder_, name);
  const fs::path aside = folder_ / fmt::format(".{}.part{}", name, getpid());
  try {
    if (!fs::exists(folder_ / key_file)) {
      fs::create_directories(folder_);
      write_text_atomically(folder_ / key_file, key_);
    }
    const auto bytes = std::as_bytes(values);
    const std::string sum = checksum(bytes);
    std::ofstream out(aside, std::ios::binary);
    out.write(sum.data(), static_cast<std::streamsize>(sum.size()));
    out.write(reinterpret_cast<const char*>(bytes.data()),
              static_cast<std::streamsize>(bytes.size()));
    out.close();
    if (!out) throw failed(path.string(), "cannot be written: " + system_reason(errno));
    fs::rename(aside, path);
  } catch (const fs::filesystem_error& error) {
    throw failed(path.string(), "cannot be written: " + error.code().message());
  } catch (const Error&) {
    std::error_code ignored;
    fs::remove(aside, ignored);
    throw;
  }
}

std::optional<std::vector<double>> FitCheckpoint::find(const std::string& name,
                                                       std::size_t count) const {
  if (folder_.empty() || !fs::exists(piece(folder_, name))) return std::nullopt;
  const std::string text = read_text(piece(folder_, name));
  if (text.size() != checksum_size + count * sizeof(double)) return std::nullopt;
  std::vector<double> values(count);
  std::memcpy(values.data(), text.data() + checksum_size, count * sizeof(double));
  if (checksum(std::as_bytes(std::span(values))) != text.substr(0, checksum_size))
    return std::nullopt;
  ++found_;
  return values;
}

void remove_checkpoint(const fs::path& folder) {
  std::error_code ignored;
  if (!folder.empty() && is_checkpoint(folder)) fs::remove_all(folder, ignored);
}

}  // namespace weft
