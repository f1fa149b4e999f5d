#include "codecs/laplacian/pyramid.h"

#include <algorithm>
#include <cmath>

namespace weft::laplacian {

namespace {

struct Share {
  int place;
  double weight;
};

int wrapped(int i, int n) {
  return (i % n + n) % n;
}

// One axis of the down filter: places of the finer grid, of size n.
std::vector<Share> down_axis(Filters filters, int i, int coarse_size, int n) {
  std::vector<Share> shares;
  switch (filters) {
    case Filters::box3:
      for (int d = -1; d <= 1; ++d) shares.push_back({wrapped(2 * i + d, n), 1.0 / 3});
      break;
    case Filters::box2: {
      const int end = i + 1 == coarse_size ? n : 2 * i + 2;
      for (int x = 2 * i; x < end; ++x) shares.push_back({x, 1.0 / (end - 2 * i)});
      break;
    }
    case Filters::linear:
      for (int d = -1; d <= 2; ++d)
        shares.push_back({wrapped(2 * i + d, n), (d == 0 || d == 1 ? 3.0 : 1.0) / 8});
      break;
  }
  return shares;
}

std::vector<Share> up_axis(Filters filters, int x, int fine_size, int levels, int coarse_size) {
  if (filters != Filters::linear) return {{parent(x, levels, coarse_size), 1}};
  const double at = (x + 0.5) * coarse_size / fine_size - 0.5;
  const int low = static_cast<int>(std::floor(at));
  const double blend = at - low;
  return {{wrapped(low, coarse_size), 1 - blend}, {wrapped(low + 1, coarse_size), blend}};
}

std::vector<Tap> product(const std::vector<Share>& columns, const std::vector<Share>& rows,
                         int width) {
  std::vector<Tap> taps;
  for (const Share& row : rows) {
    for (const Share& column : columns) {
      taps.push_back(
          {static_cast<std::size_t>(row.place) * width + column.place, row.weight * column.weight});
    }
  }
  return taps;
}

}  // namespace

std::string name_of(Filters filters) {
  switch (filters) {
    case Filters::box3:
      return "box3";
    case Filters::box2:
      return "box2";
    case Filters::linear:
      return "linear";
  }
  return "";
}

std::vector<Tap> Pyramid::down(int level, std::size_t texel) const {
  const int w = width_of(level);
  const int x = static_cast<int>(texel) % w;
  const int y = static_cast<int>(texel) / w;
  return product(down_axis(filters, x, w, width_of(level - 1)),
                 down_axis(filters, y, height_of(level), height_of(level - 1)),
                 width_of(level - 1));
}

std::vector<Tap> Pyramid::up(int fine, std::size_t texel, int coarse) const {
  const int w = width_of(fine);
  const int x = static_cast<int>(texel) % w;
  const int y = static_cast<int>(texel) / w;
  return product(up_axis(filters, x, w, coarse - fine, width_of(coarse)),
                 up_axis(filters, y, height_of(fine), coarse - fine, height_of(coarse)),
                 width_of(coarse));
}

int most_levels(int width, int height) {
  int levels = 0;
  while (std::min(width, height) >> (levels + 1) > 0) ++levels;
  return levels;
}

int usual_top(int width, int height, std::size_t components) {
  int top = 0;
  while (top < most_levels(width, height) &&
         static_cast<std::size_t>(width >> (top + 1)) * (height >> (top + 1)) >= 2 * components)
    ++top;
  return top;
}

}  // namespace weft::laplacian
