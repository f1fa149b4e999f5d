#include "codecs/factor_maps/k_means.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <limits>
#include <numeric>

namespace weft::factor_maps {

namespace {

using Index = Eigen::Index;

constexpr Index rows_a_block = 256;

// Calls `work(first, count)` for fixed blocks of rows, so that sums don't depend on the threads.
template <typename Work>
void for_row_blocks(Index rows, const Work& work) {
  tbb::parallel_for(Index{0}, (rows + rows_a_block - 1) / rows_a_block, [&](Index block) {
    const Index first = block * rows_a_block;
    work(first, std::min(rows_a_block, rows - first));
  });
}

// A number in [0, 1) that is a hash of the seed and the draw (the finaliser of splitmix64).
double random_unit(std::uint64_t seed, std::uint64_t draw) {
  std::uint64_t h = (seed + 0x9E3779B97F4A7C15ULL) * 0xD1342543DE82EF95ULL + draw + 1;
  for (int round = 0; round < 2; ++round) {
    h ^= h >> 30;
    h *= 0xBF58476D1CE4E5B9ULL;
    h ^= h >> 27;
    h *= 0x94D049BB133111EBULL;
    h ^= h >> 31;
  }
  return static_cast<double>(h >> 11) * 0x1p-53;
}

// Arthur and Vassilvitskii's seeding: each next seed is drawn by its weight times its squared
// distance to the nearest one so far. A row whose nearest seed is less than half as far as that
// seed is from the new one cannot come nearer, and is left alone: most are, which makes 256 seeds
// of 4,096 maps cost less than two Lloyd iterations.
class Seeding {
 public:
  Seeding(const Rows& data, const std::vector<double>& weights)
      : data_(data),
        weights_(weights),
        nearest_(data.rows(), 0),
        distance_(data.rows(), std::numeric_limits<double>::infinity()) {}

  std::vector<Index> seeds(int count, std::uint64_t seed) {
    std::vector<Index> chosen{
        static_cast<Index>(random_unit(seed, 0) * static_cast<double>(data_.rows()))};
    take(chosen, 0);
    while (static_cast<int>(chosen.size()) < count) {
      const Index next = draw(random_unit(seed, chosen.size()));
      if (next < 0) break;  // every row is a seed's equal
      chosen.push_back(next);
      take(chosen, chosen.size() - 1);
    }
    return chosen;
  }

 private:
  void take(const std::vector<Index>& chosen, std::size_t newest) {
    const auto centre = data_.row(chosen[newest]);
    std::vector<double> apart(newest);
    for (std::size_t c = 0; c < newest; ++c)
      apart[c] = (data_.row(chosen[c]) - centre).squaredNorm();
    for_row_blocks(data_.rows(), [&](Index first, Index count) {
      for (Index r = first; r < first + count; ++r) {
        if (newest > 0 && apart[nearest_[r]] >= 4 * distance_[r]) continue;
        const double d = (data_.row(r) - centre).squaredNorm();
        if (d < distance_[r]) {
          distance_[r] = d;
          nearest_[r] = newest;
        }
      }
    });
  }

  // The row where the running sum of squared distances passes `unit` of the whole; -1 where the
  // whole is zero.
  Index draw(double unit) const {
    const double total =
        std::inner_product(distance_.begin(), distance_.end(), weights_.begin(), 0.0);
    if (!(total > 0)) return -1;
    double left = unit * total;
    Index last = -1;
    for (Index r = 0; r < data_.rows(); ++r) {
      const double share = weights_[r] * distance_[r];
      if (!(share > 0)) continue;
      last = r;
      left -= share;
      if (left < 0) break;
    }
    return last;
  }

  const Rows& data_;
  const std::vector<double>& weights_;
  std::vector<std::size_t> nearest_;
  std::vector<double> distance_;
};

// |x - c|^2 = |x|^2 - 2 x.c + |c|^2: the middle term is one matrix product a block.
std::vector<std::uint16_t> nearest_prototypes(const Rows& data, const RowMatrix& prototypes) {
  std::vector<std::uint16_t> index(data.rows());
  const Eigen::VectorXf squares = prototypes.rowwise().squaredNorm();
  for_row_blocks(data.rows(), [&](Index first, Index count) {
    const RowMatrix products = data.middleRows(first, count) * prototypes.transpose();
    for (Index r = 0; r < count; ++r) {
      Index best = 0;
      (squares - 2 * products.row(r).transpose()).minCoeff(&best);
      index[first + r] = static_cast<std::uint16_t>(best);
    }
  });
  return index;
}

std::vector<std::vector<Index>> members_of(const std::vector<std::uint16_t>& index,
                                           Index clusters) {
  std::vector<std::vector<Index>> members(clusters);
  for (std::size_t r = 0; r < index.size(); ++r) members[index[r]].push_back(static_cast<Index>(r));
  return members;
}

// Means in double, each cluster's members in order. A cluster that lost its members, or whose
// members have no weight, keeps its prototype.
void move_to_means(const Rows& data, const std::vector<double>& weights,
                   const std::vector<std::uint16_t>& index, Prototypes kind,
                   RowMatrix& prototypes) {
  const auto members = members_of(index, prototypes.rows());
  tbb::parallel_for(Index{0}, prototypes.rows(), [&](Index c) {
    Eigen::RowVectorXd sum = Eigen::RowVectorXd::Zero(data.cols());
    double weight = 0;
    for (const Index r : members[c]) {
      sum += weights[r] * data.row(r).cast<double>();
      weight += weights[r];
    }
    const double divisor = kind == Prototypes::means ? weight : sum.norm();
    if (!(divisor > 0)) return;
    prototypes.row(c) = (sum / divisor).cast<float>();
  });
}

// An empty cluster takes the row whose distance to its own prototype weighs most.
void fill_empty_clusters(const Rows& data, const std::vector<double>& weights,
                         std::vector<std::uint16_t>& index, RowMatrix& prototypes) {
  const auto members = members_of(index, prototypes.rows());
  if (std::ranges::none_of(members, [](const auto& m) { return m.empty(); })) return;
  std::vector<double> distance(data.rows());
  for_row_blocks(data.rows(), [&](Index first, Index count) {
    for (Index r = first; r < first + count; ++r) {
      distance[r] = weights[r] * (data.row(r) - prototypes.row(index[r])).squaredNorm();
    }
  });
  for (Index c = 0; c < prototypes.rows(); ++c) {
    if (!members[c].empty()) continue;
    const auto furthest = std::ranges::max_element(distance);
    const Index r = furthest - distance.begin();
    prototypes.row(c) = data.row(r);
    index[r] = static_cast<std::uint16_t>(c);
    *furthest = 0;
  }
}

}  // namespace

Clustering k_means(const Rows& data, const std::vector<double>& weights, int clusters,
                   std::uint64_t seed, Prototypes kind, Progress& progress) {
  const std::vector<Index> seeds = Seeding(data, weights).seeds(clusters, seed);
  Clustering result{RowMatrix(seeds.size(), data.cols()), {}};
  for (std::size_t c = 0; c < seeds.size(); ++c) result.prototypes.row(c) = data.row(seeds[c]);
  for (int iteration = 0; iteration < max_k_means_iterations; ++iteration) {
    std::vector<std::uint16_t> index = nearest_prototypes(data, result.prototypes);
    fill_empty_clusters(data, weights, index, result.prototypes);
    progress.advance(1);
    const bool settled = index == result.index;
    result.index = std::move(index);
    if (settled) break;
    move_to_means(data, weights, result.index, kind, result.prototypes);
  }
  return result;
}

}  // namespace weft::factor_maps
