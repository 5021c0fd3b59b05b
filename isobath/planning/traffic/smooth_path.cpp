#include <algorithm>
#include <cmath>
#include <isobath/geometry/polygon.hpp>
#include <isobath/planning/traffic/smooth_path.hpp>
#include <limits>
#include <numbers>
#include <optional>

namespace isobath {
namespace {

using Eigen::Vector2d;
using std::numbers::pi;

constexpr double kNoTurn = 1e-6;        // rad
constexpr double kMaxBend = pi + 0.2;   // rad, turn of corners that one circle may hold
constexpr double kUnneeded = 1.5 * pi;  // rad; an arc that turns by more would turn back without the bend
constexpr double kArcChord_m = 0.5;     // of the chords by which arcs are checked
constexpr double kNever = std::numeric_limits<double>::infinity();

Vector2d unit(double angle) { return {std::cos(angle), std::sin(angle)}; }

/// A circle that the path follows on its way from leg to leg.
struct Bend {
  Vector2d centre{0, 0};
  double sense = 0;         ///< 1: to starboard; -1: to port; 0: a point, the goal
  std::size_t first, last;  ///< corners that it replaces
  double turn = 0;          ///< of the corners together, rad
  double heading = 0;       ///< of the leg that leads to the first of them
  bool outside = false;     ///< its arc passes outside the corners
};

/// The centre of a circle that passes outside of all corners of a bend and through one; none if they are too far apart.
std::optional<Vector2d> centre_outside(std::span<const Vector2d> points, const Bend& bend, double radius) {
  const Vector2d inward = unit(bend.heading + bend.sense * (bend.turn + pi) / 2);
  const Vector2d middle = (points[bend.first] + points[bend.last]) / 2;
  double low = -kNever, high = kNever;
  for (std::size_t i = bend.first; i <= bend.last; ++i) {
    const double along = inward.dot(points[i] - middle), aside = cross(inward, points[i] - middle);
    if (std::abs(aside) > radius) return std::nullopt;
    const double half = std::sqrt(radius * radius - aside * aside);
    low = std::max(low, along - half);
    high = std::min(high, along + half);
  }
  if (low > high) return std::nullopt;
  return middle + high * inward;
}

/// The bends at the corners of a path between its ends.
std::vector<Bend> bends_of(std::span<const Vector2d> points, double radius) {
  std::vector<Bend> bends;
  for (std::size_t i = 1; i + 1 < points.size(); ++i) {
    const Vector2d in = points[i] - points[i - 1], out = points[i + 1] - points[i];
    if (in.norm() == 0 || out.norm() == 0) continue;
    const double turn = std::atan2(cross(in, out), in.dot(out));
    if (std::abs(turn) < kNoTurn) continue;
    Bend bend{{0, 0}, turn < 0 ? -1.0 : 1.0, i, i, std::abs(turn), std::atan2(in.y(), in.x()), false};
    if (!bends.empty() && bends.back().sense == bend.sense) {
      Bend joined = bends.back();
      const double trims = radius * (std::tan(std::min(joined.turn, 3.0) / 2) + std::tan(std::min(bend.turn, 3.0) / 2));
      joined.last = i;
      joined.turn += bend.turn;
      joined.outside = true;
      const auto centre = centre_outside(points, joined, radius);
      if ((points[i] - points[bends.back().last]).norm() < trims && joined.turn <= kMaxBend && centre) {
        joined.centre = *centre;
        bends.back() = joined;
        continue;
      }
    }
    bend.outside = bend.turn > 0.9 * pi;
    bend.centre = points[i] + unit(bend.heading + bend.sense * (bend.turn + pi) / 2) * radius /
                                  (bend.outside ? 1 : std::cos(bend.turn / 2));
    bends.push_back(bend);
  }
  return bends;
}

/// The heading of the leg from one circle to the next; none where they overlap.
std::optional<double> leg_heading(const Bend& from, const Bend& to, double radius) {
  const Vector2d way = to.centre - from.centre;
  const double wider = (to.sense - from.sense) * radius, leg2 = way.squaredNorm() - wider * wider;
  if (leg2 < 1e-12) return std::nullopt;
  return std::atan2(way.y(), way.x()) - std::atan2(wider, std::sqrt(leg2));
}

class Smoother {
 public:
  Smoother(const MotionState& start, std::span<const Vector2d> points, double radius, const GrownObstacles& obstacles)
      : start_(start), points_(points), radius_(radius), obstacles_(obstacles) {}

  Result<SmoothPath, SmoothRefusal> smooth(double first_sense) const {
    std::vector<Bend> bends = bends_of(points_, radius_);
    const Vector2d centre = start_.p_W + first_sense * radius_ * unit(start_.heading + pi / 2);
    bends.insert(bends.begin(), Bend{centre, first_sense, 0, 0, 0, start_.heading, true});
    bends.push_back({points_.back(), 0, points_.size() - 1, points_.size() - 1, 0, 0, true});
    // Each round drops a bend or moves one outside: there are not more than two of them for each bend.
    while (true) {
      SmoothPath path;
      std::size_t at = 0;
      const Outcome outcome = lay(bends, path, at);
      if (outcome == Outcome::kDone) return path;
      if (outcome == Outcome::kUnneeded) {
        bends.erase(bends.begin() + static_cast<std::ptrdiff_t>(at));
        continue;
      }
      if (outcome == Outcome::kBlocked) {
        const bool first = move_outside(bends[at]), second = move_outside(bends[at + 1]);
        if (first || second) continue;
      }
      return tl::unexpected(SmoothRefusal{outcome == Outcome::kBlocked ? SmoothFault::kBlocked : SmoothFault::kTurn,
                                          points_[bends[at].first > 0 ? bends[at].first : bends[at + 1].first]});
    }
  }

 private:
  enum class Outcome : std::uint8_t { kDone, kUnneeded, kOverlap, kBlocked };

  bool move_outside(Bend& bend) const {
    if (bend.outside) return false;
    bend.outside = true;
    if (const auto centre = centre_outside(points_, bend, radius_)) bend.centre = *centre;
    return true;
  }

  /// The arcs and legs along the bends. On failure `at` is the bend that is not needed, or before the leg that fails.
  Outcome lay(const std::vector<Bend>& bends, SmoothPath& path, std::size_t& at) const {
    MotionState state = start_;
    for (at = 0; at + 1 < bends.size(); ++at) {
      const Bend &from = bends[at], &to = bends[at + 1];
      const auto heading = leg_heading(from, to, radius_);
      if (!heading) return Outcome::kOverlap;
      double turn = std::remainder(from.sense * (*heading - state.heading), 2 * pi);
      if (turn < -kNoTurn) turn += 2 * pi;
      turn = std::max(turn, 0.0);
      if (at > 0 && turn > kUnneeded) return Outcome::kUnneeded;
      if (!append(path, state, from.sense / radius_, turn * radius_)) return Outcome::kBlocked;
      state.heading = *heading;
      const Vector2d end = to.centre - to.sense * radius_ * unit(*heading + pi / 2);
      if (!append(path, state, 0, (end - state.p_W).norm())) return Outcome::kBlocked;
      state.p_W = end;
    }
    return Outcome::kDone;
  }

  /// False where the piece meets an obstacle.
  bool append(SmoothPath& path, MotionState& state, double curvature, double length_m) const {
    if (length_m < 1e-9) return true;
    path.pieces.push_back({path.length_m(), length_m, state, curvature});
    const int chords = curvature == 0 ? 1 : static_cast<int>(std::ceil(length_m / kArcChord_m));
    for (int k = 1; k <= chords; ++k) {
      const MotionState next = along_arc(path.pieces.back().start, curvature, length_m * k / chords);
      if (!obstacles_.is_free(state.p_W, next.p_W)) return false;
      state = next;
    }
    return true;
  }

  MotionState start_;
  std::span<const Vector2d> points_;
  double radius_;
  const GrownObstacles& obstacles_;
};

}  // namespace

double SmoothPath::length_m() const { return pieces.empty() ? 0 : pieces.back().start_m + pieces.back().length_m; }

MotionState SmoothPath::at(double along_m) const {
  if (pieces.empty()) return {};
  const auto later = std::ranges::upper_bound(pieces, along_m, {}, &PathPiece::start_m);
  const PathPiece& piece = later == pieces.begin() ? pieces.front() : *(later - 1);
  return along_arc(piece.start, piece.curvature, std::clamp(along_m - piece.start_m, 0.0, piece.length_m));
}

Result<SmoothPath, SmoothRefusal> smooth_path(const MotionState& start, std::span<const Vector2d> corners,
                                              double turning_radius_m, const GrownObstacles& obstacles) {
  ISOBATH_ASSERT(!corners.empty() && turning_radius_m > 0);
  std::vector<Vector2d> points{start.p_W};
  points.insert(points.end(), corners.begin(), corners.end());
  const Smoother smoother(start, points, turning_radius_m, obstacles);
  const auto port = smoother.smooth(-1), starboard = smoother.smooth(1);
  if (!port && !starboard) {  // the side to which the path turns says why
    const double aside = cross(unit(start.heading), points[1] - points[0]);
    return aside < 0 ? port : starboard;
  }
  if (!port || (starboard && starboard->length_m() <= port->length_m())) return starboard;
  return port;
}

}  // namespace isobath
