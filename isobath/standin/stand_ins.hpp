// StandIns: a simulated vehicle whose devices and autopilot speak their own bytes over sockets, in the time of the
// clock: what `isobath aboard` joins where no vehicle is. A scene gives the vehicle, its sonars and its world; the
// autopilot holds the scene's mission, as if a ground station had planned it; a MOOSDB holds none.
//
//   StandIns stand_ins(scenario, request);
//   while (stand_ins.step()) {}
//
// Throws Error if the scene has no origin on the globe or no mission, or a server cannot listen. One thread calls.
#pragma once

#include <isobath/links/front_seat.hpp>
#include <isobath/scenario/ground_truth_trajectory.hpp>
#include <isobath/scenario/scenario.hpp>
#include <isobath/standin/autopilot_stand_in.hpp>
#include <isobath/standin/device_stand_ins.hpp>
#include <isobath/standin/moos_stand_in.hpp>
#include <memory>
#include <optional>
#include <vector>

namespace isobath {

/// The plan of a scenario as the items of MAVLink missions.
AutopilotPlan autopilot_plan(const MissionPlan& plan, const GeoOrigin& origin);

struct StandInRequest {
  SimulationConfig simulation;
  FrontSeatKind front_seat = FrontSeatKind::kArduSub;
  std::string autopilot;  ///< link_address.hpp; empty: udp:127.0.0.1:14550, or tcp-server:9000 of a MOOSDB
  struct Device {
    DeviceKind kind = DeviceKind::kPing360;
    std::string link;
  };
  std::vector<Device> devices;
  /// Where Oculus stand-ins broadcast their status.
  std::string oculus_status = "udp:127.255.255.255:52102";
  std::string ping360_discovery;  ///< where a Ping360 stand-in answers those that look for it; empty: nowhere
  bool stays = false;             ///< whether it goes on after the companion has fallen silent
  double speed = 1;               ///< times real time
  double guided_after_s = 2;
  std::vector<PilotTurn> turns;
  std::optional<MavlinkKey> key = {};  ///< the autopilot signs its frames, and hears no others
  UnplugConfig unplug;                 ///< its speed is that of the request
};

class StandIns {
 public:
  StandIns(const Scenario& scenario, const StandInRequest& request);
  StandIns(const StandIns&) = delete;
  StandIns& operator=(const StandIns&) = delete;
  ~StandIns() { hub_.stop(); }

  /// Simulates up to the next event and waits for its time. Returns false at the end of the scene's time, or 5 s after
  /// the companion has fallen silent, unless it stays.
  bool step();
  [[nodiscard]] const TrackTruth& truth() const { return truth_.truth(); }
  /// Where the autopilot listens, if its link is a server.
  [[nodiscard]] int autopilot_port() const { return autopilot_->port(); }
  [[nodiscard]] const std::string& autopilot_link() const { return request_.autopilot; }
  [[nodiscard]] AutopilotCounts autopilot() const { return autopilot_->counts(); }
  /// What the simulated vehicle is told to do.
  [[nodiscard]] Setpoint setpoint() const { return autopilot_->setpoint(0); }
  [[nodiscard]] const std::vector<std::unique_ptr<DeviceStandIn>>& devices() const { return devices_; }
  [[nodiscard]] double now_s() const { return source_.simulator().now_s(); }

 private:
  void announce(const StandInRequest::Device& device);

  const StandInRequest request_;
  mutable SimulatedSource source_;
  GroundTruthTrajectory truth_;
  LinkHub hub_;
  std::unique_ptr<FrontSeatStandIn> autopilot_;
  std::vector<std::unique_ptr<DeviceStandIn>> devices_;
  std::vector<std::unique_ptr<OculusBeacon>> beacons_;
  std::vector<std::unique_ptr<Ping360Finder>> finders_;
  std::chrono::steady_clock::time_point began_;
  double steered_s_ = 0;
};

}  // namespace isobath
