// PoseBuffer: the pose of the body at the transmit time of a ping, from the fixes around it (design, section 3).
//
// Between two fixes: interpolation (straight line, shortest arc). After the newest fix: carried on with its velocity,
// for at most `max_extrapolation_s`. Holds a bounded number of fixes; nothing allocates after construction.
//
// A jump: a fix that lies farther than `jump_m` from where the vehicle can have moved to, by the velocity that the
// last fix states or by the way from the fix before it, whichever explains more, and by an acceleration of 1 m/s2. It
// corrects what was believed until then; so the fixes before it are moved to where they would have been, and a pose
// that is asked for later is in line with the new place (ledger S6-53). What jumps is the position: a heading that
// jumps is taken for a turn.
#pragma once

#include <isobath/base/config.hpp>
#include <isobath/base/error.hpp>
#include <isobath/vehicle/navigation.hpp>
#include <optional>
#include <vector>

namespace isobath {

struct PoseBufferConfig {
  double wait_s = 0.5;               ///< that a ping waits for the fix after it
  double max_extrapolation_s = 1.0;  ///< beyond the newest fix
  double max_gap_s = 5.0;            ///< between two fixes that are still joined by a straight line
  double jump_m = 1.0;               ///< from where the motion leads to, beyond which a fix is a correction
};
std::vector<Field> fields(PoseBufferConfig& config);

enum class PoseFault : std::uint8_t { kNoFixYet, kBeforeFirst, kGap, kStale };
const char* to_text(PoseFault fault);

class PoseBuffer {
 public:
  explicit PoseBuffer(const PoseBufferConfig& config);

  /// Fixes come in order of time. Returns by how much the position jumped, m in W; zero: it did not.
  Eigen::Vector3d add(const Navigation& fix);
  void clear();
  [[nodiscard]] bool empty() const { return count_ == 0; }
  /// Whether a later fix could still change the answer for this time.
  [[nodiscard]] bool settled(Time time) const { return count_ > 0 && newest().time >= time; }
  [[nodiscard]] Result<Pose, PoseFault> at(Time time) const;
  /// Standard deviation of the place in the plane along its longer axis, as the newest fix states it, m; 0: not stated.
  [[nodiscard]] double sigma_m() const;
  /// Whether displacements rest on more than dead reckoning by a model of the thruster: the newest fix states its
  /// velocity to 0.1 m/s, or states no accuracy (ledger S6-22).
  [[nodiscard]] bool knows_its_motion() const;

 private:
  static constexpr std::size_t kCapacity = 1024;
  [[nodiscard]] const Navigation& fix(std::size_t age) const {
    return ring_[(next_ + kCapacity - 1 - age) % kCapacity];
  }
  [[nodiscard]] const Navigation& newest() const { return fix(0); }
  [[nodiscard]] Eigen::Vector3d jump_to(const Navigation& fix) const;

  PoseBufferConfig config_;
  std::vector<Navigation> ring_;
  std::size_t next_ = 0;
  std::size_t count_ = 0;
  std::optional<Eigen::Vector3d> velocity_;  ///< W, by the last two fixes, jumps left out
  double apart_s_ = 0;                       ///< these two
};

}  // namespace isobath
