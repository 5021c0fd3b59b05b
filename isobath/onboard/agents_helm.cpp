#include <algorithm>
#include <bit>
#include <cmath>
#include <fmt/format.h>
#include <isobath/mission/messages/group_words.hpp>
#include <isobath/mission/safety/sonar_health_sample.hpp>
#include <isobath/onboard/agents_helm.hpp>
#include <utility>

namespace isobath {
namespace {

constexpr Duration kBeatInterval = std::chrono::seconds(1);
constexpr std::string_view kAgent = "agent.";

bool finite_fix(const Navigation& fix) {
  return fix.X_WB.is_finite() && (!fix.v_WB || fix.v_WB->allFinite()) &&
         (!fix.covariance || fix.covariance->allFinite());
}

}  // namespace

void MissionLog::note(const Envelope& envelope) {
  if (const auto* decision = std::get_if<Decision>(&envelope.message)) decisions.push_back(*decision);
  if (const auto* said = std::get_if<MissionReport>(&envelope.message)) report = *said;
  if (const auto* point = std::get_if<PointReport>(&envelope.message)) report.update(*point);
  if (const auto* order = std::get_if<SonarOrder>(&envelope.message)) sonar = *order;
  const auto* command = std::get_if<OperatorCommand>(&envelope.message);
  if (command && command->kind == OperatorCommand::Kind::kAcknowledge) acknowledged = true;
  const auto* frame = std::get_if<LinkFrame>(&envelope.message);
  if (frame && frame->way == LinkFrame::Way::kToOperator) frames.push_back(frame->bytes);
  if (frame && frame->way == LinkFrame::Way::kToGroup) group_frames.push_back(frame->bytes);
}

namespace {

/// Whether a swath shows what stands in the water, as a 3-D sonar or a pair of cameras does; an echo sounder shows the
/// bottom.
bool looks_around(const Swath& swath) {
  const auto in_water = [](const Sounding& s) { return s.kind == Sounding::Kind::kWater; };
  return swath.frame == Swath::Frame::kBody && check(swath) == SwathFault::kNone &&
         std::ranges::any_of(swath.soundings, in_water);
}

/// What the Safety Officer watches of a sensor that decides its echoes itself: that it speaks, and not always the same.
SonarHealthSample sample_of(const Swath& swath) {
  SonarHealthSample look;
  look.time = swath.time;
  look.sonar = "soundings";
  for (const Sounding& s : swath.soundings) look.digest = 31 * look.digest + std::bit_cast<std::uint32_t>(s.range_m);
  return look;
}

}  // namespace

AgentsHelm::AgentsHelm(std::shared_ptr<const MissionPlan> plan, WorldSnapshot chart, double echo_contrast)
    : plan_(std::move(plan)), world_(std::move(chart)), echo_contrast_(echo_contrast) {}

void AgentsHelm::on_event(const Event& event) {
  const std::lock_guard lock(mutex_);
  clock_.update(time_of(event));
  moved(now());
  tell_chart();
  beat();
  if (const auto* fix = std::get_if<Navigation>(&event)) on_fix(*fix);
  if (const auto* range = std::get_if<RangeReading>(&event)) on_range_arrival(*range);
  if (const auto* ping = std::get_if<Ping>(&event)) on_ping_arrival(*ping);
  if (const auto* swath = std::get_if<Swath>(&event); swath && looks_around(*swath)) {
    SonarHealthSample look = sample_of(*swath);
    look.time += clock_.offset();
    executor_->on_message(std::move(look), now());
    ++heard_;  // its echoes are decided
    ++decided_;
  }
  if (const auto* health = std::get_if<Health>(&event)) on_health(*health);
  if (const auto* frame = std::get_if<OperatorFrame>(&event)) on_frame(*frame);
}

void AgentsHelm::tell_chart() {
  if (std::exchange(chart_told_, true) || (!world_.depths && !world_.objects)) return;
  executor_->on_message(world_, now());
}

void AgentsHelm::on_frame(const OperatorFrame& frame) {
  if (is_of_group(frame.bytes)) {
    executor_->on_message(LinkFrame{LinkFrame::Way::kFromGroup, frame.bytes}, now());
    return;
  }
  operator_heard_ = true;
  executor_->on_message(LinkFrame{LinkFrame::Way::kFromOperator, frame.bytes}, now());
}

void AgentsHelm::on_fix(const Navigation& fix) {
  if (!finite_fix(fix)) return;
  Navigation own = fix;
  own.time += clock_.offset();
  sigma_m_ = sigma_m_of(own).value_or(sigma_m_);
  executor_->on_message(own, now());
  if (!first_fix_) first_fix_ = now();
  if (begun_ || plan_->waits_for_operator || !(looked_ || now() - *first_fix_ > kLongestWarmUp)) return;
  begun_ = true;
  executor_->on_message(OperatorCommand{OperatorCommand::Kind::kStart, plan_}, now());
}

void AgentsHelm::on_range_arrival(const RangeReading& range) {
  if (!range.X_BS.is_finite() || !std::isfinite(range.range_m.value_or(0))) return;
  RangeReading own = range;
  own.time += clock_.offset();
  executor_->on_message(own, now());
}

void AgentsHelm::on_ping_arrival(const Ping& ping) {
  if (check(ping) != PingFault::kNone) return;
  SonarHealthSample look = look_of(ping, name_of(ping));
  look.time += clock_.offset();
  executor_->on_message(std::move(look), now());
}

void AgentsHelm::on_health(const Health& health) {
  if (!std::isfinite(health.battery_share)) return;
  const bool lost = health.state == HealthState::kLost;
  if (health.source == "link") link_ = !lost;
  if (health.source.starts_with(kAgent)) {
    if (lost) fail(health.source.substr(kAgent.size()), health.note == kHangs);
    return;
  }
  Health own = health;
  own.time += clock_.offset();
  executor_->on_message(std::move(own), now());
}

/// Makes an agent die or hang (kHangs of health.hpp); does nothing if there is no such agent.
void AgentsHelm::fail(const std::string& agent, bool hangs) {
  if (!executor_->has(agent)) return;
  if (hangs) {
    executor_->hang(agent);
  } else {
    executor_->kill(agent);
  }
}

void AgentsHelm::beat() {
  if (!next_beat_) next_beat_ = now();
  if (now() < *next_beat_) return;
  if (link_ && !operator_heard_) executor_->on_message(OperatorCommand{OperatorCommand::Kind::kBeat, nullptr}, now());
  next_beat_ = now() + kBeatInterval;
}

/// The name of the sonar in faults; sonars are numbered in the order of their first pings.
std::string AgentsHelm::name_of(const Ping& ping) {
  const std::size_t index = sonars_.index_of(ping.X_BS).value_or(0);
  return index == 0 ? "sonar" : fmt::format("sonar.{}", index + 1);
}

void AgentsHelm::on_ping(const PosedPing& posed) {
  const std::lock_guard lock(mutex_);
  ++heard_;
  auto echoes = echoes_of(posed.ping, posed.decisions, posed.X_WB, echo_contrast_);
  if (!echoes) return;
  ++decided_;
  echoes->time += clock_.offset();
  executor_->on_message(*std::move(echoes), now());
}

void AgentsHelm::on_jump(const Eigen::Vector3d& by_W) {
  const std::lock_guard lock(mutex_);
  jumped_ += by_W.head<2>();
}

void AgentsHelm::on_scan(const ScanResult& scan) {
  const std::lock_guard lock(mutex_);
  const bool looked = 2 * std::exchange(decided_, 0) > std::exchange(heard_, 0);
  if (!looked) return;
  looked_ = true;
  auto map = std::make_shared<Detection>(scan.detection);
  map->time += clock_.offset();
  executor_->on_message(Sweep{scan.number, scan.posed, sigma_m_, std::move(map), jumped_}, now());
}

void AgentsHelm::on_decision(const Decision& decision) {
  const std::lock_guard lock(mutex_);
  Decision timed = decision;
  timed.time = now();
  executor_->on_message(std::move(timed), now());
}

/// A map that the run does not have yet does not replace the chart.
void AgentsHelm::on_world(const WorldSnapshot& world) {
  const std::lock_guard lock(mutex_);
  if (world.depths && world.depths != world_.depths) {
    world_.depths = world.depths;
    world_.looked_ahead = world.looked_ahead;
    if (world_.looked_ahead) *world_.looked_ahead += clock_.offset();
  }
  if (world.sphere) world_.sphere = world.sphere;
  if (world.voxels) world_.voxels = world.voxels;
  looked_ = looked_ || world_.looked_ahead;
  executor_->on_message(world_, now());
}

}  // namespace isobath
