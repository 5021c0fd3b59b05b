// Captain: starts missions, ends them when anything is abnormal, and takes the decisions that no lower agent may take
// (Ganesan 2015, 5.1, 7.2.3; ledger S6-34, S6-41, S6-56, S6-65).
//
// Receives OperatorCommand, SafetyReport, AgentLost, RouteRefused, PointReport, VisitOrder, Navigation, MissionReport,
// TaskBid. Sends MissionOrder, PointMoved, TaskCall, TaskAward, StatusReport, LevelPlan, Decision. It sends its
// responses to a message in the same turn.
//
// The Captain starts a mission if the plan is sound (check_mission) and no fault is active that would end it. A
// SafetyReport that asks for it, or the loss of an agent without which the vehicle cannot be controlled, ends the
// mission at once. A later reason may still change holding or returning into surfacing, never the other way round. If a
// mission point is blocked, the Captain moves it to the safe place that the Navigator found, provided that this is no
// farther from the position in the mission file than the file allows.
//
// The operator may replace the mission, under way too. The Captain checks the new one like the first; a mission that it
// refuses changes nothing. The start of the first mission stays the place to return to. The operator's order to return
// is a mission with that place as its only point. A mission that a group shares is not replaced.
//
// Under way the Captain predicts, at the interval of the timing table, how long the rest of the mission takes (the way
// through the points that are left, and the time at them). Where the mission is to end at its start and has a maximum
// duration, the vehicle turns back as soon as the way to the start takes the time that is left.
//
// Where no vehicle of a group finds a way to what is left of the area, the mission ends as after a dropped point
// (S2-17).
//
// A task that the Executive Officer asks for is offered to all back-seat drivers. After `bid_s` the highest suitability
// wins; of equal bids the first name wins, in whatever order they arrived. If the winner is lost, the next best bid
// wins. An award without a driver means that no driver has bid.
#pragma once

#include <isobath/mission/messages/agent.hpp>
#include <isobath/mission/messages/plan_clock.hpp>
#include <isobath/mission/plan/timing_table.hpp>
#include <map>
#include <set>

namespace isobath {

struct CaptainConfig {
  double bid_s = 1;
};

std::vector<Field> fields(CaptainConfig& config);

class Captain final : public Agent {
 public:
  explicit Captain(const CaptainConfig& config, const TimingTable& timing = {})
      : config_(config), plans_(CommandLevel::kMission, timing.of(CommandLevel::kMission).replan_s) {}

  void on_message(const Message& message, Time now, Outbox& out) override;
  void tick(Time now, Outbox& out) override;

 private:
  void on(const OperatorCommand& command, Outbox& out);
  void start(const OperatorCommand& command, Outbox& out);
  void replace(const OperatorCommand& command, Outbox& out);
  void send_home(const OperatorCommand& command, Outbox& out);
  void begin(std::shared_ptr<const MissionPlan> plan);
  [[nodiscard]] std::string problem_of(const MissionPlan* plan) const;
  void on(const SafetyReport& report, Outbox& out);
  void on(const AgentLost& lost, Outbox& out);
  void on(const RouteRefused& refused, Outbox& out);
  void on(const PointReport& report, Outbox& out);
  void on(const MissionReport& report, Outbox& out);
  void on(const TaskBid& bid);
  void call(const std::string& task, const MissionPoint& at, Outbox& out);
  void award(Outbox& out);
  /// `changed`: by an order of the Commodore.
  void plan(bool changed, Outbox& out);
  void turn_back_in_time(Outbox& out);
  void take_order(const VisitOrder& order);
  [[nodiscard]] double way_home_s() const;
  void abort(MissionEnd end, const std::string& why, Outbox& out);
  void order(MissionOrder::Kind kind, const char* what, const std::string& why, Outbox& out);
  void decide(const char* what, std::string reason, Outbox& out) const;
  void tell(const std::string& text, Outbox& out) const;
  [[nodiscard]] bool under_way() const { return phase_ == MissionPhase::kUnderWay || phase_ == MissionPhase::kHolding; }

  CaptainConfig config_;
  std::shared_ptr<const MissionPlan> plan_;
  MissionPhase phase_ = MissionPhase::kWaiting;
  std::optional<MissionEnd> aborted_;  ///< how the mission was last ended
  std::set<std::string> faults_;       ///< active faults that would end a mission
  std::size_t point_ = 0;
  PlanClock plans_;
  std::vector<std::size_t> left_;  ///< points that are to be visited, in order
  std::optional<Navigation> here_;
  Eigen::Vector2d home_W_ = Eigen::Vector2d::Zero();  ///< where the mission started
  Time now_;
  Time started_;

  TaskCall call_;
  std::uint32_t calls_ = 0;
  std::map<std::string, double> bids_;  ///< by driver
  std::optional<Time> bids_until_;
  std::string awarded_;
};

}  // namespace isobath
