#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <isobath/mission/sonar_look.hpp>
#include <isobath/runtime/mission_helm.hpp>

namespace isobath {
namespace {

constexpr Duration kBeatInterval = std::chrono::seconds(1);
constexpr std::string_view kAgent = "agent.";

std::vector<std::string> names_of(const std::vector<Seat>& seats) {
  std::vector<std::string> names;
  for (const Seat& seat : seats) names.push_back(seat.name);
  return names;
}

bool is_finite(const Navigation& fix) {
  return fix.X_WB.is_finite() && (!fix.v_WB || fix.v_WB->allFinite()) &&
         (!fix.covariance || fix.covariance->allFinite());
}

}  // namespace

MissionHelm::MissionHelm(std::vector<Seat> seats, const VehicleSheet& vehicle, const CrewConfig& config,
                         std::shared_ptr<const MissionPlan> plan, double echo_contrast)
    : names_(names_of(seats)),
      plan_(std::move(plan)),
      crew_(std::make_unique<Crew>(std::move(seats), vehicle, config,
                                   [this](const Envelope& envelope) { note(envelope); })),
      echo_contrast_(echo_contrast) {}

void MissionHelm::note(const Envelope& envelope) {
  if (const auto* decision = std::get_if<Decision>(&envelope.message)) decisions_.push_back(*decision);
  if (const auto* report = std::get_if<MissionReport>(&envelope.message)) report_ = *report;
}

void MissionHelm::hear(const Event& event) {
  const Time now = clock_.hear(time_of(event));
  crew_->advance(now);
  beat();
  if (const auto* fix = std::get_if<Navigation>(&event); fix && is_finite(*fix)) {
    Navigation own = *fix;
    own.time += clock_.offset();
    if (own.covariance) sigma_m_ = std::sqrt(std::max(0.0, (*own.covariance)(0, 0) + (*own.covariance)(1, 1)) / 2);
    crew_->hear(own, now);
    begin();
  }
  if (const auto* range = std::get_if<RangeReading>(&event);
      range && range->X_BS.is_finite() && std::isfinite(range->range_m.value_or(0))) {
    RangeReading own = *range;
    own.time += clock_.offset();
    crew_->hear(own, now);
  }
  if (const auto* ping = std::get_if<Ping>(&event); ping && check(*ping) == PingFault::kNone) {
    SonarLook look = look_of(*ping, name_of(*ping));
    look.time += clock_.offset();
    crew_->hear(std::move(look), now);
  }
  if (const auto* health = std::get_if<Health>(&event); health && std::isfinite(health->battery_share)) {
    hear_health(*health);
  }
}

/// The order to start, once it is known where the vehicle is.
void MissionHelm::begin() {
  if (begun_) return;
  begun_ = true;
  crew_->hear(OperatorCommand{OperatorCommand::Kind::kStart, plan_}, clock_.now());
}

void MissionHelm::beat() {
  const Time now = clock_.now();
  if (!next_beat_) next_beat_ = now;
  if (now < *next_beat_) return;
  if (link_) crew_->hear(OperatorCommand{OperatorCommand::Kind::kBeat}, now);
  next_beat_ = now + kBeatInterval;
}

void MissionHelm::hear_health(Health health) {
  health.time += clock_.offset();
  const bool lost = health.state == HealthState::kLost;
  if (health.source == "link") link_ = !lost;
  if (health.source.starts_with(kAgent)) {
    const std::string name = health.source.substr(kAgent.size());
    if (std::find(names_.begin(), names_.end(), name) == names_.end()) return;
    if (lost && health.note == kHangs) crew_->hang(name);
    if (lost && health.note != kHangs) crew_->kill(name);
    return;
  }
  crew_->hear(std::move(health), clock_.now());
}

/// As faults name them: in the order of their first pings.
std::string MissionHelm::name_of(const Ping& ping) {
  const std::size_t index = sonars_.index_of(ping.X_BS).value_or(0);
  return index == 0 ? "sonar" : fmt::format("sonar.{}", index + 1);
}

void MissionHelm::on_ping(const PosedPing& posed) {
  SonarLook look = look_of(posed.ping, name_of(posed.ping));
  bool decided = false;
  for (int w = 0; w < posed.decisions.words(); ++w) decided = decided || posed.decisions.usable()[w] != 0;
  add_echoes(look, posed.ping, posed.decisions, decided, posed.X_WB, echo_contrast_);
  look.time += clock_.offset();
  crew_->hear(std::move(look), clock_.now());
}

void MissionHelm::on_scan(const ScanResult& scan) {
  auto map = std::make_shared<Detection>(scan.detection);
  map->time += clock_.offset();
  crew_->hear(Sweep{scan.number, scan.posed, sigma_m_, std::move(map)}, clock_.now());
}

Setpoint MissionHelm::steer() { return crew_->helm(clock_.now()); }

}  // namespace isobath
