#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <isobath/base/random.hpp>
#include <isobath/geometry/polygon.hpp>
#include <isobath/sim/clutter.hpp>

namespace isobath {
namespace {

using Eigen::Vector2d;

constexpr int kTries = 200;
constexpr double kLegs_m = 20;         // approximate length of a leg of the passage
constexpr double kSlope = 0.7;         // maximum slope of a leg against the straight line: the passage never turns back
constexpr double kSample_m = 0.25;     // spacing of the points of the passage at which distances are checked
constexpr double kThick_m = 0.4;       // thickness of walls
constexpr double kSquareMetres = 1e4;  // a hectare

double draw_cm(Random& random, double low, double high) { return whole_cm(random.uniform(low, high)); }

/// Whole degrees in [0, 180): an upright body looks the same after half a turn.
int draw_heading(Random& random) { return static_cast<int>(random.index(180)); }

Vector2d along(int heading_deg) {
  const Angle a = Angle::degrees(heading_deg);
  return {cos(a), sin(a)};
}

/// The plan area of a body: everything within `round` of a convex outline.
struct Footprint {
  Polygon outline;
  double round = 0;
  [[nodiscard]] double distance(const Vector2d& p) const { return (nearest_point(outline, p) - p).norm() - round; }
};

struct Placed {
  const char* kind = "";
  Body body;
  Footprint footprint;
};

Placed pole(Random& random, const Vector2d& at, const ClutterConfig& c) {
  Cylinder shape;
  shape.centre = {at.x(), at.y(), (c.top_m + c.bottom_m) / 2};
  shape.radius = draw_cm(random, 0.2, 0.8);
  shape.length = c.bottom_m - c.top_m;
  Placed placed;
  placed.kind = "pole";
  placed.footprint = {{at}, shape.radius};
  placed.body.shape = shape;
  return placed;
}

Placed upright_box(const char* kind, const Vector2d& at, double length, double breadth, int heading,
                   const ClutterConfig& c) {
  Box shape;
  shape.centre = {at.x(), at.y(), (c.top_m + c.bottom_m) / 2};
  shape.size = {length, breadth, c.bottom_m - c.top_m};
  shape.heading = Angle::degrees(heading);
  const Vector2d u = 0.5 * length * along(heading);
  const Vector2d v = 0.5 * breadth * Vector2d(-along(heading).y(), along(heading).x());
  Placed placed;
  placed.kind = kind;
  placed.footprint.outline = {at + u + v, at - u + v, at - u - v, at + u - v};
  placed.body.shape = shape;
  return placed;
}

Placed box(Random& random, const Vector2d& at, const ClutterConfig& c) {
  const double length = draw_cm(random, 2, 7);
  const double breadth = draw_cm(random, 2, 7);
  return upright_box("box", at, length, breadth, draw_heading(random), c);
}

Placed wall(Random& random, const Vector2d& at, const ClutterConfig& c) {
  const double length = draw_cm(random, 6, 16);
  return upright_box("wall", at, length, kThick_m, draw_heading(random), c);
}

std::vector<Vector2d> passage_of(Random& random, const ClutterConfig& c) {
  std::vector<Vector2d> way{Vector2d::Zero()};
  const double within = std::min(c.wander_m, (c.breadth_m - c.passage_m) / 2);
  const int legs = std::max(2, static_cast<int>(c.length_m / kLegs_m));
  const double leg = c.length_m / legs;
  for (int i = 1; i < legs; ++i) {
    // The remaining legs must be able to return to the straight line.
    const double back = std::min(within, kSlope * leg * (legs - i));
    const double low = std::max(-back, way.back().y() - kSlope * leg);
    const double high = std::min(back, way.back().y() + kSlope * leg);
    const double east = draw_cm(random, low, high);
    way.emplace_back(whole_cm(leg * i), east);
  }
  way.emplace_back(c.length_m, 0);
  return way;
}

bool clear_of(const Footprint& footprint, const std::vector<Vector2d>& way, double distance) {
  for (std::size_t i = 0; i + 1 < way.size(); ++i) {
    const Vector2d leg = way[i + 1] - way[i];
    const int parts = std::max(1, static_cast<int>(std::ceil(leg.norm() / kSample_m)));
    for (int k = 0; k <= parts; ++k) {
      if (footprint.distance(way[i] + leg * (static_cast<double>(k) / parts)) < distance + kSample_m / 2) return false;
    }
  }
  return true;
}

void check_clutter(const ClutterConfig& c) {
  const auto refuse = [](const std::string& key, const std::string& problem, const std::string& allowed) {
    throw Error(problem, {.key = "clutter." + key}, allowed);
  };
  if (2 * c.free_m >= c.length_m) {
    refuse("free_m", fmt::format("{:g} leaves no field between start and goal", c.free_m),
           fmt::format("less than {:g}", c.length_m / 2));
  }
  if (c.passage_m > c.breadth_m) {
    refuse("passage_m", fmt::format("{:g} is wider than the field", c.passage_m),
           fmt::format("at most {:g}", c.breadth_m));
  }
  if (c.pole_share + c.box_share > 1) refuse("box_share", "the shares exceed 1", "at most 1 - pole_share");
  if (c.bottom_m <= c.top_m) refuse("bottom_m", "does not lie below top_m", "more than top_m");
}

/// A disc that reflects at the sides of the field.
Body moving_disc(Random random, const ClutterConfig& c, int number, double duration_s) {
  Vector2d at;
  do {
    at = {draw_cm(random, 0, c.length_m), draw_cm(random, -c.breadth_m / 2, c.breadth_m / 2)};
  } while (at.norm() < c.free_m);
  const Angle course = Angle::degrees(static_cast<int>(random.index(360)));
  Vector2d velocity = whole_cm(random.uniform(0, c.moving_speed)) * Vector2d(cos(course), sin(course));
  const double depth = (c.top_m + c.bottom_m) / 2;
  const Vector2d low(0, -c.breadth_m / 2), high(c.length_m, c.breadth_m / 2);
  Body body;
  body.name = fmt::format("moving {}", number);
  body.shape = Cylinder{.centre = {at.x(), at.y(), depth}, .radius = c.moving_radius_m, .length = c.bottom_m - c.top_m};
  body.path = {0, at.x(), at.y(), depth};
  for (double t = 0; t < duration_s;) {
    double leg = duration_s - t;
    int side = -1;
    for (int i = 0; i < 2; ++i) {
      if (std::abs(velocity[i]) < 1e-9) continue;
      const double until = ((velocity[i] > 0 ? high[i] : low[i]) - at[i]) / velocity[i];
      if (until < leg) {
        leg = std::max(until, 0.0);
        side = i;
      }
    }
    at += leg * velocity;
    t += leg;
    if (leg > 0) body.path.insert(body.path.end(), {t, at.x(), at.y(), depth});
    if (side >= 0) velocity[side] = -velocity[side];
  }
  return body;
}

Body basin_wall(const ClutterConfig& c) {
  // Sonar sees the inside: walls along the field's sides, and behind start and goal.
  const double side = c.breadth_m / 2, south = -c.free_m, north = c.length_m + c.free_m;
  Wall shape;
  shape.line = {south, -side, north, -side, north, side, south, side, south, -side};
  shape.top = c.top_m;
  shape.bottom = c.bottom_m;
  Body body;
  body.name = "basin";
  body.shape = shape;
  return body;
}

}  // namespace

double whole_cm(double metres) { return std::round(metres * 100) / 100; }

std::vector<Field> fields(ClutterConfig& c) {
  return {Field::real("density", &c.density, {0, 1000}, "1/ha", "Bodies per hectare; 0: no field."),
          Field::real("length_m", &c.length_m, {20, 1000}, "m",
                      "Distance from the start to the goal, which lies to the north."),
          Field::real("breadth_m", &c.breadth_m, {10, 1000}, "m",
                      "Width of the field, centred on the line from start to goal."),
          Field::real("free_m", &c.free_m, {2, 500}, "m", "Radius around start and goal that is kept free of bodies."),
          Field::real("passage_m", &c.passage_m, {0, 1000}, "m", "Width of a path that is left free; 0: none."),
          Field::real("wander_m", &c.wander_m, {0, 500}, "m", "Largest distance of that path from the straight line."),
          Field::real("pole_share", &c.pole_share, {0, 1}, "1", "Share of poles, 0.2 to 0.8 m in radius."),
          Field::real("box_share", &c.box_share, {0, 1}, "1",
                      "Share of boxes, 2 to 7 m; the rest are walls, 6 to 16 m by 0.4 m."),
          Field::real("top_m", &c.top_m, {-100, 12000}, "m", "Depth of their tops."),
          Field::real("bottom_m", &c.bottom_m, {-100, 12000}, "m", "Depth of their feet."),
          Field::flag("basin", &c.basin, "Whether vertical walls surround the field."),
          Field::integer("moving", &c.moving, {0, 1000}, "1", "Number of bodies that move."),
          Field::real("moving_speed", &c.moving_speed, {0, 10}, "m/s", "Their greatest speed."),
          Field::real("moving_radius_m", &c.moving_radius_m, {0.05, 20}, "m", "Their radius.")};
}

ClutterField clutter_field(const ClutterConfig& c, std::uint64_t seed, double duration_s) {
  check_clutter(c);
  ClutterField field;
  if (c.density <= 0 && c.moving <= 0) return field;
  Random random(seed);
  Random way = random.fork();
  if (c.passage_m > 0) field.passage = passage_of(way, c);
  const double inside = c.length_m - 2 * c.free_m;
  const Vector2d start = Vector2d::Zero(), goal(c.length_m, 0);
  const long wanted = std::lround(c.density * inside * c.breadth_m / kSquareMetres);
  for (long i = 0; i < wanted; ++i) {
    Random one = random.fork();  // the number of tries of one body does not move the others
    for (int attempt = 0; attempt < kTries; ++attempt) {
      const double north = draw_cm(one, c.free_m, c.length_m - c.free_m);
      const double left = one.uniform();
      const double right = one.uniform();
      const Vector2d at(north, whole_cm((left + right - 1) * c.breadth_m / 2));
      const double kind = one.uniform();
      Placed placed = kind < c.pole_share                 ? pole(one, at, c)
                      : kind < c.pole_share + c.box_share ? box(one, at, c)
                                                          : wall(one, at, c);
      const bool room = placed.footprint.distance(start) >= c.free_m && placed.footprint.distance(goal) >= c.free_m;
      if (!room || !clear_of(placed.footprint, field.passage, c.passage_m / 2)) continue;
      const std::size_t number = field.bodies.size() + 1;
      placed.body.name = fmt::format("{} {}", placed.kind, number);
      field.bodies.push_back(std::move(placed.body));
      break;
    }
  }
  for (int i = 0; i < c.moving; ++i) field.bodies.push_back(moving_disc(random.fork(), c, i + 1, duration_s));
  if (c.basin) field.bodies.push_back(basin_wall(c));
  return field;
}

}  // namespace isobath
