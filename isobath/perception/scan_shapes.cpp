#include <algorithm>
#include <cmath>
#include <isobath/perception/scan_shapes.hpp>
#include <limits>
#include <numeric>
#include <optional>

namespace isobath {
namespace {

using Eigen::Vector2d;

constexpr double kNever = std::numeric_limits<double>::infinity();
constexpr double kMaxOutliers = 0.25;    // share of a run's echoes above which the run is not extended
constexpr double kMinSquareness = 0.05;  // sine of the angle between a line and the beams below which any range fits

/// One shape for a run of echoes, and its cost.
struct Account {
  double cost = kNever;
  ScanShape shape;
  std::size_t outliers = 0;
};

template <class Shape>
void count_in(const PlaneScan& scan, std::span<const std::size_t> echoes, const Shape& shape, double miss,
              Account& account) {
  account.cost = 0;
  account.outliers = 0;
  account.shape = {shape, {}};
  for (const std::size_t i : echoes) {
    const double d = deviation(scan, scan.echoes[i], shape);
    account.cost += std::min(d * d, miss);
    if (d * d < miss) {
      account.shape.echoes.push_back(i);
    } else {
      ++account.outliers;
    }
  }
}

/// Whether the echoes of a shape have no gap above gap_m.
bool is_whole(const PlaneScan& scan, const ScanShape& shape, double gap_m) {
  for (std::size_t k = 1; k < shape.echoes.size(); ++k) {
    const Vector2d a = scan.point(scan.echoes[shape.echoes[k - 1]]), b = scan.point(scan.echoes[shape.echoes[k]]);
    if ((a - b).norm() > gap_m) return false;
  }
  return true;
}

/// Rejects lines along the beams, which fit any range.
bool can_be_heard(const PlaneScan& scan, const PlaneLine& line, const ScanShapesConfig& /*config*/) {
  return line.height_of(scan.from) >= kMinSquareness * (line.centre - scan.from).norm();
}
/// Rejects arcs that turn too little, or whose convex side does not face the sonar.
bool can_be_heard(const PlaneScan& scan, const PlaneArc& arc, const ScanShapesConfig& config) {
  if (arc.sweep < config.min_sweep || (!arc.hollow && arc.sweep > Angle::degrees(180))) return false;
  const Angle middle = arc.first + arc.sweep / 2;
  const double facing = plan_direction(middle).dot(scan.from - arc.centre);
  return arc.hollow || facing > 0;
}

/// Whether chance gives so large a chi^2 with a probability of at least 0.001 (Wilson and Hilferty 1931).
bool is_likely(double chi_square, int freedom) {
  const double k = std::max(1, freedom), share = 2 / (9 * k);
  return chi_square <= k * std::pow(1 - share + 3.1 * std::sqrt(share), 3);
}
bool is_likely(const PlaneLine& line) { return is_likely(line.residual, line.support - 2); }
bool is_likely(const PlaneArc& arc) { return is_likely(arc.residual, arc.support - 3); }

/// Fits twice: with all echoes, and with those that the first fit explains. `near`: the shape of the run that is one
/// echo shorter; becomes the shape of this run.
template <class Shape, class Fit>
Account account_for(const PlaneScan& scan, std::span<const std::size_t> echoes, const ScanShapesConfig& config,
                    std::optional<Shape>& near, const Fit& fit) {
  near = fit(echoes, near ? &*near : nullptr);
  if (!near) return {};
  Account account;
  count_in(scan, echoes, *near, config.miss, account);
  if (account.outliers > 0) {
    const std::vector<std::size_t> kept = account.shape.echoes;
    const auto again = fit(std::span<const std::size_t>(kept), &*near);
    if (!again) return {};
    count_in(scan, echoes, *again, config.miss, account);
  }
  const auto least = static_cast<std::size_t>(std::is_same_v<Shape, PlaneLine> ? config.min_line : config.min_arc);
  const Shape& shape = std::get<Shape>(account.shape.shape);
  if (account.shape.echoes.size() < least || !is_likely(shape) || !can_be_heard(scan, shape, config) ||
      !is_whole(scan, account.shape, config.gap_m)) {
    account.cost = kNever;
  }
  account.cost += std::is_same_v<Shape, PlaneLine> ? config.line_price : config.arc_price;
  return account;
}

/// Fits runs that begin at one echo, each run longer than the previous one.
class RunFitter {
 public:
  RunFitter(const PlaneScan& scan, const ScanShapesConfig& config) : scan_(scan), config_(config) {}

  Account best(std::span<const std::size_t> run) {
    Account line = account_for(
        scan_, run, config_, line_,
        [&](std::span<const std::size_t> of, const PlaneLine* about) { return fit_line(scan_, of, {}, about); });
    // If a line fits within the noise, no arc is tried.
    if (line.cost <= config_.line_price + static_cast<double>(run.size())) return line;
    Account arc = account_for(scan_, run, config_, arc_, [&](std::span<const std::size_t> of, const PlaneArc* about) {
      return fit_arc(scan_, of, about);
    });
    return arc.cost < line.cost ? arc : line;
  }

 private:
  const PlaneScan& scan_;
  const ScanShapesConfig& config_;
  std::optional<PlaneLine> line_;
  std::optional<PlaneArc> arc_;
};

/// Indices of the echoes in order, starting after the widest gap in bearing.
std::vector<std::size_t> order_from_gap(const PlaneScan& scan) {
  const std::size_t n = scan.echoes.size();
  std::size_t start = 0;
  double widest =
      scan.echoes[0].bearing.radians() + Angle::degrees(360).radians() - scan.echoes[n - 1].bearing.radians();
  double jump = std::abs(scan.echoes[0].range_m - scan.echoes[n - 1].range_m);
  for (std::size_t i = 1; i < n; ++i) {
    const double gap = (scan.echoes[i].bearing - scan.echoes[i - 1].bearing).radians();
    const double step = std::abs(scan.echoes[i].range_m - scan.echoes[i - 1].range_m);
    // without a clear gap in bearing, the largest step in range separates bodies
    if (gap > 2 * widest || (gap > 0.5 * widest && step > jump)) {
      start = i;
      widest = std::max(widest, gap);
      jump = step;
    }
  }
  std::vector<std::size_t> order(n);
  for (std::size_t k = 0; k < n; ++k) order[k] = (start + k) % n;
  return order;
}

bool is_neighbour(const PlaneScan& scan, std::size_t a, std::size_t b, Angle gap) {
  return (scan.echoes[b].bearing - scan.echoes[a].bearing).wrapped_positive() <= gap;
}

void find_corners(const PlaneScan& scan, const ScanShapesConfig& config, ScanShapes& told) {
  const std::size_t n = told.shapes.size();
  for (std::size_t i = 0; i < n && n > 1; ++i) {
    const std::size_t k = (i + 1) % n;
    const PlaneLine *a = told.shapes[i].line(), *b = told.shapes[k].line();
    if (!a || !b || (n == 2 && i == 1)) continue;
    const bool follow = is_neighbour(scan, told.shapes[i].echoes.back(), told.shapes[k].echoes.front(), config.gap);
    std::optional<PlaneCorner> corner = corner_of(*a, *b);
    if (!follow || !corner) continue;
    const auto off_end = [&](const PlaneLine& line) {
      const double s = line.along_of(corner->at);
      return std::min(std::abs(s - line.begin_m), std::abs(s - line.end_m));
    };
    if (off_end(*a) > config.corner_m || off_end(*b) > config.corner_m) continue;
    std::optional<PlaneLine> fitted_a =
        fit_line(scan, told.shapes[i].echoes, factors_near(scan, told.shapes[i].echoes, *a, corner->at));
    std::optional<PlaneLine> fitted_b =
        fit_line(scan, told.shapes[k].echoes, factors_near(scan, told.shapes[k].echoes, *b, corner->at));
    if (fitted_a && fitted_b) {
      if (const auto again = corner_of(*fitted_a, *fitted_b)) corner = again;
    }
    told.corners.push_back({*corner, i, k});
  }
}

}  // namespace

// cost[k]: cost of the first k echoes in order; how[k]: the shape that ends at k, if any.
ScanShapes shapes_of(const PlaneScan& scan, const ScanShapesConfig& config) {
  ScanShapes told;
  const std::size_t n = scan.echoes.size();
  if (n == 0) return told;
  const std::vector<std::size_t> order = order_from_gap(scan);
  std::vector<double> cost(n + 1, kNever);
  std::vector<std::optional<ScanShape>> how(n + 1);
  std::vector<std::size_t> from(n + 1, 0);
  cost[0] = 0;
  for (std::size_t i = 0; i < n; ++i) {
    if (cost[i] + config.miss < cost[i + 1]) {
      cost[i + 1] = cost[i] + config.miss;
      how[i + 1].reset();
      from[i + 1] = i;
    }
    RunFitter fitter(scan, config);
    for (std::size_t end = i + 2; end <= n && is_neighbour(scan, order[end - 2], order[end - 1], config.gap); ++end) {
      const std::span<const std::size_t> run(order.data() + i, end - i);
      if (run.size() < static_cast<std::size_t>(std::min(config.min_line, config.min_arc))) continue;
      Account best = fitter.best(run);
      if (cost[i] + best.cost < cost[end]) {
        cost[end] = cost[i] + best.cost;
        how[end] = std::move(best.shape);
        from[end] = i;
      }
      if (run.size() >= 12 && static_cast<double>(best.outliers) > kMaxOutliers * static_cast<double>(run.size())) {
        break;
      }
    }
  }
  for (std::size_t k = n; k > 0; k = from[k]) {
    if (how[k]) told.shapes.push_back(std::move(*how[k]));
  }
  std::reverse(told.shapes.begin(), told.shapes.end());
  std::vector<bool> has(n, false);
  for (const ScanShape& shape : told.shapes) {
    for (const std::size_t i : shape.echoes) has[i] = true;
  }
  for (std::size_t i = 0; i < n; ++i) {
    if (!has[i]) told.unassigned.push_back(i);
  }
  find_corners(scan, config, told);
  return told;
}

}  // namespace isobath
