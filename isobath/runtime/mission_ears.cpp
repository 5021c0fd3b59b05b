#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <isobath/mission/sonar_look.hpp>
#include <isobath/runtime/mission_ears.hpp>
#include <isobath/runtime/scenario.hpp>
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

MissionEars::MissionEars(std::shared_ptr<const MissionPlan> plan, ChartUpdate chart, double echo_contrast, Say say,
                         Fail fail)
    : plan_(std::move(plan)), echo_contrast_(echo_contrast), say_(std::move(say)), fail_(std::move(fail)) {
  if (chart.depths || chart.objects) chart_ = std::move(chart);
}

void MissionEars::hear(const Event& event) {
  clock_.hear(time_of(event));
  tell_chart();
  beat();
  if (const auto* fix = std::get_if<Navigation>(&event)) hear_fix(*fix);
  if (const auto* range = std::get_if<RangeReading>(&event)) hear_range(*range);
  if (const auto* ping = std::get_if<Ping>(&event)) hear_ping(*ping);
  if (const auto* health = std::get_if<Health>(&event)) hear_health(*health);
  if (const auto* frame = std::get_if<OperatorFrame>(&event)) hear_frame(*frame);
}

void MissionEars::tell_chart() {
  if (auto chart = std::exchange(chart_, std::nullopt)) say_(std::move(*chart), now());
}

void MissionEars::hear_frame(const OperatorFrame& frame) {
  operator_heard_ = true;
  say_(LinkFrame{LinkFrame::Way::kFromOperator, frame.bytes}, now());
}

void MissionEars::hear_fix(const Navigation& fix) {
  if (!finite_fix(fix)) return;
  Navigation own = fix;
  own.time += clock_.offset();
  if (own.covariance) sigma_m_ = std::sqrt(std::max(0.0, (*own.covariance)(0, 0) + (*own.covariance)(1, 1)) / 2);
  say_(own, now());
  if (!first_fix_) first_fix_ = now();
  if (begun_ || plan_->waits_for_operator || !(looked_ || now() - *first_fix_ > kLongestWarmUp)) return;
  begun_ = true;
  say_(OperatorCommand{OperatorCommand::Kind::kStart, plan_}, now());
}

void MissionEars::hear_range(const RangeReading& range) {
  if (!range.X_BS.is_finite() || !std::isfinite(range.range_m.value_or(0))) return;
  RangeReading own = range;
  own.time += clock_.offset();
  say_(own, now());
}

void MissionEars::hear_ping(const Ping& ping) {
  if (check(ping) != PingFault::kNone) return;
  SonarLook look = look_of(ping, name_of(ping));
  look.time += clock_.offset();
  say_(std::move(look), now());
}

void MissionEars::hear_health(const Health& health) {
  if (!std::isfinite(health.battery_share)) return;
  const bool lost = health.state == HealthState::kLost;
  if (health.source == "link") link_ = !lost;
  if (health.source.starts_with(kAgent)) {
    if (lost) fail_(health.source.substr(kAgent.size()), health.note == kHangs);
    return;
  }
  Health own = health;
  own.time += clock_.offset();
  say_(std::move(own), now());
}

void MissionEars::beat() {
  if (!next_beat_) next_beat_ = now();
  if (now() < *next_beat_) return;
  if (link_ && !operator_heard_) say_(OperatorCommand{OperatorCommand::Kind::kBeat, nullptr}, now());
  next_beat_ = now() + kBeatInterval;
}

/// As faults name them: in the order of their first pings.
std::string MissionEars::name_of(const Ping& ping) {
  const std::size_t index = sonars_.index_of(ping.X_BS).value_or(0);
  return index == 0 ? "sonar" : fmt::format("sonar.{}", index + 1);
}

void MissionEars::on_ping(const PosedPing& posed) {
  ++heard_;
  auto echoes = echoes_of(posed.ping, posed.decisions, posed.X_WB, echo_contrast_);
  if (!echoes) return;
  ++decided_;
  echoes->time += clock_.offset();
  say_(*std::move(echoes), now());
}

void MissionEars::on_scan(const ScanResult& scan) {
  const bool looked = 2 * std::exchange(decided_, 0) > std::exchange(heard_, 0);
  if (!looked) return;
  looked_ = true;
  auto map = std::make_shared<Detection>(scan.detection);
  map->time += clock_.offset();
  say_(Sweep{scan.number, scan.posed, sigma_m_, std::move(map)}, now());
}

void MissionEars::on_space(Time time, const std::shared_ptr<const SpaceGrid>& space) {
  say_(SpaceSeen{time + clock_.offset(), space}, now());
}

}  // namespace isobath
