// CrewHelm: a crew of agents at the helm: events, and what the pipeline makes of them, become messages (Ganesan 2015,
// 5.1; ledger S6-42). MissionHelm runs the crew in one thread, LiveHelm each agent in its own.
//
// The chart is told first of all. Navigation, ranges, health, frames of the operator's link and what a ping says of its
// sonar are told as they come, its echoes and each sweep as soon as the pipeline has placed them. The order to start
// follows the first sweep that could be decided, or kLongestWarmUp after the first fix: a sonar that never hears is for
// the Safety Officer, not to be waited for. A mission that waits for the operator starts by his frame alone. As long as
// no operator has been heard, whoever started the program counts as one: a beat is given each second, but while a
// health report calls the link lost. Times are those of the mission's clock (mission_clock.hpp), which every event
// moves. A health report of "agent.NAME" is no message but a fault of this computer, injected by a simulator or found
// in its log (kHangs of scenario.hpp).
//
// A sweep most of whose pings could not be decided has looked at nothing: it is told to nobody.
//
// Events whose numbers are not finite are for nobody: their sender falls silent. A function of the events. Any thread
// may call hear and on_*.
#pragma once

#include <isobath/runtime/helm.hpp>
#include <isobath/runtime/mission_clock.hpp>
#include <isobath/sonar/sensor_table.hpp>
#include <memory>
#include <mutex>
#include <optional>

namespace isobath {

class CrewHelm : public Helm {
 public:
  static constexpr Duration kLongestWarmUp = std::chrono::seconds(20);

  /// `echo_contrast`: of the echoes that the Safety Officer is shown (sonar_look.hpp).
  CrewHelm(std::shared_ptr<const MissionPlan> plan, ChartUpdate chart, double echo_contrast);

  void hear(const Event& event) override;
  void on_ping(const PosedPing& ping) override;
  void on_scan(const ScanResult& scan) override;
  void on_space(Time time, const std::shared_ptr<const SpaceGrid>& space) override;

  [[nodiscard]] const MissionPlan& plan() const { return *plan_; }

 protected:
  /// On the mission's clock. Not while anything else is heard.
  [[nodiscard]] Time now() const { return clock_.now(); }

 private:
  /// The mission's clock has come to this time.
  virtual void moved(Time /*now*/) {}
  /// For all agents to hear.
  virtual void say(Message message, Time now) = 0;
  /// An agent dies, or hangs.
  virtual void fail(const std::string& agent, bool hangs) = 0;

  void hear_fix(const Navigation& fix);
  void hear_range(const RangeReading& range);
  void hear_ping(const Ping& ping);
  void hear_health(const Health& health);
  void hear_frame(const OperatorFrame& frame);
  void tell_chart();
  void beat();
  [[nodiscard]] std::string name_of(const Ping& ping);

  std::mutex mutex_;
  std::shared_ptr<const MissionPlan> plan_;
  std::optional<ChartUpdate> chart_;  ///< until it is told
  double echo_contrast_;
  MissionClock clock_;
  SensorTable sonars_;
  bool begun_ = false, looked_ = false;
  std::optional<Time> first_fix_;
  bool link_ = true;
  bool operator_heard_ = false;
  std::optional<Time> next_beat_;
  double sigma_m_ = 0;           ///< of the last fix
  int heard_ = 0, decided_ = 0;  ///< pings of the sweep under way, and those in which echoes could be told from noise
};

/// What is kept of all that a crew says.
struct Logbook {
  MissionReport report;  ///< the last
  std::vector<Decision> decisions;
  std::vector<FrameBytes> frames;  ///< for the operator, until they are fetched

  void note(const Envelope& envelope);
};

/// An injected fault of the computer (kHangs of scenario.hpp); none where the crew has no such seat.
template <class AnyCrew>
void inject_failure(AnyCrew& crew, const std::string& agent, bool hangs) {
  if (!crew.has(agent)) return;
  if (hangs) {
    crew.hang(agent);
  } else {
    crew.kill(agent);
  }
}

}  // namespace isobath
