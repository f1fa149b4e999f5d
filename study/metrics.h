// How far a picture is from its reference, in linear values.
#pragma once

#include <string>

#include "images/image.h"

namespace weft {

/// All over the colour channels: the first three, or the only one of a grey picture. Alpha is left
/// out.
struct ImageDifference {
  double rmse = 0;           ///< root of the mean squared error over pixels and channels
  double mae = 0;            ///< mean absolute error
  double relative_rmse = 0;  ///< rmse / mean of the reference; infinite where that mean is 0
  double psnr = 0;           ///< 20 log10(peak / rmse) in dB; infinite for equal pictures
  double peak = 0;           ///< the largest reference value, which psnr and ssim stand on
  double ssim = 0;           ///< mean structural similarity of the luminances, at most 1
  double largest = 0;        ///< largest absolute error of one channel
  int largest_x = 0;
  int largest_y = 0;
  int largest_channel = 0;
};

/// @throws Error  bad_input, where sizes or channels differ, or a value is NaN or infinite (how
/// many, and
///                the first pixel). The names say which picture it was.
ImageDifference compare_images(const Image& reference, const Image& test,
                               const std::string& reference_name = "reference",
                               const std::string& test_name = "test");

/// Mean structural similarity of two one-channel pictures (Wang, Bovik, Sheikh, Simoncelli 2004,
/// eqs. 13 to 17): Gaussian window of 11 x 11 and sigma 1.5, K1 = 0.01, K2 = 0.03, over the windows
/// that lie inside. In a direction in which the picture is narrower than 11 the window is cut at
/// the border and its weights again sum to 1. @param dynamic_range  L of the paper, >= 0.
double mean_ssim(const Image& a, const Image& b, double dynamic_range);

/// Mean absolute error over the colour channels, one value a pixel. @throws Error as
/// `compare_images`.
Image error_per_pixel(const Image& reference, const Image& test,
                      const std::string& reference_name = "reference",
                      const std::string& test_name = "test");

}  // namespace weft
