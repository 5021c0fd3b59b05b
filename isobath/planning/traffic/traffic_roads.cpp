#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <isobath/geometry/segment.hpp>
#include <isobath/planning/roadmap/visibility_graph.hpp>
#include <isobath/planning/traffic/traffic_roads.hpp>
#include <limits>
#include <numbers>

namespace isobath {
namespace {

using Eigen::Vector2d;
using std::numbers::pi;

constexpr int kSides = 12;         // of the polygon for a disc
constexpr double kSlack_m = 0.05;  // by which candidates keep more than their smoothed paths need
constexpr double kSpacing_m = 2;   // of points along outlines
constexpr double kMaxOutlinePoints = 8000;
constexpr double kBeyond_m = 100;     // of the region of the path finder, around what it holds
constexpr double kHold_s = 2;         // for which candidates hold
constexpr double kMoved_m = 0.1;      // by which a slow body moves before its outline does
constexpr double kPathChord_m = 0.5;  // of the chords by which arcs are checked
constexpr double kOnPath_m = 0.05, kOnPathHeading = 0.02;
constexpr int kRounds = 3;  // to move a start away from outlines

bool is_same_outline(const MovingBody& a, const MovingBody& b) {
  return (a.p_W - b.p_W).norm() < kMoved_m && a.radius_m == b.radius_m && a.outline == b.outline &&
         a.position_covariance == b.position_covariance;
}

/// Distance along a path to its place nearest to p.
double nearest_along(const SmoothPath& path, const Vector2d& p) {
  double best_m = 0, least = std::numeric_limits<double>::infinity();
  for (const PathPiece& piece : path.pieces) {
    double along = (p - piece.start.p_W).dot(Vector2d(std::cos(piece.start.heading), std::sin(piece.start.heading)));
    if (piece.curvature != 0) {
      const Vector2d to_centre(-std::sin(piece.start.heading), std::cos(piece.start.heading));
      const Vector2d from_centre = p - piece.start.p_W - to_centre / piece.curvature;
      const Vector2d first = -to_centre / piece.curvature;
      const double turned = std::atan2(cross(first, from_centre), first.dot(from_centre)) / piece.curvature;
      along = turned < 0 ? turned + 2 * pi / std::abs(piece.curvature) : turned;
      if (along > piece.length_m + pi / std::abs(piece.curvature)) along = 0;
    }
    along = std::clamp(along, 0.0, piece.length_m);
    const double apart = (along_arc(piece.start, piece.curvature, along).p_W - p).norm();
    if (apart >= least) continue;
    least = apart;
    best_m = piece.start_m + along;
  }
  return best_m;
}

}  // namespace

TrafficRoads::TrafficRoads(const TrafficVehicle& vehicle, const RoadRules& rules)
    : vehicle_(vehicle), rules_(rules), speeds_(vehicle) {}

void TrafficRoads::set_goal(const Vector2d& goal_W, double arrival_m) {
  goal_W_ = goal_W;
  rules_.speeds.arrival_m = arrival_m;
  in_force_ = {};
  guide_ = {};
  candidates_.clear();
  changed_ = true;
  is_shut_ = false;
  reason_.clear();
  work_ = {};
}

// --- outlines --------------------------------------------------------------------------------------------------------

/// In W, with the radius of the body and its uncertainty.
Polygon TrafficRoads::outline_of(const MovingBody& body) const {
  const double grown = body.radius_m + predicted_growth(body, 0, rules_.speeds.sigmas);
  Polygon outline = body.outline.empty() ? Polygon{Vector2d::Zero()} : body.outline;
  for (Vector2d& corner : outline) corner += body.p_W;
  return grown > 0 || outline.size() < 3 ? grown_polygon(convex_hull(outline), std::max(grown, 0.01), kSides) : outline;
}

bool TrafficRoads::update(const MotionState& own, std::span<const MovingBody> bodies) {
  moving_.clear();
  for (auto& [id, still] : still_) still.seen = false;
  for (const MovingBody& body : bodies) {
    if (!is_still(body, 0)) moving_.push_back(body);
    if (!is_still(body, rules_.still_speed)) continue;
    const auto found = still_.find(body.number);
    if (found != still_.end() && is_same_outline(found->second.body, body)) {
      found->second.seen = true;
      continue;
    }
    still_[body.number] = {body, true};
    changed_ = true;
    if (finder_ && !finder_->set_obstacle(body.number, outline_of(body))) finder_.reset();
  }
  for (auto it = still_.begin(); it != still_.end();) {
    if (it->second.seen) {
      ++it;
      continue;
    }
    if (finder_) finder_->remove_obstacle(it->first);
    it = still_.erase(it);
    changed_ = true;
  }
  if (still_.empty()) {
    guide_ = {};
    in_force_ = {};
    candidates_.clear();
    is_shut_ = false;
    return false;
  }
  if (!finder_ || !region_.contains(own.p_W)) rebuild(own);
  if (changed_) grow();
  return true;
}

/// The path finder, in a region that holds all outlines, the vehicle and the goal.
void TrafficRoads::rebuild(const MotionState& own) {
  region_.setEmpty();
  region_.extend(own.p_W).extend(goal_W_);
  double around_m = 0;
  for (const auto& [id, still] : still_) {
    const Polygon outline = outline_of(still.body);
    for (std::size_t i = 0; i < outline.size(); ++i) {
      region_.extend(outline[i]);
      around_m += (outline[(i + 1) % outline.size()] - outline[i]).norm();
    }
  }
  const Vector2d beyond = Vector2d::Constant(kBeyond_m);
  region_ = Eigen::AlignedBox2d(region_.min() - beyond, region_.max() + beyond);
  finder_ =
      std::make_unique<PathFinder>(PathFinderConfig{.region = region_,
                                                    .radius_m = rules_.kept_m + kSlack_m,
                                                    .sides = kSides,
                                                    .spacing_m = std::max(kSpacing_m, around_m / kMaxOutlinePoints),
                                                    .wished_clearance_m = 1 / vehicle_.max_curvature(),
                                                    .speed_m_s = vehicle_.max_speed});
  for (const auto& [id, still] : still_) finder_->set_obstacle(id, outline_of(still.body));
}

/// What smoothed paths are checked against, and what hides one place from another.
void TrafficRoads::grow() {
  std::vector<GrownPart> kept, hull;
  for (const auto& [id, still] : still_) {
    for (const Polygon& part : convex_parts(outline_of(still.body))) {
      kept.push_back({id, id, part, grown_polygon(part, rules_.kept_m, kSides)});
      hull.push_back({id, id, part, grown_polygon(part, vehicle_.radius_m, kSides)});
    }
  }
  water_ = std::make_unique<GrownObstacles>(std::move(kept));
  hidden_ = std::make_unique<GrownObstacles>(std::move(hull));
  guide_.still = hidden_.get();
}

// --- candidates ------------------------------------------------------------------------------------------------------

bool TrafficRoads::is_passed(const MotionState& own, const Corners& corners) const {
  return corners.size() > 1 && water_->is_free(own.p_W, corners[1]);
}

void TrafficRoads::find(const MotionState& own, Time now) {
  const bool is_known = is_shut_ || !candidates_.empty();
  const bool holds = !changed_ && is_known && searched_ && to_seconds(now - *searched_) < kHold_s;
  if (!holds) {
    searched_ = now;
    changed_ = false;
    search(own);
  }
  for (Corners& corners : candidates_) {
    while (is_passed(own, corners)) corners.erase(corners.begin());
  }
  if (!candidates_.empty()) take_guide(candidates_.front());
  if (is_shut_) guide_.corners_W.clear();
}

void TrafficRoads::take_guide(const Corners& corners) {
  guide_.corners_W = corners;
  guide_.rest_m.assign(corners.size(), 0);
  for (std::size_t i = corners.size(); i-- > 1;) {
    guide_.rest_m[i - 1] = guide_.rest_m[i] + (corners[i] - corners[i - 1]).norm();
  }
}

/// A place beside p where candidates can begin, if p is nearer to an outline than they are allowed to be.
Vector2d TrafficRoads::start_beside(Vector2d p) const {
  const double needed_m = (rules_.kept_m + kSlack_m) / std::cos(pi / kSides) + 0.01;
  for (int round = 0; round < kRounds; ++round) {
    const MovingBody* nearest = nullptr;
    double least = needed_m;
    for (const auto& [id, still] : still_) {
      const double gap = distance_to(still.body, p, 0) - predicted_growth(still.body, 0, rules_.speeds.sigmas);
      if (gap >= least) continue;
      least = gap;
      nearest = &still.body;
    }
    if (nearest == nullptr) break;
    constexpr double kSide_m = 1e-3;
    const auto slope = [&](const Vector2d& step) {
      return (distance_to(*nearest, p + step, 0) - distance_to(*nearest, p - step, 0)) / (2 * kSide_m);
    };
    p += (needed_m - least) * Vector2d(slope({kSide_m, 0}), slope({0, kSide_m}));
  }
  return p;
}

/// Asks for candidates. Those that can be smoothed come before those that only guide a search.
void TrafficRoads::search(const MotionState& own) {
  candidates_.clear();
  reason_.clear();
  ++work_.searches;
  const auto found = finder_->candidates(start_beside(own.p_W), goal_W_);
  for (const auto& [id, still] : still_) work_.detail = std::max(work_.detail, finder_->detail(id));
  is_shut_ = !found && found.error() != PathRefusal::kStartBlocked;
  if (!found) {
    reason_ = to_text(found.error());
    return;
  }
  std::size_t smoothed = 0;
  std::optional<Vector2d> refused;
  for (const PathCandidate& path : found->paths) {
    Corners corners(path.points.begin() + 1, path.points.end());
    const auto smooth = smooth_path(own, corners, 1 / vehicle_.max_curvature(), *water_);
    if (smooth) {
      candidates_.insert(candidates_.begin() + static_cast<std::ptrdiff_t>(smoothed++), std::move(corners));
      continue;
    }
    ++work_.refused_paths;
    if (!refused) refused = smooth.error().place;
    candidates_.push_back(std::move(corners));
  }
  if (smoothed == 0) {
    reason_ = fmt::format("no path bends as the turning radius of the vehicle needs, first at ({:.1f}, {:.1f})",
                          refused->x(), refused->y());
  }
}

// --- motions ---------------------------------------------------------------------------------------------------------

std::optional<SmoothPath> TrafficRoads::rest_of_path(const MotionState& own) const {
  if (in_force_.smooth.pieces.empty()) return std::nullopt;
  const double along_m = nearest_along(in_force_.smooth, own.p_W);
  const MotionState there = in_force_.smooth.at(along_m);
  if ((there.p_W - own.p_W).norm() > kOnPath_m ||
      std::abs(std::remainder(there.heading - own.heading, 2 * pi)) > kOnPathHeading) {
    return std::nullopt;
  }
  SmoothPath rest;
  MotionState state = own;
  for (const PathPiece& piece : in_force_.smooth.pieces) {
    const double left_m = std::min(piece.length_m, piece.start_m + piece.length_m - along_m);
    if (left_m <= 1e-9) continue;
    rest.pieces.push_back({rest.length_m(), left_m, state, piece.curvature});
    const int chords = piece.curvature == 0 ? 1 : static_cast<int>(std::ceil(left_m / kPathChord_m));
    for (int k = 1; k <= chords; ++k) {
      const MotionState next = along_arc(rest.pieces.back().start, piece.curvature, left_m * k / chords);
      if (!water_->is_free(state.p_W, next.p_W)) return std::nullopt;  // an outline is new or has moved
      state = next;
    }
  }
  return rest;
}

/// Adds the way to brake beyond the goal, as far as it is free; returns its length.
double TrafficRoads::run_out(SmoothPath& path) const {
  const MotionState end = path.at(path.length_m());
  const double way_m = vehicle_.max_speed * vehicle_.max_speed / (2 * vehicle_.braking) + vehicle_.radius_m;
  if (!water_->is_free(end.p_W, along_arc(end, 0, way_m).p_W)) return 0;
  path.pieces.push_back({path.length_m(), way_m, end, 0});
  return way_m;
}

std::optional<RoadMotion> TrafficRoads::motion(const MotionState& own, Time now) {
  if (vehicle_.min_speed > 0) return std::nullopt;
  struct Choice {
    Path path;
    bool mends;
  };
  std::vector<Choice> choices;
  if (auto rest = rest_of_path(own)) {
    Corners corners = in_force_.corners;
    while (is_passed(own, corners)) corners.erase(corners.begin());
    choices.push_back({{std::move(*rest), std::move(corners)}, true});
  }
  for (const Corners& corners : candidates_) {
    auto smooth = smooth_path(own, corners, 1 / vehicle_.max_curvature(), *water_);
    if (smooth) choices.push_back({{std::move(*smooth), corners}, false});
  }
  std::ranges::stable_sort(choices, {}, [](const Choice& choice) { return choice.path.smooth.length_m(); });
  std::optional<RoadMotion> best;
  const Choice* taken = nullptr;
  for (const Choice& choice : choices) {
    SpeedRules rules = rules_.speeds;
    if (best && (choice.path.smooth.length_m() - rules.arrival_m) / vehicle_.max_speed >= best->arrival_s) break;
    SmoothPath path = choice.path.smooth;
    rules.arrival_m += run_out(path);
    const auto speeds = speeds_.plan(path, own.speed, moving_, now, rules);
    if (!speeds) {
      ++work_.blocked_paths;
      if (!best) {
        reason_ = fmt::format("body {} blocks the path after {:.1f} s", speeds.error().body, speeds.error().time_s);
      }
      continue;
    }
    if (best && speeds->arrival_s >= best->arrival_s) continue;
    best = RoadMotion{speeds->motion_along(path, own.speed, vehicle_, rules.clear_s), speeds->arrival_s, speeds->free_s,
                      choice.mends};
    taken = &choice;
  }
  if (!best) return std::nullopt;
  reason_.clear();
  found_ = taken->path;
  take_guide(found_.corners);
  return best;
}

void TrafficRoads::follow() { in_force_ = found_; }

}  // namespace isobath
