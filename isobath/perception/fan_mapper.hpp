// FanMapper: pings of an imaging sonar, each beam wide in elevation, into voxels (Horner et al. c. 2009, 4; ledger
// S5-12, S5-14 to S5-16, S5-31, S5-57).
//
// Voxel-centred: of every voxel in the ensonified sector the rectangle of (beam, bin) cells that its cube spans is
// looked up, and what they say is added once. With mount, roll, pitch and heading; bins are slant ranges. The voxel
// that holds a point hears the cell that holds it: no bin is dropped.
//
// What a rectangle says. Of its n cells, the one that an echo of the voxel would fall into is not known; so the
// likelihood ratio P(cells | occupied) / P(cells | empty) is the mean over the n of the ratio of each: (1 - p_D) / (1 -
// f) where it is clear, 1 where it tells nothing, and where it holds an echo one of
//   marginal     p_D / (p_D (1 - E) + f E), E the probability that no other voxel gave it, the product over all voxels
//                that span the cell of 1 - P / n, P from what this sensor has said before: an echo that another voxel
//                of the arc explains says little here (S5-31);
//   stamp        p_D / f: the paper's update, all of the arc alike;
//   hit_and_miss no likelihoods: `hit` where any cell of the rectangle holds an echo, else `miss`.
// Beams nearer to each other than their width are not independent looks: the logarithm counts times the beams of the
// rectangle, times their spacing over their width, but at least once and at most `most_looks` times.
//
// Behind an echo of `shadow_bins` bins in a row clear bins of the beam tell nothing: what is there is hidden (S5-57).
// A dim bin (bottom or surface are loud there) tells something only where it holds an echo.
//
// Frames: ledger. The evidence of a ping is the same, bit for bit, on any number of threads and whatever vector
// instructions the processor has. Allocates at the first ping of a geometry and where the map grows. Not thread-safe.
#pragma once

#include <cstdint>
#include <isobath/base/config.hpp>
#include <isobath/map/voxel_blocks.hpp>
#include <isobath/perception/fan_kernel.hpp>
#include <isobath/sonar/echo_decisions.hpp>
#include <isobath/sonar/ping.hpp>
#include <memory>
#include <utility>
#include <vector>

namespace isobath {

struct FanMapperConfig {
  enum class Rule : std::uint8_t { kMarginal, kStamp, kHitAndMiss } rule = Rule::kMarginal;
  double hit = 0.847;     ///< of hit_and_miss, log-odds
  double miss = -0.405;   ///< the same
  double most_looks = 4;  ///< of one ping at one voxel
  int shadow_bins = 3;    ///< 0: nothing hides anything
};
std::vector<Field> fields(FanMapperConfig& config);

class FanMapper {
 public:
  /// `prior`: log-odds of a voxel before any look, for the marginal rule.
  FanMapper(const FanMapperConfig& config, double voxel_m, double prior);

  /// The ping is valid, decisions have its size, the pose is finite. Throws Error where a voxel near the sonar spans
  /// 65536 cells or more. Returns the blocks that it looked at.
  int update(const Ping& ping, const EchoDecisions& decisions, const Pose& X_WB, VoxelBlocks& layer, int threads = 1);

 private:
  struct Sector;
  void take_geometry(const Ping& ping);
  void take_decisions(const EchoDecisions& decisions);
  void hide_shadows(const EchoDecisions& decisions, int beam, std::uint64_t* tells) const;
  [[nodiscard]] std::pair<int, int> counts(const MixedVoxel& voxel) const;
  template <class Visit>
  void each_echo(const MixedVoxel& voxel, const EchoDecisions& decisions, const Visit& visit) const;
  [[nodiscard]] std::int32_t explanation(const MixedVoxel& voxel, LogOdds16 evidence) const;
  void explain(MixedVoxel& voxel, const EchoDecisions& decisions, const LogOdds16* block);
  void settle(const MixedVoxel& voxel, const EchoDecisions& decisions, const EvidenceBounds& bounds,
              LogOdds16* block) const;
  [[nodiscard]] double probability(LogOdds16 evidence) const;

  FanMapperConfig config_;
  double voxel_m_;
  int prior_;  ///< units of evidence

  // Of the geometry at hand. Frame F: the sensor's, turned about its down axis so that the fan's middle lies ahead.
  std::shared_ptr<const BeamFan> fan_;
  RangeWindow window_;
  Pose X_SF_;
  double half_width_ = 0;  ///< of the fan with the outer beams' width, rad
  double sine_ = 0;        ///< of half its height
  std::vector<std::int32_t> beams_at_;
  FanView view_{};

  // Of the ping at hand.
  std::vector<std::int32_t> sums_;
  std::vector<std::uint64_t> tells_;
  std::vector<float> clear_, clear_ratio_;
  std::vector<std::int32_t> explained_;  ///< of each cell that holds an echo: -ln E of all its voxels, fixed point
  std::vector<std::vector<MixedVoxel>> mixed_;  ///< of each block
};

}  // namespace isobath
