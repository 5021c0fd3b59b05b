#include <algorithm>
#include <array>
#include <cmath>
#include <isobath/base/error.hpp>
#include <isobath/perception/reading_evidence.hpp>
#include <numbers>
#include <utility>

namespace isobath {
namespace {

using Kind = PixelEvidence::Kind;
using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double kWidestHalfAngle = 89 * std::numbers::pi / 180;
constexpr double kLongest = 10;  // maximum axis ratio of a footprint: that of soundings at 84 degrees
constexpr double kReservedHalfAngle = 15 * std::numbers::pi / 180;

/// Pixel centres in a beam's axes: x along its azimuth, y across it, from the apex. Rows and columns count from the
/// pixel of the apex, so that floats represent them exactly.
struct BeamAxes {
  std::int32_t column;
  std::int32_t row;
  float x, x_of_column, x_of_row;
  float y, y_of_column, y_of_row;

  BeamAxes(const BeamCone& cone, const PixelGrid& grid) {
    const Pixel home = grid.at(cone.apex().head<2>());
    const Vector2d d = grid.centre(home) - cone.apex().head<2>();
    const Vector2d& e = cone.heading();
    column = home.column;
    row = home.row;
    x = static_cast<float>(e.dot(d));
    y = static_cast<float>(e.x() * d.y() - e.y() * d.x());
    x_of_column = static_cast<float>(e.y() * grid.pixel_m);
    x_of_row = static_cast<float>(-e.x() * grid.pixel_m);
    y_of_column = static_cast<float>(e.x() * grid.pixel_m);
    y_of_row = static_cast<float>(e.y() * grid.pixel_m);
  }
};

/// Ellipse about the origin with semi-axes `radius` across the tilt of a direction and `stretch` times that along it.
class Ellipse {
 public:
  Ellipse(const Vector3d& u, double radius, double stretch) : radius2_(radius * radius) {
    const double horizontal = u.head<2>().norm();
    const Vector2d t = horizontal > 0 ? Vector2d(u.head<2>() / horizontal) : Vector2d(1, 0);
    const double k = 1 / (stretch * stretch);
    east2_ = t.y() * t.y() * k + t.x() * t.x();
    mixed_ = t.x() * t.y() * (k - 1);
    north2_ = t.x() * t.x() * k + t.y() * t.y();
  }
  /// West and east limits on the line `north` of the middle; in reverse order if the line misses the ellipse.
  [[nodiscard]] std::pair<double, double> east_at(double north) const {
    const double middle = -mixed_ * north / east2_;
    const double square = (radius2_ - (north2_ - mixed_ * mixed_ / east2_) * north * north) / east2_;
    if (square < 0) return {1, -1};
    const double half = std::sqrt(square);
    return {middle - half, middle + half};
  }

 private:
  double radius2_;
  double east2_;
  double mixed_;
  double north2_;
};

double steepest_side(const BeamCone& cone) {
  return std::abs(cone.depression().radians()) + cone.half_angle().radians();
}

}  // namespace

std::vector<Field> fields(ReadingEvidenceConfig& c) {
  using C = ReadingEvidenceConfig;
  return {
      Field::choice(
          "footprint", &c.footprint,
          {{"square", C::Footprint::kSquare}, {"circle", C::Footprint::kCircle}, {"ellipse", C::Footprint::kEllipse}},
          "Shape of a depth sonar's footprint on the bottom; the square is a quarter larger than the circle."),
      Field::choice("geometry", &c.geometry, {{"exact", C::Geometry::kExact}, {"planes", C::Geometry::kPlanes}},
                    "Geometry of a beam: the exact cone at the full attitude, or, for comparison, two planes of a "
                    "level vehicle."),
      Field::choice("coverage", &c.coverage, {{"centre", C::Coverage::kCentre}, {"touched", C::Coverage::kTouched}},
                    "Pixels of a beam: those whose centres are in it, or all that it touches."),
      Field::real("range_cap_m", &c.range_cap_m, {0.5, 1000}, "m",
                  "Maximum range of forward sonars: echoes beyond it count as none."),
      Field::real("margin_m", &c.margin_m, {0, 100}, "m", "Margin within which depths agree with a sounding."),
      Field::real("margin_share", &c.margin_share, {0, 1}, "1", "The same as a share of the range; the larger counts."),
      Field::real("extension_px", &c.extension_px, {0, 100}, "pixels", "Extension of a beam beyond its echo."),
      Field::degrees("depth_within_deg", &c.depth_within, {0, 90},
                     "Maximum angle between the axis of a depth sonar and the vertical."),
      Field::integer("depth_weight", &c.depth_weight, {0, 20}, "1", "Confidence units of a reading of the bottom."),
      Field::integer("obstacle_weight", &c.obstacle_weight, {0, 20}, "1",
                     "Confidence units of a reading of a forward sonar."),
      Field::integer("weight_cap", &c.weight_cap, {1, 20}, "1",
                     "Maximum confidence units of one reading, merged or not."),
      Field::real("gate", &c.gate, {0, 20}, "1", "Standard deviations within which an echo counts as predicted."),
      Field::real("min_confidence", &c.min_confidence, {0, 1}, "1",
                  "Minimum confidence of a reading, as stated by the sonar.")
          .was("least_confidence"),
  };
}

int footprint_half_width(double radius_m, double pixel_m) {
  return std::max(0, static_cast<int>(std::ceil(radius_m / pixel_m - 0.5)));
}

ReadingEvidence::ReadingEvidence(const ReadingEvidenceConfig& config, const PixelGrid& grid)
    : config_(config), grid_(grid) {
  ISOBATH_ASSERT(grid.pixel_m > 0);
  const double reach = config.range_cap_m / grid.pixel_m + config.extension_px;
  spans_.reserve(static_cast<std::size_t>(std::ceil(2.2 * reach)) + 4);
  pixels_.resize(static_cast<std::size_t>(std::ceil((reach * std::tan(kReservedHalfAngle) + 3) * (reach + 3))));
}

int ReadingEvidence::weight(int of_sensor, int count) const {
  return std::min(of_sensor * std::max(count, 1), config_.weight_cap);
}

std::optional<BeamCone> ReadingEvidence::cone(const RangeReading& reading, const Pose& X_WB) const {
  const double a = reading.width.radians() / 2;
  if (!(a >= 0 && a < kWidestHalfAngle) || !X_WB.is_finite() || !reading.X_BS.is_finite()) return std::nullopt;
  if (!(reading.confidence >= config_.min_confidence)) return std::nullopt;
  if (reading.range_m && !(std::isfinite(*reading.range_m) && *reading.range_m > 0)) return std::nullopt;
  const bool exact = config_.geometry == ReadingEvidenceConfig::Geometry::kExact;
  return BeamCone(reading, exact ? X_WB : level(X_WB));
}

Evidence ReadingEvidence::add_reading(const RangeReading& reading, const Pose& X_WB, const ReadingContext& context) {
  Evidence out;
  count_ = 0;
  const std::optional<BeamCone> beam = cone(reading, X_WB);
  if (!beam) return out;
  const double vertical = std::cos(config_.depth_within.radians());
  if (beam->axis().z() <= -vertical) return out;
  const bool depth_sonar = beam->axis().z() >= vertical;
  const double max_range = max_range_m(reading, depth_sonar);
  const bool echo = reading.range_m && *reading.range_m < max_range;
  const double range = echo ? *reading.range_m : max_range;
  if (depth_sonar) {
    if (!echo) return out;
    fill_depth(*beam, range, context, out);
  } else {
    const bool exact = config_.geometry == ReadingEvidenceConfig::Geometry::kExact;
    if (!exact && steepest_side(*beam) >= kWidestHalfAngle) return out;
    out.outcome = echo ? Evidence::Outcome::kEcho : Evidence::Outcome::kNoEcho;
    out.weight = weight(config_.obstacle_weight, context.count);
    out.explained = echo && explained(*beam, range, max_range, context);
    fill_beam(*beam, range, context, out);
    if (!echo) keep_only_clear();
  }
  out.sigma_m =
      static_cast<float>(config_.deviation.total(range, context.navigation_m.value_or(config_.deviation.navigation_m)));
  out.pixels = std::span(pixels_).first(count_);
  return out;
}

Evidence ReadingEvidence::add_sounding(const Vector3d& p_W, const Vector3d& u_W, double range_m, Angle half_angle,
                                       double sigma_m, const ReadingContext& context) {
  Evidence out;
  count_ = 0;
  const double a = half_angle.radians();
  if (!p_W.allFinite() || !u_W.allFinite() || !(range_m >= 0 && std::isfinite(range_m))) return out;
  if (!(a >= 0 && a < kWidestHalfAngle) || !(u_W.squaredNorm() > 0)) return out;
  out.outcome = Evidence::Outcome::kBottom;
  out.weight = weight(config_.depth_weight, context.count);
  out.margin_m = static_cast<float>(std::max(config_.margin_m, config_.margin_share * range_m));
  const double navigation = context.navigation_m.value_or(config_.deviation.navigation_m);
  out.sigma_m = static_cast<float>(sigma_m > 0 ? std::hypot(sigma_m, config_.deviation.of_pose(range_m, navigation))
                                               : config_.deviation.total(range_m, navigation));
  fill_footprint(p_W, u_W, range_m * std::tan(a), context.window);
  out.pixels = std::span(pixels_).first(count_);
  return out;
}

bool ReadingEvidence::explained(const BeamCone& cone, double range_m, double max_range_m,
                                const ReadingContext& context) const {
  const double sigma = config_.deviation.of_range(range_m);
  if (context.prediction != nullptr && context.prediction->agrees(range_m, sigma, config_.gate)) return true;
  return predict_surface(cone, max_range_m, config_.deviation).agrees(range_m, sigma, config_.gate);
}

void ReadingEvidence::fill_depth(const BeamCone& cone, double range_m, const ReadingContext& context, Evidence& out) {
  out.outcome = Evidence::Outcome::kBottom;
  out.weight = weight(config_.depth_weight, context.count);
  out.margin_m = static_cast<float>(std::max(config_.margin_m, config_.margin_share * range_m));
  const double radius = range_m * cone.sin_half_angle() / cone.cos_half_angle();
  fill_footprint(cone.apex() + range_m * cone.axis(), cone.axis(), radius, context.window);
}

// S1-54, S1-55, S1-E07: the square around the pixel, or the pixels whose centres lie in the circle or in the ellipse,
// and in any case the pixel that holds the point.
void ReadingEvidence::fill_footprint(const Vector3d& p_W, const Vector3d& u_W, double radius_m,
                                     const PixelWindow& window) {
  using Footprint = ReadingEvidenceConfig::Footprint;
  const Vector2d p = p_W.head<2>();
  const double limit = grid_.pixel_m * (1 << 29);
  if (!((p - grid_.corner_m).cwiseAbs().maxCoeff() < limit)) return;
  radius_m = std::min(radius_m, config_.range_cap_m);  // beam widths from files are not trusted
  const bool square = config_.footprint == Footprint::kSquare;
  double stretch = 1;
  if (config_.footprint == Footprint::kEllipse) stretch = std::min(u_W.norm() / std::abs(u_W.z()), kLongest);
  stretch = std::min(stretch, std::max(config_.range_cap_m / radius_m, 1.0));
  const Ellipse spot(u_W, radius_m, stretch);
  const Pixel middle = grid_.at(p);
  const Vector2d offset = grid_.centre(middle) - p;
  const int n = footprint_half_width(radius_m * stretch, grid_.pixel_m);
  const std::size_t side = 2 * static_cast<std::size_t>(n) + 1;
  if (side * side > pixels_.size()) pixels_.resize(side * side);
  const std::int64_t row_end = std::min(std::int64_t{middle.row} + n + 1, std::int64_t{window.row} + window.height);
  const std::int64_t last_end = std::int64_t{window.column} + window.width;
  PixelEvidence* to = pixels_.data();
  for (std::int64_t row = std::max<std::int64_t>(std::int64_t{middle.row} - n, window.row); row < row_end; ++row) {
    int west = -n;
    int east = n;
    if (!square) {
      const double north = offset.x() - static_cast<double>(row - middle.row) * grid_.pixel_m;
      const auto [low, high] = spot.east_at(north);
      west = std::max(static_cast<int>(std::ceil((low - offset.y()) / grid_.pixel_m)), -n);
      east = std::min(static_cast<int>(std::floor((high - offset.y()) / grid_.pixel_m)), n);
      if (row == middle.row) {
        west = std::min(west, 0);
        east = std::max(east, 0);
      }
    }
    const std::int64_t begin = std::max<std::int64_t>(std::int64_t{middle.column} + west, window.column);
    const std::int64_t end = std::min(std::int64_t{middle.column} + east + 1, last_end);
    for (std::int64_t column = begin; column < end; ++column) {
      *to++ = {static_cast<std::int32_t>(column), static_cast<std::int32_t>(row), static_cast<float>(p_W.z()),
               Kind::kBottom};
    }
  }
  count_ = static_cast<std::size_t>(to - pixels_.data());
}

void ReadingEvidence::fill_beam(const BeamCone& cone, double range_m, const ReadingContext& context, Evidence& out) {
  const bool echo = out.outcome == Evidence::Outcome::kEcho;
  const bool planes = config_.geometry == ReadingEvidenceConfig::Geometry::kPlanes;
  const double extension = echo ? config_.extension_px * grid_.pixel_m : 0;
  const double tangent = planes ? cone.sin_half_angle() / cone.cos_half_angle() : cone.plan_tangent();
  const double limit = grid_.pixel_m * (1 << 28);
  if (!((cone.apex().head<2>() - grid_.corner_m).cwiseAbs().maxCoeff() < limit)) return;
  const PlanFootprint footprint = plan_footprint(cone, range_m, extension, tangent);
  list_pixels(footprint, context.window);
  const Kind beyond = out.explained ? Kind::kConfirm : Kind::kObstructed;
  // If the lower side of the cone is under water over the whole plan, all pixels count and none needs a test.
  const double s_z = cone.apex().z();
  const double lowest_rise = std::min(cone.axis().z() * cone.cos_depression() / cone.vertical_term(), 0.0);
  const bool submerged = s_z >= 0 && s_z + (range_m + extension + grid_.pixel_m) * lowest_rise >= 0;
  if (planes) {
    judge_by_planes(cone, range_m, beyond);
  } else if (footprint.is_triangle() && submerged) {
    judge_by_cone(cone, range_m, tangent, beyond);
  } else {
    judge_by_columns(cone, range_m, beyond);
  }
}

void ReadingEvidence::list_pixels(const PlanFootprint& footprint, const PixelWindow& window) {
  std::array<Vector2d, 4> corners;
  for (std::size_t i = 0; i < corners.size(); ++i) corners[i] = pixel_coordinates(grid_, footprint.corners[i]);
  const auto polygon = std::span(corners).first(static_cast<std::size_t>(footprint.count));
  if (config_.coverage == ReadingEvidenceConfig::Coverage::kCentre) {
    pixels_inside(polygon, window, spans_);
  } else {
    pixels_touched(polygon, window, spans_);
  }
  std::int64_t pixels = 0;
  for (const PixelSpan& s : spans_) pixels += s.column_end - s.column_begin;
  count_ = static_cast<std::size_t>(pixels);
  if (count_ > pixels_.size()) pixels_.resize(count_);
  PixelEvidence* to = pixels_.data();
  for (const PixelSpan& s : spans_) {
    for (std::int32_t column = s.column_begin; column < s.column_end; ++column) {
      to->column = column;
      to->row = s.row;
      ++to;
    }
  }
}

// S1-65 with x = h cos eta, y = h sin eta: sqrt(D) h = sqrt(sin^2 a x^2 - A y^2). One line per equation and no branch,
// so that the compiler vectorises it.
void ReadingEvidence::judge_by_cone(const BeamCone& cone, double range_m, double plan_tangent, Kind beyond) {
  const BeamAxes axes(cone, grid_);
  const double a_term = cone.vertical_term();
  const auto tangent = static_cast<float>(plan_tangent);
  const auto sin2 = static_cast<float>(cone.sin_half_angle() * cone.sin_half_angle());
  const auto A = static_cast<float>(a_term);
  const auto rise = static_cast<float>(cone.axis().z() * cone.cos_depression() / a_term);
  const auto spread = static_cast<float>(cone.cos_half_angle() / a_term);
  const double tan_delta = cone.axis().z() / cone.cos_depression();
  const auto tan2 = static_cast<float>(tan_delta * tan_delta);
  const auto R2 = static_cast<float>(range_m * range_m);
  const auto s_z = static_cast<float>(cone.apex().z());
  const float least = 1e-3F * static_cast<float>(grid_.pixel_m);
  PixelEvidence* const p = pixels_.data();
  const std::size_t n = count_;
  for (std::size_t i = 0; i < n; ++i) {
    const auto column = static_cast<float>(p[i].column - axes.column);
    const auto row = static_cast<float>(p[i].row - axes.row);
    // A pixel that the beam only touches takes the bounds at the beam's side.
    const float ahead = axes.x + column * axes.x_of_column + row * axes.x_of_row;
    const float x = ahead > least ? ahead : least;
    const float side = axes.y + column * axes.y_of_column + row * axes.y_of_row;
    const float limit = x * tangent;
    const float inner = side < limit ? side : limit;
    const float y = inner > -limit ? inner : -limit;
    const float h2 = x * x + y * y;
    const float root = sin2 * x * x - A * y * y;
    const float half = spread * std::sqrt(root > 0 ? root : 0);
    const float middle = s_z + rise * x;
    const float left = R2 - h2;
    const float sphere = s_z + std::sqrt(left > 0 ? left : 0);
    const float bottom = middle + half;
    const float proved = bottom < sphere ? bottom : sphere;
    const float top = middle - half;
    const float wet = top > 0 ? top : 0;
    const bool clear = h2 * (x * x + tan2 * h2) < R2 * (x * x);
    p[i].bound_m = clear ? proved : wet;
    p[i].kind = clear ? Kind::kClear : beyond;
  }
}

// The same column by column, for cones that contain the vertical and for beams that leave the water.
void ReadingEvidence::judge_by_columns(const BeamCone& cone, double range_m, Kind beyond) {
  std::size_t kept = 0;
  for (std::size_t i = 0; i < count_; ++i) {
    PixelEvidence e = pixels_[i];
    const Vector2d at = grid_.centre({e.column, e.row});
    const auto interval = cone.depth_interval(at);
    if (!interval || interval->bottom_m < 0) continue;
    const double h2 = (at - cone.apex().head<2>()).squaredNorm();
    const double slant = cone.slant_range(at);
    const bool behind = std::isinf(slant);  // only in cones that contain the vertical; no echo is expected there
    if (slant < range_m || behind) {
      if (!(h2 < range_m * range_m)) continue;
      const double sphere = cone.apex().z() + std::sqrt(range_m * range_m - h2);
      const double proved = std::min(interval->bottom_m, sphere);
      if (proved < std::max(interval->top_m, 0.0)) continue;
      e.bound_m = static_cast<float>(proved);
      e.kind = Kind::kClear;
    } else {
      e.bound_m = static_cast<float>(std::max(interval->top_m, 0.0));
      e.kind = beyond;
    }
    pixels_[kept++] = e;
  }
  count_ = kept;
}

// S1-60, S1-61 as printed, for a level vehicle.
void ReadingEvidence::judge_by_planes(const BeamCone& cone, double range_m, Kind beyond) {
  const BeamAxes axes(cone, grid_);
  const double s_z = cone.apex().z();
  const DepthInterval unit = cone.planes(1);
  const auto top = static_cast<float>(unit.top_m - s_z);
  const auto bottom = static_cast<float>(unit.bottom_m - s_z);
  const auto z = static_cast<float>(s_z);
  const double plan = range_m * cone.cos_depression();
  const auto plan2 = static_cast<float>(plan * plan);
  for (std::size_t i = 0; i < count_; ++i) {
    PixelEvidence& e = pixels_[i];
    const auto column = static_cast<float>(e.column - axes.column);
    const auto row = static_cast<float>(e.row - axes.row);
    const float x = axes.x + column * axes.x_of_column + row * axes.x_of_row;
    const float y = axes.y + column * axes.y_of_column + row * axes.y_of_row;
    const float h2 = x * x + y * y;
    const float h = std::sqrt(h2);
    const float wet = z + h * top > 0 ? z + h * top : 0;
    const bool clear = h2 < plan2;
    e.bound_m = clear ? z + h * bottom : wet;
    e.kind = clear ? Kind::kClear : beyond;
  }
}

void ReadingEvidence::keep_only_clear() {
  const auto end = pixels_.begin() + static_cast<std::ptrdiff_t>(count_);
  const auto kept = std::remove_if(pixels_.begin(), end, [](const PixelEvidence& e) { return e.kind != Kind::kClear; });
  count_ = static_cast<std::size_t>(kept - pixels_.begin());
}

}  // namespace isobath
