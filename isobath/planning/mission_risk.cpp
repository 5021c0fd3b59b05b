#include <algorithm>
#include <array>
#include <cmath>
#include <isobath/base/error.hpp>
#include <isobath/planning/mission_risk.hpp>
#include <utility>

namespace isobath {
namespace {

using Eigen::Vector2d;

/// The part of a leg inside the window's rectangle, as shares of the leg; first above second where there is none.
std::pair<double, double> inside(const Vector2d& a, const Vector2d& d, const Vector2d& low, const Vector2d& high) {
  double from = 0, to = 1;
  for (int i = 0; i < 2; ++i) {
    if (d[i] == 0) {
      if (a[i] < low[i] || a[i] > high[i]) return {1, 0};
      continue;
    }
    const double one = (low[i] - a[i]) / d[i], other = (high[i] - a[i]) / d[i];
    from = std::max(from, std::min(one, other));
    to = std::min(to, std::max(one, other));
  }
  return {from, to};
}

/// Where the leg crosses the lines corner + k px between two coordinates.
void add_crossings(std::vector<double>& cuts, double a, double d, double corner, double px, double from, double to) {
  if (d == 0) return;
  const double one = a + from * d, other = a + to * d;
  const double last = std::floor((std::max(one, other) - corner) / px);
  for (double k = std::ceil((std::min(one, other) - corner) / px); k <= last; ++k) {
    cuts.push_back(std::clamp((corner + k * px - a) / d, from, to));
  }
}

}  // namespace

double rate_of_probability(double probability, double reference_m) {
  ISOBATH_ASSERT(probability >= 0 && probability <= 1 && reference_m > 0);
  return -std::log1p(-probability) / reference_m;
}

RiskGrid risk_of(const MissionMap& map, Threat threat) {
  RiskGrid risk{map.grid(), map.extent(), {}};
  const PixelWindow& w = risk.window;
  risk.rate_per_m.reserve(static_cast<std::size_t>(w.width) * static_cast<std::size_t>(w.height));
  for (std::int32_t row = w.row; row < w.row + w.height; ++row) {
    for (std::int32_t column = w.column; column < w.column + w.width; ++column) {
      const MissionCell& cell = map.at({column, row});
      risk.rate_per_m.push_back((threat == Threat::kDestruction ? 0 : cell.detection_per_m) +
                                (threat == Threat::kDetection ? 0 : cell.destruction_per_m));
    }
  }
  return risk;
}

double PathRisk::probability() const { return -std::expm1(-cost); }

PathRisk& PathRisk::operator+=(const PathRisk& other) {
  cost += other.cost;
  judged_m += other.judged_m;
  outside_m += other.outside_m;
  return *this;
}

PathRisk path_risk(const RiskGrid& risk, std::span<const Vector2d> path) {
  const PixelWindow& w = risk.window;
  const double px = risk.grid.pixel_m;
  ISOBATH_ASSERT(risk.rate_per_m.size() == static_cast<std::size_t>(w.width) * static_cast<std::size_t>(w.height));
  const Vector2d high_north(risk.grid.corner_m.x() - w.row * px, risk.grid.corner_m.y() + w.column * px);
  const Vector2d low(high_north.x() - w.height * px, high_north.y());
  const Vector2d high(high_north.x(), high_north.y() + w.width * px);
  PathRisk out;
  std::vector<double> cuts;
  for (std::size_t i = 0; i + 1 < path.size(); ++i) {
    const Vector2d& a = path[i];
    const Vector2d d = path[i + 1] - a;
    const double length = d.norm();
    const auto [from, to] = inside(a, d, low, high);
    const double share = std::max(0.0, to - from);
    out.judged_m += share * length;
    out.outside_m += (1 - share) * length;
    if (!(share > 0)) continue;
    cuts.assign({from, to});
    add_crossings(cuts, a.x(), d.x(), risk.grid.corner_m.x(), px, from, to);
    add_crossings(cuts, a.y(), d.y(), risk.grid.corner_m.y(), px, from, to);
    std::sort(cuts.begin(), cuts.end());
    for (std::size_t k = 0; k + 1 < cuts.size(); ++k) {
      Pixel p = risk.grid.at(a + d * ((cuts[k] + cuts[k + 1]) / 2));
      // The window's far edges belong to it like the near ones.
      p.column = std::clamp(p.column, w.column, w.column + w.width - 1);
      p.row = std::clamp(p.row, w.row, w.row + w.height - 1);
      const double piece = (cuts[k + 1] - cuts[k]) * length;
      if (!(piece > 0)) continue;  // an infinite rate over zero length
      out.cost += piece * risk.rate_of(p);
    }
  }
  return out;
}

}  // namespace isobath
