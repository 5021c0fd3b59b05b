#include <algorithm>
#include <cmath>
#include <Eigen/Geometry>
#include <isobath/geometry/polygon_parts.hpp>
#include <isobath/scenario/detection_scorer.hpp>
#include <isobath/scenario/ground_truth_trajectory.hpp>
#include <limits>
#include <set>
#include <utility>

namespace isobath {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double kSquare = 1;   // m, edge of a square of marks
constexpr double kCompact = 6;  // m, maximum extent of a compact body

std::int64_t square_of(double north, double east) {
  return static_cast<std::int64_t>(std::floor(north / kSquare)) << 32 ^
         (static_cast<std::int64_t>(std::floor(east / kSquare)) & 0xffffffff);
}

bool near(const std::vector<Polygon>& plan, const Vector2d& p, double within) {
  return std::any_of(plan.begin(), plan.end(), [&](const Polygon& part) { return distance_from(part, p) <= within; });
}

Polygon in_frame(const Polygon& polygon, const Pose& X) {
  Polygon out;
  for (const Vector2d& p : polygon) out.push_back((X * Vector3d(p.x(), p.y(), 0)).head<2>());
  return out;
}

/// The mean of all corners.
Vector2d middle_of(const std::vector<Polygon>& parts) {
  Vector2d sum = Vector2d::Zero();
  double corners = 0;
  for (const Polygon& part : parts) {
    for (const Vector2d& corner : part) sum += corner;
    corners += static_cast<double>(part.size());
  }
  return sum / std::max(1.0, corners);
}

/// A piece of an obstacle, in W.
struct ObstaclePiece {
  Polygon outline;
  double tolerance, gap;  ///< to the nearest body; infinite: none is near
};

/// The pieces of a scan, and the bodies that they belong to.
struct BodyMatches {
  std::vector<ObstaclePiece> pieces;      ///< in the order of the obstacles
  std::set<int> of_body;                  ///< numbers of the obstacles that belong to one
  std::vector<const Obstacle*> reported;  ///< nearest obstacle of each body; null: none
};

Eigen::AlignedBox2d box_around(const std::vector<Polygon>& parts) {
  Eigen::AlignedBox2d box;
  for (const Polygon& part : parts) {
    for (const Vector2d& p : part) box.extend(p);
  }
  return box;
}

/// `beam`: width of a beam, rad; `bin_m`: length of a bin.
BodyMatches match_to_bodies(const Detection& found, const std::vector<std::vector<Polygon>>& plans, const Pose& X_WL,
                            double beam, double bin_m) {
  BodyMatches matches;
  matches.reported.resize(plans.size(), nullptr);
  std::vector<Eigen::AlignedBox2d> boxes;
  for (const std::vector<Polygon>& plan : plans) boxes.push_back(box_around(plan));
  for (const Obstacle& o : found.obstacles) {
    ObstaclePiece piece{in_frame(o.outline, X_WL), 0.5 * beam * o.range_m + bin_m + found.cells.cell_m,
                        std::numeric_limits<double>::infinity()};
    const Eigen::AlignedBox2d box = box_around({piece.outline});
    for (std::size_t i = 0; i < plans.size(); ++i) {
      if (boxes[i].exteriorDistance(box) > std::max(piece.tolerance, kAttached_m)) continue;
      const double gap = gap_between(plans[i], piece.outline);
      piece.gap = std::min(piece.gap, gap);
      const Obstacle*& nearest = matches.reported[i];
      if (gap > piece.tolerance || (nearest && o.range_m >= nearest->range_m)) continue;
      nearest = &o;
    }
    if (piece.gap <= piece.tolerance) matches.of_body.insert(o.number);
    matches.pieces.push_back(std::move(piece));
  }
  return matches;
}

}  // namespace

DetectionScorer::DetectionScorer(Simulator& simulator)
    : simulator_(simulator), keel_m_(simulator.vehicle().height / 2 + kAboveAndBelow_m) {
  for (const WorldBody& body : simulator.world().bodies()) {
    bodies_.emplace_back();
    bodies_.back().score.name = body.name;
    bodies_.back().score.compact = body.box.sizes().head<2>().maxCoeff() < kCompact;
  }
}

void DetectionScorer::on_truth(const EchoTruth& echoes) { waiting_.push_back(echoes); }

void DetectionScorer::on_truth(const TrueMotion& motion) {
  if (motions_.size() > 100) motions_.erase(motions_.begin(), motions_.begin() + 50);
  motions_.push_back(motion);
}

/// The true pose of the vehicle, without roll and pitch.
Pose DetectionScorer::true_level_pose(Time time) const {
  if (motions_.empty()) return {};
  const TrueMotion& nearest = time < motions_.front().time ? motions_.front() : motions_.back();
  return level(true_pose_at(motions_, time).value_or(nearest.state.X_WB));
}

void DetectionScorer::on_ping(const PosedPing& posed) {
  const Ping& ping = posed.ping;
  const Pose X_WL = true_level_pose(ping.time);
  const Pose X_WS = X_WL * ping.X_BS;
  look(ping, X_WS);
  const auto truth = std::find_if(waiting_.begin(), waiting_.end(), [&ping](const EchoTruth& t) {
    return t.time == ping.time && t.beams == ping.fan->beams() && t.bins == ping.window.bins;
  });
  if (truth == waiting_.end()) return;
  bin_ = ping.window.bin_m;
  beam_ = ping.fan->width[0].radians();
  std::vector<bool> heard(bodies_.size());
  const std::vector<std::vector<Polygon>> plans = plans_now();
  const Vector2d origin = X_WS.translation.head<2>();
  for (int b = 0; b < truth->beams; ++b) {
    const Angle a = ping.fan->azimuth[static_cast<std::size_t>(b)];
    const Vector2d along = (X_WS.rotation * Vector3d(cos(a), sin(a), 0)).head<2>();
    std::int64_t marked_square = 0;  // reverberation fills many consecutive bins of one square
    std::uint8_t marked = 0;
    const EchoLabel* labels =
        truth->labels.data() + static_cast<std::size_t>(b) * static_cast<std::size_t>(truth->bins);
    for (int k = 0; k < truth->bins; ++k) {
      const EchoLabel label = labels[k];
      if (label.path() == EchoPath::kNoise) continue;
      if (label.path() == EchoPath::kVolume || label.path() == EchoPath::kSpurious ||
          label.path() == EchoPath::kDisturbance || label.path() == EchoPath::kRinging) {
        continue;  // an obstacle from these is a false alarm
      }
      const double r = ping.window.centre(k);
      const Vector2d at = origin + r * along;
      const bool direct = label.path() == EchoPath::kDirect;
      if (label.target() >= kFirstBody) {
        // Close under the surface a bounce can be louder than the direct echo; it shows the body just as well.
        const auto body = static_cast<std::size_t>(label.target() - kFirstBody);
        if (direct || near(plans[body], at, bin_ + 0.5 * beam_ * r)) {
          heard[body] = true;
          continue;
        }
      }
      std::uint8_t kind = kMirrorEcho;
      if (direct) kind = label.target() == kBottom ? kBottomEcho : kSurfaceEcho;
      const std::int64_t square = square_of(at.x(), at.y());
      if (kind == marked && square == marked_square) continue;
      marks_[square] |= kind;
      marked_square = square;
      marked = kind;
    }
  }
  const double now = to_seconds(ping.time);
  for (std::size_t i = 0; i < bodies_.size(); ++i) {
    if (!heard[i]) continue;
    Watch& w = bodies_[i];
    w.heard = true;
    if (w.first_heard_s < 0) w.first_heard_s = now;
    ++w.score.pings_heard;
    if (w.score.scans_found == 0) ++w.score.delay_pings;
  }
  waiting_.erase(waiting_.begin(), truth + 1);
}

void DetectionScorer::look(const Ping& ping, const Pose& X_WS) {
  const auto& azimuths = ping.fan->azimuth;
  const auto [first, last] = std::minmax_element(azimuths.begin(), azimuths.end());
  const Angle middle = (*first + *last) / 2;
  const Vector3d along = X_WS.rotation * Vector3d(cos(middle), sin(middle), 0);
  views_.push_back({X_WS.translation.head<2>(), Angle::radians(std::atan2(along.y(), along.x())),
                    (*last - *first + ping.fan->width[0]) / 2, ping.window.end_m()});
}

bool DetectionScorer::in_view(const Polygon& outline) const {
  const auto seen = [this](const Vector2d& p) {
    return std::any_of(views_.begin(), views_.end(), [&p](const View& v) {
      const Vector2d to = p - v.origin;
      const Angle off = (Angle::radians(std::atan2(to.y(), to.x())) - v.middle).wrapped();
      return to.norm() <= v.reach_m && std::abs(off.radians()) <= v.half_width.radians();
    });
  };
  if (std::any_of(outline.begin(), outline.end(), seen)) return true;
  // An outline may reach across a sector without a corner in it.
  return std::any_of(views_.begin(), views_.end(), [&](const View& v) {
    if (seen(nearest_point(outline, v.origin))) return true;
    return std::any_of(outline.begin(), outline.end(), [&](const Vector2d& p) {
      const double far = std::min((p - v.origin).norm(), v.reach_m);
      const Vector2d on_axis = v.origin + far * Vector2d(cos(v.middle), sin(v.middle));
      return seen(nearest_point(outline, on_axis));
    });
  });
}

std::vector<std::vector<Polygon>> DetectionScorer::plans_now() const {
  std::vector<std::vector<Polygon>> plans;
  for (const WorldBody& body : simulator_.world().bodies()) {
    plans.push_back(body.plan);
    for (Polygon& part : plans.back()) {
      for (Vector2d& p : part) p += body.moved.head<2>();
    }
  }
  return plans;
}

std::uint8_t DetectionScorer::kinds_near(const Polygon& outline, double within) const {
  std::uint8_t kinds = 0;
  const int reach = static_cast<int>(std::ceil(within / kSquare));
  const auto look = [&](const Vector2d& p) {
    for (int i = -reach; i <= reach; ++i) {
      for (int j = -reach; j <= reach; ++j) {
        for (const auto* marks : {&marks_, &last_marks_}) {
          const auto found = marks->find(square_of(p.x() + i * kSquare, p.y() + j * kSquare));
          if (found != marks->end()) kinds |= found->second;
        }
      }
    }
  };
  for (const Vector2d& p : outline) look(p);
  Vector2d middle = Vector2d::Zero();
  for (const Vector2d& p : outline) middle += p / static_cast<double>(outline.size());
  look(middle);
  return kinds;
}

bool DetectionScorer::bottom_in_the_way(const Polygon& outline) const {
  const double needed = X_WL_.translation.z() + keel_m_;
  return std::any_of(outline.begin(), outline.end(), [&](const Vector2d& p) {
    const auto bottom = simulator_.world().bottom_depth(p.x(), p.y());
    return bottom && *bottom < needed;
  });
}

void DetectionScorer::on_scan(const ScanResult& scan) {
  X_WL_ = true_level_pose(scan.detection.time);
  const std::vector<std::vector<Polygon>> plans = plans_now();
  const BodyMatches matches = match_to_bodies(scan.detection, plans, X_WL_, beam_, bin_);
  ++score_.scans;
  bool any_false = false;
  for (std::size_t at = 0; at < matches.pieces.size(); ++at) {
    const Obstacle& o = scan.detection.obstacles[at];
    const auto& [outline, tolerance, gap] = matches.pieces[at];
    const bool owned = gap <= (matches.of_body.count(o.number) > 0 ? std::max(tolerance, kAttached_m) : tolerance);
    ++score_.obstacles;
    const std::uint8_t kinds = owned ? 0 : kinds_near(outline, tolerance);
    int& count = owned                  ? score_.of_bodies
                 : kinds & kBottomEcho  ? score_.of_bottom
                 : kinds & kSurfaceEcho ? score_.of_surface
                 : kinds & kMirrorEcho  ? score_.of_mirrors
                                        : score_.false_alarms;
    ++count;
    any_false = any_false || &count == &score_.false_alarms;
    if (owned || o.existence < kSureObstacle || bottom_in_the_way(outline)) continue;
    const bool seen = in_view(outline);
    ++(seen ? score_.false_obstacles : score_.unseen_false_obstacles);
    score_.near_false_obstacles += seen && o.range_m <= kNearObstacle_m;
  }
  score_.scans_with_false_alarms += any_false;
  const double now = to_seconds(scan.detection.time);
  for (std::size_t i = 0; i < bodies_.size(); ++i) {
    if (!matches.reported[i]) continue;
    const Obstacle& reported = *matches.reported[i];
    Watch& w = bodies_[i];
    if (w.score.scans_found++ == 0) {
      w.score.delay_s = w.first_heard_s < 0 ? 0 : now - w.first_heard_s;
      w.score.first_range_m = reported.range_m;
    }
    const double error = reported.range_m - distance_from(plans[i], X_WL_.translation.head<2>());
    w.error_sum += error;
    w.error_squares += error * error;
    const Vector2d apart = middle_of({world_outline(reported, scan.detection.X_WB)}) - middle_of(plans[i]);
    w.fix_sum += apart;
    w.fix_squares += apart.squaredNorm();
    if (std::abs(error) > std::abs(w.score.range_error_worst_m)) w.score.range_error_worst_m = error;
  }
  compare_motion(scan.detection);
  views_.clear();
  last_marks_ = std::move(marks_);
  marks_.clear();
}

/// The bodies that move and the obstacles that do, in W as seen from the true place of the vehicle.
void DetectionScorer::compare_motion(const Detection& found) {
  const double since_s = compared_ ? to_seconds(found.time - *compared_) : 0;
  compared_ = found.time;
  std::vector<MotionScorer::TrueBody> bodies;
  for (std::size_t i = 0; i < bodies_.size(); ++i) {
    const WorldBody& body = simulator_.world().bodies()[i];
    if (!body.moves) continue;
    const Vector2d moved = body.moved.head<2>();
    if (since_s > 0) {
      bodies.push_back({i, body.box.center().head<2>() + moved, (moved - bodies_[i].moved) / since_s,
                        std::exchange(bodies_[i].heard, false)});
    }
    bodies_[i].moved = moved;
  }
  if (bodies.empty()) return;
  std::vector<MotionScorer::Track> tracks;
  for (const Obstacle& o : found.obstacles) {
    if (!o.moves()) continue;
    tracks.push_back(
        {o.motion.track, (X_WL_ * Vector3d(o.centre.x(), o.centre.y(), 0)).head<2>(), o.motion.velocity_W});
  }
  motion_.add(to_seconds(found.time), bodies, tracks);
}

const TruthScore& DetectionScorer::score() {
  score_.bodies.clear();
  for (Watch& w : bodies_) {
    if (w.score.pings_heard == 0) continue;
    BodyScore s = w.score;
    if (s.scans_found > 0) {
      s.range_error_mean_m = w.error_sum / s.scans_found;
      s.range_error_rms_m = std::sqrt(w.error_squares / s.scans_found);
      const Vector2d mean = w.fix_sum / s.scans_found;
      s.fix_offset_m = mean.norm();
      s.fix_spread_m = std::sqrt(std::max(0.0, w.fix_squares / s.scans_found - mean.squaredNorm()));
    }
    score_.bodies.push_back(std::move(s));
  }
  score_.motion = motion_.score();
  return score_;
}

std::vector<Polygon> DetectionScorer::outlines() const {
  std::vector<Polygon> all;
  const Pose X_LW = X_WL_.inverse();
  for (const auto& plan : plans_now()) {
    for (const Polygon& part : plan) all.push_back(in_frame(part, X_LW));
  }
  return all;
}

}  // namespace isobath
