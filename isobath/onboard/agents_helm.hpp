// AgentsHelm: turns events and the results of the pipeline into messages for the mission's agents (Ganesan 2015, 5.1;
// ledger S6-42). SerialHelm runs the agents in one thread, ThreadedHelm each agent in its own.
//
// The chart is the first message; the depth map that grows from it follows once a second. Navigation, ranges, health,
// frames of the operator's link and the quality of each ping are sent on arrival; echoes and sweeps are sent as soon as
// the pipeline has placed them. The start command follows the first sweep that could be decided or the first depth map
// with readings ahead, or kLongestWarmUp after the first fix: the mission does not wait for a sonar that never works;
// the Safety Officer handles that. A mission that waits for the operator starts only by an operator's frame. Until the
// first such frame, the person who started the program counts as the operator: AgentsHelm sends a heartbeat each
// second, except while a health report says that the link is lost.
//
// Times are those of the mission's clock (mission_clock.hpp), which every event advances. A health report of
// "agent.NAME" is not a message but a fault of this computer, injected by a simulator or found in its log (kHangs of
// health.hpp). Sweeps in which at most half of the pings could be decided are dropped. Non-finite events are
// discarded; the watchdog reports the silent sensor.
//
// A function of the events. Any thread may call `on_*`.
#pragma once

#include <isobath/onboard/helm.hpp>
#include <isobath/onboard/mission_clock.hpp>
#include <isobath/sonar/sensor_table.hpp>
#include <memory>
#include <mutex>
#include <optional>

namespace isobath {

class AgentsHelm : public Helm {
 public:
  static constexpr Duration kLongestWarmUp = std::chrono::seconds(20);

  /// `echo_contrast`: least contrast of the echoes that the Safety Officer gets (sonar_health_sample.hpp).
  AgentsHelm(std::shared_ptr<const MissionPlan> plan, WorldSnapshot chart, double echo_contrast);

  void on_event(const Event& event) override;
  void on_ping(const PosedPing& ping) override;
  void on_scan(const ScanResult& scan) override;
  void on_jump(const Eigen::Vector3d& by_W) override;
  void on_world(const WorldSnapshot& world) override;
  void on_decision(const Decision& decision) override;

  [[nodiscard]] std::vector<AgentReport> crew() const override { return executor_->crew(); }

  [[nodiscard]] const MissionPlan& plan() const { return *plan_; }

 protected:
  /// To be called by the constructors of the classes below, which own the executor.
  void steer_by(AgentExecutor& executor) { executor_ = &executor; }
  /// On the mission's clock. Not while another thread calls `on_*`.
  [[nodiscard]] Time now() const { return clock_.now(); }

 private:
  /// The mission's clock has advanced to this time.
  virtual void moved(Time /*now*/) {}

  void on_fix(const Navigation& fix);
  void on_range_arrival(const RangeReading& range);
  void on_ping_arrival(const Ping& ping);
  void on_health(const Health& health);
  void on_frame(const OperatorFrame& frame);
  void tell_chart();
  void beat();
  void fail(const std::string& agent, bool hangs);
  [[nodiscard]] std::string name_of(const Ping& ping);

  AgentExecutor* executor_ = nullptr;
  std::mutex mutex_;
  std::shared_ptr<const MissionPlan> plan_;
  WorldSnapshot world_;  ///< the chart, until the run has maps of its own
  bool chart_told_ = false;
  double echo_contrast_;
  MissionClock clock_;
  SensorTable sonars_;
  bool begun_ = false, looked_ = false;
  std::optional<Time> first_fix_;
  bool link_ = true;
  bool operator_heard_ = false;
  std::optional<Time> next_beat_;
  double sigma_m_ = 0;                                ///< of the last fix
  Eigen::Vector2d jumped_ = Eigen::Vector2d::Zero();  ///< sum of all jumps of the position, m
  int heard_ = 0, decided_ = 0;  ///< pings of the current sweep, and those of them that could be decided
};

/// What a run keeps of its agents' messages.
struct MissionLog {
  MissionReport report;  ///< the last
  std::vector<Decision> decisions;
  std::vector<FrameBytes> frames;        ///< for the operator, until they are fetched
  std::vector<FrameBytes> group_frames;  ///< likewise for the other vehicles
  std::optional<SonarOrder> sonar;       ///< the last, until it is fetched
  bool acknowledged = false;             ///< the operator has acknowledged the alarms since this was last fetched

  void note(const Envelope& envelope);
};

}  // namespace isobath
