#include <exception>
#include <isobath/mission/command/bus.hpp>
#include <utility>

namespace isobath {
namespace {

/// One name per type: a type without a name does not compile, and the order of Message does not matter.
constexpr const char* name(const Navigation*) { return "navigation"; }
constexpr const char* name(const RangeReading*) { return "range reading"; }
constexpr const char* name(const Health*) { return "health"; }
constexpr const char* name(const SonarHealthSample*) { return "sonar look"; }
constexpr const char* name(const SonarEchoes*) { return "sonar echoes"; }
constexpr const char* name(const Sweep*) { return "sweep"; }
constexpr const char* name(const ObstacleScan*) { return "obstacle scan"; }
constexpr const char* name(const ChartedHazards*) { return "charted hazards"; }
constexpr const char* name(const GroupHazards*) { return "group hazards"; }
constexpr const char* name(const GroupObstacles*) { return "group obstacles"; }
constexpr const char* name(const OperatorCommand*) { return "operator command"; }
constexpr const char* name(const MissionOrder*) { return "mission order"; }
constexpr const char* name(const VisitOrder*) { return "visit order"; }
constexpr const char* name(const PointMoved*) { return "point moved"; }
constexpr const char* name(const RouteRequest*) { return "route request"; }
constexpr const char* name(const RoutePlanned*) { return "route planned"; }
constexpr const char* name(const RouteRefused*) { return "route refused"; }
constexpr const char* name(const PointReport*) { return "point report"; }
constexpr const char* name(const MissionReport*) { return "mission report"; }
constexpr const char* name(const FollowOrder*) { return "follow order"; }
constexpr const char* name(const StillHazards*) { return "still hazards"; }
constexpr const char* name(const MotionOrder*) { return "motion order"; }
constexpr const char* name(const WaypointPassed*) { return "waypoint passed"; }
constexpr const char* name(const HelmOrder*) { return "helm order"; }
constexpr const char* name(const SafetyAction*) { return "safety action"; }
constexpr const char* name(const SafetyReport*) { return "safety report"; }
constexpr const char* name(const AgentLost*) { return "agent lost"; }
constexpr const char* name(const StatusReport*) { return "status report"; }
constexpr const char* name(const TaskCall*) { return "task call"; }
constexpr const char* name(const TaskBid*) { return "task bid"; }
constexpr const char* name(const TaskAward*) { return "task award"; }
constexpr const char* name(const TaskPlan*) { return "task plan"; }
constexpr const char* name(const Decision*) { return "decision"; }
constexpr const char* name(const WorldSnapshot*) { return "world"; }
constexpr const char* name(const LinkFrame*) { return "link frame"; }
constexpr const char* name(const LevelPlan*) { return "level plan"; }
constexpr const char* name(const SonarOrder*) { return "sonar order"; }
constexpr const char* name(const PlanStep*) { return "plan step"; }
constexpr const char* name(const PassageWait*) { return "passage wait"; }

template <std::size_t... I>
constexpr std::array<const char*, sizeof...(I)> all_names(std::index_sequence<I...>) {
  return {name(static_cast<const std::variant_alternative_t<I, Message>*>(nullptr))...};
}

std::string why_of(const std::exception_ptr& thrown) {
  try {
    std::rethrow_exception(thrown);
  } catch (const std::exception& e) {
    return e.what();
  } catch (...) {
    return "threw something that is not an exception";
  }
}

template <class Call>
Turn turn_of(const Call& call) {
  Outbox out;
  try {
    call(out);
  } catch (...) {
    return {{}, why_of(std::current_exception())};
  }
  return {std::move(out.said()), std::nullopt};
}

}  // namespace

const char* message_name(std::size_t type) {
  static constexpr auto kNames = all_names(std::make_index_sequence<kMessageTypes>());
  ISOBATH_ASSERT(type < kMessageTypes);
  return kNames.at(type);
}

std::map<std::string, std::uint64_t> Bus::sent_by(const std::string& sender) const {
  std::map<std::string, std::uint64_t> sent;
  const auto found = said_.find(sender);
  if (found == said_.end()) return sent;
  for (std::size_t type = 0; type < kMessageTypes; ++type) {
    if (found->second[type] > 0) sent[message_name(type)] = found->second[type];
  }
  return sent;
}

Envelope Bus::post(std::string sender, Message message, Time now) {
  if (auto* decision = std::get_if<Decision>(&message)) decision->number = ++decisions_;
  Envelope envelope{++number_, now, std::move(sender), std::move(message)};
  envelope.link = chain_.link(envelope.message, envelope.number, now);
  ++said_[envelope.sender].at(envelope.message.index());
  if (recorder_) {
    try {
      recorder_(envelope);
    } catch (...) {
      recorder_loss_ = why_of(std::current_exception());
      recorder_ = nullptr;
    }
  }
  return envelope;
}

std::optional<std::string> Bus::take_recorder_loss() { return std::exchange(recorder_loss_, std::nullopt); }

Turn deliver_in_turn(Agent& agent, const Message& message, Time now) {
  return turn_of([&](Outbox& out) { agent.on_message(message, now, out); });
}

Turn tick_in_turn(Agent& agent, Time now) {
  return turn_of([&](Outbox& out) { agent.tick(now, out); });
}

}  // namespace isobath
