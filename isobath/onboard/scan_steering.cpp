#include <algorithm>
#include <isobath/onboard/scan_steering.hpp>
#include <isobath/sonar/fan_stance.hpp>
#include <utility>

namespace isobath {

std::vector<Field> fields(ScanSteeringConfig& c) {
  return {
      Field::flag("on", &c.on,
                  "Whether every other sweep of a scanning sonar looks where the spherical grid is least certain."),
      Field::degrees("sector_deg", &c.limits.sector, {5, 180}, "Sector of such a sweep."),
      Field::degrees("height_deg", &c.limits.height, {1, 90}, "Height of the beams, centred on the horizontal."),
      Field::real("turn_cost", &c.limits.turn_cost, {0, 100}, "nat/rad", "Uncertainty that a turn of the head costs."),
  };
}

bool ScanSteering::is_head(const Ping& ping) const {
  if (ping.fan->beams() != 1 || !lies_flat(ping)) return false;
  return !X_BS_ || (ping.X_BS.translation == X_BS_->translation &&
                    ping.X_BS.rotation.quaternion().coeffs() == X_BS_->rotation.quaternion().coeffs());
}

void ScanSteering::on_ping(const Ping& ping) {
  of_head_ = config_.on && is_head(ping);
  if (!of_head_) return;
  const Angle azimuth = ping.fan->azimuth[0];
  if (!X_BS_) {
    X_BS_ = ping.X_BS;
    first_ = last_ = now_ = azimuth;
  }
  const Angle step = (azimuth - now_).wrapped();
  now_ += step;
  ++pings_;
  if (whole_known_) return;
  step_ = abs(step);
  first_ = std::min(first_, now_);
  last_ = std::max(last_, now_);
}

std::optional<ScanCommand> ScanSteering::on_sweep(const SphericalGrid& grid, const Pose& X_WB) {
  if (!of_head_ || pings_ < 2) return std::nullopt;
  const bool all_round = last_ - first_ + step_ * 1.5 >= Angle::degrees(360);
  const Angle whole = all_round ? Angle::degrees(360) : last_ - first_, middle = first_ + (last_ - first_) / 2;
  if (whole <= config_.limits.sector) return std::nullopt;
  if (!std::exchange(whole_known_, true)) whole_pings_ = pings_;
  const double share = part_ ? config_.limits.sector / whole : 1;
  // The end of a sweep is known one or two pings late, and the head then begins another one.
  if (pings_ < 0.7 * share * whole_pings_) return std::nullopt;
  pings_ = 0;
  ScanCommand command;
  part_ = !part_;
  command.middle = middle.wrapped();
  command.sector = whole;
  if (!part_) return command;
  // Azimuths of the grid are counterclockwise from x', those of the sonar clockwise from its bow.
  const Angle bow = Angle::degrees(90) + grid.turned() - X_WB.rotation.heading() - X_BS_->rotation.heading();
  const ScanChoice choice = control_.next(grid, bow - now_, {bow - middle, whole});
  command.middle = (bow - choice.azimuth).wrapped();
  command.sector = config_.limits.sector;
  return command;
}

}  // namespace isobath
