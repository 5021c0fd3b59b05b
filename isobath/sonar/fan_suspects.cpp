// The learning of a FanDetector: suspects are the cells that stand out by chance too seldom; where they stand side by
// side or repeatedly they are taken for targets, and nothing is learnt there.
#include <algorithm>
#include <isobath/sonar/fan_detector_state.hpp>

namespace isobath {
namespace {

constexpr int kHeatMemory = 10;  // pings
constexpr int kHeat = 3;         // echoes within that time, from which on a cell is taken to hold a target
constexpr int kSkirtBeams = 4, kSkirtBins = 3;
constexpr int kWideBeams = 2, kWideBins = 16;  // to each side
constexpr double kFull = 0.25;
constexpr float kClutter = 0.004f, kClutterMemory = 0.01f;  // share of cells; of pings
constexpr int kClutteredThirds = 2;                         // of nine ninths, those that may be free of it

template <class Visit>
void for_around(int beam, int bin, int beams, int bins, const Visit& visit) {
  for (int b = std::max(0, beam - 1); b <= std::min(beams - 1, beam + 1); ++b) {
    for (int k = std::max(0, bin - 1); k <= std::min(bins - 1, bin + 1); ++k)
      visit(static_cast<std::size_t>(b) * static_cast<std::size_t>(bins) + static_cast<std::size_t>(k));
  }
}

}  // namespace

void FanDetectorState::suspect(const Geometry& g) {
  const int bins = g.cells.bins();
  suspects_.assign(power_.size(), 0);
  for (int b = 0; b < g.cells.beams(); ++b) {
    const auto row = static_cast<std::ptrdiff_t>(b) * bins;
    const float* u = ratios_.data() + row;
    const Strata strata = strata_of(g, b);
    std::uint8_t* out = suspects_.data() + row;
    for (int k = g.first_bin; k < bins; ++k) out[k] = u[k] >= suspect_[strata[k]] ? 1 : 0;
  }
}

/// What looks like targets in all parts of the fan is clutter: the spikes of a sea, which stay for seconds.
bool FanDetectorState::is_cluttered(const Geometry& g) const {
  auto shares = g.marked;
  std::nth_element(shares.begin(), shares.begin() + kClutteredThirds, shares.end());
  return shares[kClutteredThirds] > kClutter;
}

void FanDetectorState::learn(Geometry& g) {
  const int bins = g.cells.bins(), beams = g.cells.beams();
  mark_targets(beams, bins, g.first_bin);
  const bool cluttered = is_cluttered(g);
  std::array<float, kNinths> marked{};
  for (int b = 0; b < beams; ++b) {
    const auto row = static_cast<std::ptrdiff_t>(b) * bins;
    const float* u = ratios_.data() + row;
    const Strata strata = strata_of(g, b);
    std::uint8_t* heat = g.heat.data() + row;
    const int end = body_.empty() ? bins : std::min(bins, body_[static_cast<std::size_t>(b)].dark_from);
    for (int k = g.first_bin; k < bins; ++k) {
      std::uint8_t& target = target_[static_cast<std::size_t>(row + k)];
      if (heat[k] >= kHeat * kHeatMemory) target = 1;
      if (heat[k] > 0) --heat[k];
      marked[strata.quiet[k]] += target;
      if (cluttered) target = 0;
      if (!(u[k] >= 0) || target || k >= end || loudest_[static_cast<std::size_t>(k)] > 0) continue;
      const std::size_t i = strata[k];
      g.laws[i].add(u[k]);
      g.all.add(u[k]);
      g.watch.add(i, u[k]);
    }
  }
  const float cells = static_cast<float>(beams * (bins - g.first_bin)) / kNinths;
  const float a = std::max(1.f / static_cast<float>(g.pings + 1), kClutterMemory);
  for (std::size_t i = 0; i < marked.size(); ++i) g.marked[i] += a * (marked[i] / std::max(cells, 1.f) - g.marked[i]);
  for (int b = 0; b < beams; ++b) {
    for (int k = g.first_bin; k < bins; ++k) {
      if (!suspects_[static_cast<std::size_t>(b) * static_cast<std::size_t>(bins) + static_cast<std::size_t>(k)])
        continue;
      for_around(b, k, beams, bins, [&g](std::size_t at) {
        g.heat[at] = static_cast<std::uint8_t>(std::min(g.heat[at] + kHeatMemory, 6 * kHeatMemory));
      });
    }
  }
}

/// Suspects side by side, and what stands around them: the skirts of an echo in range and direction. Not where a wide
/// neighbourhood is full of suspects: that is reverberation whose level is not known yet.
void FanDetectorState::mark_targets(int beams, int bins, int first_bin) {
  target_.assign(suspects_.size(), 0);
  sum_suspects(beams, bins);
  const auto row = static_cast<std::size_t>(bins) + 1;
  for (int b = 0; b < beams; ++b) {
    for (int k = first_bin; k < bins; ++k) {
      const std::size_t at = static_cast<std::size_t>(b) * static_cast<std::size_t>(bins) + static_cast<std::size_t>(k);
      if (!suspects_[at] || company(b, k, beams, bins) < 2) continue;
      const int b0 = std::max(0, b - kWideBeams), b1 = std::min(beams, b + kWideBeams + 1);
      const int k0 = std::max(0, k - kWideBins), k1 = std::min(bins, k + kWideBins + 1);
      const auto sum = [&](int beam, int bin) {
        return suspect_sums_[static_cast<std::size_t>(beam) * row + static_cast<std::size_t>(bin)];
      };
      const std::uint32_t inside = sum(b1, k1) - sum(b0, k1) - sum(b1, k0) + sum(b0, k0);
      if (inside > kFull * static_cast<double>((b1 - b0) * (k1 - k0))) continue;
      for (int c = std::max(0, b - kSkirtBeams); c <= std::min(beams - 1, b + kSkirtBeams); ++c) {
        const auto from = target_.begin() + static_cast<std::ptrdiff_t>(c) * bins;
        std::fill(from + std::max(0, k - kSkirtBins), from + std::min(bins, k + kSkirtBins + 1), std::uint8_t{1});
      }
    }
  }
}

void FanDetectorState::sum_suspects(int beams, int bins) {
  const auto row = static_cast<std::size_t>(bins) + 1;
  suspect_sums_.assign((static_cast<std::size_t>(beams) + 1) * row, 0);
  for (std::size_t b = 0; b < static_cast<std::size_t>(beams); ++b) {
    std::uint32_t along = 0;
    for (std::size_t k = 0; k < static_cast<std::size_t>(bins); ++k) {
      along += suspects_[b * static_cast<std::size_t>(bins) + k];
      suspect_sums_[(b + 1) * row + k + 1] = suspect_sums_[b * row + k + 1] + along;
    }
  }
}

/// Other cells beside this one that may hold an echo.
int FanDetectorState::company(int beam, int bin, int beams, int bins) const {
  int count = -1;
  for_around(beam, bin, beams, bins, [&](std::size_t at) { count += suspects_[at]; });
  return count;
}

}  // namespace isobath
