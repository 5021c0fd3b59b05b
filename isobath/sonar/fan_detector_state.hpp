// FanDetectorState: what the sources of FanDetector share; no other source includes it. Each part is a source of its
// own:
//
//   fan_detector.cpp      geometries, thresholds, the decision of each cell and its information
//   fan_loud_echoes.cpp   what loud echoes hide: side lobes at their range, the shadow behind them
//   fan_suspects.cpp      the learning: which cells may hold targets, and are not learnt from
//
// Vectors of cells are beams x bins. A stratum is one of kStrata classes of cells that have thresholds of their own: by
// third of the ranges, by third of the beams, quiet or loud.
#pragma once

#include <array>
#include <cstdint>
#include <isobath/sonar/boundary_echoes.hpp>
#include <isobath/sonar/fan_background.hpp>
#include <isobath/sonar/fan_cells.hpp>
#include <isobath/sonar/fan_config.hpp>
#include <isobath/sonar/fan_looks.hpp>
#include <isobath/sonar/fan_model.hpp>
#include <isobath/sonar/fan_watch.hpp>
#include <isobath/sonar/tail_law.hpp>
#include <memory>
#include <optional>
#include <vector>

namespace isobath {

struct FanDetectorState {
  explicit FanDetectorState(const FanDetectorConfig& config) : config_(config) {}
  void detect(const Ping& ping, const WaterColumn& water, EchoDecisions& samples, FanLooks& looks);
  [[nodiscard]] float threshold(int beam, int bin) const;
  [[nodiscard]] FanModel learnt() const;
  [[nodiscard]] std::optional<FanDeparture> departure() const;

  static constexpr int kThirds = FanModel::kThirds, kNinths = kThirds * kThirds, kStrata = FanModel::kStrata;
  static constexpr float kLoud = 2;        ///< times the quiet water, in power
  static constexpr std::size_t kKept = 4;  ///< geometries
  /// A loud echo in front.
  struct Front {
    int dark_from = 0;  ///< the cell
    float power = 0;
  };
  struct Geometry {
    std::shared_ptr<const BeamFan> fan;
    RangeWindow window;
    SampleType type = SampleType::kU8;
    double blanking_m = 0;
    int first_bin = 0;
    FanCells cells;
    FanBackground background;
    std::array<TailLaw, kStrata> laws;
    TailLaw all;
    FanWatch watch;
    std::array<std::vector<std::uint8_t>, kThirds> quiet_strata;  ///< for each third of the beams: of each range
    std::vector<std::uint8_t> heat;  ///< of each cell: pings for which it is not learnt from
    std::uint64_t used = 0;
    Time time;
    int pings = 0;
    std::array<float, kNinths> marked{};  ///< share of the cells of each ninth that look like targets
    bool heard = false;
    bool of_model = false;  ///< the setting of the model
  };
  /// The strata of the cells of a beam.
  struct Strata {
    const std::uint8_t* quiet;  ///< of each range, as if its level were that of quiet water
    const float* level;         ///< of each range
    float loud;                 ///< above this level a cell is of another stratum
    std::size_t operator[](int bin) const { return level[bin] > loud ? std::size_t{kNinths} + quiet[bin] : quiet[bin]; }
  };
  static Strata strata_of(const Geometry& g, int beam) {
    return {g.quiet_strata[static_cast<std::size_t>(beam * kThirds / g.cells.beams())].data(),
            g.background.level().data() + static_cast<std::ptrdiff_t>(beam) * g.cells.bins(),
            kLoud * g.background.quiet()};
  }

  Geometry& geometry_of(const Ping& ping);
  void take_laws(Geometry& g, const Geometry* before) const;
  void drop_model(Geometry& g);
  void silence_dead_beams(const Geometry& g);
  void rate(const Geometry& g);
  void set_thresholds(const Geometry& g);
  void decide(Geometry& g, EchoDecisions& out);
  void suspect(const Geometry& g);
  [[nodiscard]] int first_loud(const Geometry& g, const EchoDecisions& out, int beam, bool body) const;
  [[nodiscard]] bool is_body(const Geometry& g, int beam, int bin) const;
  void hide_shadows(const Geometry& g, EchoDecisions& out);
  void cast(std::vector<Front>& fronts, int beam, int bin, int thick) const;
  [[nodiscard]] bool is_loud(const Geometry& g, int beam, int bin) const;
  void drop_side_lobes(const Geometry& g, EchoDecisions& out);
  void drop_skirts(EchoDecisions& out, int bin) const;
  void learn(Geometry& g);
  void describe(const Geometry& g, EchoDecisions& out);
  void spread_to_samples(const Ping& ping, const Geometry& g, const EchoDecisions& cells, EchoDecisions& out);
  void sum_suspects(int beams, int bins);
  void mark_targets(int beams, int bins, int first_bin);
  [[nodiscard]] bool is_cluttered(const Geometry& g) const;
  [[nodiscard]] int company(int beam, int bin, int beams, int bins) const;

  std::vector<std::unique_ptr<Geometry>> geometries_;
  Geometry* last_ = nullptr;
  std::uint64_t clock_ = 0;
  std::vector<float> power_, ratios_;
  std::vector<Front> body_, any_;  ///< for each beam: the echo that casts its shadow; the nearest loud one
  std::vector<std::uint32_t> suspect_sums_;
  std::vector<std::uint8_t> target_;                     ///< cells: 1 where a target stands, or its skirts
  std::vector<std::uint8_t> suspects_;                   ///< cells: 1 where there may be an echo
  std::vector<float> loudest_;                           ///< of each range
  std::array<float, kStrata> thresholds_{}, suspect_{};  ///< ratios: of an echo; of what may be one
  float largest_ = 0, saturated_ = 0;  ///< power of a sample at full scale; of a cell from which on samples are clipped
  std::vector<float> sums_, p_dim_, row_;
  std::vector<std::uint64_t> dim_;

  FanDetectorConfig config_;
  std::shared_ptr<const FanModel> model_;  ///< null: none
  bool dropped_ = false;                   ///< the pings contradict its laws
};

}  // namespace isobath
