// FanDetector: decides for each resolution cell of a fan whether it holds an echo of something that stands in the water
// (ledger S6-03, S6-06, S6-09, S6-62, S6-64, S6-69).
//
//   samples -> cells (fan_cells.hpp) -> background of each cell (fan_background.hpp) -> ratio u -> threshold
//   (tail_law.hpp)
//
// One decision a cell and ping. Its false-alarm rate is the one that is asked for: the thresholds are quantiles of u,
// learnt from the pings so far for each third of the ranges and each third of the beams, apart where bottom, surface or
// reverberation are louder than the quiet water. Targets must
// not raise them: cells that stand out (by the middle of the law, which targets do not move) side by side, or again and
// again within kHeatMemory pings, are not learnt from. The first ping decides already, by a law fitted to itself.
//
// Side lobes. A loud echo is heard in all beams at its range. An echo below a quarter of the amplitude of the loudest
// at its range is taken for one of those, and its cell says nothing.
//
// What a decision tells. p_D is `fan_p_detect` in quiet water. Where the background is louder a target hides: p_D falls
// as that of a fluctuating target (Swerling 1), p_D = f^(1 / (1 + s)), s its signal to noise ratio; below twice f the
// cell says nothing. `weight` is the share of an independent look that the ping is: pings that follow each other faster
// than `look_s` share one. Echoes of one ping count for no more than half of one, so that no ping makes an obstacle; in
// clutter, whose spikes stay for seconds, for a third of that.
//
// Geometries. The state of the last four pairs of fan and range window is kept, so that pings may interlace; a new one
// takes over the thresholds, since u has no unit. Beams that are dead (below a hundredth of the median beam) say
// nothing. Samples: linear amplitude, or any monotonic scale of it; the law of u is learnt, not assumed.
//
// A model (fan_model.hpp) gives thresholds, reliefs of the rows and blind zone from the first ping on; a ping of
// another setting takes the laws alone. What is heard goes on to teach them. Where the middle of the ratios of the
// first 40 pings is not that of the model (a factor 2 at first, 1.5 later), its laws are dropped at once.
//
// Not promised: an obstacle that fills more than two thirds of the directions within `window_deg` and more than 13
// cells in range, and is no louder than four times what was there before, is taken for bottom (a gentle slope that
// rises). After the first ping of a geometry nothing allocates, nothing throws. One thread, one object a sonar.
// Deterministic.
#pragma once

#include <isobath/sonar/boundary_echoes.hpp>
#include <isobath/sonar/echo_decisions.hpp>
#include <isobath/sonar/fan_config.hpp>
#include <isobath/sonar/fan_model.hpp>
#include <isobath/sonar/ping.hpp>
#include <memory>
#include <optional>
#include <vector>

namespace isobath {

/// The looks of one ping: one decision a resolution cell. `ping` has the geometry of the cells, and no samples.
struct FanLooks {
  Ping ping;
  EchoDecisions decisions;
};

class FanDetector {
 public:
  static constexpr int kLeastBeams = 8;  ///< with fewer there is no background across the beams

  explicit FanDetector(const FanDetectorConfig& config = {});
  ~FanDetector();
  FanDetector(FanDetector&&) noexcept;
  FanDetector& operator=(FanDetector&&) noexcept;

  /// The ping passes `check`. `samples`: the same decisions sample by sample, for pictures and statistics: a sample is
  /// an echo where its cell is, if it is at least as loud as the mean of the cell.
  void detect(const Ping& ping, const WaterColumn& water, EchoDecisions& samples, FanLooks& looks);

  /// Ratio of the power of each cell of the last ping to its background; -1 where nothing was heard.
  [[nodiscard]] const std::vector<float>& ratios() const;
  /// Threshold on that ratio in force for a cell of the last ping.
  [[nodiscard]] float threshold(int beam, int bin) const;

  /// Before the first ping; of the sonar whose pings come.
  void start_from(std::shared_ptr<const FanModel> model);
  /// What was learnt at the setting of the last ping: all of a model but correlation, quality and the blind zone.
  [[nodiscard]] FanModel learnt() const;
  /// How far the pings depart from the model that it started from; empty without one.
  [[nodiscard]] std::optional<FanDeparture> departure() const;
  /// The threshold of a stratum, from its own law where that knows enough, else from that of all strata.
  [[nodiscard]] static float threshold_of(const TailLaw& own, const TailLaw& all, double false_alarm);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace isobath
