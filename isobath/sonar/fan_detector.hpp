// FanDetector: decides for each resolution cell of a fan whether it holds an echo of an object in the water (ledger
// S6-03, S6-06, S6-09, S6-62, S6-64, S6-69).
//
//   samples -> cells (fan_cells.hpp) -> background of each cell (fan_background.hpp) -> ratio u -> threshold
//   (tail_law.hpp)
//
// There is one decision per cell and ping. Its false-alarm rate is the requested one: the thresholds are quantiles of
// u, learnt from the pings so far for each third of the ranges and each third of the beams, and separately where
// bottom, surface or reverberation are louder than the quiet water. Targets must not raise the thresholds: the detector
// does not learn from cells that stand out (by the middle of the law, which targets do not affect) side by side, or
// repeatedly within kHeatMemory pings. The first ping is decided already, by a law fitted to itself.
//
// Side lobes. All beams receive a loud echo at its range. An echo below a quarter of the amplitude of the loudest at
// its range is taken for a side lobe, and its cell has no information.
//
// Information of a decision. p_D is `fan_p_detect` in quiet water. A louder background hides targets: p_D falls as that
// of a fluctuating target (Swerling 1), p_D = f^(1 / (1 + s)), s its signal-to-noise ratio; below twice f the cell has
// no information. `weight` is the ping's share of an independent look: pings that follow each other faster than
// `look_s` share one. Echoes of one ping have a weight of at most one half, so that no single ping makes an obstacle;
// in clutter, whose spikes last for seconds, of a third of the ping's weight.
//
// Geometries. The state of the last four pairs of fan and range window is kept, so that pings may interlace. A new one
// inherits the thresholds, since u is dimensionless. Dead beams (below a hundredth of the median beam) have no
// information. Samples may be linear amplitude or any monotonic scale of it, since the law of u is learnt, not assumed.
//
// A model (fan_model.hpp) provides thresholds, reliefs of the rows and the blind zone from the first ping on; a ping of
// another setting uses only its laws. Later pings refine them. If the median ratio of the first 40 pings differs from
// the model's (a factor 2 at first, 1.5 later), its laws are dropped at once.
//
// Not promised: an obstacle that fills more than two thirds of the directions within `window_deg` and more than 13
// cells in range, and is at most four times as loud as the background before, is taken for bottom (a gentle slope that
// rises). After the first ping of a geometry nothing allocates, nothing throws. One thread, one object per sonar.
// Deterministic.
#pragma once

#include <isobath/sonar/boundary_echoes.hpp>
#include <isobath/sonar/echo_decisions.hpp>
#include <isobath/sonar/fan_config.hpp>
#include <isobath/sonar/fan_looks.hpp>
#include <isobath/sonar/fan_model.hpp>
#include <isobath/sonar/ping.hpp>
#include <memory>
#include <optional>
#include <vector>

namespace isobath {

struct FanDetectorState;

class FanDetector {
 public:
  static constexpr int kMinBeams = 8;  ///< minimum number of beams for a background across the beams

  explicit FanDetector(const FanDetectorConfig& config = {});
  ~FanDetector();
  FanDetector(FanDetector&&) noexcept;
  FanDetector& operator=(FanDetector&&) noexcept;

  /// Decides a ping that passes `check`. `samples`: the same decisions by sample, for pictures and statistics: a sample
  /// of a cell with an echo is an echo if it is at least as loud as the mean of the cell.
  void detect(const Ping& ping, const WaterColumn& water, EchoDecisions& samples, FanLooks& looks);

  /// Ratio of the power of each cell of the last ping to its background; -1 for a cell without samples.
  [[nodiscard]] const std::vector<float>& ratios() const;
  /// Threshold on this ratio for a cell of the last ping.
  [[nodiscard]] float threshold(int beam, int bin) const;

  /// Starts from a model; call before the first ping. The model must be of the same sonar as the pings.
  void start_from(std::shared_ptr<const FanModel> model);
  /// The model learnt at the setting of the last ping, without correlation, quality and blind zone.
  [[nodiscard]] FanModel learnt() const;
  /// Departure of the pings from the start model; empty without one.
  [[nodiscard]] std::optional<FanDeparture> departure() const;
  /// The threshold of a stratum, from its own law if that has enough values, else from the law of all strata.
  [[nodiscard]] static float threshold_of(const TailLaw& own, const TailLaw& all, double false_alarm);

 private:
  std::unique_ptr<FanDetectorState> state_;
};

}  // namespace isobath
