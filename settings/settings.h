// Settings that a person writes: a TOML file, or `--set KEY=VALUE` pairs, read with names, places
// and hints.
//
// Each key that is asked for is marked; `finish()` then refuses what nobody asked for, naming its
// line and the names that are valid there. A value of another type than asked for is an error with
// its line; NaN and infinity are no numbers here. Not for use from several threads at once.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "btf/vector.h"

namespace weft {

class Settings {
 public:
  /// No keys at all: every question is answered by its default.
  Settings();
  /// @param overrides  "a.b.c=VALUE" pairs, the last of equals wins; VALUE is TOML, or a bare word
  ///                   that is taken as a string. `a.0.b` names element 0 of an array of tables.
  /// @throws Error     with file:line:column for a syntax error.
  static Settings from_file(const std::filesystem::path& path,
                            const std::vector<std::string>& overrides = {});
  static Settings from_text(const std::string& text, const std::string& name,
                            const std::vector<std::string>& overrides = {});

  bool has(const std::string& key) const;

  // Each answers the value of `key`, or `fallback` where it is absent. The forms without a fallback
  // throw where the key is absent, naming it.
  double number(const std::string& key) const;
  double number(const std::string& key, double fallback) const;
  /// Also checks lower <= value <= upper. @throws Error with the range.
  double number(const std::string& key, double fallback, double lower, double upper) const;
  std::int64_t integer(const std::string& key, std::int64_t fallback, std::int64_t lower,
                       std::int64_t upper) const;
  bool flag(const std::string& key, bool fallback) const;
  std::string text(const std::string& key) const;
  std::string text(const std::string& key, const std::string& fallback) const;
  /// One of `choices`, a string or a whole number spelt so; @throws Error listing them. The first
  /// is the fallback.
  std::string choice(const std::string& key, const std::vector<std::string>& choices) const;
  std::vector<double> numbers(const std::string& key) const;
  Vec2 vec2(const std::string& key, const Vec2& fallback) const;
  Vec3 vec3(const std::string& key) const;
  Vec3 vec3(const std::string& key, const Vec3& fallback) const;
  /// A colour: three numbers, or one for all three; each >= 0.
  Rgb rgb(const std::string& key, const Rgb& fallback) const;
  /// A path, relative to the file it stands in; one from an override, to the working folder.
  std::filesystem::path path(const std::string& key) const;
  /// The same of a file or folder that is there. @throws Error naming the line and the path.
  std::filesystem::path existing_path(const std::string& key) const;

  /// A sub-table; empty settings where absent. Its `finish()` is called by this one's.
  Settings table(const std::string& key) const;
  /// The same, where keys that are absent are filled in from `defaults`, a TOML text; a table that
  /// names its own `type` takes none of them.
  Settings table(const std::string& key, const std::string& defaults) const;
  /// An array of tables (or of inline tables); empty where absent.
  std::vector<Settings> tables(const std::string& key) const;
  /// Names of the keys of this table, sorted.
  std::vector<std::string> keys() const;

  /// "file:line:column" of a key, or of this table for an empty key.
  std::string where(const std::string& key = {}) const;

  /// @throws Error  for the first key, here or in sub-tables, that nobody asked for: its line, the
  ///                nearest name and all that were asked for there. Where an override changed a
  ///                table's `type`, what the file says for the type that it had is left aside.
  void finish() const;

  /// All keys and values as canonical JSON text (sorted keys, shortest numbers), sub-tables
  /// included. Of a file only its
  /// name and checksum, so that the text depends on what it holds and not on where it lies.
  std::string canonical_json() const;

 private:
  struct Node;
  explicit Settings(std::shared_ptr<Node> node);
  std::shared_ptr<Node> node_;
};

}  // namespace weft
