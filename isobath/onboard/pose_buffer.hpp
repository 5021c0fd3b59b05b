// PoseBuffer: the pose of the body at the transmit time of a ping, from the fixes around it (design, section 3).
//
// Between two fixes the pose is interpolated (straight line, shortest arc). After the newest fix it is extrapolated
// with the velocity of that fix, for at most `max_extrapolation_s`, and for the first `extrapolate_s` of it with the
// rate of turn of the last two fixes: longer, the noise of a compass would turn it away. Within `extrapolate_s` such a
// pose is good enough for a ping that must not wait for the next fix. The buffer holds a bounded number of fixes;
// nothing allocates after construction.
//
// A fix is a jump if it lies farther than `jump_m` from any position that the vehicle can have reached. The reachable
// positions follow from the velocity that the last fix states, or from the last two fixes, whichever explains more of
// the displacement, and from an acceleration of 1 m/s2. A jump corrects the estimated position. The buffer therefore
// moves all earlier fixes by the jump, so that later queries agree with the new position (ledger S6-53).
//
// If the motion goes on at the rate of the jump, it was motion: a boat that starts between two fixes, and states no
// velocity, is taken for a jump once. A position that repeats to the last bit, as from a frozen receiver, does not
// count as measured. Only positions jump; a jump of the heading is taken for a turn.
#pragma once

#include <isobath/base/config.hpp>
#include <isobath/base/error.hpp>
#include <isobath/vehicle/navigation.hpp>
#include <optional>
#include <vector>

namespace isobath {

struct PoseBufferConfig {
  double wait_s = 0.5;               ///< how long a ping waits for the next fix
  double extrapolate_s = -1;         ///< after the newest fix, in which a ping does not wait; -1: as the run has it
  double max_extrapolation_s = 1.0;  ///< beyond the newest fix
  double max_gap_s = 5.0;            ///< between two fixes that are interpolated
  double jump_m = 1.0;               ///< distance from the predicted position beyond which a fix is a jump
};
std::vector<Field> fields(PoseBufferConfig& config);

enum class PoseFault : std::uint8_t { kNoFixYet, kBeforeFirst, kGap, kStale };
const char* to_text(PoseFault fault);

class PoseBuffer {
 public:
  explicit PoseBuffer(const PoseBufferConfig& config);

  /// Fixes come in order of time. Returns the jump of the position, m in W; zero if there was none.
  Eigen::Vector3d add(const Navigation& fix);
  /// Moves all fixes so far: the next ones contain a correction of the position, m in W.
  void move(const Eigen::Vector3d& by_W);
  void clear();
  [[nodiscard]] bool empty() const { return count_ == 0; }
  /// Whether later fixes can no longer change the pose of this time, or a measurement is not to wait for them.
  [[nodiscard]] bool settled(Time time) const;
  [[nodiscard]] Result<Pose, PoseFault> at(Time time) const;
  /// Standard deviation of the horizontal position along the longer axis of its ellipse, m, as the newest fix states
  /// it; 0: not stated.
  [[nodiscard]] double sigma_m() const;
  /// Variance of the heading, rad2, as the newest fix states it; 0: not stated.
  [[nodiscard]] double heading_variance() const;
  /// Whether displacements come from more than dead reckoning with a model of the thruster: the newest fix states its
  /// velocity to 0.1 m/s or better, or states no accuracy (ledger S6-22).
  [[nodiscard]] bool knows_its_motion() const;

 private:
  static constexpr std::size_t kCapacity = 1024;
  [[nodiscard]] const Navigation& fix(std::size_t age) const {
    return ring_[(next_ + kCapacity - 1 - age) % kCapacity];
  }
  [[nodiscard]] const Navigation& newest() const { return fix(0); }
  [[nodiscard]] Eigen::Vector3d jump_to(const Navigation& fix) const;
  [[nodiscard]] std::optional<Eigen::Vector3d> rate_of_turn() const;

  PoseBufferConfig config_;
  std::vector<Navigation> ring_;
  std::size_t next_ = 0;
  std::size_t count_ = 0;
  std::optional<Eigen::Vector3d> velocity_;  ///< in W, from the last two fixes, without the jump
  std::optional<Eigen::Vector3d> doubted_;   ///< the same with the jump: if the motion goes on so, it was no jump
  double apart_s_ = 0;                       ///< time between these two fixes
  double stood_s_ = 0;  ///< how long the position has been the same to the last bit, with no velocity stated
};

}  // namespace isobath
