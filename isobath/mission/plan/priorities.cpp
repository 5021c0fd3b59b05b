#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <isobath/geometry/cone_integral.hpp>
#include <isobath/mission/plan/priorities.hpp>

namespace isobath {

using Eigen::Vector2d;

namespace {

constexpr double kLeastWeight = 1e-3;  // of a second: a way without cost has no shortest one

double weight_of(const RiskArea& area, const Priorities& priorities) {
  return area.kind == RiskArea::Kind::kDetection ? priorities.stealth : priorities.survival;
}

}  // namespace

std::vector<Field> fields(Priorities& p) {
  return {Field::real("time", &p.time, {0, 1e6}, "1", "Weight of a second."),
          Field::real("energy", &p.energy, {0, 1e6}, "s/kJ", "What a kilojoule is worth."),
          Field::real("stealth", &p.stealth, {0, 1e6}, "s",
                      "What it is worth not to be detected: seconds per unit of -ln P(not detected)."),
          Field::real("survival", &p.survival, {0, 1e6}, "s",
                      "What it is worth not to be destroyed: seconds per unit of -ln P(not destroyed)."),
          Field::real("power_w", &p.power_w, {0, 1e6}, "W", "Power that the vehicle draws under way.")};
}

std::vector<Field> fields(RiskArea& a) {
  using K = RiskArea::Kind;
  return {Field::choice("kind", &a.kind, {{"detection", K::kDetection}, {"destruction", K::kDestruction}},
                        "What may happen there."),
          Field::numbers("centre", a.centre_W.data(), 2, {-1e5, 1e5}, "m", "North, east."),
          Field::real("radius_m", &a.radius_m, {1, 1e5}, "m", "Beyond it the area is harmless."),
          Field::real("per_minute", &a.per_minute, {0, 1e4}, "1/min",
                      "Rate at the centre; it falls linearly to 0 at the radius.")};
}

WayCost cost_of_way(std::span<const Vector2d> way_W, double speed, const Priorities& priorities,
                    std::span<const RiskArea> areas) {
  WayCost cost;
  double length_m = 0, seen = 0, hit = 0;  // -ln P
  for (std::size_t i = 1; i < way_W.size(); ++i) {
    length_m += (way_W[i] - way_W[i - 1]).norm();
    for (const RiskArea& area : areas) {
      const double at_centre_s = cone_integral(way_W[i - 1], way_W[i], area.centre_W, area.radius_m) / speed;
      (area.kind == RiskArea::Kind::kDetection ? seen : hit) += area.per_minute / 60 * at_centre_s;
    }
  }
  cost.time_s = length_m / speed;
  cost.energy_kj = cost.time_s * priorities.power_w / 1e3;
  cost.detected = -std::expm1(-seen);
  cost.destroyed = -std::expm1(-hit);
  cost.total_s = priorities.time * cost.time_s + priorities.energy * cost.energy_kj + priorities.stealth * seen +
                 priorities.survival * hit;
  return cost;
}

std::string to_text(const WayCost& cost) {
  std::string text = fmt::format("cost {:.0f} s: {:.0f} s", cost.total_s, cost.time_s);
  if (cost.energy_kj > 0) text += fmt::format(", {:.1f} kJ", cost.energy_kj);
  text += fmt::format(", detected with {:.0f} %", 100 * cost.detected);
  if (cost.destroyed > 0) text += fmt::format(", destroyed with {:.0f} %", 100 * cost.destroyed);
  return text;
}

double extra_cost(const RiskArea& area, const Priorities& priorities) {
  const double second = priorities.time + priorities.energy * priorities.power_w / 1e3;
  return weight_of(area, priorities) * area.per_minute / 60 / std::max(second, kLeastWeight);
}

}  // namespace isobath
