#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <isobath/evaluation/mission_story.hpp>
#include <isobath/geometry/polygon_parts.hpp>
#include <limits>
#include <optional>

namespace isobath {
namespace {

using Eigen::Vector2d;

// Where a scan must look for its silence to say that an obstacle has faded: within the sector of the sonars used.
constexpr double kLooks_m = 45;
constexpr Angle kLooks = Angle::degrees(40);

/// When a stage happened, and where.
struct Happening {
  double time_s = 0;
  std::optional<Vector2d> place;
};

bool looks_at(const StoryLog::Scan& scan, const Vector2d& place) {
  const Vector2d there = place - scan.X_WB.translation.head<2>();
  const Angle bearing = Angle::radians(std::atan2(there.y(), there.x())) - scan.X_WB.rotation.heading();
  return there.norm() < kLooks_m && std::abs(bearing.wrapped().radians()) < kLooks.radians();
}

/// Looks for the stages of one run in turn.
class StoryReader {
 public:
  StoryReader(const Scenario& scenario, const std::vector<Polygon>& bodies, const StoryLog& log,
              const LoopResult& result)
      : mission_(scenario.mission), bodies_(bodies), scans_(log.scans()), decisions_(result.decisions) {}

  [[nodiscard]] std::optional<double> start() const {
    for (const Decision& d : decisions_) {
      if (d.agent == "captain" && d.what == "start") return to_seconds(d.time);
    }
    return std::nullopt;
  }
  /// The stage at or after `from_s`.
  std::optional<Happening> find(const StoryStage& stage, double from_s) {
    switch (stage.what) {
      case StageKind::kSeen:
      case StageKind::kSpurious: return seen(stage, from_s);
      case StageKind::kFaded: return faded(stage, from_s);
      case StageKind::kPlanned:
      case StageKind::kReplanned:
      case StageKind::kDropped: return decided(stage, from_s);
    }
    return std::nullopt;
  }
  [[nodiscard]] int scans_between(double after_s, double until_s) const {
    return static_cast<int>(std::count_if(scans_.begin(), scans_.end(), [&](const StoryLog::Scan& scan) {
      return scan.time_s > after_s && scan.time_s <= until_s;
    }));
  }

 private:
  std::optional<Happening> seen(const StoryStage& stage, double from_s) {
    seen_.clear();
    for (const StoryLog::Scan& scan : scans_) {
      if (scan.time_s < from_s) continue;
      for (const Polygon& outline : scan.outlines) {
        const bool fits = stage.what == StageKind::kSeen ? distance_from(outline, stage.at) <= stage.within_m
                                                         : gap_between(bodies_, outline) > stage.within_m;
        if (fits) seen_.push_back({scan.time_s, stage.what == StageKind::kSeen ? stage.at : outline.front()});
      }
    }
    return seen_.empty() ? std::nullopt : std::optional(seen_.front());
  }
  /// Whether a scan after `from_s` looks at the place and shows nothing there; when.
  std::optional<Happening> gone(const StoryStage& stage, const Vector2d& place, double from_s) const {
    for (const StoryLog::Scan& scan : scans_) {
      if (scan.time_s <= from_s || !looks_at(scan, place)) continue;
      const bool shown = std::any_of(scan.outlines.begin(), scan.outlines.end(), [&](const Polygon& outline) {
        return distance_from(outline, place) <= stage.within_m;
      });
      if (!shown) return Happening{scan.time_s, place};
    }
    return std::nullopt;
  }
  std::optional<Happening> faded(const StoryStage& stage, double from_s) const {
    std::optional<Happening> first;
    for (const Happening& seen : seen_) {
      const auto one = gone(stage, *seen.place, std::max(from_s, seen.time_s));
      if (one && (!first || one->time_s < first->time_s)) first = one;
    }
    return first;
  }
  std::optional<Happening> decided(const StoryStage& stage, double from_s) const {
    for (const Decision& d : decisions_) {
      if (to_seconds(d.time) < from_s || d.reason.find(stage.reason) == std::string::npos) continue;
      if (fits(stage, d)) return Happening{to_seconds(d.time), d.obstacle};
    }
    return std::nullopt;
  }
  /// A replan names its obstacle. A plan does not: its straight line would have passed the place, and it has corners.
  [[nodiscard]] bool goes_round(const StoryStage& stage, const Decision& d) const {
    if (d.agent != "navigator" || d.way.size() < 2) return false;
    if (d.what == "replan") return d.obstacle && (*d.obstacle - stage.at).norm() <= stage.within_m;
    if (d.what != "plan") return false;
    Vector2d from = d.way.front();
    for (const StoryLog::Scan& scan : scans_) {
      if (scan.time_s <= to_seconds(d.time)) from = scan.X_WB.translation.head<2>();
    }
    return distance_from(Polygon{from, d.way.back()}, stage.at) <= stage.within_m;
  }
  [[nodiscard]] bool fits(const StoryStage& stage, const Decision& d) const {
    if (stage.what == StageKind::kReplanned) return goes_round(stage, d);
    const auto point = std::find_if(mission_.points.begin(), mission_.points.end(),
                                    [&](const MissionPoint& p) { return p.name == stage.point; });
    if (point == mission_.points.end()) return false;
    if (stage.what == StageKind::kPlanned) {
      return d.agent == "navigator" && d.what == "plan" && !d.way.empty() &&
             (d.way.back() - point->north_east).norm() < 1e-6;
    }
    return d.agent == "executive officer" && d.what == "drop point" && d.reason.find(point->name) != std::string::npos;
  }

  const MissionPlan& mission_;
  const std::vector<Polygon>& bodies_;
  const std::vector<StoryLog::Scan>& scans_;
  const std::vector<Decision>& decisions_;
  std::vector<Happening> seen_;  ///< all that fits the last stage seen or spurious
};

double nearest_to_injected(const MissionPlan& mission, const std::vector<TrueMotion>& track) {
  double least = std::numeric_limits<double>::infinity();
  for (const InjectedMap& map : mission.injected) {
    for (const Polygon& outline : map.outlines) {
      for (const TrueMotion& m : track)
        least = std::min(least, distance_from(outline, m.state.X_WB.translation.head<2>()));
    }
  }
  return std::isfinite(least) ? least : -1;
}

}  // namespace

std::vector<Field> fields(StoryStage& stage) {
  return {Field::text("name", &stage.name, "What happens, in a few words."),
          Field::choice(
              "what", &stage.what,
              {{"seen", StageKind::kSeen},
               {"spurious", StageKind::kSpurious},
               {"faded", StageKind::kFaded},
               {"planned", StageKind::kPlanned},
               {"replanned", StageKind::kReplanned},
               {"dropped", StageKind::kDropped}},
              "seen: a scan shows an obstacle at `at`; spurious: a scan shows one where no body is; faded: a scan "
              "looks at one of these and no longer shows it; planned: a leg to `point`; "
              "replanned: a route around `at`; dropped: `point`."),
          Field::numbers("at", stage.at.data(), 2, {-1e5, 1e5}, "m", "Place of the obstacle: north, east."),
          Field::real("within_m", &stage.within_m, {0, 1000}, "m",
                      "Maximum distance from the place; for spurious the minimum distance from every body."),
          Field::text("point", &stage.point, "Name of the mission point that is planned or dropped."),
          Field::text("reason", &stage.reason, "Text that the reason of the decision contains; empty: any."),
          Field::numbers("after_s", stage.after_s.data(), 2, {0, 1e6}, "s",
                         "Minimum and maximum time since the stage before, or since the start of the mission."),
          Field::numbers("scans", stage.scans.data(), 2, {0, 1e6}, "",
                         "Minimum and maximum number of scans since the stage before.")};
}

void StoryLog::on_scan(const ScanResult& scan) {
  Scan& one = scans_.emplace_back(Scan{to_seconds(scan.detection.time), scan.detection.X_WB, {}});
  for (const Obstacle& o : scan.detection.obstacles) one.outlines.push_back(world_outline(o, scan.detection.X_WB));
}

StoryCheck follow_story(const std::vector<StoryStage>& stages, const Scenario& scenario,
                        const std::vector<Polygon>& bodies, const StoryLog& log, const LoopResult& result) {
  StoryCheck check;
  check.min_injected_m = nearest_to_injected(scenario.mission, result.track);
  StoryReader reader(scenario, bodies, log, result);
  std::optional<double> last = reader.start();
  for (const StoryStage& stage : stages) {
    if (!last) {
      check.failure = "the mission was not started";
      return check;
    }
    const std::optional<Happening> event = reader.find(stage, *last);
    if (!event) {
      check.failure = stage.name + ": did not happen";
      return check;
    }
    const double after_s = event->time_s - *last;
    const int scans = reader.scans_between(*last, event->time_s);
    if (after_s < stage.after_s[0] || after_s > stage.after_s[1]) {
      check.failure = fmt::format("{}: after {:.1f} s", stage.name, after_s);
    } else if (scans < stage.scans[0] || scans > stage.scans[1]) {
      check.failure = fmt::format("{}: after {} scans", stage.name, scans);
    }
    if (!check.failure.empty()) return check;
    check.after_s.push_back(after_s);
    check.scans.push_back(scans);
    last = event->time_s;
  }
  return check;
}

}  // namespace isobath
