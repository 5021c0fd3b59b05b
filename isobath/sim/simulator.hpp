// Simulator: runs a scene and gives a stream of events in time, with the ground truth beside them.
//
// There is one logical clock and no wall clock. The vehicle moves in steps of 20 ms (vehicle/plant.hpp). Navigation
// sensors and sonars fire at their own times between steps, with the interpolated pose. Faults act between the sensors
// and the output. The vehicle follows its way-points until it is commanded; each command takes effect with the next
// step (closed loop). The vehicle reports its health once a second. The host reports a failed part at once and then
// once a second, and reports its recovery once. Parts are: a depth, heading or attitude sensor or an altimeter (failed
// if it is silent for five of its periods, at least half a second), a thruster, the disk. All output follows from scene
// and seed, the same bytes on any number of threads (ledger S6-57). Throws Error, with the place in the scene's file,
// if the scene cannot start: a body inside the vehicle, a start below the bottom. One thread calls; sonars may use
// more.
#pragma once

#include <deque>
#include <isobath/sim/dead_reckoning.hpp>
#include <isobath/sim/faulty_channel.hpp>
#include <isobath/sim/hydrophones.hpp>
#include <isobath/sim/navigation_sensors.hpp>
#include <isobath/sim/scene.hpp>
#include <isobath/sim/simulated_sonar.hpp>
#include <isobath/sim/world.hpp>
#include <isobath/sonar/echo_truth.hpp>
#include <isobath/stereo/optics/camera_pair.hpp>
#include <isobath/vehicle/guidance.hpp>
#include <isobath/vehicle/health.hpp>
#include <isobath/vehicle/plant.hpp>
#include <isobath/vehicle/vehicle_state.hpp>
#include <map>
#include <optional>
#include <variant>

namespace isobath {

/// Output of the vehicle (the first six) and ground truth (the last two).
using SimulatedEvent =
    std::variant<Ping, RangeReading, Navigation, Health, PassiveBearing, CameraPair, EchoTruth, TrueMotion>;

struct SimulationConfig {
  int seed = -1;             ///< -1: the scene's seed
  double duration_s = 0;     ///< 0: the scene's duration
  std::string without = {};  ///< name of a sonar to switch off
};
std::vector<Field> fields(SimulationConfig& config);

/// The vehicle of a scene: that of its vehicle file, or a body of half a metre that turns instantly. Throws Error.
VehicleModel vehicle_model_of(const Scene& scene);

class Simulator {
 public:
  explicit Simulator(Scene scene, const SimulationConfig& config = {}, int threads = 1);
  ~Simulator();

  /// The next event in order of arrival; empty at the end of the run. Ground truth is delivered before the event that
  /// it describes.
  std::optional<SimulatedEvent> next();
  /// From the next step on the vehicle follows this set-point instead of its way-points.
  void command(const Setpoint& setpoint) { command_ = setpoint; }
  /// Applies the command to the first scanning head, if there is one, from its next ping on (S4-40). Throws Error for a
  /// command that it cannot follow.
  void command_scanning(const ScanCommand& scan);

  /// From now on a body of the scene, which has a path, moves straight from this place, at t_s of the run.
  void steer_body(std::size_t body, double t_s, const Eigen::Vector3d& p_W, const Eigen::Vector3d& v_W);
  /// The true state of the vehicle now.
  [[nodiscard]] const VehicleState& state() const { return plant_->state(); }
  /// Commands to the actuators (VehiclePlant::commands).
  [[nodiscard]] ActuatorVector actuator_commands() const { return plant_->commands(); }
  [[nodiscard]] const Scene& scene() const { return scene_; }
  [[nodiscard]] const World& world() const { return *world_; }
  [[nodiscard]] double now_s() const { return to_seconds(now_); }
  [[nodiscard]] double duration_s() const { return duration_s_; }
  [[nodiscard]] std::uint64_t seed() const { return seed_; }
  /// Half the diagonal of the hull in plan, m: the radius that must stay clear.
  [[nodiscard]] double hull_radius() const;
  [[nodiscard]] const VehicleModel& vehicle() const { return model_; }
  /// The faults, also for the parts of the vehicle that are not simulated here: agents, planner, link.
  [[nodiscard]] const FaultSchedule& faults() const { return faults_; }

 private:
  struct Device;
  struct Cameras;
  void check_start() const;
  void step();
  [[nodiscard]] Setpoint wanted(double dt);
  void move(double dt);
  void navigate();
  void ping_all();
  void listen();
  void take_pictures();
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
  std::vector<Cameras> cameras_;
  int threads_;
  std::vector<std::pair<std::string, FaultyChannel<NavReading>>> reading_channels_;
  FaultyChannel<Navigation> fix_channel_;
  std::optional<Hydrophones> hydrophones_;
  Time next_bearings_{};
  std::uint64_t bearings_ = 0;  ///< sets of bearings so far
  struct Part {
    double silent_s = 0;  ///< a sensor's longest silence; 0: no sensor
    Time heard{};         ///< time of the last reading
    HealthState state = HealthState::kOk;
    Time due{};  ///< time of its next report while it has failed
  };
  std::map<std::string, Part> parts_;  ///< parts that the host monitors
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
