#include <algorithm>
#include <array>
#include <cmath>
#include <isobath/base/error.hpp>
#include <isobath/perception/range_prediction.hpp>
#include <utility>

namespace isobath {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kBeyond = RangePredictor::kBeyond;

/// The beam over one pixel, relative to the apex: between w = top h and w = bottom h, with h from the pixel's near side
/// to its far side. A cone is scale-invariant, so the two slopes hold for all h.
struct Column {
  double near_m;
  double far_m;
  double top;
  double bottom;

  /// Smallest distance from the apex to ground whose top is w below it.
  [[nodiscard]] double contact(double w) const {
    double h = near_m;
    if (w > 0) {
      if (bottom <= 0) return kInfinity;
      h = std::max(h, w / bottom);
      if (h > far_m) return kInfinity;
    } else if (bottom * h < w) {
      return kInfinity;
    }
    const double low = std::isinf(top) ? w : std::max(w, top * h);
    const double high = std::isinf(bottom) ? kInfinity : std::max(bottom * h, low);
    const double nearest = std::clamp(0.0, low, high);
    return std::sqrt(h * h + nearest * nearest);
  }
};

/// Squares of the distances to the pixel's near side and to its far side.
std::pair<double, double> reach2_of(const Eigen::Vector2d& centre, double pixel_m) {
  const double north = std::abs(centre.x()), east = std::abs(centre.y()), half = pixel_m / 2;
  const double near_n = std::max(north - half, 0.0), near_e = std::max(east - half, 0.0);
  const double far_n = north + half, far_e = east + half;
  return {near_n * near_n + near_e * near_e, far_n * far_n + far_e * far_e};
}

/// Whether the beam covers the pixel at this offset from the apex, and its slopes there.
bool find_slopes(const BeamCone& cone, const Eigen::Vector2d& centre, double pixel_m, Column& column) {
  const Eigen::Vector2d& e = cone.heading();
  const double x = e.dot(centre);
  double y = e.x() * centre.y() - e.y() * centre.x();
  // A beam thinner than a pixel still covers it: across the beam, the nearest point of the pixel counts.
  if (!cone.contains_vertical()) y = std::copysign(std::max(std::abs(y) - pixel_m / 2, 0.0), y);
  Eigen::Vector2d at = x * e + y * Eigen::Vector2d(-e.y(), e.x());
  if (at.squaredNorm() < 1e-12) at = 1e-6 * e;
  const auto interval = cone.depth_interval(cone.apex().head<2>() + at);
  if (!interval) return false;
  const double h = at.norm();
  column.top = (interval->top_m - cone.apex().z()) / h;
  column.bottom = (interval->bottom_m - cone.apex().z()) / h;
  return true;
}

std::array<Eigen::Vector2d, 4> in_pixels(const PixelGrid& grid, const PlanFootprint& footprint) {
  std::array<Eigen::Vector2d, 4> corners;
  std::transform(footprint.corners.begin(), footprint.corners.end(), corners.begin(),
                 [&grid](const Eigen::Vector2d& p) { return pixel_coordinates(grid, p); });
  return corners;
}

}  // namespace

double RangeDeviation::of_pose(double range_m, double navigation) const {
  return std::hypot(navigation, range_m * attitude.radians());
}

double RangeDeviation::total(double range_m, double navigation) const {
  return std::hypot(of_range(range_m), of_pose(range_m, navigation));
}

std::vector<Field> fields(RangeDeviation& c) {
  return {
      Field::real("floor_m", &c.floor_m, {0, 100}, "m", "Standard deviation of a range at distance 0."),
      Field::real("share", &c.share, {0, 1}, "1", "Growth of this standard deviation per metre of range."),
      Field::real("navigation_m", &c.navigation_m, {0, 1000}, "m",
                  "Standard deviation of the vehicle's position if navigation does not state one."),
      Field::real("vertical_m", &c.vertical_m, {0, 100}, "m",
                  "Standard deviation of the vehicle's depth relative to the map's depths."),
      Field::degrees("attitude_deg", &c.attitude, {0, 45}, "Standard deviation of the direction of a beam."),
  };
}

bool RangePrediction::agrees(const std::optional<double>& measured_m, double sigma_range_m, double n) const {
  const double gate = n * std::hypot(sigma_range_m, sigma_m);
  return measured_m ? std::abs(*measured_m - expected_m) <= gate : expected_m + gate >= max_range_m;
}

PixelWindow RangePredictor::window(const BeamCone& cone, double max_range_m) const {
  const PlanFootprint footprint = plan_footprint(cone, kBeyond * max_range_m, 0, cone.plan_tangent());
  const auto corners = in_pixels(grid_, footprint);
  Eigen::Vector2d low = corners[0];
  Eigen::Vector2d high = corners[0];
  for (const Eigen::Vector2d& c : corners) {
    low = low.cwiseMin(c);
    high = high.cwiseMax(c);
  }
  const auto column = static_cast<std::int32_t>(std::floor(low.x()));
  const auto row = static_cast<std::int32_t>(std::floor(low.y()));
  return {column, row, static_cast<std::int32_t>(std::floor(high.x())) - column + 1,
          static_cast<std::int32_t>(std::floor(high.y())) - row + 1};
}

std::span<const PixelSpan> RangePredictor::pixels(const BeamCone& cone, double max_range_m, const PixelWindow& patch) {
  const PlanFootprint footprint = plan_footprint(cone, kBeyond * max_range_m, 0, cone.plan_tangent());
  const auto corners = in_pixels(grid_, footprint);
  pixels_touched(std::span(corners).first(static_cast<std::size_t>(footprint.count)), patch, spans_);
  return spans_;
}

RangePrediction RangePredictor::predict_listed(const BeamCone& cone, double max_range_m,
                                               const DepthPatch& patch) const {
  ISOBATH_ASSERT(static_cast<std::size_t>(patch.window.width) * static_cast<std::size_t>(patch.window.height) ==
                 patch.depth_m.size());
  // Variance of the bottom's height relative to the beam: a constant part, and one that grows with distance.
  const double steady = deviation_.vertical_m * deviation_.vertical_m;
  const double turning = deviation_.attitude.radians() * deviation_.attitude.radians();
  const double steepest = cone.contains_vertical() ? kInfinity : cone.planes(1).bottom_m - cone.apex().z();
  // Ground deeper than this is out of reach everywhere: the deviation of a height is at most `most` plus a share of it.
  const double share = deviation_.attitude.radians();
  const double farthest = kBeyond * max_range_m + 4 * grid_.pixel_m;
  const double most = deviation_.vertical_m + share * farthest;
  const double deepest =
      share < 1 ? cone.apex().z() + (std::max(steepest * farthest, 0.0) + most) / (1 - share) : kInfinity;
  const double flattest = steepest > 0 ? (1 - 1e-12) / steepest : kInfinity;
  const double flattest2 = flattest * flattest;
  double raised = kInfinity;
  double expected = kInfinity;
  double lowered = kInfinity;
  const auto look = [&](std::int32_t c, std::int32_t r, double depth) {
    const double w = depth - cone.apex().z();
    const Eigen::Vector2d centre = grid_.centre({c, r}) - cone.apex().head<2>();
    const std::pair<double, double> reach2 = reach2_of(centre, grid_.pixel_m);
    const double near2 = reach2.first, far2 = reach2.second;
    // Whether ground whose top is `below` the apex could have a contact in this column nearer than `best`: the middle
    // of the beam is the steepest.
    const auto may_improve = [&](double below, double best) {
      if (below <= 0) return near2 < best * best;
      return far2 >= flattest2 * below * below && near2 + below * below < best * best;
    };
    if (!may_improve(w - most - share * std::abs(w), raised) && !may_improve(w, expected) &&
        !may_improve(w + deviation_.vertical_m, lowered)) {
      return;
    }
    const double up = std::sqrt(steady + turning * (near2 + w * w));
    if (!may_improve(w - up, raised) && !may_improve(w, expected) && !may_improve(w + up, lowered)) return;
    Column column{std::sqrt(near2), std::sqrt(far2), 0, 0};
    if (!find_slopes(cone, centre, grid_.pixel_m, column)) return;
    raised = std::min(raised, column.contact(w - up));
    expected = std::min(expected, column.contact(w));
    lowered = std::min(lowered, column.contact(w + up));
  };
  // From the apex outwards, so that most pixels beyond the first echo are skipped.
  const Pixel middle{patch.window.column + patch.window.width / 2, patch.window.row + patch.window.height / 2};
  const Eigen::Vector2d ahead = grid_.centre(middle) - cone.apex().head<2>();
  for (std::size_t i = 0; i < spans_.size(); ++i) {
    const PixelSpan& span = ahead.x() > 0 ? spans_[spans_.size() - 1 - i] : spans_[i];
    const float* row = patch.depth_m.data() + std::ptrdiff_t{span.row - patch.window.row} * patch.window.width;
    const std::int32_t count = span.column_end - span.column_begin;
    for (std::int32_t k = 0; k < count; ++k) {
      const std::int32_t c = ahead.y() > 0 ? span.column_begin + k : span.column_end - 1 - k;
      const double depth = row[c - patch.window.column];
      if (depth <= deepest) look(c, span.row, depth);  // false for NaN, an unknown depth
    }
  }
  RangePrediction out;
  out.max_range_m = max_range_m;
  if (expected <= kBeyond * max_range_m) {
    out.expected_m = expected;
    out.sigma_m = std::isfinite(lowered) ? (lowered - raised) / 2 : expected - raised;
  }
  return out;
}

RangePrediction predict_surface(const BeamCone& cone, double max_range_m, const RangeDeviation& deviation) {
  RangePrediction out;
  out.max_range_m = max_range_m;
  const double depth = std::max(cone.apex().z(), 0.0);
  const auto range_of_metre = cone.range_to_level(cone.apex().z() - 1);  // range for each metre of depth
  if (!range_of_metre || *range_of_metre * depth > kBeyond * max_range_m) return out;
  out.expected_m = *range_of_metre * depth;
  out.sigma_m = *range_of_metre * std::hypot(deviation.vertical_m, out.expected_m * deviation.attitude.radians());
  return out;
}

}  // namespace isobath
