// What the loud echoes of a ping hide: the side lobes at their range, and the shadow behind them.
#include <algorithm>
#include <bit>
#include <cmath>
#include <isobath/sonar/fan_detector_state.hpp>

namespace isobath {
namespace {

constexpr float kSideLobe = 1.f / 16;    // of the loudest at a range, in power
constexpr float kOfSaturated = 1.f / 4;  // where that one is clipped
constexpr int kClippedRun = 3;           // cells
constexpr double kThick_m = 1.5;         // of a body that casts a shadow
constexpr float kBehind = 0.5f;          // of the power of the echo in front: another body
constexpr int kThickCells = 4, kShadowBeams = 3;
constexpr float kGhost = 0.1f;    // of that power: may be its own by a detour
constexpr float kSkirt = 0.03f;   // the same within the thickness of a body: may be its upper or lower parts
constexpr int kBodyBeams = 4;     // side by side that hear a body
constexpr int kBodyStep = 4;      // cells of range from one of them to the next
constexpr float kFarBeyond = 4;   // times its own threshold, and
constexpr float kLoudEcho = 100;  // times the quiet water: its side lobes may be heard, and its shadow is dark

}  // namespace

/// An echo that is heard by way of side lobes, and leaves a shadow.
bool FanDetectorState::is_loud(const Geometry& g, int beam, int bin) const {
  const std::size_t at =
      static_cast<std::size_t>(beam) * static_cast<std::size_t>(g.cells.bins()) + static_cast<std::size_t>(bin);
  return power_[at] >= kLoudEcho * g.background.quiet() &&
         ratios_[at] >= kFarBeyond * thresholds_[strata_of(g, beam)[bin]];
}

void FanDetectorState::drop_side_lobes(const Geometry& g, EchoDecisions& out) {
  const int bins = g.cells.bins();
  for (int b = 0; b < out.beams(); ++b) {
    const auto row = static_cast<std::ptrdiff_t>(b) * bins;
    for (int w = 0; w < out.words(); ++w) {
      for (std::uint64_t left = out.hits(b)[w]; left != 0; left &= left - 1) {
        const int k = 64 * w + std::countr_zero(left);
        if (!is_loud(g, b, k)) continue;
        const float power = power_[static_cast<std::size_t>(row + k)];
        for (int n = std::max(0, k - 1); n <= std::min(bins - 1, k + 1); ++n)
          loudest_[static_cast<std::size_t>(n)] = std::max(loudest_[static_cast<std::size_t>(n)], power);
      }
    }
  }
  for (int b = 0; b < out.beams(); ++b) {
    const auto row = static_cast<std::ptrdiff_t>(b) * bins;
    for (int w = 0; w < out.words(); ++w) {
      for (std::uint64_t left = out.hits(b)[w]; left != 0; left &= left - 1) {
        const int k = 64 * w + std::countr_zero(left);
        const float power = power_[static_cast<std::size_t>(row + k)];
        if (power < (loudest_[static_cast<std::size_t>(k)] > saturated_ ? kOfSaturated : kSideLobe) *
                        loudest_[static_cast<std::size_t>(k)])
          out.set_blind(b, k);
      }
    }
  }
  for (int k = g.first_bin; k < bins; ++k) {
    if (loudest_[static_cast<std::size_t>(k)] > saturated_) drop_skirts(out, k);
  }
}

/// The main lobe of a clipped echo is clipped beside the body too, as far as it cannot be told: on either side the
/// outermost of three and more such cells.
void FanDetectorState::drop_skirts(EchoDecisions& out, int bin) const {
  const auto is_clipped = [&](int b) {
    return b < out.beams() &&
           power_[static_cast<std::size_t>(b) * static_cast<std::size_t>(out.bins()) + static_cast<std::size_t>(bin)] >
               saturated_;
  };
  for (int b = 0; b < out.beams(); ++b) {
    const int first = b;
    while (is_clipped(b)) ++b;
    if (b - first < kClippedRun) continue;
    out.set_blind(first, bin);
    out.set_blind(b - 1, bin);
  }
}

/// Behind a body with a loud echo stands its shadow, and what comes from there went round by bottom, surface or the
/// body itself; an echo of a like power is another body that the first one does not hide. Sound goes past what is
/// narrower than that: behind it only weak echoes say nothing, which may be its own by way of bottom or surface.
void FanDetectorState::hide_shadows(const Geometry& g, EchoDecisions& out) {
  const int bins = g.cells.bins(), beams = out.beams();
  const int thick = std::max(kThickCells, static_cast<int>(std::lround(kThick_m / g.cells.window().bin_m)));
  body_.assign(static_cast<std::size_t>(beams), Front{bins});
  any_.assign(static_cast<std::size_t>(beams), Front{bins});
  for (int b = 0; b < beams; ++b) {
    cast(any_, b, first_loud(g, out, b, false), 1);
    cast(body_, b, first_loud(g, out, b, true), thick);
  }
  for (int b = 0; b < beams; ++b) {
    const float* power = power_.data() + static_cast<std::ptrdiff_t>(b) * bins;
    const Front &body = body_[static_cast<std::size_t>(b)], &any = any_[static_cast<std::size_t>(b)];
    for (int k = any.dark_from; k < bins; ++k) {
      const bool hit = out.hit(b, k);
      const float faint = (k >= any.dark_from + thick ? kGhost : kSkirt) * any.power;
      if (k >= body.dark_from ? !(hit && power[k] >= kBehind * body.power) : hit && power[k] < faint)
        out.set_blind(b, k);
    }
  }
}

/// What the cell in front hides in its own beam and those beside it.
void FanDetectorState::cast(std::vector<Front>& fronts, int beam, int bin, int thick) const {
  const int beams = static_cast<int>(fronts.size()), bins = last_->cells.bins();
  if (bin >= bins) return;
  const float power =
      power_[static_cast<std::size_t>(beam) * static_cast<std::size_t>(bins) + static_cast<std::size_t>(bin)];
  for (int c = std::max(0, beam - kShadowBeams); c <= std::min(beams - 1, beam + kShadowBeams); ++c) {
    Front& front = fronts[static_cast<std::size_t>(c)];
    front.dark_from = std::min(front.dark_from, bin + thick);
    front.power = std::max(front.power, power);
  }
}

/// Whether a loud echo goes on in the beams beside it: what is narrower than a beam lets sound past it, however loud.
bool FanDetectorState::is_body(const Geometry& g, int beam, int bin) const {
  int wide = 1;
  for (const int side : {-1, 1}) {
    int at = bin;
    for (int b = beam + side; b >= 0 && b < g.cells.beams(); b += side) {
      int next = -1;
      for (int k = std::max(0, at - kBodyStep); k <= std::min(g.cells.bins() - 1, at + kBodyStep); ++k) {
        if (is_loud(g, b, k) && (next < 0 || std::abs(k - at) < std::abs(next - at))) next = k;
      }
      if (next < 0) break;
      if (++wide >= kBodyBeams) return true;
      at = next;
    }
  }
  return false;
}

/// The nearest cell of a beam with a loud echo, or with one of a body; bins() without one.
int FanDetectorState::first_loud(const Geometry& g, const EchoDecisions& out, int beam, bool body) const {
  for (int w = 0; w < out.words(); ++w) {
    for (std::uint64_t left = out.hits(beam)[w]; left != 0; left &= left - 1) {
      const int k = 64 * w + std::countr_zero(left);
      if (is_loud(g, beam, k) && (!body || is_body(g, beam, k))) return k;
    }
  }
  return g.cells.bins();
}

}  // namespace isobath
