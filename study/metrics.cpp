#include "study/metrics.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "btf/error.h"

namespace weft {

namespace {

int colour_channels(const Image& image) {
  return image.channels >= 3 ? 3 : 1;
}

const char* channel_name(int channel, int channels) {
  static constexpr const char* names[] = {"red", "green", "blue"};
  return channels == 1 ? "grey" : names[channel];
}

void refuse_not_finite(const Image& image, const std::string& name) {
  const int channels = colour_channels(image);
  std::size_t count = 0;
  std::string first;
  for (int y = 0; y < image.height; ++y) {
    for (int x = 0; x < image.width; ++x) {
      for (int c = 0; c < channels; ++c) {
        const float value = image.values[image.offset(x, y) + c];
        if (std::isfinite(value)) continue;
        if (count++ == 0) {
          first = fmt::format("{} at x {}, y {}, {}", value, x, y, channel_name(c, channels));
        }
      }
    }
  }
  if (count > 0) {
    throw bad_input(name,
                    fmt::format("{} values are NaN or infinite; the first is {}", count, first));
  }
}

void check_pair(const Image& reference, const Image& test, const std::string& reference_name,
                const std::string& test_name) {
  if (reference.width != test.width || reference.height != test.height) {
    throw bad_input(test_name,
                    fmt::format("is {} x {} pixels, but {} is {} x {}", test.width, test.height,
                                reference_name, reference.width, reference.height));
  }
  if (colour_channels(reference) != colour_channels(test)) {
    throw bad_input(test_name, fmt::format("has {} channels, but {} has {}", test.channels,
                                           reference_name, reference.channels));
  }
  if (reference.width <= 0 || reference.height <= 0) {
    throw bad_input(reference_name, "has no pixels");
  }
  refuse_not_finite(reference, reference_name);
  refuse_not_finite(test, test_name);
}

/// Of Rec. 709 primaries.
Image luminance(const Image& image) {
  Image grey(image.width, image.height, 1);
  for (int y = 0; y < image.height; ++y) {
    for (int x = 0; x < image.width; ++x) {
      const float* p = &image.values[image.offset(x, y)];
      grey.values[grey.offset(x, y)] =
          colour_channels(image) == 1 ? p[0] : 0.2126F * p[0] + 0.7152F * p[1] + 0.0722F * p[2];
    }
  }
  return grey;
}

/// A plane of doubles: SSIM subtracts moments that are nearly equal.
struct Plane {
  int width;
  int height;
  std::vector<double> values;
};

constexpr int window_radius = 5;

/// Gaussian means along a row of `count` values that lie `stride` apart; see `mean_ssim` for the
/// borders.
void filter_line(const double* in, int count, std::size_t stride, double* out,
                 std::size_t out_stride) {
  static const std::vector<double> weights = [] {
    std::vector<double> w(2 * window_radius + 1);
    for (int i = -window_radius; i <= window_radius; ++i) {
      w[i + window_radius] = std::exp(-i * i / (2 * 1.5 * 1.5));
    }
    return w;
  }();
  const int margin = count > 2 * window_radius ? window_radius : 0;
  for (int centre = margin; centre < count - margin; ++centre) {
    double sum = 0;
    double weight = 0;
    for (int i = std::max(0, centre - window_radius);
         i <= std::min(count - 1, centre + window_radius); ++i) {
      const double w = weights[i - centre + window_radius];
      sum += w * in[i * stride];
      weight += w;
    }
    out[(centre - margin) * out_stride] = sum / weight;
  }
}

int filtered_size(int size) {
  return size > 2 * window_radius ? size - 2 * window_radius : size;
}

Plane filtered(const Plane& plane) {
  Plane rows{filtered_size(plane.width), plane.height, {}};
  rows.values.resize(static_cast<std::size_t>(rows.width) * rows.height);
  for (int y = 0; y < plane.height; ++y) {
    filter_line(&plane.values[static_cast<std::size_t>(y) * plane.width], plane.width, 1,
                &rows.values[static_cast<std::size_t>(y) * rows.width], 1);
  }
  Plane both{rows.width, filtered_size(rows.height), {}};
  both.values.resize(static_cast<std::size_t>(both.width) * both.height);
  for (int x = 0; x < rows.width; ++x) {
    filter_line(&rows.values[x], rows.height, rows.width, &both.values[x], both.width);
  }
  return both;
}

/// Windowed means of a(x) b(x).
Plane filtered_product(const Image& a, const Image& b) {
  Plane product{a.width, a.height, std::vector<double>(a.values.size())};
  for (std::size_t i = 0; i < product.values.size(); ++i) {
    product.values[i] = static_cast<double>(a.values[i]) * b.values[i];
  }
  return filtered(product);
}

Plane filtered_mean(const Image& a) {
  return filtered({a.width, a.height, std::vector<double>(a.values.begin(), a.values.end())});
}

}  // namespace

double mean_ssim(const Image& a, const Image& b, double dynamic_range) {
  const Plane mean_a = filtered_mean(a);
  const Plane mean_b = filtered_mean(b);
  const Plane square_a = filtered_product(a, a);
  const Plane square_b = filtered_product(b, b);
  const Plane product = filtered_product(a, b);
  const double c1 = std::pow(0.01 * dynamic_range, 2);
  const double c2 = std::pow(0.03 * dynamic_range, 2);
  // A factor 0 / 0 (both windows black, or both flat, and L = 0) compares equal things.
  const auto ratio = [](double above, double below) { return below > 0 ? above / below : 1.0; };
  double sum = 0;
  for (std::size_t i = 0; i < mean_a.values.size(); ++i) {
    const double mu_a = mean_a.values[i];
    const double mu_b = mean_b.values[i];
    const double variance_a = std::max(0.0, square_a.values[i] - mu_a * mu_a);
    const double variance_b = std::max(0.0, square_b.values[i] - mu_b * mu_b);
    const double covariance = product.values[i] - mu_a * mu_b;
    sum += ratio(2 * mu_a * mu_b + c1, mu_a * mu_a + mu_b * mu_b + c1) *  // eq. 13
           ratio(2 * covariance + c2, variance_a + variance_b + c2);
  }
  return sum / static_cast<double>(mean_a.values.size());  // eq. 17
}

ImageDifference compare_images(const Image& reference, const Image& test,
                               const std::string& reference_name, const std::string& test_name) {
  check_pair(reference, test, reference_name, test_name);
  const int channels = colour_channels(reference);
  ImageDifference result;
  double squares = 0;
  double absolutes = 0;
  double total = 0;
  for (int y = 0; y < reference.height; ++y) {
    for (int x = 0; x < reference.width; ++x) {
      for (int c = 0; c < channels; ++c) {
        const double expected = reference.values[reference.offset(x, y) + c];
        const double error = std::abs(test.values[test.offset(x, y) + c] - expected);
        squares += error * error;
        absolutes += error;
        total += expected;
        result.peak = std::max(result.peak, expected);
        if (error > result.largest) {
          result.largest = error;
          result.largest_x = x;
          result.largest_y = y;
          result.largest_channel = c;
        }
      }
    }
  }
  const double count = static_cast<double>(reference.width) * reference.height * channels;
  result.rmse = std::sqrt(squares / count);
  result.mae = absolutes / count;
  const bool equal = result.rmse == 0;
  const double mean = total / count;
  constexpr double infinity = std::numeric_limits<double>::infinity();
  result.relative_rmse = equal ? 0 : mean > 0 ? result.rmse / mean : infinity;
  result.psnr = equal ? infinity : 20 * std::log10(result.peak / result.rmse);

  const Image grey_reference = luminance(reference);
  const float range = *std::max_element(grey_reference.values.begin(), grey_reference.values.end());
  result.ssim = mean_ssim(grey_reference, luminance(test), std::max(0.0F, range));
  return result;
}

Image error_per_pixel(const Image& reference, const Image& test, const std::string& reference_name,
                      const std::string& test_name) {
  check_pair(reference, test, reference_name, test_name);
  const int channels = colour_channels(reference);
  Image errors(reference.width, reference.height, 1);
  for (int y = 0; y < reference.height; ++y) {
    for (int x = 0; x < reference.width; ++x) {
      double sum = 0;
      for (int c = 0; c < channels; ++c) {
        sum += std::abs(static_cast<double>(test.values[test.offset(x, y) + c]) -
                        reference.values[reference.offset(x, y) + c]);
      }
      errors.values[errors.offset(x, y)] = static_cast<float>(sum / channels);
    }
  }
  return errors;
}

}  // namespace weft
