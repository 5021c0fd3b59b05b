#include <algorithm>
#include <isobath/perception/plane_scan.hpp>

namespace isobath {

using Eigen::Vector2d;

void PlaneScan::sort() {
  for (PlaneEcho& echo : echoes) echo.bearing = echo.bearing.wrapped_positive();
  std::stable_sort(echoes.begin(), echoes.end(),
                   [](const PlaneEcho& a, const PlaneEcho& b) { return a.bearing < b.bearing; });
}

Vector2d PlaneScan::point_towards(const PlaneEcho& echo, const Vector2d& nearest) const {
  const Vector2d& u = echo.axis;
  const double c = beam_width.cos_half, s = beam_width.sin_half;
  if (u.dot(nearest) >= c) return from + echo.offset + echo.range_m * nearest;
  const double to = std::copysign(s, u.x() * nearest.y() - u.y() * nearest.x());
  return from + echo.offset + echo.range_m * Vector2d(c * u.x() - to * u.y(), to * u.x() + c * u.y());
}

double PlaneScan::variance_along(const Vector2d& n, const PlaneEcho& echo) const {
  const double squarely = n.dot(echo.axis), square = squarely * squarely;
  const double along_m = range_sigma(echo.range_m), across_m = echo.range_m * sigma.radians();
  return along_m * along_m * square + across_m * across_m * (1 - square);
}

std::vector<RangeRun> constant_range_runs(const PlaneScan& scan, const RangeRunConfig& config) {
  const std::size_t n = scan.echoes.size();
  const Angle turn = Angle::degrees(360);
  const auto bearing_of = [&](std::size_t i) { return scan.echoes[i % n].bearing + (i < n ? Angle{} : turn); };
  const auto goes_on = [&](std::size_t i) {  // from i to the next
    const double a = scan.echoes[i % n].range_m, b = scan.echoes[(i + 1) % n].range_m;
    return bearing_of(i + 1) - bearing_of(i) <= config.neighbours &&
           std::abs(b - a) <= config.step * scan.range_sigma(std::min(a, b));
  };
  std::vector<RangeRun> runs;
  if (n < 2) return runs;
  std::size_t start = 0;  // starts after a break, if there is one
  while (start < n && goes_on(start + n - 1)) ++start;
  start %= n;
  for (std::size_t i = start; i < start + n;) {
    RangeRun run{i % n, 1, bearing_of(i), {}, scan.echoes[i % n].range_m};
    std::size_t last = i;
    for (; last + 1 < start + n && goes_on(last); ++last) {
      ++run.count;
      run.range_m += scan.echoes[(last + 1) % n].range_m;
    }
    run.end = bearing_of(last);
    run.range_m /= static_cast<double>(run.count);
    if (run.begin >= turn) {
      run.begin = run.begin - turn;
      run.end = run.end - turn;
    }
    if (run.count > 1 && run.end - run.begin >= config.least - Angle::degrees(1e-6)) runs.push_back(run);
    i = last + 1;
  }
  std::stable_sort(runs.begin(), runs.end(), [](const RangeRun& a, const RangeRun& b) { return a.begin < b.begin; });
  return runs;
}

}  // namespace isobath
