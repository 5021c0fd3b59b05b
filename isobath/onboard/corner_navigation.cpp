#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <isobath/onboard/corner_navigation.hpp>
#include <isobath/perception/scan_shapes.hpp>
#include <isobath/sonar/fan_stance.hpp>
#include <isobath/sonar/ping_quality.hpp>
#include <utility>

namespace isobath {
namespace {

using Eigen::Matrix2d;
using Eigen::Vector2d;

constexpr double kStep_m = 1;         // of the way: shorter steps may be noise of the navigation
constexpr double kLevel = 0.5;        // cosine of the slope from which on a beam is not level
constexpr double kMinSigma_m = 0.15;  // of a range: as in the spherical grid
constexpr double kBias_m = 0.15;      // of a corner, each axis: the same from sweep to sweep
constexpr double kWidthOverSigma = 2.355;
constexpr std::size_t kLastMoves = 5;

std::optional<Matrix2d> stated(const Navigation& fix) {
  if (!fix.covariance) return std::nullopt;
  return Matrix2d(fix.covariance->topLeftCorner<2, 2>());
}

}  // namespace

std::vector<Field> fields(CornerNavigationConfig& c) {
  return {
      Field::flag("on", &c.on,
                  "Whether corners of charted walls that a scanning sonar detects correct the position. Needs a chart "
                  "with walls (prior.file or a stored map)."),
      Field::real("drift_share", &c.drift_share, {0, 1}, "1",
                  "Standard deviation by which the position drifts, each axis, as a share of the way. A higher value "
                  "trusts the corners more and the navigation less."),
      Field::real("drift_length_m", &c.drift_length_m, {1, 1e6}, "m",
                  "Way over which the drift keeps its direction. A higher value trusts longer that it goes on as the "
                  "last corners have shown."),
      Field::real("gate", &c.gate, {0.1, 10}, "1",
                  "Number of standard deviations within which a detected corner matches a charted one."),
      Field::real("max_move_m", &c.max_move_m, {0.01, 1000}, "m",
                  "A corner fix that would move the position farther is refused."),
  };
}

std::string to_text(const CornerMove& move) {
  const std::string what =
      move.corners == 1 ? "a corner of the chart moves" : fmt::format("{} corners of the chart move", move.corners);
  return fmt::format(
      "{} the position by {:.2f} m, north {:+.2f} m, east {:+.2f} m; its standard deviation was {:.2f} m", what,
      move.by.norm(), move.by.x(), move.by.y(), move.sigma_m);
}

CornerNavigation::CornerNavigation(const CornerNavigationConfig& config, double contrast,
                                   std::vector<ChartedCorner> charted)
    : config_(config),
      contrast_(contrast),
      charted_(std::move(charted)),
      drift_(config.drift_share, config.drift_length_m) {
  counts_.charted = charted_.size();
}

// The source thread --------------------------------------------------------------------------------------------------

std::optional<CornerMove> CornerNavigation::correct(Navigation& fix) {
  if (!config_.on || !fix.X_WB.is_finite()) return std::nullopt;
  const std::lock_guard lock(mutex_);
  advance(fix);
  heading_variance_ = fix.covariance ? (*fix.covariance)(5, 5) : 0;
  fix.X_WB.translation.head<2>() += drift_.offset();
  if (fix.covariance && corrected_) {
    fix.covariance->topRows<2>().setZero();
    fix.covariance->leftCols<2>().setZero();
    fix.covariance->topLeftCorner<2, 2>() = drift_.covariance();
  }
  if (std::exchange(told_, move_.version) == move_.version) return std::nullopt;
  return move_;
}

/// Lets the estimate drift by the way since the anchor. The navigation's own position fix ends the correction.
void CornerNavigation::advance(const Navigation& fix) {
  const std::optional<Matrix2d> own = stated(fix);
  const std::optional<Matrix2d> before = anchor_ ? stated(*anchor_) : std::nullopt;
  const bool fixed = corrected_ && own && before && own->trace() < before->trace() / 2;
  if (fixed) {
    corrected_ = false;
    move_ = {-drift_.offset(), 0, std::sqrt(2 * drift_.variance()), move_.version + 1};
  }
  if (!anchor_ || fixed) {
    drift_.begin(own.value_or(Matrix2d::Zero()));
    anchor_ = fix;
  }
  const double step = (fix.X_WB.translation - anchor_->X_WB.translation).head<2>().norm();
  if (step < kStep_m) return;
  drift_.advance(step);
  if (own && (!corrected_ || drift_.variance() > own->trace() / 2)) drift_.scale_to(own->trace() / 2);
  anchor_ = fix;
}

// The mapping thread -------------------------------------------------------------------------------------------------

void CornerNavigation::on_ping(const PosedPing& posed) {
  const Ping& ping = posed.ping;
  if (!config_.on || ping.fan->beams() != 1 || !lies_flat(ping) || heads_.index_of(ping.X_BS) != 0) return;
  width_ = ping.fan->width[0];
  bin_m_ = ping.window.bin_m;
  reach_m_ = ping.window.end_m();
  const std::optional<int> bin = nearest_sure_echo(ping, posed.decisions, 0, contrast_);
  if (!bin) return;
  const Pose X_WS = posed.X_WB * ping.X_BS;
  const Vector2d beam =
      (X_WS.rotation * Eigen::Vector3d(cos(ping.fan->azimuth[0]), sin(ping.fan->azimuth[0]), 0)).head<2>();
  if (beam.norm() < kLevel) return;
  echoes_.push_back({X_WS.translation.head<2>(), plan_bearing(beam), ping.window.edge(*bin) * beam.norm()});
}

void CornerNavigation::on_jump(const Eigen::Vector3d& by_W) {
  for (Echo& echo : echoes_) echo.from += by_W.head<2>();
}

PlaneScan CornerNavigation::scan_of_sweep() const {
  PlaneScan scan;
  scan.beam_width = BeamWidth(Angle{});
  scan.sigma = width_ / kWidthOverSigma;
  scan.sigma_m = std::max(kMinSigma_m, bin_m_);
  for (const Echo& echo : echoes_) scan.from += echo.from / static_cast<double>(echoes_.size());
  for (const Echo& echo : echoes_) scan.echoes.emplace_back(echo.bearing, echo.range_m, echo.from - scan.from);
  scan.sort();
  return scan;
}

bool CornerNavigation::charted_near(const Vector2d& from) const {
  return std::any_of(charted_.begin(), charted_.end(),
                     [&](const ChartedCorner& corner) { return (corner.at - from).norm() <= reach_m_; });
}

void CornerNavigation::on_sweep(bool posed) {
  if (echoes_.empty()) return;
  const PlaneScan scan = scan_of_sweep();
  echoes_.clear();
  if (!posed) return;
  std::vector<PlaneCorner> seen;
  for (const ScanCorner& corner : shapes_of(scan).corners) {
    seen.push_back(corner);
    seen.back().covariance += kBias_m * kBias_m * Matrix2d::Identity();
  }
  if (seen.empty()) return;
  const std::lock_guard lock(mutex_);
  ++counts_.sweeps;
  if (followed_ != move_.version) return;  // the poses of these echoes do not contain the last fix yet
  const PlanePosition believed{scan.from, drift_.covariance()};
  const auto fix = corner_fix(believed, seen, charted_, Angle::radians(std::sqrt(heading_variance_)), config_.gate);
  if (fix && (fix->at - believed.at).norm() <= config_.max_move_m) return take(*fix, believed);
  if (fix || charted_near(scan.from)) ++counts_.refused;
}

void CornerNavigation::take(const CornerFix& fix, const PlanePosition& believed) {
  const double sigma_m = std::sqrt(believed.covariance.trace());
  const Vector2d by = drift_.correct(drift_.offset() + fix.at - believed.at, fix.covariance);
  move_ = {by, fix.corners, sigma_m, move_.version + 1};
  corrected_ = true;
  ++counts_.taken;
  if (counts_.last_moves_m.size() == kLastMoves) counts_.last_moves_m.erase(counts_.last_moves_m.begin());
  counts_.last_moves_m.push_back(by.norm());
  counts_.farthest_move_m = std::max(counts_.farthest_move_m, by.norm());
}

CornerFixOutcome CornerNavigation::outcome() const {
  const std::lock_guard lock(mutex_);
  CornerFixOutcome outcome = counts_;
  outcome.offset = drift_.offset();
  outcome.sigma_m = std::sqrt(drift_.variance());
  return outcome;
}

}  // namespace isobath
