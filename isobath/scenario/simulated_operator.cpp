#include <algorithm>
#include <isobath/scenario/simulated_operator.hpp>
#include <utility>

namespace isobath {

std::vector<Field> fields(OperatorOrder& o) {
  using Kind = OperatorCommand::Kind;
  return {Field::real("at_s", &o.at_s, {0, 1e7}, "s", "Time at which the operator gives the order."),
          Field::choice("command", &o.command,
                        {{"start", Kind::kStart},
                         {"hold", Kind::kHold},
                         {"resume", Kind::kResume},
                         {"abort", Kind::kAbort},
                         {"acknowledge", Kind::kAcknowledge}},
                        "The order to the vehicle.")};
}

SectionList operator_list(std::vector<OperatorOrder>& orders) {
  return {"operator", "An order of the operator, sent over the link.", [&orders](const Place& place) {
            OperatorOrder& order = orders.emplace_back();
            order.place = place;
            return fields(order);
          }};
}

SimulatedOperator::SimulatedOperator(std::vector<OperatorOrder> orders, std::shared_ptr<const MissionPlan> plan,
                                     std::uint64_t seed)
    : orders_(std::move(orders)), plan_(std::move(plan)), random_(seed) {
  std::stable_sort(orders_.begin(), orders_.end(),
                   [](const OperatorOrder& a, const OperatorOrder& b) { return a.at_s < b.at_s; });
}

void SimulatedOperator::order(OperatorCommand command) {
  if (command.kind == OperatorCommand::Kind::kStart) command.plan = plan_;
  console_.command(command);
}

bool SimulatedOperator::loses(const FaultSchedule& faults, Time now) {
  ++frames_;
  const FaultConfig* fault = faults.active("link", now);
  const bool lost = fault && (fault->kind == FaultKind::kOff || random_.uniform() < fault->amount);
  lost_ += lost ? 1 : 0;
  return lost;
}

std::vector<OperatorFrame> SimulatedOperator::due(const FaultSchedule& faults, Time now) {
  while (!orders_.empty() && orders_.front().at_s <= to_seconds(now)) {
    order({orders_.front().command});
    orders_.erase(orders_.begin());
  }
  std::vector<OperatorFrame> arrived;
  for (FrameBytes& bytes : console_.due(now)) {
    if (!loses(faults, now)) arrived.push_back({now, std::move(bytes)});
  }
  return arrived;
}

void SimulatedOperator::on_frames(const std::vector<FrameBytes>& frames, const FaultSchedule& faults, Time now) {
  for (const FrameBytes& bytes : frames) {
    if (loses(faults, now)) continue;
    if (auto status = console_.on_frame(bytes)) answers_.push_back({now, std::move(*status)});
  }
}

}  // namespace isobath
