#include <algorithm>
#include <cmath>
#include <cstdint>
#include <isobath/base/error.hpp>
#include <isobath/base/random.hpp>
#include <isobath/geometry/surface_error.hpp>
#include <limits>
#include <map>
#include <unordered_map>

namespace isobath {
namespace {

using Eigen::Vector2d;
using Miss = std::pair<double, double>;  // distance to the nearest sounding left, error of the surface

constexpr std::size_t kFewest = 30;
constexpr double kWeightOfRule = 4;  // local roughness counts as much as the rule once there are this many misses

struct LocalMiss {
  int sounding;
  Miss miss;
};

/// The value below which this share of the values lies; the list must not be empty.
double quantile(std::vector<double> values, double share) {
  const auto at = static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), values.begin() + at, values.end());
  return values[static_cast<std::size_t>(at)];
}

/// The scale that puts at least 68.3 % within one sigma and 95.4 % within two.
double covering_scale(const std::vector<double>& absolute) {
  return std::max(quantile(absolute, 0.683), quantile(absolute, 0.954) / 2);
}

/// The additional sigma of each run: the smallest that, combined with that of the surface, covers the misses.
double sigma_of_runs(const std::vector<Miss>& sigma_and_miss) {
  double low = 0, high = 0;
  for (const Miss& m : sigma_and_miss) high = std::max(high, m.second);
  std::vector<double> ratios(sigma_and_miss.size());
  for (int i = 0; i < 30; ++i) {
    const double middle = (low + high) / 2;
    std::transform(sigma_and_miss.begin(), sigma_and_miss.end(), ratios.begin(),
                   [middle](const Miss& m) { return m.second / std::hypot(m.first, middle); });
    (covering_scale(ratios) > 1 ? low : high) = middle;
  }
  return high;
}

double mean_spacing(const Triangulation& t) {
  double sum = 0, count = 0;
  for (std::size_t i = 0; i < t.points().size(); ++i) {
    double nearest = std::numeric_limits<double>::infinity();
    for (const int n : t.around(static_cast<int>(i))) {
      nearest = std::min(nearest, (t.points()[static_cast<std::size_t>(n)] - t.points()[i]).norm());
    }
    if (std::isfinite(nearest)) {
      sum += nearest;
      ++count;
    }
  }
  return sum / count;
}

/// Soundings in a grid of squares, to find those in a disc.
class Squares {
 public:
  Squares(const std::vector<SurveyPoint>& soundings, double edge) : soundings_(soundings), edge_(edge) {
    for (std::size_t i = 0; i < soundings.size(); ++i)
      bins_[key(soundings[i].north_east)].push_back(static_cast<int>(i));
  }
  /// `radius` must not exceed the edge.
  template <class Visit>
  void visit(const Vector2d& centre, double radius, const Visit& each) const {
    for (int i = -1; i <= 1; ++i) {
      for (int j = -1; j <= 1; ++j) {
        const auto found = bins_.find(key(centre + edge_ * Vector2d(i, j)));
        if (found == bins_.end()) continue;
        for (const int s : found->second) {
          if ((soundings_[static_cast<std::size_t>(s)].north_east - centre).norm() <= radius) each(s);
        }
      }
    }
  }

 private:
  [[nodiscard]] std::uint64_t key(const Vector2d& p) const {
    const auto square = [this](double at) {  // at the end of the range the squares are longer
      return static_cast<std::int32_t>(std::clamp(std::floor(at / edge_), -2e9, 2e9));
    };
    const std::int32_t x = square(p.x()), y = square(p.y());
    return (static_cast<std::uint64_t>(static_cast<std::uint32_t>(x)) << 32) | static_cast<std::uint32_t>(y);
  }
  const std::vector<SurveyPoint>& soundings_;
  double edge_;
  std::unordered_map<std::uint64_t, std::vector<int>> bins_;
};

/// Empties discs around random soundings until the share is removed.
std::vector<std::uint8_t> empty_discs(const std::vector<SurveyPoint>& all, double radius, double share, Random random) {
  std::vector<std::uint8_t> removed(all.size(), 0);
  const Squares squares(all, radius);
  const auto most = static_cast<std::size_t>(share * static_cast<double>(all.size()));
  std::size_t count = 0;
  for (std::size_t draw = 0; draw < all.size() && count < most; ++draw) {
    const Vector2d centre = all[random.index(all.size())].north_east;
    squares.visit(centre, radius, [&](int s) {
      count += !removed[static_cast<std::size_t>(s)];
      removed[static_cast<std::size_t>(s)] = 1;
    });
  }
  return removed;
}

/// The runs with the most soundings; empty if all soundings are of one run.
std::vector<int> largest_runs(const std::vector<SurveyPoint>& all, int most) {
  std::map<int, std::size_t> size;
  for (const SurveyPoint& s : all) ++size[s.run];
  if (size.size() < 2) return {};
  std::vector<std::pair<std::size_t, int>> by_size;
  for (const auto& [run, count] : size) by_size.emplace_back(count, run);
  std::sort(by_size.rbegin(), by_size.rend());
  std::vector<int> runs;
  for (const auto& [count, run] : by_size) {
    if (static_cast<int>(runs.size()) < most) runs.push_back(run);
  }
  return runs;
}

std::vector<std::uint8_t> whole_run(const std::vector<SurveyPoint>& all, int run) {
  std::vector<std::uint8_t> removed(all.size());
  std::transform(all.begin(), all.end(), removed.begin(), [run](const SurveyPoint& s) { return s.run == run; });
  return removed;
}

void compare(const SmoothSurface& surface, const std::vector<std::uint8_t>& removed, std::vector<LocalMiss>& misses) {
  const std::vector<SurveyPoint>& all = surface.soundings();
  std::vector<SurveyPoint> kept;
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (!removed[i]) kept.push_back(all[i]);
  }
  if (kept.size() < 10) return;
  std::optional<SmoothSurface> rest;
  try {
    rest.emplace(std::move(kept));
  } catch (const Error&) {
    return;  // the remaining soundings lie on one line
  }
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (!removed[i]) continue;
    if (const auto sample = rest->at(all[i].north_east)) {
      misses.push_back({static_cast<int>(i), {sample->distance_m, std::abs(sample->depth_m - all[i].depth_m)}});
    }
  }
}

}  // namespace

SurfaceError::SurfaceError(const SmoothSurface& surface, const SurfaceErrorConfig& config, double fallback_m) {
  const double spacing = mean_spacing(surface.triangulation());
  std::vector<LocalMiss> misses;
  Random random(config.seed);
  for (int round = 0; round < config.rounds; ++round) {
    const double radius = spacing * std::exp2(round);
    compare(surface, empty_discs(surface.soundings(), radius, config.share, random.fork()), misses);
  }
  comparisons_ = misses.size();
  roughness_.assign(surface.soundings().size(), 1);
  if (misses.size() < kFewest) {
    growth_ = {{spacing, fallback_m}, {2 * spacing, 2 * fallback_m}};
    return;
  }
  std::vector<Miss> plain(misses.size());
  std::transform(misses.begin(), misses.end(), plain.begin(), [](const LocalMiss& m) { return m.miss; });
  fit_growth(std::move(plain));
  std::vector<double> power(roughness_.size(), 0), count(roughness_.size(), 0);
  const auto ratio_of = [&](const LocalMiss& m) { return m.miss.second / sigma_at_distance(m.miss.first); };
  for (const LocalMiss& m : misses) {
    power[static_cast<std::size_t>(m.sounding)] += std::min(ratio_of(m) * ratio_of(m), 25.0);
    ++count[static_cast<std::size_t>(m.sounding)];
  }
  // The ratio of the misses at a sounding and its neighbours to the rule.
  const auto roughness_at = [&](int sounding, double share_of_its_own) {
    double p = kWeightOfRule + share_of_its_own * power[static_cast<std::size_t>(sounding)];
    double n = kWeightOfRule + share_of_its_own * count[static_cast<std::size_t>(sounding)];
    for (const int other : surface.triangulation().around(sounding)) {
      p += power[static_cast<std::size_t>(other)];
      n += count[static_cast<std::size_t>(other)];
    }
    return std::sqrt(p / n);
  };
  for (std::size_t i = 0; i < roughness_.size(); ++i) roughness_[i] = roughness_at(static_cast<int>(i), 1);
  std::vector<double> ratios(misses.size());  // each miss is scaled by the roughness of the others only
  std::transform(misses.begin(), misses.end(), ratios.begin(),
                 [&](const LocalMiss& m) { return ratio_of(m) / roughness_at(m.sounding, 0); });
  const double scale = covering_scale(ratios);
  for (auto& [distance, sigma] : growth_) sigma *= scale;
  std::vector<Miss> between_runs;  // sigma of the surface, miss
  for (const int run : largest_runs(surface.soundings(), config.runs)) {
    std::vector<LocalMiss> of_run;
    compare(surface, whole_run(surface.soundings(), run), of_run);
    for (const LocalMiss& m : of_run) {
      const double rough = roughness_[static_cast<std::size_t>(m.sounding)];
      between_runs.emplace_back(rough * sigma_at_distance(m.miss.first), m.miss.second);
    }
  }
  if (between_runs.size() >= kFewest) run_sigma_ = sigma_of_runs(between_runs);
  comparisons_ += between_runs.size();
}

/// Fits sigma in distance classes of equal size, made monotonic by pooling neighbours that fall.
void SurfaceError::fit_growth(std::vector<Miss> misses) {
  std::sort(misses.begin(), misses.end());
  const std::size_t classes = std::clamp<std::size_t>(misses.size() / kFewest, 1, 24);
  struct Class {
    double distance, power, weight;
  };
  std::vector<Class> rising;
  for (std::size_t c = 0; c < classes; ++c) {
    const std::size_t begin = c * misses.size() / classes, end = (c + 1) * misses.size() / classes;
    std::vector<double> absolute;
    double distance = 0;
    for (std::size_t i = begin; i < end; ++i) {
      absolute.push_back(misses[i].second);
      distance += misses[i].first;
    }
    const auto n = static_cast<double>(end - begin);
    const double sigma = std::max(covering_scale(absolute), 1e-6);
    rising.push_back({distance / n, sigma * sigma, n});
    while (rising.size() > 1 && rising[rising.size() - 2].power >= rising.back().power) {
      const Class last = rising.back();
      rising.pop_back();
      Class& into = rising.back();
      const double sum = into.weight + last.weight;
      into = {(into.distance * into.weight + last.distance * last.weight) / sum,
              (into.power * into.weight + last.power * last.weight) / sum, sum};
    }
  }
  growth_.clear();
  for (const Class& c : rising) growth_.emplace_back(c.distance, std::sqrt(c.power));
}

double SurfaceError::sigma_at_distance(double distance_m) const {
  if (distance_m <= growth_.front().first) return growth_.front().second;
  for (std::size_t i = 1; i < growth_.size(); ++i) {
    if (distance_m > growth_[i].first) continue;
    const auto& [d0, s0] = growth_[i - 1];
    const auto& [d1, s1] = growth_[i];
    return s0 + (s1 - s0) * (distance_m - d0) / (d1 - d0);
  }
  return growth_.back().second * distance_m / growth_.back().first;  // beyond the largest distance: in proportion
}

double SurfaceError::sigma_m(const SmoothSurface::Sample& sample) const {
  const double own = roughness_[static_cast<std::size_t>(sample.nearest)] * sigma_at_distance(sample.distance_m);
  return std::hypot(own, run_sigma_, (sample.depth_m - sample.flat_m) / 2);
}

}  // namespace isobath
