#include <algorithm>
#include <cmath>
#include <isobath/display/obstacle_display.hpp>
#include <isobath/map/occupancy/whole_obstacle.hpp>
#include <map>
#include <nlohmann/json.hpp>
#include <utility>

namespace isobath {
namespace {

using nlohmann::ordered_json;

/// Rounded to a millimetre, finer than any picture.
ordered_json rounded(double value) {
  if (!std::isfinite(value)) return nullptr;
  return std::round(value * 1e3) / 1e3;
}

/// Rounded to a tenth, of a second or a metre.
double rounded_to_tenth(double value) { return std::round(value * 10) / 10; }

ordered_json place_of(const Eigen::Vector2d& p) { return ordered_json::array({rounded(p.x()), rounded(p.y())}); }

ordered_json covariance_json(const Eigen::Matrix2d& c) {
  return ordered_json::array({rounded(c(0, 0)), rounded(c(0, 1)), rounded(c(1, 1))});
}

ordered_json corners_json(const Polygon& outline) {
  ordered_json corners = ordered_json::array();
  for (const Eigen::Vector2d& p : outline) corners.push_back(place_of(p));
  return corners;
}

/// What the agents remember of one obstacle.
struct Remembered {
  std::vector<Polygon> outlines;
  Time first_seen = Time::max(), last_seen = Time::min();
  double existence = 0;
};

std::map<int, Remembered> remembered_by_number(const KnownObstacles* known) {
  std::map<int, Remembered> all;
  if (known == nullptr) return all;
  for (const RememberedObstacle& o : known->obstacles) {
    Remembered& of = all[o.number];
    of.outlines.push_back(o.outline_W);
    of.first_seen = std::min(of.first_seen, o.first_seen);
    of.last_seen = std::max(of.last_seen, o.last_seen);
    of.existence = std::max(of.existence, o.existence);
  }
  return all;
}

}  // namespace

void ObstacleDisplay::update(const ScanResult& scan, Time start) {
  const Pose X_WL = level(scan.detection.X_WB);
  const auto in_world = [&](const Eigen::Vector2d& p) -> Eigen::Vector2d {
    return (X_WL * Eigen::Vector3d(p.x(), p.y(), 0)).head<2>();
  };
  scan_ = scan.number;
  scanned_ = scan.detection.time;
  seen_ = scan.detection.obstacles;
  for (Obstacle& o : seen_) {
    o.nearest = in_world(o.nearest);
    o.outline = world_outline(o, scan.detection.X_WB);
  }
  show(scan.detection.time, start);
}

void ObstacleDisplay::update(std::shared_ptr<const KnownObstacles> known, Time now, Time start) {
  known_ = std::move(known);
  if (known_) trails_.update(*known_);
  show(now, start);
}

std::optional<Eigen::Vector2d> ObstacleDisplay::predicted(int number, Time time) const {
  const auto body = std::find_if(seen_.begin(), seen_.end(), [number](const Obstacle& o) {
    return o.number == number && (o.moves() || o.may_move) && !o.outline.empty();
  });
  if (body == seen_.end()) return std::nullopt;
  Eigen::Vector2d middle = Eigen::Vector2d::Zero();
  for (const Eigen::Vector2d& p : body->outline) middle += p / static_cast<double>(body->outline.size());
  return middle + to_seconds(time - scanned_) * body->motion.velocity_W;
}

void ObstacleDisplay::show(Time now, Time start) {
  ordered_json pieces = ordered_json::array();
  for (std::size_t i = 0; i < seen_.size(); ++i) pieces.push_back(seen_json(i));
  if (known_) {
    for (const RememberedObstacle& o : known_->obstacles) pieces.push_back(remembered_json(o, start));
  }
  const ordered_json json{{"obstacles", whole_json(start)}, {"pieces", std::move(pieces)}};
  items_.set(DisplayKind::kObstacles, 0, now, json.dump(-1, ' ', false, ordered_json::error_handler_t::replace));
}

/// The obstacles of the scan, nearest first, then those that are only remembered, in the order of their numbers.
ordered_json ObstacleDisplay::whole_json(Time start) const {
  std::map<int, Remembered> remembered = remembered_by_number(known_.get());
  ordered_json all = ordered_json::array();
  const auto add_times = [&](ordered_json& json, const Remembered& of) {
    json["since_s"] = rounded_to_tenth(to_seconds(of.first_seen - start));
    json["seen_s"] = rounded_to_tenth(to_seconds(of.last_seen - start));
  };
  for (const WholeObstacle& o : whole_obstacles(seen_)) {
    ordered_json& json = all.emplace_back(ordered_json{{"number", o.number},
                                                       {"kind", o.kind()},
                                                       {"extent_m", rounded(o.extent_m)},
                                                       {"pieces", o.pieces},
                                                       {"existence", rounded(o.existence)},
                                                       {"in_scan", true},
                                                       {"nearest", place_of(o.nearest->nearest)},
                                                       {"range_m", rounded(o.nearest->range_m)},
                                                       {"behind", o.behind}});
    const auto known = remembered.find(o.number);
    if (known == remembered.end()) continue;
    add_times(json, known->second);
    remembered.erase(known);
  }
  for (const auto& [number, of] : remembered) {
    const double extent = extent_of(of.outlines);
    ordered_json& json = all.emplace_back(ordered_json{{"number", number},
                                                       {"kind", kind_of_obstacle(extent)},
                                                       {"extent_m", rounded(extent)},
                                                       {"pieces", of.outlines.size()},
                                                       {"existence", rounded(of.existence)},
                                                       {"in_scan", false}});
    add_times(json, of);
  }
  return all;
}

ordered_json ObstacleDisplay::seen_json(std::size_t index) const {
  const Obstacle& o = seen_[index];
  ordered_json json{{"number", o.number},
                    {"outline", corners_json(o.outline)},
                    {"existence", rounded(o.existence)},
                    {"range_m", rounded(o.range_m)},
                    {"bearing_deg", rounded(o.bearing.wrapped_positive().degrees())},
                    {"hits", o.hits},
                    {"behind", o.behind}};
  if (o.label != WaterLabel::kUnknown) json["label"] = to_text(o.label);
  if (o.moves()) {
    json["track"] = o.motion.track;
    json["velocity"] = place_of(o.motion.velocity_W);
    json["covariance_m2"] = covariance_json(o.motion.position_covariance);
    json["velocity_covariance"] = covariance_json(o.motion.velocity_covariance);
  }
  if (const auto id = taken_for(index)) json["of"] = *id;
  return json;
}

/// Leaves out an outline that the scan shows as well, and a trail of a single point.
ordered_json ObstacleDisplay::remembered_json(const RememberedObstacle& o, Time start) const {
  ordered_json json{{"number", o.number}, {"id", o.id}};
  if (!o.whole) json["outline"] = corners_json(o.outline_W);
  json["margin_m"] = rounded(o.margin_m);
  json["since_s"] = rounded_to_tenth(to_seconds(o.first_seen - start));
  json["seen_s"] = rounded_to_tenth(to_seconds(o.last_seen - start));
  const auto trail = trails_.of(o.id);
  if (trail.size() < 2) return json;
  json["trail"] = ordered_json::array();
  for (const Eigen::Vector2d& p : trail) {
    json["trail"].push_back(ordered_json::array({rounded_to_tenth(p.x()), rounded_to_tenth(p.y())}));
  }
  return json;
}

/// Id of the known obstacle that the agents matched an obstacle of the last scan to.
std::optional<std::uint32_t> ObstacleDisplay::taken_for(std::size_t seen) const {
  if (!known_ || known_->sweep != scan_ || seen >= known_->seen_as.size()) return std::nullopt;
  const std::uint32_t id = known_->seen_as[seen];
  const bool is_known = std::any_of(known_->obstacles.begin(), known_->obstacles.end(),
                                    [id](const RememberedObstacle& o) { return o.id == id; });
  return is_known ? std::optional(id) : std::nullopt;
}

}  // namespace isobath
