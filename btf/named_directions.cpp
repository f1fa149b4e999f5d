// Direction sets by name.
#include <fmt/core.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <fstream>
#include <numbers>
#include <sstream>
#include <utility>

#include "btf/error.h"
#include "btf/hemisphere_sampling.h"

namespace weft {

namespace {

constexpr int most_directions = 16000;

struct Ring {
  double theta;  // degrees
  int count;
  double first_phi;  // degrees
};

std::vector<Direction> rings(std::initializer_list<Ring> list) {
  std::vector<Direction> directions;
  for (const Ring& ring : list) {
    for (int i = 0; i < ring.count; ++i) {
      directions.push_back(
          from_spherical(radians(ring.theta), radians(ring.first_phi + 360.0 * i / ring.count)));
    }
  }
  return directions;
}

// Spherical Fibonacci, equal area. The last points are lifted to 89.9 degrees, the lowest that is
// acquired.
std::vector<Direction> fibonacci(int n) {
  const double golden_angle = std::numbers::pi * (3 - std::sqrt(5.0));
  const double lowest = std::cos(radians(89.9));
  std::vector<Direction> directions;
  for (int i = 0; i < n; ++i) {
    const double z = std::max(1 - (i + 0.5) / n, lowest);
    directions.push_back(from_spherical(std::acos(z), i * golden_angle));
  }
  return directions;
}

std::vector<Direction> regular(int thetas, int phis) {
  std::vector<Direction> directions;
  for (int t = 0; t < thetas; ++t) {
    for (int p = 0; p < phis; ++p) {
      directions.push_back(
          from_spherical(radians(90.0 * (t + 0.5) / thetas), radians(360.0 * (p + 0.5) / phis)));
    }
  }
  return directions;
}

std::vector<Direction> from_csv(const std::string& name) {
  std::ifstream in(name);
  if (!in) throw bad_input(name, "cannot be read");
  std::string line;
  std::getline(in, line);
  std::erase_if(line, [](char c) { return c == ' ' || c == '\r'; });
  if (line != "theta,phi") throw bad_input(name + ":1", "expected the header \"theta,phi\"");
  std::vector<Direction> directions;
  for (int number = 2; std::getline(in, line); ++number) {
    if (line.find_first_not_of(" \r\t") == std::string::npos) continue;
    std::istringstream fields(line);
    double theta = 0;
    double phi = 0;
    char comma = 0;
    const std::string where = fmt::format("{}:{}", name, number);
    if (!(fields >> theta >> comma >> phi) || comma != ',') {
      throw bad_input(where,
                      "expected two angles in degrees, \"theta,phi\"; found \"" + line + "\"");
    }
    if (!(theta >= 0 && theta <= 90)) {
      throw bad_input(where, fmt::format("theta is {}; expected 0 to 90 degrees", theta));
    }
    directions.push_back(from_spherical(radians(theta), radians(phi)));
  }
  if (directions.empty() || std::cmp_greater(directions.size(), most_directions)) {
    throw bad_input(name, fmt::format("holds {} directions; expected 1 to {}, a line each",
                                      directions.size(), most_directions));
  }
  return directions;
}

// A whole number in [1, most_directions] that fills the text, or 0.
int count_of(std::string_view text) {
  int value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  const bool whole = error == std::errc() && end == text.data() + text.size();
  return whole && value > 0 && value <= most_directions ? value : 0;
}

}  // namespace

std::vector<Direction> named_directions(const std::string& name) {
  if (name == "ubo81") {
    return rings({{0, 1, 0}, {15, 6, 0}, {30, 12, 0}, {45, 18, 0}, {60, 20, 0}, {75, 24, 0}});
  }
  if (name == "ubo151") {
    return rings({{0, 1, 0},
                  {11, 6, 15},
                  {23.5, 12, 0},
                  {30, 12, 15},
                  {37.5, 12, 0},
                  {45, 18, 0},
                  {52.5, 18, 7.5},
                  {60, 24, 0},
                  {67.5, 24, 7.5},
                  {75, 24, 0}});
  }
  if (name.starts_with("file:") && name.size() > 5) return from_csv(name.substr(5));
  if (name.starts_with("fibonacci:")) {
    if (const int n = count_of(std::string_view(name).substr(10)); n > 0) return fibonacci(n);
  }
  if (name.starts_with("regular:")) {
    const std::string_view sizes = std::string_view(name).substr(8);
    const std::size_t x = sizes.find('x');
    if (x != std::string_view::npos) {
      const int thetas = count_of(sizes.substr(0, x));
      const int phis = count_of(sizes.substr(x + 1));
      if (thetas > 0 && phis > 0 && thetas * phis <= most_directions) return regular(thetas, phis);
    }
  }
  throw bad_input(
      "directions", "unknown set \"" + name + "\"",
      fmt::format("ubo81, ubo151, regular:THETAxPHI, fibonacci:N or file:NAME.csv, at most {} "
                  "directions",
                  most_directions));
}

}  // namespace weft
