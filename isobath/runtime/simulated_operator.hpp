// SimulatedOperator: the operator of a simulated vehicle: commands at their times, beats between them, and an ear for
// what the vehicle answers, over the real frames (operator_link.hpp; Ganesan 2015, 5.1; ledger S6-40).
//
//   [[operator]]
//   at_s = 60
//   command = "hold"
//
// A fault of "link" keeps frames away both ways: all of them (off), or a share (intermittent). What is lost is sent
// again until it is acknowledged. A function of the scenario and its seed.
#pragma once

#include <isobath/base/random.hpp>
#include <isobath/mission/operator_link.hpp>
#include <isobath/sim/faults.hpp>
#include <isobath/vehicle/operator_frame.hpp>

namespace isobath {

struct OperatorOrder {
  Place place;  ///< in the file it comes from
  double at_s = 0;
  OperatorCommand::Kind command = OperatorCommand::Kind::kStart;
};
std::vector<Field> fields(OperatorOrder& order);
/// [[operator]]: appends to `orders`, which must outlive the schema.
SectionList operator_list(std::vector<OperatorOrder>& orders);

struct OperatorAnswer {
  Time time;
  StatusReport status;
};

class SimulatedOperator {
 public:
  /// `plan`: what an order to start is about.
  SimulatedOperator(std::vector<OperatorOrder> orders, std::shared_ptr<const MissionPlan> plan, std::uint64_t seed);

  /// One more order, to be given with the next frames.
  void order(OperatorCommand::Kind command);
  /// Frames that reach the vehicle now.
  std::vector<OperatorFrame> due(const FaultSchedule& faults, Time now);
  /// Frames that the vehicle sends now.
  void hear(const std::vector<FrameBytes>& frames, const FaultSchedule& faults, Time now);

  /// What the operator knows of the vehicle: each status once, as it arrived.
  [[nodiscard]] const std::vector<OperatorAnswer>& answers() const { return answers_; }
  [[nodiscard]] bool all_acknowledged() const { return orders_.empty() && console_.all_acknowledged(); }
  [[nodiscard]] std::uint64_t frames() const { return frames_; }  ///< sent, both ways
  [[nodiscard]] std::uint64_t lost() const { return lost_; }      ///< of them

 private:
  bool loses(const FaultSchedule& faults, Time now);

  std::vector<OperatorOrder> orders_;  ///< still to be given, in the order of time
  std::shared_ptr<const MissionPlan> plan_;
  OperatorConsole console_;
  Random random_;
  std::vector<OperatorAnswer> answers_;
  std::uint64_t frames_ = 0, lost_ = 0;
};

}  // namespace isobath
