#include <algorithm>
#include <cmath>
#include <isobath/base/error.hpp>
#include <isobath/sim/plane_section.hpp>
#include <numbers>

namespace isobath {
namespace {

using Eigen::Vector2d;

constexpr double kTurn = 2 * std::numbers::pi;

double cross_of(const Vector2d& a, const Vector2d& b) { return a.x() * b.y() - a.y() * b.x(); }
Vector2d heading_vector(double a) { return {std::cos(a), std::sin(a)}; }

bool within_arc(const SectionArc& arc, const Vector2d& from_centre) {
  const double at = std::atan2(from_centre.y(), from_centre.x()) - arc.first.radians();
  return at - kTurn * std::floor(at / kTurn) <= arc.sweep.radians();
}

/// Bounding box of the lines and arcs.
Eigen::AlignedBox2d box_about(const std::vector<SectionLine>& lines, const std::vector<SectionArc>& arcs) {
  Eigen::AlignedBox2d box;
  for (const SectionLine& line : lines) box.extend(line.a).extend(line.b);
  for (const SectionArc& arc : arcs) {
    for (const double a : {arc.first.radians(), (arc.first + arc.sweep).radians()}) {
      box.extend(Vector2d(arc.centre + arc.radius * heading_vector(a)));
    }
    for (int quarter = 0; quarter < 4; ++quarter) {
      const Vector2d u = heading_vector(quarter * std::numbers::pi / 2);
      if (within_arc(arc, u)) box.extend(Vector2d(arc.centre + arc.radius * u));
    }
  }
  return box;
}

Angle beam_bearing(const SectionSonarConfig& config, int beam) {
  if (config.sector >= Angle::degrees(360)) return Angle::radians(kTurn * beam / config.beams);
  return (config.middle + config.sector * ((beam + 0.5) / config.beams - 0.5)).wrapped_positive();
}

/// Adds multiples and false echoes. The false echoes are a Poisson process: a beam has none with probability
/// exp(-rate). Draws the same number of random numbers for each beam.
void add_false_echoes(const SectionSonarConfig& config, Random& random, SectionReading& reading) {
  const bool bounces = random.uniform() < config.multiple_share;
  const bool clutter = random.uniform() < 1 - std::exp(-config.clutter_per_turn / config.beams);
  const double clutter_m = random.uniform() * config.range_m;
  if (bounces && reading.range_m && reading.truth.incidence <= config.multiple_cone) {
    reading.range_m = 2 * *reading.range_m;
    reading.is = SectionEcho::kMultiple;
    if (*reading.range_m > config.range_m) reading.range_m.reset();
  }
  if (clutter && (!reading.range_m || clutter_m < *reading.range_m)) {
    reading.range_m = clutter_m;
    reading.is = SectionEcho::kClutter;
  }
}

}  // namespace

PlaneSection::PlaneSection(const Scene& scene, double depth) {
  for (std::size_t i = 0; i < scene.bodies.size(); ++i) {
    const auto* prism = std::get_if<Prism>(&scene.bodies[i].shape);
    if (!prism || depth < prism->top || depth > prism->bottom) continue;
    std::vector<SectionLine> lines;
    std::vector<SectionArc> arcs;
    const int object = static_cast<int>(i);
    for (std::size_t k = 0; k + 3 < prism->lines.size(); k += 4) {
      const double* row = prism->lines.data() + k;
      lines.push_back({{row[0], row[1]}, {row[2], row[3]}, object});
    }
    for (std::size_t k = 0; k + 4 < prism->arcs.size(); k += 5) {
      const double* row = prism->arcs.data() + k;
      const double sweep = row[4] - row[3];
      arcs.push_back({{row[0], row[1]},
                      row[2],
                      Angle::degrees(row[3]),
                      Angle::degrees(sweep > 0 ? std::min(sweep, 360.0) : sweep + 360),
                      object});
    }
    const Vector2d middle = box_about(lines, arcs).center();
    const double scale = 1 + (prism->bottom_scale - 1) * (depth - prism->top) / (prism->bottom - prism->top);
    const auto scaled = [&](const Vector2d& p) -> Vector2d { return middle + scale * (p - middle); };
    for (const SectionLine& line : lines) lines_.push_back({scaled(line.a), scaled(line.b), object});
    for (const SectionArc& arc : arcs) {
      arcs_.push_back({scaled(arc.centre), scale * arc.radius, arc.first, arc.sweep, object});
    }
  }
}

std::optional<SectionHit> PlaneSection::cast(const Vector2d& p, const Vector2d& u) const {
  std::optional<SectionHit> nearest;
  const auto meet = [&](double t, double cosine, int object) {
    if (!(t > 0) || (nearest && nearest->range <= t)) return;
    nearest = SectionHit{t, Angle::radians(std::acos(std::min(1.0, std::abs(cosine)))), object};
  };
  for (const SectionLine& line : lines_) {
    const Vector2d along = line.b - line.a, to = line.a - p;
    const double across = cross_of(u, along);
    if (across == 0) continue;  // parallel
    const double s = cross_of(to, u) / across;
    if (s >= 0 && s <= 1) meet(cross_of(to, along) / across, across / along.norm(), line.object);
  }
  for (const SectionArc& arc : arcs_) {
    const Vector2d m = p - arc.centre;
    const double b = u.dot(m), root = b * b - m.squaredNorm() + arc.radius * arc.radius;
    if (root < 0) continue;
    for (const double t : {-b - std::sqrt(root), -b + std::sqrt(root)}) {
      const Vector2d at = m + t * u;
      if (within_arc(arc, at)) meet(t, at.dot(u) / arc.radius, arc.object);
    }
  }
  return nearest;
}

std::vector<Field> fields(SectionSonarConfig& c) {
  using Pick = SectionSonarConfig::Pick;
  return {
      Field::integer("beams", &c.beams, {1, 3600}, "beams", "Beams per turn, or of the sector."),
      Field::degrees("sector_deg", &c.sector, {1, 360}, "Sector that the beams share."),
      Field::degrees("middle_deg", &c.middle, {-360, 360}, "Bearing of the sector's middle."),
      Field::degrees("beam_width_deg", &c.beam_width, {0.1, 60}, "Half-power width of a beam."),
      Field::integer("rays", &c.rays, {1, 1001}, "rays", "Rays per beam, side by side."),
      Field::choice("pick", &c.pick, {{"nearest", Pick::kNearest}, {"strongest", Pick::kStrongest}},
                    "Which ray of a beam gives the reading."),
      Field::real("range_m", &c.range_m, {0.1, 2000}, "m", "Maximum range."),
      Field::real("sigma_m", &c.sigma_m, {0, 10}, "m", "Minimum standard deviation of a range."),
      Field::real("sigma_share", &c.sigma_share, {0, 0.2}, "1", "Standard deviation of a range, as a share of it."),
      Field::degrees("sigma_deg", &c.sigma, {0, 30}, "Standard deviation of a bearing."),
      Field::flag("noise", &c.noise, "Whether readings have errors."),
      Field::real("multiple_share", &c.multiple_share, {0, 1}, "1",
                  "Share of hits near normal incidence that are reported at twice their range."),
      Field::degrees("multiple_cone_deg", &c.multiple_cone, {0, 90}, "Largest incidence of these hits."),
      Field::real("clutter_per_turn", &c.clutter_per_turn, {0, 1000}, "echoes",
                  "False echoes per turn, at random ranges."),
  };
}

std::vector<SectionReading> scan(const PlaneSection& section, const Vector2d& p, const SectionSonarConfig& config,
                                 Random& random) {
  std::vector<SectionReading> readings;
  readings.reserve(static_cast<std::size_t>(config.beams));
  for (int beam = 0; beam < config.beams; ++beam) {
    const Angle bearing = beam_bearing(config, beam);
    SectionReading reading{bearing, {}, SectionEcho::kDirect, {}};
    double best = -1;
    for (int ray = 0; ray < config.rays; ++ray) {
      const double aside = config.beam_width.radians() * ((ray + 0.5) / config.rays - 0.5);
      const auto hit = section.cast(p, heading_vector(bearing.radians() + aside));
      if (!hit || hit->range > config.range_m) continue;
      const bool nearest = config.pick == SectionSonarConfig::Pick::kNearest;
      const double merit = nearest ? 1 / hit->range : std::pow(cos(hit->incidence), 2) / std::pow(hit->range, 4);
      if (merit <= best) continue;
      best = merit;
      reading.truth = *hit;
      reading.range_m = hit->range;
    }
    if (config.noise) {
      // Drawn with or without an echo, so that a beam's echo does not change the errors of the next beams.
      const double in_range = random.normal();
      const double in_angle = random.normal();
      reading.bearing = (reading.bearing + config.sigma * in_angle).wrapped_positive();
      if (reading.range_m) {
        const double sigma = std::max(config.sigma_m, config.sigma_share * *reading.range_m);
        reading.range_m = std::max(0.0, *reading.range_m + sigma * in_range);
      }
    }
    if (config.multiple_share > 0 || config.clutter_per_turn > 0) add_false_echoes(config, random, reading);
    readings.push_back(reading);
  }
  return readings;
}

ScanPath scan_path(const Scene& scene, int count, Random& random) {
  std::vector<Eigen::Vector3d> corners{scene.vehicle.start};
  std::vector<double> at{0};  // distance along the path
  for (const WaypointConfig& w : scene.waypoints) {
    corners.emplace_back(w.north, w.east, w.depth);
    at.push_back(at.back() + (corners.back() - corners[corners.size() - 2]).head<2>().norm());
  }
  if (corners.size() < 2 || !(at.back() > 0)) {
    throw Error("the vehicle has no path", scene.vehicle.place, "at least one [[waypoint]] apart from the start");
  }
  constexpr int kPartsOfLeg = 20;  // parts between two scans, so that the path shows the dive
  const int parts = std::max(1, count - 1) * kPartsOfLeg;
  const double speed = scene.vehicle.speed > 0 ? scene.vehicle.speed : 1;
  ScanPath made;
  double noise = 0;
  for (int i = 0; i <= parts; ++i) {
    const double way = at.back() * i / parts;
    const auto leg = static_cast<std::size_t>(std::clamp<std::ptrdiff_t>(
        std::upper_bound(at.begin(), at.end(), way) - at.begin(), 1, static_cast<std::ptrdiff_t>(at.size()) - 1));
    const double share = at[leg] > at[leg - 1] ? (way - at[leg - 1]) / (at[leg] - at[leg - 1]) : 0;
    Eigen::Vector3d p = corners[leg - 1] + share * (corners[leg] - corners[leg - 1]);
    const Eigen::Vector2d along = (corners[leg] - corners[leg - 1]).head<2>();
    // slow noise: correlation 0.5 from one scan to the next
    const double keep = std::pow(0.5, 1.0 / kPartsOfLeg);
    noise = keep * noise + std::sqrt(1 - keep * keep) * scene.vehicle.dive_noise * random.normal();
    const double phase = kTurn * way / speed / scene.vehicle.dive_period_s;
    p.z() = std::max(0.0, p.z() + scene.vehicle.dive_amplitude * std::sin(phase) + noise);
    made.path.push_back(p);
    if (i % kPartsOfLeg == 0 && static_cast<int>(made.scans.size()) < count) {
      made.scans.push_back(
          {static_cast<int>(made.scans.size()) + 1, p, Angle::radians(std::atan2(along.y(), along.x()))});
    }
  }
  return made;
}

}  // namespace isobath
