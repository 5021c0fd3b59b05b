#include <algorithm>
#include <isobath/mission/command/command_chain.hpp>

namespace isobath {

/// The newest one counts: an agent that starts anew begins to count anew.
std::uint64_t CommandChain::Named::number_of(std::uint32_t id) const {
  std::uint64_t newest = 0;
  for (const auto& [known, number] : known_) {
    if (known == id) newest = std::max(newest, number);
  }
  return newest;
}

std::optional<CommandLink> CommandChain::link(const Message& message, std::uint64_t number, Time now) {
  if (const auto* command = std::get_if<OperatorCommand>(&message)) {
    using Kind = OperatorCommand::Kind;
    if (command->kind != Kind::kBeat && command->kind != Kind::kHandOver) operator_ = number;
    return std::nullopt;
  }
  if (std::holds_alternative<MissionOrder>(message)) {
    order_ = mission_ = number;
    return CommandLink{CommandLevel::kMission, operator_};
  }
  if (std::holds_alternative<VisitOrder>(message)) {
    order_ = number;
    return CommandLink{CommandLevel::kGroup, mission_};
  }
  if (const auto* request = std::get_if<RouteRequest>(&message)) {
    requests_.note(request->id, number);
    return CommandLink{CommandLevel::kVehicle, order_};
  }
  if (std::holds_alternative<SonarOrder>(message)) return CommandLink{CommandLevel::kVehicle, order_};
  if (const auto* route = std::get_if<RoutePlanned>(&message)) {
    routes_.note(route->version, number);
    return CommandLink{CommandLevel::kMove, requests_.number_of(route->request)};
  }
  if (const auto* follow = std::get_if<FollowOrder>(&message)) {
    follows_.note(follow->version, number);
    follow_ = number;
    follow_version_ = follow->version;
    return CommandLink{CommandLevel::kMove, follow->waypoints.empty() ? order_ : routes_.number_of(follow->version)};
  }
  if (const auto* motion = std::get_if<MotionOrder>(&message)) {
    const std::uint64_t parent = follows_.number_of(motion->version);
    if (motion->version == follow_version_) {
      motion_ = number;
      motion_at_ = now;
    }
    return CommandLink{CommandLevel::kMove, parent};
  }
  if (std::holds_alternative<HelmOrder>(message)) {
    const bool by_motion = motion_at_ && motion_ > follow_ && now - *motion_at_ <= MotionOrder::kLasts;
    return CommandLink{CommandLevel::kPrimitive, by_motion ? motion_ : follow_};
  }
  if (std::holds_alternative<SafetyAction>(message)) return CommandLink{CommandLevel::kPrimitive, 0};
  return std::nullopt;
}

}  // namespace isobath
