#include "codecs/srbf/level_fit.h"

#include <fmt/core.h>
#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>

#include "codecs/srbf/kernel_order.h"

namespace weft::srbf {

namespace {

// Mean squared difference of a kernel's numbers beyond which a neighbour counts as another thing.
constexpr double edge = 0.05;

// Colours are pulled less than centres and angles: kernels that lie alike may differ in colour and
// filter well, since sums are linear in it. Not pulled at all, neighbours' colours of opposite
// signs grow until whatever difference of centres is left ruins what lies between
// (docs/codecs/srbf.md).
constexpr double colour_pull = 0.01;

// A restart is tried where a neighbour's kernels are already this good, before any descent.
constexpr double promising = 1.05;

constexpr int most_restarts = 2;

// What fits are compared by: the less, the better. A start may be so bad that its error is no
// number, which nothing compares with; any other is better.
double misfit(const TexelFit& fit) {
  return std::isnan(fit.value.total) ? std::numeric_limits<double>::infinity() : fit.value.total;
}

struct Workspace {
  TexelFitter fitter;
  std::vector<float> abrdf;
  std::vector<float> channels;
};

// Many pulls add up to one towards their weighted mean, but for a constant.
class PullSum {
 public:
  explicit PullSum(std::size_t numbers) : sum_(numbers) {}
  void add(const Kernels& kernels, double weight) {
    if (weight == 0) return;
    weight_ += weight;
    for (std::size_t i = 0; i < sum_.size(); ++i) sum_[i] += weight * kernels.values()[i];
  }
  Pull pull() const {
    if (weight_ == 0) return {};
    Pull pull{.weight = {weight_ * centre_metric, weight_, weight_ * colour_pull}, .target = sum_};
    for (double& value : pull.target) value /= weight_;
    return pull;
  }

 private:
  std::vector<double> sum_;
  double weight_ = 0;
};

class LevelFit {
 public:
  LevelFit(const MipLevels& data, const Samples& samples, const FitOptions& options, int level,
           const std::vector<Kernels>& parents, const std::vector<Kernels>& hints, double scale)
      : data_(data),
        samples_(samples),
        options_(options),
        level_(level),
        parents_(parents),
        hints_(hints),
        scale_(scale),
        width_(data.sizes().width_of(level)),
        height_(data.sizes().height_of(level)),
        fits_(data.sizes().texels(level)),
        restarted_(fits_.size()),
        fell_back_(fits_.size()),
        workspaces_([&] {
          return Workspace{TexelFitter(samples, options.modes, options.kernels),
                           std::vector<float>(3 * samples.pairs),
                           {}};
        }) {}

  LevelResult run(Progress& progress) {
    const int sweeps = parents_.empty() ? 0 : options_.sweeps;
    for (int sweep = 0; sweep <= sweeps; ++sweep) {
      std::vector<TexelFit> next(fits_.size());
      std::atomic<double> error = 0;  // shown only: what is added up in no certain order
      std::atomic<int> done = 0;
      tbb::parallel_for(std::size_t{0}, fits_.size(), [&](std::size_t texel) {
        next[texel] = parents_.empty() ? from_scratch(texel)
                      : sweep == 0     ? from_parents(texel)
                                       : from_neighbours(texel);
        fell_back_[texel] |= next[texel].fell_back ? 1 : 0;
        const double so_far = error += next[texel].value.data;
        progress.note(fmt::format("RMSE {:.3g} 1/sr", scale_ * std::sqrt(so_far / ++done)));
        progress.advance(1);
      });
      fits_ = std::move(next);
    }
    return result();
  }

 private:
  // Of a descent below the top.
  DescentLimits descent() const {
    return {.iterations = options_.iterations, .decrease = options_.decrease};
  }

  Workspace& workspace_at(std::size_t texel) {
    Workspace& workspace = workspaces_.local();
    data_.abrdf(level_, texel, workspace.abrdf);
    workspace.channels = channel_arrays(samples_, workspace.abrdf, scale_);
    workspace.fitter.set_texel(workspace.channels);
    workspace.fitter.set_pull({});
    return workspace;
  }

  TexelFit from_scratch(std::size_t texel) {
    // Where all that follows starts from, and of one texel.
    return workspace_at(texel).fitter.from_scratch(
        options_.starts,
        {.iterations = 4 * options_.iterations, .decrease = options_.decrease / 5});
  }

  TexelFit from_parents(std::size_t texel) {
    const MipSizes& sizes = data_.sizes();
    const std::size_t own = sizes.parent(level_, texel);
    std::vector<Kernels> starts{parents_[own]};
    if (options_.restarts) {
      for (const std::size_t t :
           around(own, sizes.width_of(level_ + 1), sizes.height_of(level_ + 1), 1))
        starts.push_back(in_order_of(parents_[own], parents_[t]));
    }
    PullSum pulls(parents_[own].values().size());
    pulls.add(parents_[own], options_.mip_weight);
    Workspace& workspace = workspace_at(texel);
    workspace.fitter.set_pull(pulls.pull());
    TexelFit best = best_of(texel, workspace.fitter, starts, nullptr);
    if (hints_.empty() || misfit(best) <= DescentLimits{}.enough) return best;
    TexelFit other = workspace.fitter.descend(
        workspace.fitter.as_it_is(in_order_of(parents_[own], hints_[texel])), descent());
    if (!(misfit(other) < misfit(best))) return best;
    restarted_[texel] = 1;
    return other;
  }

  TexelFit from_neighbours(std::size_t texel) {
    Kernels own = fits_[texel].kernels;
    PullSum pulls(own.values().size());
    pulls.add(parents_[data_.sizes().parent(level_, texel)], options_.mip_weight);
    for (const std::size_t t : around(texel, width_, height_, 2)) {
      const Kernels& neighbour = fits_[t].kernels;
      if (options_.smooth_weight > 0)
        pulls.add(neighbour, options_.smooth_weight * share(own, neighbour));
    }
    // Where there is a pull, kernels lie as it has them; the texel's own may come to lie so, too.
    const Pull pull = pulls.pull();
    if (!pull.target.empty()) {
      Kernels target(own.shape());
      std::ranges::copy(pull.target, target.values().begin());
      own = in_order_of(target, own);
    }
    std::vector<Kernels> starts;
    if (options_.restarts) {
      for (const std::size_t t : around(texel, width_, height_, 1))
        starts.push_back(in_order_of(own, fits_[t].kernels));
    }
    Workspace& workspace = workspace_at(texel);
    workspace.fitter.set_pull(pull);
    const TexelFit now = workspace.fitter.as_it_is(own);
    return best_of(texel, workspace.fitter, starts, &now);
  }

  // Geman's and McClure's penalty, as the weight that makes a square of it.
  double share(const Kernels& own, const Kernels& neighbour) const {
    if (!options_.robust) return 1;
    const double d = distance(own, neighbour) / (edge * static_cast<double>(options_.kernels));
    return 1 / ((1 + d) * (1 + d));
  }

  // Descends from `now`, or the first start, and from the most promising of the others.
  TexelFit best_of(std::size_t texel, TexelFitter& fitter, const std::vector<Kernels>& starts,
                   const TexelFit* now) {
    const DescentLimits limits = descent();
    std::vector<TexelFit> begun;
    for (const Kernels& start : starts) begun.push_back(fitter.as_it_is(start));
    TexelFit best =
        now != nullptr ? fitter.descend(*now, limits) : fitter.descend(begun[0], limits);
    const std::size_t first_other = now != nullptr ? 0 : 1;
    std::stable_sort(begun.begin() + static_cast<std::ptrdiff_t>(first_other), begun.end(),
                     [](const TexelFit& a, const TexelFit& b) { return misfit(a) < misfit(b); });
    for (std::size_t i = first_other;
         i < std::min<std::size_t>(begun.size(), first_other + most_restarts); ++i) {
      const double bound = now != nullptr ? promising * misfit(best) : misfit(begun[0]);
      if (!(misfit(begun[i]) < bound) || misfit(best) <= limits.enough) break;
      TexelFit other = fitter.descend(begun[i], limits);
      if (!(misfit(other) < misfit(best))) continue;
      best = std::move(other);
      restarted_[texel] = 1;
    }
    return best;
  }

  // The texels at most `reach` away, itself left out; the tile repeats.
  static std::vector<std::size_t> around(std::size_t texel, int width, int height, int reach) {
    const int x = static_cast<int>(texel) % width;
    const int y = static_cast<int>(texel) / width;
    std::vector<std::size_t> texels;
    for (int dy = -reach; dy <= reach; ++dy) {
      for (int dx = -reach; dx <= reach; ++dx) {
        const int column = ((x + dx) % width + width) % width;
        const int row = ((y + dy) % height + height) % height;
        const std::size_t other = static_cast<std::size_t>(row) * width + column;
        if (other != texel && std::ranges::find(texels, other) == texels.end())
          texels.push_back(other);
      }
    }
    return texels;
  }

  LevelResult result() {
    LevelResult result;
    for (std::size_t i = 0; i < fits_.size(); ++i) {
      result.kernels.push_back(std::move(fits_[i].kernels));
      result.squared_error += fits_[i].value.data / static_cast<double>(fits_.size());
      result.restarts += restarted_[i];
      result.fallbacks += fell_back_[i];
    }
    return result;
  }

  const MipLevels& data_;
  const Samples& samples_;
  const FitOptions& options_;
  int level_;
  const std::vector<Kernels>& parents_;
  const std::vector<Kernels>& hints_;
  double scale_;
  int width_;
  int height_;
  std::vector<TexelFit> fits_;
  std::vector<std::uint8_t> restarted_;
  std::vector<std::uint8_t> fell_back_;
  tbb::enumerable_thread_specific<Workspace> workspaces_;
};

}  // namespace

LevelResult fit_level(const MipLevels& data, const Samples& samples, const FitOptions& options,
                      int level, const std::vector<Kernels>& parents,
                      const std::vector<Kernels>& hints, double scale, Progress& progress) {
  return LevelFit(data, samples, options, level, parents, hints, scale).run(progress);
}

}  // namespace weft::srbf
