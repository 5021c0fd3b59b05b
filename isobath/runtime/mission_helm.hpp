// MissionHelm: the crew of agents at the helm: events become messages, messages set-points (Ganesan 2015, 5.1; ledger
// S6-32, S6-42, S6-57, S6-D09).
//
// The same object steers in the closed loop, before a log and on a vehicle: it knows nothing but the events that it
// hears and what the pipeline makes of them. Navigation, ranges and health go to the crew as they come, what a ping
// says of its sonar and each sweep as soon as the pipeline has placed them. The mission begins with the first fix.
// Time is that of the events (mission_clock.hpp); every event moves it, so that agents notice what has fallen silent.
//
// The operator's link gives a sign of life each second, but while a health report calls it lost. A health report of
// "agent.NAME" is a fault of this computer, injected by a simulator or found in its log: the agent hangs where the note
// says so, else it dies; both are for good.
//
// Events whose numbers are not finite are for nobody: their sender falls silent. A function of the events. One thread.
// Throws Error where the crew cannot be (crew.hpp).
#pragma once

#include <isobath/mission/crew.hpp>
#include <isobath/runtime/helm.hpp>
#include <isobath/runtime/mission_clock.hpp>
#include <isobath/runtime/scenario.hpp>
#include <isobath/sonar/sensor_table.hpp>
#include <memory>
#include <optional>

namespace isobath {

class MissionHelm : public Helm {
 public:
  /// `echo_contrast`: of the echoes that the Safety Officer is shown (sonar_look.hpp).
  MissionHelm(std::vector<Seat> seats, const VehicleSheet& vehicle, const CrewConfig& config,
              std::shared_ptr<const MissionPlan> plan, double echo_contrast);

  void hear(const Event& event) override;
  void on_ping(const PosedPing& ping) override;
  void on_scan(const ScanResult& scan) override;
  [[nodiscard]] Setpoint steer() override;
  [[nodiscard]] MissionReport progress() const override { return report_; }
  [[nodiscard]] const std::vector<Decision>& decisions() const override { return decisions_; }

  [[nodiscard]] const Crew& crew() const { return *crew_; }
  [[nodiscard]] const MissionPlan& plan() const { return *plan_; }

 private:
  void note(const Envelope& envelope);
  void begin();
  void beat();
  void hear_health(Health health);
  [[nodiscard]] std::string name_of(const Ping& ping);

  std::vector<std::string> names_;  ///< of the seats
  std::shared_ptr<const MissionPlan> plan_;
  std::unique_ptr<Crew> crew_;  ///< holds a way back to this object
  double echo_contrast_;
  MissionClock clock_;
  SensorTable sonars_;
  bool begun_ = false;
  bool link_ = true;
  std::optional<Time> next_beat_;
  double sigma_m_ = 0;  ///< of the last fix
  MissionReport report_;
  std::vector<Decision> decisions_;
};

}  // namespace isobath
