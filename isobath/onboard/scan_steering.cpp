#include <algorithm>
#include <isobath/onboard/scan_steering.hpp>
#include <isobath/sonar/fan_stance.hpp>

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

void ScanSteering::on_ping(const Ping& ping) {
  if (!config_.on || ping.fan->beams() != 1 || !lies_flat(ping)) return;
  now_ = ping.fan->azimuth[0].wrapped();
  mounted_ = ping.X_BS.rotation.heading();
  ++pings_;
  if (whole_known_) return;
  first_ = std::min(first_.value_or(now_), now_);
  last_ = std::max(last_.value_or(now_), now_);
}

std::optional<ScanCommand> ScanSteering::on_sweep(const SphericalGrid& grid, const Pose& X_WB) {
  if (!config_.on || !first_ || pings_ < 2) return std::nullopt;
  const Angle whole = *last_ - *first_, middle = *first_ + whole / 2;
  if (whole <= config_.limits.sector) return std::nullopt;
  if (!std::exchange(whole_known_, true)) whole_pings_ = pings_;
  const double share = part_ ? config_.limits.sector / whole : 1;
  // The end of a sweep is known one or two pings late, and the head then begins another one.
  if (pings_ < 0.7 * share * whole_pings_) return std::nullopt;
  pings_ = 0;
  ScanCommand command;
  part_ = !part_;
  command.middle = middle;
  command.sector = whole;
  if (!part_) return command;
  // Azimuths of the grid are counterclockwise from x', those of the sonar clockwise from its bow.
  const Angle bow = Angle::degrees(90) + grid.turned() - X_WB.rotation.heading() - mounted_;
  const ScanChoice choice = control_.next(grid, bow - now_, {bow - middle, whole});
  command.middle = (bow - choice.azimuth).wrapped();
  command.sector = config_.limits.sector;
  return command;
}

}  // namespace isobath
