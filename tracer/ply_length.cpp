#include "tracer/ply_length.h"

#include <fmt/format.h>

#include <cstdint>
#include <fstream>
#include <map>
#include <sstream>
#include <string>
#include <vector>

#include "btf/error.h"

namespace weft {

namespace {

/// A scalar, or a list with a count before its values.
struct Property {
  std::size_t bytes = 0;
  std::size_t count_bytes = 0;  ///< 0: a scalar
};

struct Element {
  std::string name;
  std::uint64_t count = 0;
  std::vector<Property> properties;
};

enum class Format { ascii, little_endian, big_endian };

struct Header {
  Format format = Format::ascii;
  std::vector<Element> elements;
};

std::size_t size_of(const std::string& type, const std::string& where) {
  static const std::map<std::string, std::size_t> sizes = {
      {"char", 1},  {"uchar", 1},   {"int8", 1},   {"uint8", 1},  {"short", 2}, {"ushort", 2},
      {"int16", 2}, {"uint16", 2},  {"int", 4},    {"uint", 4},   {"int32", 4}, {"uint32", 4},
      {"float", 4}, {"float32", 4}, {"double", 8}, {"float64", 8}};
  const auto found = sizes.find(type);
  if (found == sizes.end()) throw bad_input(where, fmt::format("'{}' is no PLY type", type));
  return found->second;
}

Property read_property(std::istringstream& words, const std::string& where) {
  std::string type;
  words >> type;
  if (type != "list") return {size_of(type, where), 0};
  std::string count_type;
  words >> count_type >> type;
  return {size_of(type, where), size_of(count_type, where)};
}

Header read_header(std::istream& file, const std::string& name) {
  Header header;
  std::size_t line_number = 0;
  for (std::string line; std::getline(file, line);) {
    const std::string where = fmt::format("{}:{}", name, ++line_number);
    std::istringstream words(line);
    std::string keyword;
    words >> keyword;
    if (line_number == 1 && keyword != "ply")
      throw bad_input(where, "a PLY file begins with 'ply'");
    if (keyword == "end_header") return header;
    if (keyword == "format") {
      std::string format;
      words >> format;
      header.format = format == "ascii"                  ? Format::ascii
                      : format == "binary_little_endian" ? Format::little_endian
                                                         : Format::big_endian;
    } else if (keyword == "element") {
      Element element;
      if (!(words >> element.name >> element.count))
        throw bad_input(where, "an element's count is missing");
      header.elements.push_back(element);
    } else if (keyword == "property") {
      if (header.elements.empty()) throw bad_input(where, "a property stands before any element");
      header.elements.back().properties.push_back(read_property(words, where));
    }
  }
  throw bad_input(name, "the file ends within its header");
}

std::uint64_t read_count(const std::string& data, std::size_t at, std::size_t bytes,
                         Format format) {
  std::uint64_t value = 0;
  for (std::size_t i = 0; i < bytes; ++i) {
    const std::size_t digit = format == Format::little_endian ? bytes - 1 - i : i;
    value = value << 8 | static_cast<unsigned char>(data[at + digit]);
  }
  return value;
}

Error ends_early(const std::string& name, const Element& element, std::uint64_t instance) {
  return bad_input(
      name, fmt::format("the file ends within {} {} of {}", element.name, instance, element.count),
      "it is truncated");
}

void require_binary(const std::string& data, const Header& header, const std::string& name) {
  std::size_t at = 0;
  for (const Element& element : header.elements) {
    for (std::uint64_t i = 0; i < element.count; ++i) {
      for (const Property& property : element.properties) {
        std::uint64_t values = 1;
        if (property.count_bytes > 0) {
          if (data.size() - at < property.count_bytes) throw ends_early(name, element, i);
          values = read_count(data, at, property.count_bytes, header.format);
          at += property.count_bytes;
        }
        if ((data.size() - at) / property.bytes < values) throw ends_early(name, element, i);
        at += values * property.bytes;
      }
    }
  }
}

void require_ascii(const std::string& data, const Header& header, const std::string& name) {
  std::istringstream lines(data);
  std::string line;
  for (const Element& element : header.elements) {
    for (std::uint64_t i = 0; i < element.count; ++i) {
      do {
        if (!std::getline(lines, line)) throw ends_early(name, element, i);
      } while (line.find_first_not_of(" \t\r") == std::string::npos);
      std::istringstream words(line);
      for (const Property& property : element.properties) {
        std::string word;
        std::uint64_t values = 1;
        const bool counted = property.count_bytes == 0 || words >> values;
        for (std::uint64_t k = 0; counted && k < values && words; ++k) words >> word;
        if (!words) {
          throw bad_input(name, fmt::format("the line of {} {} of {} ends early", element.name, i,
                                            element.count));
        }
      }
    }
  }
}

}  // namespace

void require_whole_ply(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  const Header header = read_header(file, path.string());
  std::ostringstream rest;
  rest << file.rdbuf();
  const std::string data = std::move(rest).str();
  if (header.format == Format::ascii) {
    require_ascii(data, header, path.string());
  } else {
    require_binary(data, header, path.string());
  }
}

}  // namespace weft
