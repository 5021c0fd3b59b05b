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
// Where the detector knows how likely the intensity of an echo is (EchoDecisions::ratios), with L = h / e, h its
// probability where something echoes and e in noise, the same derivation gives
//   marginal     L / (L (1 - E) + E):  given the voxel echoes, the intensity has probability h; given it does not, some
//                other one gave it with probability 1 - E, so that it has (1 - E) h + E e; divided by e;
//   stamp        L;
// and an echo or none is the case of two intensities, L = p_D / f. Below the threshold all intensities count as one.
// p_D here is of a voxel: what is occupied echoes only from some directions (a hull mirrors most of the sound away), so
// that the detector's p_D counts by `answers` and f by the rest; so does h, and L becomes 1 + answers (L - 1).
//
// By the rule `aspects` (the default) looks are not independent: pings from nearly one place say nearly the same.
// Silence saturates and echoes from one direction have a limit (aspect_law.hpp). A voxel is heard where any cell of its
// rectangle holds an echo, in empty water with probability F = 1 - (1 - f)^n. With R the mean over these cells of
//   p_D / (p_D (1 - E) + F E),   or L / n for p_D / F where the detector knows ratios,
// E as above, P counted by the share of directions that echo. An echo adds no more than (1 - F) / F times what silence
// takes: however often noise is heard, the evidence of empty water does not rise on average.
//
// Beams nearer to each other than their width are not independent looks: the logarithm counts times the beams of the
// rectangle, times their spacing over their width, but at least once and at most `most_looks` times.
//
// Behind an echo of `shadow_bins` bins in a row clear bins of the beam tell nothing: what is there is hidden (S5-57).
// A dim bin (bottom or surface are loud there) tells something only where it holds an echo.
//
// Frames: ledger. The evidence of a ping is the same, bit for bit, on any number of threads and whatever vector
// instructions the processor has. Its threads wait from ping to ping. Allocates at the first ping of a geometry and
// where the map grows. Not thread-safe.
#pragma once

#include <cstdint>
#include <isobath/base/config.hpp>
#include <isobath/base/work_team.hpp>
#include <isobath/map/voxel_map.hpp>
#include <isobath/perception/aspect_law.hpp>
#include <isobath/perception/fan_kernel.hpp>
#include <isobath/sonar/echo_decisions.hpp>
#include <isobath/sonar/ping.hpp>
#include <limits>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

namespace isobath {

/// Of one cell of a ping: how likely an echo is, by a map; and the share of the voxels that could give one which any
/// sensor has looked at.
struct EchoForecast {
  float p_echo = 0;
  float seen = 0;
};

struct FanMapperConfig {
  enum class Rule : std::uint8_t { kAspects, kMarginal, kStamp, kHitAndMiss } rule = Rule::kAspects;
  double hit = 0.847;     ///< of hit_and_miss, log-odds
  double miss = -0.405;   ///< the same
  double answers = 0.35;  ///< share of the looks at an occupied voxel in which it can echo at all
  AspectConfig aspects;
  double most_looks = 1;  ///< of one ping at one voxel
  int shadow_bins = 3;    ///< 0: nothing hides anything
};
std::vector<Field> fields(FanMapperConfig& config);

class FanMapper {
 public:
  /// `prior`: log-odds of a voxel before any look, for the marginal rule.
  FanMapper(const FanMapperConfig& config, double voxel_m, double prior);

  /// Depth of the surface in W, m: voxels whose centre is above it are no water and are left as they are (S5-39).
  /// Minus infinity, as at first: there is none.
  void set_surface(double depth_m) { surface_m_ = depth_m; }

  /// The position jumped, m in W: the sonar has not moved by that much.
  void move_along(const Eigen::Vector3d& jump_W) {
    if (last_W_) *last_W_ += jump_W;
  }

  /// Why a valid ping cannot go into voxels of this size; null: it can. They are so large that one near the sonar spans
  /// 65536 cells or more, or so small that the fan is 4000 of them long, or holds
  /// 10^9.
  [[nodiscard]] static const char* fault_of(const Ping& ping, double voxel_m);

  /// The ping is valid, decisions have its size, the pose is finite. Throws Error where `fault_of` says why. Returns
  /// the blocks that it looked at.
  int update(const Ping& ping, const EchoDecisions& decisions, const Pose& X_WB, VoxelBlocks& layer, int threads = 1);

  /// What the same geometry would hear, f + (p_D - f) (1 - E), beam after beam; of the decisions only p_D and f count.
  /// E as of the marginal rule, by the pooled probabilities of a map of the same voxels.
  std::vector<EchoForecast> forecast(const Ping& ping, const EchoDecisions& decisions, const Pose& X_WB,
                                     const VoxelMap& map);

 private:
  struct Sector;
  struct Part {
    VoxelIndex corner;
    float first[3];  ///< centre of its first voxel relative to the sensor, along W, m
    LogOdds16* evidence;
  };
  /// Those that the ping can touch, in one order.
  [[nodiscard]] std::vector<Part> parts_of(const Pose& X_WF) const;
  void aim(const Pose& X_WF);
  void take_geometry(const Ping& ping);
  void take_decisions(const EchoDecisions& decisions, WorkTeam& team);
  void take_beam(const EchoDecisions& decisions, int beam);
  void hide_shadows(const EchoDecisions& decisions, int beam, std::uint64_t* tells) const;
  [[nodiscard]] std::pair<int, int> counts(const MixedVoxel& voxel) const;
  template <class Visit>
  void each_echo(const MixedVoxel& voxel, const Visit& visit) const;
  void explain(MixedVoxel& voxel, const LogOdds16* block, bool alone);
  void settle(const MixedVoxel& voxel, const EchoDecisions& decisions, const EvidenceBounds& bounds,
              LogOdds16* block) const;
  void settle_aspect(const MixedVoxel& voxel, const EchoDecisions& decisions, const EvidenceBounds& bounds,
                     const Part& part) const;
  [[nodiscard]] double probability(LogOdds16 evidence) const;
  /// Of an occupied voxel's giving an echo in its cell.
  [[nodiscard]] double p_voxel(double p_detect, double false_alarm) const {
    return false_alarm + config_.answers * (p_detect - false_alarm);
  }

  FanMapperConfig config_;
  double voxel_m_;
  int prior_;  ///< units of evidence

  AspectLaw law_;
  std::vector<float> saturation_;  ///< AspectLaw::share by evidence, FanView::kSteps; empty by the other rules
  std::optional<Eigen::Vector3d> last_W_;
  Eigen::Vector3d moved_W_ = Eigen::Vector3d::Zero();  ///< of the sonar since the ping before, m; zero at first

  double surface_m_ = -std::numeric_limits<double>::infinity();

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
  int words_ = 0;  ///< of a beam in the next three
  std::vector<std::uint64_t> heard_,
      echoes_;                      ///< bins that tell anything, beam after beam; and those that hold an echo
  std::vector<std::uint64_t> fit_;  ///< bins in which an echo can be told from noise
  std::vector<float> clear_, clear_ratio_;
  std::vector<std::int32_t> explained_;  ///< of each cell that holds an echo: -ln E of all its voxels, fixed point
  std::vector<std::vector<MixedVoxel>> mixed_;  ///< of each block
  std::unique_ptr<WorkTeam> team_;
};

}  // namespace isobath
