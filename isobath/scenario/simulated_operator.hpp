// SimulatedOperator: the operator of a simulated vehicle. It sends commands at their times and heartbeats between them,
// and receives the answers of the vehicle, in the frames of the real link (operator_link.hpp; Ganesan 2015, 5.1; ledger
// S6-40).
//
//   [[operator]]
//   at_s = 60
//   command = "hold"
//
// A fault of "link" drops frames both ways: all of them (off), or a share (intermittent). Lost frames are sent again
// until they are acknowledged. The frames are a function of the scenario and its seed.
#pragma once

#include <isobath/base/random.hpp>
#include <isobath/mission/messages/operator_link.hpp>
#include <isobath/sim/faults.hpp>
#include <isobath/vehicle/operator_frame.hpp>

namespace isobath {

struct OperatorOrder {
  Place place;  ///< in the scenario file
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
  /// `plan`: the plan that a start order starts.
  SimulatedOperator(std::vector<OperatorOrder> orders, std::shared_ptr<const MissionPlan> plan, std::uint64_t seed);

  /// Adds an order; the next frames carry it. A start starts the operator's own plan.
  void order(OperatorCommand command);
  /// Returns the frames that reach the vehicle now.
  std::vector<OperatorFrame> due(const FaultSchedule& faults, Time now);
  /// Takes the frames that the vehicle sends now.
  void on_frames(const std::vector<FrameBytes>& frames, const FaultSchedule& faults, Time now);

  /// The status reports that the operator has received, each once, in the order of arrival.
  [[nodiscard]] const std::vector<OperatorAnswer>& answers() const { return answers_; }
  [[nodiscard]] bool all_acknowledged() const { return orders_.empty() && console_.all_acknowledged(); }
  [[nodiscard]] std::uint64_t frames() const { return frames_; }  ///< frames sent, both ways
  [[nodiscard]] std::uint64_t lost() const { return lost_; }      ///< frames lost, both ways

 private:
  bool loses(const FaultSchedule& faults, Time now);

  std::vector<OperatorOrder> orders_;  ///< not given yet, in the order of time
  std::shared_ptr<const MissionPlan> plan_;
  OperatorConsole console_;
  Random random_;
  std::vector<OperatorAnswer> answers_;
  std::uint64_t frames_ = 0, lost_ = 0;
};

}  // namespace isobath
