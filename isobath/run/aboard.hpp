// Aboard: the run's end of a real vehicle: who may command it, what it is told, and how long that takes.
//
// The holder of the vehicle's controls is the operator. While the front seat leaves the vehicle to Isobath (Authority),
// the mission starts, or goes on after a hold; when it does not, the mission holds and no set-point goes out. Orders of
// the page are sent as those of the operator. While the front seat is silent, no heartbeat of an operator is sent,
// which raises the fault "operator link lost".
//
// To the front seat (front_seat.hpp) go the set-point of the helm after each event, the obstacles of the last scan four
// times a second, and each decision of the agents as a text, at most one a second. A set-point also goes out, without
// waiting for the next event of a device, when a ping has been mapped and when the helm or the safety officer orders.
//
// The latency of a ping is the time from its last byte until the first set-point that goes out after it has been
// mapped; a ping is mapped when its pose is known, which may be with the fix after it. on_ping, on_scan and on_mapped
// belong to the mapping thread, on_message to that of any agent, all else to the source thread.
#pragma once

#include <chrono>
#include <isobath/links/vehicle_links.hpp>
#include <isobath/mission/messages/operator_link.hpp>
#include <isobath/onboard/helm.hpp>
#include <isobath/onboard/latency_histogram.hpp>
#include <isobath/onboard/onboard_observer.hpp>
#include <isobath/report/run_outcome.hpp>
#include <map>
#include <mutex>
#include <optional>

namespace isobath {

struct AboardOptions {
  bool commands = true;            ///< false: a dry run, which hears and decides and sends no set-point
  bool ends_with_mission = false;  ///< false: the vehicle goes on mapping and holding
};

class Aboard final : public OnboardObserver {
 public:
  /// `links` must outlive it. `vehicle`: the limits of the vehicle.
  Aboard(VehicleLinks& links, const VehicleParameters& vehicle, const AboardOptions& options = {})
      : links_(links), vehicle_(vehicle), options_(options) {}

  [[nodiscard]] VehicleLinks& links() { return links_; }
  [[nodiscard]] const VehicleParameters& vehicle() const { return vehicle_; }
  [[nodiscard]] const AboardOptions& options() const { return options_; }
  /// The plan that the operator starts.
  void set_plan(const MissionPlan& plan) { plan_ = std::make_shared<const MissionPlan>(plan); }

  void on_event(const Event& event) override;
  void on_ping(const PosedPing& ping) override;
  void on_scan(const ScanResult& scan) override;
  void on_mapped(Time time, const Pipeline& pipeline, const DepthModel& depths, const VoxelModel& voxels) override;

  void on_message(const Envelope& envelope);

  /// An order of the page. A new mission takes the place of the one that waits to start; while the autopilot does not
  /// give the controls away, the vehicle holds.
  void order(OperatorCommand command);
  /// Gives the operator's frames to the run, and takes the helm's answers.
  void speak_for_operator(Helm& helm, Time now);
  void steer(const Setpoint& setpoint, Time answers);
  void scan(const ScanCommand& command) { links_.scan(command); }
  void tell(const Helm& helm, Time now);
  [[nodiscard]] AboardOutcome outcome() const;

 private:
  void steer_at_once();
  void show_surroundings(const Navigation& fix, Time now);

  VehicleLinks& links_;
  const VehicleParameters vehicle_;
  const AboardOptions options_;
  std::shared_ptr<const MissionPlan> plan_;
  OperatorConsole console_;
  bool started_ = false, ours_ = false;
  std::optional<Navigation> fix_;
  Time ring_told_{}, text_told_{};
  std::size_t decisions_told_ = 0;

  mutable std::mutex mutex_;       ///< guards all below
  std::map<Time, Time> arrivals_;  ///< of pings that are not mapped yet
  std::optional<Time> placed_;     ///< arrival of the newest ping whose pose is known and that is being mapped
  std::optional<Time> mapped_;     ///< arrival of the newest ping that is mapped and not yet answered
  Surroundings around_;
  LatencyHistogram latency_;
};

}  // namespace isobath
