// Alarms: the emergency flags of a run. They are raised from raw ranges and health reports, before any stage waits for
// a pose or a map (Oskard 1990, III-D; ledger S1-05, S1-43, S1-44).
//
// ImminentCollision gets every range reading on arrival, without a gate, a filter or a map. The speed is that of the
// last fix, or follows from the last two positions where fixes carry no velocity. A fix older than kFreshFix is not
// used. Sensors beyond SensorTable::kMax share the looks of the last one.
//
// Times are those of the events. One thread calls `on_event`, `moved` and `jumped`; any thread may read the flags.
// Ranges and fixes allocate nothing.
#pragma once

#include <isobath/event/event.hpp>
#include <isobath/perception/imminent_collision.hpp>
#include <isobath/sonar/sensor_table.hpp>
#include <isobath/vehicle/emergency_flags.hpp>
#include <isobath/vehicle/state_evaluator.hpp>
#include <optional>
#include <string>
#include <vector>

namespace isobath {

/// A flag that was raised.
struct Alarm {
  std::string what;  ///< "imminent collision"
  Time first;
  bool lasting = false;  ///< still raised: its cause lasts, or it is latched
  bool acknowledged = false;
};
/// At the end of a run: "imminent collision, first at 2026-05-01T10:00:04.200Z, over at the end".
std::string to_text(const Alarm& alarm);
/// During a run: "imminent collision, first at 2026-05-01T10:00:04.200Z, over, not acknowledged".
std::string present_text(const Alarm& alarm);
/// All flags that were ever raised, in the order of their bits.
std::vector<Alarm> alarms_of(const EmergencyFlags& flags);

class Alarms {
 public:
  static constexpr Duration kFreshFix = std::chrono::seconds(3);

  /// Throws Error if the configuration is invalid.
  Alarms(const ImminentCollisionConfig& collision, const StateEvaluatorConfig& state);

  /// Range readings and health reports; other events are ignored.
  void on_event(const Event& event);
  /// A fix that the gate has admitted.
  void moved(const Navigation& fix);
  /// Navigation corrected the position by this much, m in W: not a motion of the vehicle.
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
