#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <isobath/base/random.hpp>
#include <isobath/sim/clutter.hpp>
#include <isobath/sim/encounters.hpp>
#include <optional>

namespace isobath {
namespace {

using Eigen::Vector2d;
using Kind = EncounterKind;

constexpr int kEncounterTries = 1000;
constexpr double kApart_m = 1;  // between the hulls of two targets at the start

/// The kinds that may follow one in a situation, in the order of the baseline situations.
std::vector<Kind> kinds_after(Kind kind) {
  switch (kind) {
    case Kind::kHeadOn:
      return {Kind::kHeadOn, Kind::kFromStarboard, Kind::kFromPort, Kind::kOvertaken, Kind::kOvertaking};
    case Kind::kFromStarboard: return {Kind::kFromStarboard, Kind::kFromPort, Kind::kOvertaken, Kind::kOvertaking};
    case Kind::kFromPort: return {Kind::kFromPort, Kind::kOvertaking, Kind::kOvertaken};
    case Kind::kOvertaken: return {Kind::kOvertaken, Kind::kOvertaking};
    case Kind::kOvertaking: return {Kind::kOvertaking};
  }
  return {};
}

std::vector<EncounterSituation> all_situations() {
  std::vector<EncounterSituation> all, before{{}};
  for (int targets = 1; targets <= 3; ++targets) {
    std::vector<EncounterSituation> longer;
    for (const EncounterSituation& situation : before) {
      for (const Kind kind : kinds_after(situation.empty() ? Kind::kHeadOn : situation.back())) {
        longer.push_back(situation);
        longer.back().push_back(kind);
      }
    }
    all.insert(all.end(), longer.begin(), longer.end());
    before = std::move(longer);
  }
  return all;
}

struct MeetingTarget {
  Vector2d start_W, velocity_W;
};

/// One draw; empty where no course leads to the meeting, or the vehicle is seen under another aspect.
std::optional<MeetingTarget> draw_target(Random& random, Kind kind, const EncounterConfig& config,
                                         const EncounteredVehicle& vehicle) {
  const EncounterBounds& bounds = encounter_bounds(kind);
  const Angle bearing = Angle::degrees(random.uniform(bounds.bearing_deg[0], bounds.bearing_deg[1]));
  const double ratio = random.uniform(bounds.speed_ratio[0], bounds.speed_ratio[1]);
  const double meeting_s = random.uniform(config.meeting_s[0], config.meeting_s[1]);
  const double side = std::abs(sin(bearing));
  if (side > ratio) return std::nullopt;
  const double root = std::sqrt(ratio * ratio - side * side);
  const bool overtaken = kind == Kind::kOvertaken;
  const double closing = cos(bearing) + (overtaken ? -root : root);  // in speeds of the vehicle
  const double bow_deg = Angle::radians(std::asin(side / ratio)).degrees();
  const double aspect_deg = overtaken ? 180 - bow_deg : bow_deg;
  if (closing <= 0 || aspect_deg < bounds.aspect_deg[0] || aspect_deg > bounds.aspect_deg[1]) return std::nullopt;
  const Angle towards = vehicle.course + bearing;
  const Vector2d distance = vehicle.speed * meeting_s * closing * Vector2d(cos(towards), sin(towards));
  const Vector2d meeting =
      vehicle.start_W + vehicle.speed * meeting_s * Vector2d(cos(vehicle.course), sin(vehicle.course));
  const Vector2d start = vehicle.start_W + distance;
  return MeetingTarget{start, (meeting - start) / meeting_s};
}

Body target_body(const MeetingTarget& target, const EncounterConfig& config, double duration_s) {
  const double depth = (config.top_m + config.bottom_m) / 2;
  const Vector2d from = target.start_W.unaryExpr(&whole_cm);
  const Vector2d to = (target.start_W + duration_s * target.velocity_W).unaryExpr(&whole_cm);
  Body body;
  body.shape = Cylinder{
      .centre = {from.x(), from.y(), depth}, .radius = config.radius_m, .length = config.bottom_m - config.top_m};
  body.path = {0, from.x(), from.y(), depth, duration_s, to.x(), to.y(), depth};
  return body;
}

}  // namespace

const char* to_text(EncounterKind kind) {
  switch (kind) {
    case Kind::kHeadOn: return "head-on";
    case Kind::kFromStarboard: return "crossing from starboard";
    case Kind::kFromPort: return "crossing from port";
    case Kind::kOvertaken: return "overtaken";
    case Kind::kOvertaking: return "overtaking";
  }
  return "";
}

const EncounterBounds& encounter_bounds(EncounterKind kind) {
  static constexpr std::array<EncounterBounds, 5> kBounds{{{{-5, 5}, {0.5, 1.8}, {0, 5}},
                                                           {{9, 102}, {0.6, 1.8}, {5, 112.5}},
                                                           {{-110, -30}, {0.6, 1.7}, {5, 112.5}},
                                                           {{8, 35}, {0.4, 0.8}, {112.5, 180}},
                                                           {{150, 210}, {1.5, 1.9}, {0, 112.5}}}};
  return kBounds[static_cast<std::size_t>(kind)];
}

const std::vector<EncounterSituation>& encounter_situations() {
  static const std::vector<EncounterSituation> kAll = all_situations();
  return kAll;
}

std::string to_text(const EncounterSituation& situation) {
  std::vector<const char*> names;
  for (const EncounterKind kind : situation) names.push_back(to_text(kind));
  return fmt::format("{}", fmt::join(names, ", "));
}

std::vector<Field> fields(EncounterConfig& c) {
  return {
      Field::flag("on", &c.on,
                  "Whether one to three bodies meet the vehicle in each run, in the situations of ships; the runs "
                  "take the 55 situations in turn."),
      Field::numbers("meeting_s", c.meeting_s.data(), 2, {1, 1e4}, "s",
                     "Minimum and maximum time after which a vehicle that goes straight meets a body."),
      Field::real("radius_m", &c.radius_m, {0.05, 20}, "m", "Radius of the bodies."),
      Field::real("free_m", &c.free_m, {0, 1000}, "m", "Minimum distance of the bodies from the vehicle at the start."),
      Field::real("top_m", &c.top_m, {-100, 12000}, "m", "Depth of their tops."),
      Field::real("bottom_m", &c.bottom_m, {-100, 12000}, "m", "Depth of their feet.")};
}

std::vector<Body> encounter_bodies(const EncounterConfig& c, const EncounterSituation& situation,
                                   const EncounteredVehicle& vehicle, std::uint64_t seed, double duration_s) {
  if (c.bottom_m <= c.top_m) throw Error("does not lie below top_m", {.key = "encounters.bottom_m"}, "more than top_m");
  Random random(seed);
  std::vector<Body> bodies;
  std::vector<Vector2d> starts;
  for (const EncounterKind kind : situation) {
    Random own = random.fork();  // the number of tries of one target does not move the others
    std::optional<MeetingTarget> target;
    for (int attempt = 0; attempt < kEncounterTries && !target; ++attempt) {
      target = draw_target(own, kind, c, vehicle);
      if (!target) continue;
      const bool apart = std::all_of(starts.begin(), starts.end(), [&](const Vector2d& other) {
        return (other - target->start_W).norm() >= 2 * c.radius_m + kApart_m;
      });
      if (!apart || (target->start_W - vehicle.start_W).norm() < c.free_m + c.radius_m) target.reset();
    }
    if (!target) {
      throw Error(fmt::format("{:g} leaves no place for a body that is {}", c.free_m, to_text(kind)),
                  {.key = "encounters.free_m"}, "less, or later meetings (meeting_s)");
    }
    starts.push_back(target->start_W);
    bodies.push_back(target_body(*target, c, duration_s));
    bodies.back().name = fmt::format("{} {}", to_text(kind), bodies.size());
  }
  return bodies;
}

}  // namespace isobath
