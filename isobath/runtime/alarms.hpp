// Alarms: the emergency flags of a run, raised from raw ranges and health reports before anything waits for a pose or
// a map (Oskard 1990, III-D; ledger S1-05, S1-43, S1-44).
//
// Every range reading is a look for ImminentCollision, as it comes: no gate, no filter, no map stands before it. The
// speed is that of the last fix, or of the way between the last two where fixes carry none; a fix older than
// kFreshFix says nothing of it. Beyond SensorTable::kMost sensors the last one's looks are shared.
//
// Times are those of the events. One thread hears; the flags may be watched from any. Ranges and fixes allocate
// nothing.
#pragma once

#include <isobath/io/event.hpp>
#include <isobath/perception/imminent_collision.hpp>
#include <isobath/sonar/sensor_table.hpp>
#include <isobath/vehicle/emergency_flags.hpp>
#include <isobath/vehicle/state_evaluator.hpp>
#include <optional>
#include <string>
#include <vector>

namespace isobath {

/// A flag that was up.
struct Alarm {
  std::string what;  ///< "imminent collision"
  Time first;
  bool lasting = false;  ///< up still, by its cause or latched
};
/// "imminent collision, first at 2026-05-01T10:00:04.200Z, over at the end".
std::string to_text(const Alarm& alarm);
/// All that were ever raised, in the order of their bits.
std::vector<Alarm> alarms_of(const EmergencyFlags& flags);

class Alarms {
 public:
  static constexpr Duration kFreshFix = std::chrono::seconds(3);

  /// Throws Error where the configuration cannot work.
  Alarms(const ImminentCollisionConfig& collision, const StateEvaluatorConfig& state);

  /// Ranges and health reports; other events say nothing here.
  void hear(const Event& event);
  /// A fix that can be believed.
  void moved(const Navigation& fix);
  /// Navigation corrected the position at once, m in W: no way that the vehicle went.
  void jumped(const Eigen::Vector3d& by_W);

  [[nodiscard]] EmergencyFlags& flags() { return flags_; }
  [[nodiscard]] const EmergencyFlags& flags() const { return flags_; }

 private:
  void look(const RangeReading& reading);
  [[nodiscard]] std::optional<Eigen::Vector3d> velocity_at(Time time) const;

  EmergencyFlags flags_;
  ImminentCollision collision_;
  StateEvaluator state_;
  SensorTable sensors_;
  std::optional<Navigation> fix_;
  std::optional<Eigen::Vector3d> v_B_;  ///< of fix_
};

}  // namespace isobath
