#include <algorithm>
#include <fmt/format.h>
#include <isobath/mission/command/executor.hpp>
#include <set>
#include <utility>

namespace isobath {

const char* to_text(AgentLevel level) {
  switch (level) {
    case AgentLevel::kSupervisory: return "supervisory";
    case AgentLevel::kMission: return "mission";
    case AgentLevel::kVehicle: return "vehicle";
  }
  return "";
}

std::vector<Field> fields(ExecutorConfig& c) {
  std::vector<Field> all = {
      Field::integer("missed_ticks", &c.missed_ticks, {1, 600}, "1",
                     "An agent that misses this many ticks (ten a second) in a row is lost."),
      Field::integer("max_messages", &c.max_messages, {1, 100000}, "1",
                     "Maximum number of messages of an agent between two ticks; further ones are dropped.")
          .was("most_said"),
      Field::integer("max_ticks", &c.max_ticks, {1, 100000}, "1",
                     "Maximum number of ticks that are made up for when the clock jumps ahead.")
          .was("most_ticks"),
      Field::integer(
          "mailbox", &c.mailbox, {16, 1000000}, "1",
          "Maximum number of messages that wait for an agent in a thread of its own; the oldest are dropped."),
  };
  for (Field& f : fields(c.arbiter)) all.push_back(std::move(f));
  return all;
}

void check_slots(const std::vector<AgentSlot>& slots, const ExecutorConfig& config) {
  std::set<std::string> names = {"", kFromOutside, kSupervisor, kCommandArbiter, kRecorder};
  for (const AgentSlot& slot : slots) {
    if (!slot.agent) throw Error("the slot '" + slot.name + "' has no agent");
    if (!names.insert(slot.name).second) {
      throw Error("the name of an agent is empty or taken: '" + slot.name + "'", {}, "a unique name");
    }
  }
  const std::string& safety_officer = config.arbiter.safety_officer;
  const bool filled =
      std::any_of(slots.begin(), slots.end(), [&](const AgentSlot& s) { return s.name == safety_officer; });
  if (!filled && !safety_officer.empty()) {
    throw Error("no agent has the name of the safety officer, '" + safety_officer + "'",
                {{}, {}, {}, {}, "safety_officer"}, "the name of an agent, or empty",
                "without a safety officer, nothing keeps the vehicle off obstacles that the mission overlooks");
  }
}

Executor::Executor(std::vector<AgentSlot> slots, const VehicleParameters& vehicle, const ExecutorConfig& config,
                   Recorder recorder)
    : config_(config), bus_(std::move(recorder)), arbiter_(config.arbiter, vehicle) {
  check_slots(slots, config);
  for (AgentSlot& slot : slots) {
    Member member;
    member.slot = std::move(slot);
    members_.push_back(std::move(member));
  }
}

bool Executor::on_message(Message sensed, Time now) {
  if (!set_clock(now)) return false;
  post(kFromOutside, std::move(sensed));
  settle();
  return true;
}

bool Executor::advance(Time now) {
  if (!set_clock(now)) return false;
  settle();
  return true;
}

Setpoint Executor::helm(Time now) {
  advance(now);
  return setpoint_;
}

void Executor::hang(std::string_view name) { member(name).hanging = true; }
void Executor::kill(std::string_view name) { member(name).dying = true; }

std::vector<AgentReport> Executor::crew() const {
  std::vector<AgentReport> crew;
  for (const Member& m : members_) crew.push_back({m.slot.name, m.slot.level, bus_.sent_by(m.slot.name)});
  return crew;
}

bool Executor::has(std::string_view name) const {
  return std::any_of(members_.begin(), members_.end(), [&](const Member& m) { return m.slot.name == name; });
}

bool Executor::lost(std::string_view name) const {
  return std::any_of(members_.begin(), members_.end(), [&](const Member& m) { return m.lost && m.slot.name == name; });
}

Executor::Member& Executor::member(std::string_view name) {
  const auto found =
      std::find_if(members_.begin(), members_.end(), [&](const Member& m) { return m.slot.name == name; });
  ISOBATH_ASSERT(found != members_.end());
  return *found;
}

bool Executor::set_clock(Time now) {
  if (!start_) {
    start_ = now_ = now;
    next_tick_ = now + kTick;
    return true;
  }
  if (now < now_) {
    ++counts_.refused;
    if (!std::exchange(back_, true)) {
      decide("refuse time", fmt::format("the clock went back by {:.3f} s", to_seconds(now_ - now)));
      settle();
    }
    return false;
  }
  back_ = false;
  const auto due = now < next_tick_ ? 0 : (now - next_tick_) / kTick + 1;
  if (due > config_.max_ticks) {
    const auto skipped = due - config_.max_ticks;
    counts_.skipped_ticks += static_cast<std::uint64_t>(skipped);
    decide("skip ticks",
           fmt::format("the clock jumped ahead by {:.3f} s: {} ticks were skipped", to_seconds(now - now_), skipped));
    next_tick_ += skipped * kTick;
  }
  for (; next_tick_ <= now; next_tick_ += kTick) {
    now_ = next_tick_;
    tick();
  }
  now_ = now;
  return true;
}

void Executor::tick() {
  ++counts_.ticks;
  for (Member& m : members_) {
    m.said = 0;
    if (m.lost) continue;
    if (m.hanging) {
      if (++m.missed >= config_.missed_ticks) {
        lose(m, true, fmt::format("no answer for {:.1f} s", to_seconds(m.missed * kTick)));
      }
      continue;
    }
    end_turn(m, m.dying ? Turn{{}, "killed"} : tick_in_turn(*m.slot.agent, now_));
  }
  settle();
}

void Executor::settle() {
  do {
    drain();
    setpoint_ = arbiter_.steer(now_);
    counts_.limited = arbiter_.limited();
    if (auto change = arbiter_.take_change()) post(kCommandArbiter, std::move(*change));
    if (auto why = bus_.take_recorder_loss()) post(kSupervisor, AgentLost{kRecorder, false, std::move(*why)});
  } while (!queue_.empty());
}

void Executor::drain() {
  while (!queue_.empty()) {
    const Envelope envelope = std::move(queue_.front());
    queue_.pop_front();
    for (Member& m : members_) {
      if (m.lost || m.hanging) continue;
      end_turn(m, m.dying ? Turn{{}, "killed"} : deliver_in_turn(*m.slot.agent, envelope.message, now_));
    }
  }
}

void Executor::end_turn(Member& m, Turn turn) {
  if (turn.died) return lose(m, false, *turn.died);
  for (Message& message : turn.said) {
    if (m.said == config_.max_messages) {
      decide("cut",
             fmt::format("the {} sent more than {} messages between two ticks", m.slot.name, config_.max_messages));
    }
    if (m.said++ < config_.max_messages) {
      post(m.slot.name, std::move(message));
    } else {
      ++counts_.cut;
    }
  }
}

void Executor::lose(Member& m, bool hung, const std::string& why) {
  m.lost = true;
  ++counts_.lost;
  post(kSupervisor, AgentLost{m.slot.name, hung, why});
}

void Executor::post(const std::string& sender, Message message) {
  queue_.push_back(bus_.post(sender, std::move(message), now_));
  arbiter_.on_message(queue_.back().message, now_, queue_.back().number);
}

void Executor::decide(const char* what, std::string reason) {
  post(kSupervisor, Decision{now_, kSupervisor, what, std::move(reason)});
}

}  // namespace isobath
