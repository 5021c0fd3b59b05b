// PoseBuffer: the pose of the body at the transmit time of a ping, from the fixes around it (design, section 3).
//
// Between two fixes: interpolation (straight line, shortest arc). After the newest fix: carried on with its velocity,
// for at most `max_extrapolation_s`. Holds a bounded number of fixes; nothing allocates after construction.
#pragma once

#include <isobath/base/config.hpp>
#include <isobath/base/error.hpp>
#include <isobath/vehicle/navigation.hpp>
#include <vector>

namespace isobath {

struct PoseBufferConfig {
  double wait_s = 0.5;               ///< that a ping waits for the fix after it
  double max_extrapolation_s = 1.0;  ///< beyond the newest fix
  double max_gap_s = 5.0;            ///< between two fixes that are still joined by a straight line
};
std::vector<Field> fields(PoseBufferConfig& config);

enum class PoseFault : std::uint8_t { kNoFixYet, kBeforeFirst, kGap, kStale };
const char* to_text(PoseFault fault);

class PoseBuffer {
 public:
  explicit PoseBuffer(const PoseBufferConfig& config);

  /// Fixes come in order of time.
  void add(const Navigation& fix);
  void clear() { count_ = 0; }
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

  PoseBufferConfig config_;
  std::vector<Navigation> ring_;
  std::size_t next_ = 0;
  std::size_t count_ = 0;
};

}  // namespace isobath
