// Simulator: a scene as a stream of events in time, with the truth beside them.
//
// One logical clock, no wall clock: the vehicle is moved in steps of 20 ms (vehicle/plant.hpp); navigation sensors and
// sonars fire at their own instants between steps, where the pose is interpolated. Between source and output stand the
// faults. The vehicle follows its way-points, unless it is commanded: then a closed loop runs, each command taking
// effect with the next step. Health comes from the vehicle once a second, and from its host at once and then once a
// second for what has failed: a depth, heading or attitude sensor or an altimeter that is silent for five of its
// periods and half a second, a thruster, the disk; and once when it is well again. Everything follows from scene and
// seed: the same bytes on any number of threads (ledger S6-57). Throws Error, with the place in the scene's file, where
// the scene cannot begin: a body inside the vehicle, a start below the bottom. One thread calls; sonars may use more.
#pragma once

#include <deque>
#include <isobath/sim/dead_reckoning.hpp>
#include <isobath/sim/faults.hpp>
#include <isobath/sim/navigation_sensors.hpp>
#include <isobath/sim/scene.hpp>
#include <isobath/sim/simulated_sonar.hpp>
#include <isobath/sim/world.hpp>
#include <isobath/sonar/echo_truth.hpp>
#include <isobath/vehicle/guidance.hpp>
#include <isobath/vehicle/health.hpp>
#include <isobath/vehicle/plant.hpp>
#include <isobath/vehicle/vehicle_state.hpp>
#include <map>
#include <optional>
#include <variant>

namespace isobath {

/// What the vehicle gives (the first four) and what only a simulator knows (the last two).
using SimulatedEvent = std::variant<Ping, RangeReading, Navigation, Health, EchoTruth, TrueMotion>;

struct SimulationConfig {
  int seed = -1;             ///< -1: the scene's
  double duration_s = 0;     ///< 0: the scene's
  std::string without = {};  ///< name of a sonar that is switched off
};
std::vector<Field> fields(SimulationConfig& config);

class Simulator {
 public:
  Simulator(Scene scene, const SimulationConfig& config, int threads = 1);
  ~Simulator();

  /// The next event in order of its arrival; empty when the time is over. A truth comes before what it is about.
  std::optional<SimulatedEvent> next();
  /// From the next step on the vehicle follows this instead of its way-points.
  void command(const Setpoint& setpoint) { command_ = setpoint; }
  /// The next ping of a sonar obeys (S4-40). Throws Error for a sonar that the scene has not, or that cannot.
  void command(const std::string& sonar, const ScanCommand& scan);

  [[nodiscard]] const Scene& scene() const { return scene_; }
  [[nodiscard]] const World& world() const { return *world_; }
  [[nodiscard]] double now_s() const { return to_seconds(now_); }
  [[nodiscard]] double duration_s() const { return duration_s_; }
  [[nodiscard]] std::uint64_t seed() const { return seed_; }
  /// Half the diagonal of the hull in plan, m: what must stay clear.
  [[nodiscard]] double hull_radius() const;
  [[nodiscard]] const VehicleModel& vehicle() const { return model_; }
  /// What is broken, for whoever plays the parts that no simulator has: agents, planner, link.
  [[nodiscard]] const FaultSchedule& faults() const { return faults_; }

 private:
  struct Device;
  void check_start() const;
  void step();
  [[nodiscard]] Setpoint wanted(double dt);
  void move(double dt);
  void navigate();
  void ping_all();
  void report_health();
  void watch_parts();
  void report_parts();
  void report_part(const std::string& source, HealthState state, const char* note);
  void watch_for_events();
  void truth(Time time);
  [[nodiscard]] VehicleState state_at(Time time) const;
  template <class Channel>
  bool deliver(Channel& channel);
  void put(SimulatedEvent event);

  Scene scene_;
  std::uint64_t seed_;
  double duration_s_;
  Water water_;
  std::unique_ptr<World> world_;
  VehicleModel model_;
  std::unique_ptr<VehiclePlant> plant_;
  std::optional<LineOfSight> guidance_;
  std::optional<Setpoint> command_;
  FaultSchedule faults_;
  NavigationSensors sensors_;
  DeadReckoning navigator_;
  std::vector<std::unique_ptr<Device>> devices_;
  std::vector<std::pair<std::string, FaultyChannel<NavReading>>> reading_channels_;
  FaultyChannel<Navigation> fix_channel_;
  struct Part {
    double silent_s = 0;  ///< of a sensor: how long it may be; 0: no sensor
    Time heard{};         ///< its last reading
    HealthState state = HealthState::kOk;
    Time due{};  ///< of its next report, while it is not well
  };
  std::map<std::string, Part> parts_;  ///< what the host watches
  Random waves_;
  double dive_noise_ = 0;

  Time now_{}, before_{};
  VehicleState state_before_;
  Time next_truth_{}, next_health_{};
  std::size_t waypoint_ = 0;
  std::vector<bool> near_;
  bool started_ = false;
  std::deque<SimulatedEvent> queue_;
};

}  // namespace isobath
