#include "codecs/factor_maps/codebook_refinement.h"

#include <tbb/parallel_for.h>

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <utility>
#include <vector>

#include "codecs/factor_maps/half_difference.h"
#include "codecs/factor_maps/k_means.h"
#include "codecs/factor_maps/map_equations.h"
#include "codecs/factor_maps/rotation.h"

namespace weft::factor_maps {

namespace {

using Eigen::Index;
using Colour = Eigen::Array4f;  // the fourth is not used
using Plane = Eigen::Array<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
// [channel][site]; the sites of a factor are its lights, its views, or all [view][light] pairs.
using Sites = Eigen::Array<float, 3, Eigen::Dynamic, Eigen::RowMajor>;
using DoubleSites = Eigen::Array<double, 3, Eigen::Dynamic, Eigen::RowMajor>;

// Of a factor over lights or views, whose sums need no second pass over the data.
constexpr int inner_rounds = 3;

// Less lets texels that are hardly asked for follow noise: at 1e-4 the samples lie 1 % nearer, and
// pictures, which show what lies between them, have up to four times the error.
constexpr double smoothness = 1;

bool at_pairs(Projection projection) {
  return link_of(projection) == 1;
}

// For a texel and a factor X, G being the product of all that is not X: the error of B - S X G is
// least at S = top . X / bottom . X^2, and is then (top . X)^2 / bottom . X^2 below that of black.
struct Sums {
  Sites top;     // sum over the site's pairs of B G
  Sites bottom;  // of G^2
};

struct Fit {
  Eigen::Array3f scale = Eigen::Array3f::Zero();
  double gain = 0;
};

Fit fit_of(const Eigen::Array3d& top, const Eigen::Array3d& bottom) {
  Fit fit;
  for (int c = 0; c < 3; ++c) {
    if (!(bottom[c] > 0) || !(top[c] > 0)) continue;
    fit.scale[c] = static_cast<float>(top[c] / bottom[c]);
    fit.gain += top[c] * top[c] / bottom[c];
  }
  return fit;
}

class Refinement {
 public:
  Refinement(const TexelSource& source, Model& model)
      : source_(source),
        model_(model),
        n_lights_(static_cast<Index>(model.lights.size())),
        n_views_(static_cast<Index>(model.views.size())),
        texels_of_(rotation_steps),
        taps_(rotation_steps),
        scale_(source.size()) {
    for (std::size_t t = 0; t < source.size(); ++t) texels_of_[rotation_of(t)].push_back(t);
    for (int r = 0; r < rotation_steps; ++r) {
      if (!texels_of_[r].empty()) taps_[r] = taps_of(r);
    }
    cosine_.resize(n_lights_);
    for (Index i = 0; i < n_lights_; ++i) cosine_[i] = std::max(model.lights[i].z, 0.0F);
    for (std::size_t f = 0; f < model.factors.size(); ++f) {
      const std::vector<float>& values = model.factors[f].maps.floats;
      std::vector<Colour> maps(values.size() / 3);
      for (std::size_t i = 0; i < maps.size(); ++i)
        maps[i] = Colour(values[3 * i], values[3 * i + 1], values[3 * i + 2], 0);
      maps_.push_back(std::move(maps));
    }
  }

  /// Assigns and solves one factor's codebook, the others held.
  void improve(std::size_t factor) {
    const bool pairs = at_pairs(projection(factor));
    sums_.assign(pairs ? 0 : source_.size(), {});
    assign(factor, true);
    update(factor);
    for (int i = 1; !pairs && i < inner_rounds; ++i) {
      assign(factor, false);
      update(factor);
    }
  }

  /// The maps into the model, where the index is already.
  void write() const {
    for (std::size_t f = 0; f < maps_.size(); ++f) {
      std::vector<float>& values = model_.factors[f].maps.floats;
      for (std::size_t i = 0; i < maps_[f].size(); ++i) {
        for (int c = 0; c < 3; ++c) values[3 * i + c] = maps_[f][i][c];
      }
    }
  }

 private:
  Projection projection(std::size_t factor) const { return model_.factors[factor].projection; }
  int rotation_of(std::size_t texel) const {
    return model_.rotation.empty() ? 0 : model_.rotation[texel];
  }
  std::size_t map_texels() const {
    return static_cast<std::size_t>(model_.resolution) * model_.resolution;
  }
  std::size_t entries(std::size_t factor) const { return maps_[factor].size() / map_texels(); }
  std::uint8_t& index(std::size_t factor, std::size_t texel) {
    return model_.index[model_.index_channels() * texel + factor];
  }
  Index sites(std::size_t factor) const {
    switch (projection(factor)) {
      case Projection::light:
        return n_lights_;
      case Projection::view:
        return n_views_;
      default:
        return n_lights_ * n_views_;
    }
  }

  // Where each factor is looked up at its sites, seen by texels of one rotation.
  std::vector<std::vector<BilinearTaps>> taps_of(int rotation) const {
    const ParabolicMap map(model_.resolution);
    const HemisphereSampling lights = turned_back(model_.lights, rotation);
    const HemisphereSampling views = turned_back(model_.views, rotation);
    std::vector<std::vector<BilinearTaps>> taps;
    for (const Factor& factor : model_.factors) {
      std::vector<BilinearTaps> own;
      if (factor.projection == Projection::light) {
        for (const Direction& light : lights.directions()) own.push_back(map.taps(light));
      } else if (factor.projection == Projection::view) {
        for (const Direction& view : views.directions()) own.push_back(map.taps(view));
      } else {
        for (const Direction& view : views.directions()) {
          for (const Direction& light : lights.directions()) {
            own.push_back(map.taps(factor.projection == Projection::half
                                       ? half_vector(light, view)
                                       : difference_vector(light, view)));
          }
        }
      }
      taps.push_back(std::move(own));
    }
    return taps;
  }

  // A map of the codebook at the factor's sites.
  Sites looked_up(std::size_t factor, std::size_t entry, int rotation) const {
    const std::vector<BilinearTaps>& taps = taps_[rotation][factor];
    const Colour* map = &maps_[factor][entry * map_texels()];
    Sites values(3, static_cast<Index>(taps.size()));
    for (std::size_t i = 0; i < taps.size(); ++i) {
      Colour sum = taps[i].weight[0] * map[taps[i].index[0]];
      for (std::size_t k = 1; k < 4; ++k) sum += taps[i].weight[k] * map[taps[i].index[k]];
      for (int c = 0; c < 3; ++c) values(c, static_cast<Index>(i)) = sum[c];
    }
    return values;
  }

  // One pass over a texel's data.
  Sums sums_of(std::size_t factor, std::size_t texel) {
    const Index pairs = n_lights_ * n_views_;
    std::vector<float> data(3 * static_cast<std::size_t>(pairs));
    source_.abrdf(texel, data);
    std::vector<Sites> values(maps_.size());
    for (std::size_t f = 0; f < maps_.size(); ++f) {
      if (f != factor) values[f] = looked_up(f, index(f, texel), rotation_of(texel));
    }
    Sums sums{Sites(3, sites(factor)), Sites(3, sites(factor))};
    Plane others(n_views_, n_lights_);
    for (int c = 0; c < 3; ++c) {
      others.rowwise() = cosine_.transpose();
      for (std::size_t f = 0; f < maps_.size(); ++f) {
        if (f == factor) continue;
        const auto own = values[f].row(c);
        if (projection(f) == Projection::light) {
          others.rowwise() *= own;
        } else if (projection(f) == Projection::view) {
          others.colwise() *= own.transpose();
        } else {
          others *= Eigen::Map<const Plane>(own.data(), n_views_, n_lights_);
        }
      }
      const Eigen::Map<const Plane, 0, Eigen::Stride<Eigen::Dynamic, 3>> b(
          data.data() + c, n_views_, n_lights_, Eigen::Stride<Eigen::Dynamic, 3>(3 * n_lights_, 3));
      const Plane product = b * others;
      others = others.square().eval();
      if (projection(factor) == Projection::light) {
        sums.top.row(c) = product.colwise().sum();
        sums.bottom.row(c) = others.colwise().sum();
      } else if (projection(factor) == Projection::view) {
        sums.top.row(c) = product.rowwise().sum().transpose();
        sums.bottom.row(c) = others.rowwise().sum().transpose();
      } else {
        using Row = Eigen::Map<const Eigen::Array<float, 1, Eigen::Dynamic>>;
        sums.top.row(c) = Row(product.data(), pairs);
        sums.bottom.row(c) = Row(others.data(), pairs);
      }
    }
    return sums;
  }

  // Of pairs, summed over those that ask for a texel: what the ranking sees of them.
  Sums lumped(const Sums& sums, const std::vector<BilinearTaps>& taps) const {
    const auto texels = static_cast<Index>(map_texels());
    Sums result{Sites::Zero(3, texels), Sites::Zero(3, texels)};
    for (int c = 0; c < 3; ++c) {
      float* top = &result.top(c, 0);
      float* bottom = &result.bottom(c, 0);
      for (std::size_t i = 0; i < taps.size(); ++i) {
        const float a = sums.top(c, static_cast<Index>(i));
        const float b = sums.bottom(c, static_cast<Index>(i));
        for (std::size_t k = 0; k < 4; ++k) {
          top[taps[i].index[k]] += taps[i].weight[k] * a;
          bottom[taps[i].index[k]] += taps[i].weight[k] * b;
        }
      }
    }
    return result;
  }

  Fit exact(const Sums& sums, const Sites& values) const {
    const Eigen::Array3d top = (sums.top * values).rowwise().sum().cast<double>();
    const Eigen::Array3d bottom = (sums.bottom * values.square()).rowwise().sum().cast<double>();
    return fit_of(top, bottom);
  }

  // [channel][entry][dimension]: the codebook as the ranking sees it.
  std::array<RowMatrix, 3> candidates(std::size_t factor, int rotation) const {
    const bool pairs = at_pairs(projection(factor));
    const Index dimensions = pairs ? static_cast<Index>(map_texels()) : sites(factor);
    std::array<RowMatrix, 3> result;
    for (RowMatrix& rows : result) rows.resize(static_cast<Index>(entries(factor)), dimensions);
    for (std::size_t e = 0; e < entries(factor); ++e) {
      const auto row = static_cast<Index>(e);
      if (pairs) {
        for (Index i = 0; i < dimensions; ++i) {
          const Colour& value = maps_[factor][e * map_texels() + i];
          for (int c = 0; c < 3; ++c) result[c](row, i) = value[c];
        }
      } else {
        const Sites values = looked_up(factor, e, rotation);
        for (int c = 0; c < 3; ++c) result[c].row(row) = values.row(c).matrix();
      }
    }
    return result;
  }

  // Gives each texel the best of the factor's maps, and S with it. `anew`: the other factors
  // changed.
  void assign(std::size_t factor, bool anew) {
    for (int rotation = 0; rotation < rotation_steps; ++rotation) {
      const std::vector<std::size_t>& texels = texels_of_[rotation];
      if (texels.empty()) continue;
      const std::array<RowMatrix, 3> maps = candidates(factor, rotation);
      std::array<RowMatrix, 3> squares;
      for (int c = 0; c < 3; ++c) squares[c] = maps[c].cwiseAbs2();
      const std::size_t blocks = (texels.size() + texels_a_block - 1) / texels_a_block;
      tbb::parallel_for(std::size_t{0}, blocks, [&](std::size_t block) {
        const std::size_t first = block * texels_a_block;
        assign_block(factor, anew, maps, squares,
                     std::span(texels).subspan(
                         first, std::min<std::size_t>(texels_a_block, texels.size() - first)));
      });
    }
  }

  void assign_block(std::size_t factor, bool anew, const std::array<RowMatrix, 3>& maps,
                    const std::array<RowMatrix, 3>& squares, std::span<const std::size_t> texels) {
    const bool pairs = at_pairs(projection(factor));
    const auto count = static_cast<Index>(texels.size());
    const int rotation = rotation_of(texels[0]);
    std::vector<Sums> own(pairs ? texels.size() : 0);
    std::array<RowMatrix, 3> top, bottom;
    for (int c = 0; c < 3; ++c) {
      top[c].resize(count, maps[c].cols());
      bottom[c].resize(count, maps[c].cols());
    }
    for (Index t = 0; t < count; ++t) {
      const std::size_t texel = texels[t];
      Sums seen;
      if (pairs) {
        own[t] = sums_of(factor, texel);
        seen = lumped(own[t], taps_[rotation][factor]);
      } else {
        if (anew) sums_[texel] = sums_of(factor, texel);
        seen = sums_[texel];
      }
      for (int c = 0; c < 3; ++c) {
        top[c].row(t) = seen.top.row(c).matrix();
        bottom[c].row(t) = seen.bottom.row(c).matrix();
      }
    }
    // Of pairs an estimate in fewer dimensions: as if each pair asked for one texel at a time, a
    // share of it for each of four. The gain itself then decides between the best and the present
    // one.
    Plane gains = Plane::Zero(count, maps[0].rows());
    for (int c = 0; c < 3; ++c) {
      const Plane tops = (top[c] * maps[c].transpose()).array();
      const Plane bottoms = (bottom[c] * squares[c].transpose()).array();
      gains += (bottoms > 0 && tops > 0).select(tops.square() / bottoms, 0.0F);
    }
    for (Index t = 0; t < count; ++t) {
      const std::size_t texel = texels[t];
      std::uint8_t& current = index(factor, texel);
      Index best = 0;
      gains.row(t).maxCoeff(&best);
      const Sums& sums = pairs ? own[t] : sums_[texel];
      Fit fit = exact(sums, looked_up(factor, current, rotation));
      if (best != current) {
        const Fit other = exact(sums, looked_up(factor, static_cast<std::size_t>(best), rotation));
        if (other.gain > fit.gain) {
          fit = other;
          current = static_cast<std::uint8_t>(best);
        }
      }
      scale_[texel] = fit.scale;
    }
  }

  void update(std::size_t factor) {
    std::vector<std::vector<std::size_t>> members(entries(factor));
    for (const auto& texels : texels_of_) {
      for (const std::size_t t : texels) members[index(factor, t)].push_back(t);
    }
    tbb::parallel_for(std::size_t{0}, members.size(), [&](std::size_t entry) {
      if (!members[entry].empty()) update_entry(factor, entry, members[entry]);
    });
  }

  // Members of one rotation follow each other.
  void update_entry(std::size_t factor, std::size_t entry,
                    const std::vector<std::size_t>& members) {
    std::vector<MapEquations> equations(3, MapEquations(model_.resolution, smoothness));
    for (std::size_t first = 0; first < members.size();) {
      const int rotation = rotation_of(members[first]);
      DoubleSites top = DoubleSites::Zero(3, sites(factor));
      DoubleSites bottom = DoubleSites::Zero(3, sites(factor));
      for (; first < members.size() && rotation_of(members[first]) == rotation; ++first) {
        const std::size_t texel = members[first];
        const bool pairs = at_pairs(projection(factor));
        const Sums fresh = pairs ? sums_of(factor, texel) : Sums{};
        const Sums& sums = pairs ? fresh : sums_[texel];
        for (int c = 0; c < 3; ++c) {
          const double s = scale_[texel][c];
          top.row(c) += s * sums.top.row(c).cast<double>();
          bottom.row(c) += s * s * sums.bottom.row(c).cast<double>();
        }
      }
      const std::vector<BilinearTaps>& taps = taps_[rotation][factor];
      const Sites now = looked_up(factor, entry, rotation);
      for (int c = 0; c < 3; ++c) {
        for (Index i = 0; i < now.cols(); ++i) {
          equations[c].add(taps[i], bottom(c, i), top(c, i) - bottom(c, i) * now(c, i));
        }
      }
    }
    Colour* map = &maps_[factor][entry * map_texels()];
    for (int c = 0; c < 3; ++c) {
      std::vector<double> values(map_texels());
      for (std::size_t i = 0; i < values.size(); ++i) values[i] = map[i][c];
      values = equations[c].solved(values);
      for (std::size_t i = 0; i < values.size(); ++i) map[i][c] = static_cast<float>(values[i]);
    }
  }

  const TexelSource& source_;
  Model& model_;
  Index n_lights_;
  Index n_views_;
  std::vector<std::vector<std::size_t>> texels_of_;           // by rotation
  std::vector<std::vector<std::vector<BilinearTaps>>> taps_;  // [rotation][factor][site]
  Eigen::ArrayXf cosine_;                                     // by light
  std::vector<std::vector<Colour>> maps_;                     // [factor][entry and texel]
  std::vector<Eigen::Array3f> scale_;                         // by texel
  std::vector<Sums> sums_;                                    // by texel
};

}  // namespace

void refine_codebooks(const TexelSource& source, int rounds, Model& model, Progress& progress) {
  Refinement refinement(source, model);
  progress.start(
      static_cast<std::int64_t>(rounds) * static_cast<std::int64_t>(model.factors.size()),
      "codebooks");
  for (int round = 0; round < rounds; ++round) {
    for (const bool pairs : {true, false}) {
      for (std::size_t f = 0; f < model.factors.size(); ++f) {
        if (at_pairs(model.factors[f].projection) != pairs) continue;
        refinement.improve(f);
        progress.advance(1);
      }
    }
  }
  refinement.write();
}

}  // namespace weft::factor_maps
