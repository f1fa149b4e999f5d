#include "study/colour_map.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "btf/error.h"
#include "images/text.h"

namespace weft {

namespace {

constexpr Rgb white{1, 1, 1};
constexpr Rgb ink{0.02F, 0.02F, 0.02F};
constexpr int font_size = 15;
constexpr int gap = 10;        // between the map, the bar and the numbers
constexpr int bar_width = 18;  // pixels
constexpr int tick_length = 5;

void fill(Image& image, int x0, int y0, int width, int height, const Rgb& colour) {
  for (int y = y0; y < y0 + height; ++y) {
    for (int x = x0; x < x0 + width; ++x) image.set_rgb(x, y, colour);
  }
}

/// Mantissa 1, 2 or 5 times a power of ten, the least that is >= value (value > 0).
double round_up(double value) {
  const double power = std::pow(10.0, std::floor(std::log10(value)));
  for (const double mantissa : {1.0, 2.0, 5.0}) {
    // The slack keeps 0.2 from becoming 0.5 when 0.2 / 0.1 rounds to above 2.
    if (value <= mantissa * power * (1 + 1e-6)) return mantissa * power;
  }
  return 10 * power;
}

/// Multiples of a round step from 0, five or so, and `top` itself as the last.
std::vector<double> tick_values(double top) {
  const double step = round_up(top / 5 * (1 - 1e-6));
  std::vector<double> ticks;
  for (int i = 0; i * step <= top * (1 + 1e-6); ++i) ticks.push_back(i * step);
  if (top - ticks.back() > 0.5 * step) {
    ticks.push_back(top);
  } else {
    ticks.back() = top;
  }
  return ticks;
}

struct Legend {
  std::vector<double> ticks;
  std::vector<std::string> labels;
  int width = 0;
};

Legend legend_of(double top, bool clamped, const std::string& unit) {
  Legend legend;
  legend.ticks = tick_values(top);
  int label_width = 0;
  for (const double tick : legend.ticks) {
    const bool last = tick == top;
    legend.labels.push_back((last && clamped ? ">= " : "") + fmt::format("{:.3g}", tick));
    label_width = std::max(label_width, text_width(legend.labels.back(), font_size));
  }
  legend.width =
      gap + std::max(text_width(unit, font_size), bar_width + tick_length + gap / 2 + label_width) +
      gap;
  return legend;
}

void draw_legend(Image& picture, int left, const Legend& legend, double top,
                 const std::string& unit) {
  const int bar_x = left + gap;
  const int bar_y = 2 * font_size + font_size / 2;  // room for the unit and half the topmost number
  const int bar_height = picture.height - bar_y - font_size;
  draw_text(picture, bar_x, font_size, unit, font_size, ink);
  for (int y = 0; y < bar_height; ++y) {
    const double t = 1 - (y + 0.5) / bar_height;
    fill(picture, bar_x, bar_y + y, bar_width, 1, scale_colour(t));
  }
  for (std::size_t i = 0; i < legend.ticks.size(); ++i) {
    const int y =
        bar_y + static_cast<int>(std::lround((1 - legend.ticks[i] / top) * (bar_height - 1)));
    fill(picture, bar_x + bar_width, y, tick_length, 1, ink);
    draw_text(picture, bar_x + bar_width + tick_length + gap / 2, y, legend.labels[i], font_size,
              ink);
  }
}

}  // namespace

Vec3 oklab(const Rgb& c) {
  const double l = std::cbrt(0.4122214708 * c.x + 0.5363325363 * c.y + 0.0514459929 * c.z);
  const double m = std::cbrt(0.2119034982 * c.x + 0.6806995451 * c.y + 0.1073969566 * c.z);
  const double s = std::cbrt(0.0883024619 * c.x + 0.2817188376 * c.y + 0.6299787005 * c.z);
  return {static_cast<float>(0.2104542553 * l + 0.7936177850 * m - 0.0040720468 * s),
          static_cast<float>(1.9779984951 * l - 2.4285922050 * m + 0.4505937099 * s),
          static_cast<float>(0.0259040371 * l + 0.7827717662 * m - 0.8086757660 * s)};
}

Rgb linear_from_oklab(const Vec3& lab) {
  const double l = std::pow(lab.x + 0.3963377774 * lab.y + 0.2158037573 * lab.z, 3);
  const double m = std::pow(lab.x - 0.1055613458 * lab.y - 0.0638541728 * lab.z, 3);
  const double s = std::pow(lab.x - 0.0894841775 * lab.y - 1.2914855480 * lab.z, 3);
  return {static_cast<float>(4.0767416621 * l - 3.3077115913 * m + 0.2309699292 * s),
          static_cast<float>(-1.2684380046 * l + 2.6097574011 * m - 0.3413193965 * s),
          static_cast<float>(-0.0041960863 * l - 0.7034186147 * m + 1.7076147010 * s)};
}

Rgb scale_colour(double t) {
  // The longest arc, and so the most colours to tell apart, that a search over centres, radii and
  // angles found inside the display's gamut for this span of lightness.
  t = std::clamp(t, 0.0, 1.0);
  const double lightness = 0.25 + t * (0.92 - 0.25);
  const double angle = (-80 - 150 * t) * std::numbers::pi / 180;
  return linear_from_oklab({static_cast<float>(lightness),
                            static_cast<float>(0.05 + 0.16 * std::cos(angle)),
                            static_cast<float>(0.06 + 0.16 * std::sin(angle))});
}

double scale_top(const Image& values) {
  if (values.values.empty()) return 1;
  std::vector<float> sorted = values.values;
  const auto percentile =
      sorted.begin() + static_cast<std::ptrdiff_t>(0.995 * static_cast<double>(sorted.size() - 1));
  std::nth_element(sorted.begin(), percentile, sorted.end());
  const float largest = *std::max_element(percentile, sorted.end());
  const float value = *percentile > 0 ? *percentile : largest;
  return value > 0 ? round_up(value) : 1;
}

Image draw_colour_map(const Image& values, double top, const std::string& unit) {
  if (values.channels != 1)
    throw bad_input("colour map", fmt::format("expected 1 channel, found {}", values.channels));
  if (!(top > 0) || !std::isfinite(top)) {
    throw bad_input("colour map", fmt::format("the scale must end above 0, found {}", top));
  }
  const bool clamped =
      std::any_of(values.values.begin(), values.values.end(), [&](float v) { return v > top; });
  const Legend legend = legend_of(top, clamped, unit);
  constexpr int least_height = 180;  // below it the numbers would touch
  Image picture(values.width + legend.width, std::max(values.height, least_height), 3);
  fill(picture, 0, 0, picture.width, picture.height, white);
  for (int y = 0; y < values.height; ++y) {
    for (int x = 0; x < values.width; ++x) {
      picture.set_rgb(x, y, scale_colour(values.values[values.offset(x, y)] / top));
    }
  }
  draw_legend(picture, values.width, legend, top, unit);
  return picture;
}

}  // namespace weft
