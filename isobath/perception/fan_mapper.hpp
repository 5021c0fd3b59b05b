// FanMapper: inserts pings of an imaging sonar, whose beams are wide in elevation, into voxels (Horner et al. c. 2009,
// 4; ledger S5-12, S5-14 to S5-16, S5-31, S5-57).
//
// The update is voxel-centred: for each voxel of the ensonified sector, the rectangle of (beam, bin) cells that its
// cube spans is looked up, and its evidence is added once. Mount, roll, pitch and heading are included; bins are slant
// ranges. The rectangle of a voxel that contains a point includes the cell that contains the point, so no bin is
// dropped.
//
// Evidence of a rectangle. It is not known into which of its n cells an echo of the voxel would fall. So the likelihood
// ratio P(cells | occupied) / P(cells | empty) is the mean over the n cells of the ratio of each. A clear cell has the
// ratio (1 - p_D) / (1 - f), an uninformative cell 1. A cell with an echo has a ratio by rule:
//   marginal     p_D / (p_D (1 - E) + f E). E is the probability that no other voxel gave the echo: the product of
//                1 - P / n over all voxels that span the cell, P from the earlier evidence of this sensor. An echo that
//                another voxel of the arc explains adds little here (S5-31);
//   stamp        p_D / f: the paper's update, the same for the whole arc;
//   hit_and_miss no likelihoods: `hit` if any cell of the rectangle holds an echo, else `miss`.
// If the detector knows the likelihood of an echo's intensity (EchoDecisions::ratios), L = h / e, with h the
// probability of the intensity given an echo and e in noise, the same derivation gives
//   marginal     L / (L (1 - E) + E):  if the voxel echoes, the intensity has probability h; if not, another voxel gave
//                it with probability 1 - E, so it has (1 - E) h + E e; divided by e;
//   stamp        L.
// A detector of echo or no echo is the case of two intensities, L = p_D / f. Below the threshold all intensities count
// as one. The p_D above is that of a voxel. An occupied voxel echoes only towards some directions (a hull reflects most
// of the sound away), so it is the detector's p_D with weight `visibility` and f with the rest; h likewise, and L
// becomes 1 + visibility (L - 1).
//
// With the rule `aspects` (the default) looks are not independent: pings from nearly one position give nearly the same
// information. Evidence of silence saturates, and echoes from one direction have a limit (aspect_law.hpp). A voxel has
// an echo if any cell of its rectangle holds one; in empty water the probability is F = 1 - (1 - f)^n. R is the mean
// over these cells of
//   p_D / (p_D (1 - E) + F E),   or L / n for p_D / F if the detector knows ratios,
// with E as above and P weighted by the share of directions that echo. An echo adds at most (1 - F) / F times what a
// silent look subtracts, so the evidence of empty water does not rise on average, however often noise gives an echo.
//
// Beams closer than their width are not independent looks: the logarithm is weighted by the number of beams of the
// rectangle times their spacing over their width, clamped to 1 .. `max_looks`.
//
// Behind an echo of `shadow_bins` consecutive bins, clear bins of the beam are not informative: objects there are
// hidden (S5-57). A dim bin (bottom or surface are loud there) is informative only if it holds an echo.
//
// Frames: ledger. The evidence of a ping is the same, bit for bit, on any number of threads and with any vector
// instructions. Its threads wait between pings. Allocates at the first ping of a geometry and where the map grows. Not
// thread-safe.
#pragma once

#include <cstdint>
#include <isobath/base/config.hpp>
#include <isobath/base/thread_pool.hpp>
#include <isobath/map/voxel/voxel_map.hpp>
#include <isobath/perception/aspect_law.hpp>
#include <isobath/perception/fan_kernel.hpp>
#include <isobath/perception/fan_sector.hpp>
#include <isobath/perception/heard_cells.hpp>
#include <isobath/sonar/echo_decisions.hpp>
#include <isobath/sonar/ping.hpp>
#include <limits>
#include <memory>
#include <optional>
#include <vector>

namespace isobath {

/// Forecast for one cell of a ping: the probability of an echo by a map, and the share of the cell's voxels that any
/// sensor has observed.
struct EchoForecast {
  float p_echo = 0;
  float seen = 0;
};

struct FanMapperConfig {
  enum class Rule : std::uint8_t { kAspects, kMarginal, kStamp, kHitAndMiss } rule = Rule::kAspects;
  double hit = 0.847;        ///< hit_and_miss: log-odds of an echo
  double miss = -0.405;      ///< hit_and_miss: log-odds of none
  double visibility = 0.35;  ///< share of looks at an occupied voxel in which it can echo
  AspectConfig aspects;
  double max_looks = 1;  ///< maximum number of independent looks of one ping at one voxel
  int shadow_bins = 3;   ///< consecutive bins with echoes that cast a shadow; 0: no shadows
};
std::vector<Field> fields(FanMapperConfig& config);

class FanMapper {
 public:
  /// `prior`: log-odds of a voxel before any look, for the marginal rule.
  FanMapper(const FanMapperConfig& config, double voxel_m, double prior);

  /// Depth of the surface in W, m. Voxels whose centre is above it are not water and stay unchanged (S5-39). Minus
  /// infinity, the default: no surface.
  void set_surface(double depth_m) { surface_m_ = depth_m; }

  /// Reports a jump of the estimated position, m in W, that is not a motion of the sonar.
  void move_along(const Eigen::Vector3d& jump_W) {
    if (last_W_) *last_W_ += jump_W;
  }

  /// The reason why a valid ping cannot be inserted into voxels of this size; null: it can. The voxels are so large
  /// that one near the sonar spans 65536 cells or more, or so small that the fan is 4000 voxels long or holds 10^9.
  [[nodiscard]] static const char* fault_of(const Ping& ping, double voxel_m) {
    return FanSector::fault_of(ping, voxel_m);
  }

  /// Inserts a ping. The ping must be valid, the decisions have its size and the pose be finite. Throws Error if
  /// `fault_of` gives a reason. Returns the number of blocks visited.
  int update(const Ping& ping, const EchoDecisions& decisions, const Pose& X_WB, VoxelBlocks& layer, int threads = 1);

  /// Forecast of a ping of the same geometry, f + (p_D - f) (1 - E), beam by beam; of the decisions only p_D and f are
  /// used. E as in the marginal rule, from the pooled probabilities of a map with the same voxel size.
  std::vector<EchoForecast> forecast(const Ping& ping, const EchoDecisions& decisions, const Pose& X_WB,
                                     const VoxelMap& map);

 private:
  void take_ping(const Ping& ping);
  void take_decisions(const EchoDecisions& decisions, ThreadPool& pool);
  void explain(MixedVoxel& voxel, const LogOdds16* block, bool alone);
  void settle(const MixedVoxel& voxel, const EchoDecisions& decisions, const EvidenceBounds& bounds,
              LogOdds16* block) const;
  void settle_aspect(const MixedVoxel& voxel, const EchoDecisions& decisions, const EvidenceBounds& bounds,
                     const EnsonifiedBlock& part) const;
  [[nodiscard]] double probability(LogOdds16 evidence) const;
  /// Of an occupied voxel's giving an echo in its cell.
  [[nodiscard]] double p_voxel(double p_detect, double false_alarm) const {
    return false_alarm + config_.visibility * (p_detect - false_alarm);
  }

  FanMapperConfig config_;
  double voxel_m_;
  int prior_;  ///< units of evidence

  AspectLaw law_;
  std::vector<float> saturation_;  ///< AspectLaw::share by evidence, FanView::kSteps; empty by the other rules
  std::optional<Eigen::Vector3d> last_W_;
  Eigen::Vector3d moved_W_ = Eigen::Vector3d::Zero();  ///< of the sonar since the ping before, m; zero at first

  double surface_m_ = -std::numeric_limits<double>::infinity();

  FanSector sector_;
  FanView view_{};

  // Of the ping at hand.
  HeardCells cells_;
  std::vector<float> clear_, clear_ratio_;
  std::vector<std::int32_t> explained_;  ///< of each cell that holds an echo: -ln E of all its voxels, fixed point
  std::vector<std::vector<MixedVoxel>> mixed_;  ///< of each block
  std::unique_ptr<ThreadPool> pool_;
};

}  // namespace isobath
