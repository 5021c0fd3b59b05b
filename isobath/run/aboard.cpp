#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <isobath/run/aboard.hpp>

namespace isobath {
namespace {

constexpr Duration kRingInterval = std::chrono::milliseconds(250), kTextInterval = std::chrono::seconds(1);
constexpr std::size_t kMostArrivals = 256;

}  // namespace

void Aboard::on_event(const Event& event) {
  if (const auto* fix = std::get_if<Navigation>(&event)) fix_ = *fix;
  const auto* ping = std::get_if<Ping>(&event);
  if (!ping) return;
  const std::lock_guard lock(mutex_);
  arrivals_[ping->time] = links_.source().arrival();
  if (arrivals_.size() > kMostArrivals) arrivals_.erase(arrivals_.begin());
}

void Aboard::on_ping(const PosedPing& ping) {
  const std::lock_guard lock(mutex_);
  const auto found = arrivals_.find(ping.ping.time);
  if (found == arrivals_.end()) return;
  placed_ = found->second;
  arrivals_.erase(arrivals_.begin(), std::next(found));
}

void Aboard::on_mapped(Time /*time*/, const Pipeline& /*pipeline*/, const DepthModel& /*depths*/,
                       const VoxelModel& /*voxels*/) {
  {
    const std::lock_guard lock(mutex_);
    if (!placed_) return;
    mapped_ = std::exchange(placed_, std::nullopt);
  }
  steer_at_once();
}

void Aboard::on_message(const Envelope& envelope) {
  const bool steers =
      std::holds_alternative<HelmOrder>(envelope.message) || std::holds_alternative<SafetyAction>(envelope.message);
  if (steers) steer_at_once();
}

void Aboard::steer_at_once() {
  links_.autopilot().hasten();
  links_.source().wake();
}

void Aboard::on_scan(const ScanResult& scan) {
  const Detection& seen = scan.detection;
  const CartesianGrid& cells = seen.cells;
  Surroundings around;
  const Angle turn = seen.X_WB.rotation.heading() - seen.heading;  // of directions in G into W
  const Eigen::Vector2d at_W = seen.X_WB.translation.head<2>();
  around.reach_m = cells.cell_m * std::min(cells.cells_x, cells.cells_y) / 2.0;
  for (std::size_t i = 0; i < Surroundings::kDirections; ++i) {
    const Angle direction_W = Angle::degrees(5.0 * static_cast<double>(i));
    const Angle direction_G = direction_W - turn;
    const Eigen::Vector2d ahead_G(cos(direction_G), sin(direction_G));
    bool clear = true;
    for (double range = cells.cell_m; range < around.reach_m; range += cells.cell_m) {
      const auto cell = cells.cell_at(seen.position + range * ahead_G);
      if (!cell) break;
      const std::size_t at = cells.index(*cell);
      if (seen.detected[at] != 0) {
        around.hits.emplace_back(at_W + range * Eigen::Vector2d(cos(direction_W), sin(direction_W)));
        clear = false;
        break;
      }
      if (seen.free[at] == 0) clear = false;
    }
    around.clear[i] = clear;
  }
  for (const Obstacle& obstacle : seen.obstacles)
    around.obstacles.push_back({obstacle.number, world_outline(obstacle, seen.X_WB)});
  const std::lock_guard lock(mutex_);
  around_ = std::move(around);
}

void Aboard::order(OperatorCommand command) {
  using Kind = OperatorCommand::Kind;
  if (command.kind == Kind::kStart) command.plan = plan_;
  console_.command(command);
  if (command.kind != Kind::kNewMission && command.kind != Kind::kReturn) return;
  started_ = true;
  if (!ours_) console_.command({Kind::kHold});
}

void Aboard::speak_for_operator(Helm& helm, Time now) {
  using Kind = OperatorCommand::Kind;
  const Authority authority = links_.autopilot().authority();
  if (authority == Authority::kNoAutopilot) return;
  const bool ours = authority == Authority::kOurs;
  if (ours != std::exchange(ours_, ours)) {
    if (ours && !std::exchange(started_, true)) {
      order({Kind::kStart});
    } else if (started_) {
      order({ours ? Kind::kResume : Kind::kHold});
    }
  }
  for (FrameBytes& bytes : console_.due(now)) links_.source().give(OperatorFrame{now, std::move(bytes)});
  for (const FrameBytes& answer : helm.to_operator()) (void)console_.on_frame(answer);
}

void Aboard::steer(const Setpoint& setpoint, Time answers) {
  if (!options_.commands) return;
  if (!links_.autopilot().command(setpoint, vehicle_, answers)) return;
  const std::lock_guard lock(mutex_);
  if (mapped_) latency_.add(to_seconds(links_.now() - *mapped_) * 1000);
  mapped_.reset();
}

void Aboard::tell(const Helm& helm, Time now) {
  const auto& decisions = helm.decisions();
  if (decisions_told_ < decisions.size() && now - text_told_ >= kTextInterval) {
    text_told_ = now;
    const Decision& newest = decisions.back();
    links_.autopilot().say(5, fmt::format("{}: {}", newest.what, newest.reason));
    decisions_told_ = decisions.size();
  }
  if (fix_ && now - ring_told_ >= kRingInterval) {
    ring_told_ = now;
    show_surroundings(*fix_, now);
  }
}

void Aboard::show_surroundings(const Navigation& fix, Time now) {
  Surroundings around;
  {
    const std::lock_guard lock(mutex_);
    around = around_;
  }
  if (around.reach_m <= 0) return;
  links_.autopilot().show(around, fix, now);
}

AboardOutcome Aboard::outcome() const {
  AboardOutcome outcome;
  const FrontSeat::Counts counts = links_.autopilot().counts();
  outcome.setpoints = counts.setpoints;
  outcome.withheld = counts.withheld;
  outcome.damaged = counts.damaged;
  for (const auto& device : links_.devices())
    outcome.devices.push_back({device->config().called(), device->heard(), device->losses()});
  const std::lock_guard lock(mutex_);
  outcome.ping_to_setpoint = latency_.time();
  return outcome;
}

}  // namespace isobath
