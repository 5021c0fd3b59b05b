// Which sightings of a sweep are which obstacles of an ObstacleMemory, after the drift since they were last seen.
#include <algorithm>
#include <cmath>
#include <isobath/map/occupancy/obstacle_memory.hpp>
#include <isobath/map/occupancy/obstacle_outline.hpp>
#include <limits>
#include <utility>

namespace isobath {
namespace {

using Eigen::Vector2d;

constexpr std::size_t kShifts = 32;  // maximum number of shifts that are tried

bool usable(const Polygon& outline) {
  return outline.size() >= 3 &&
         std::all_of(outline.begin(), outline.end(), [](const Vector2d& p) { return p.allFinite(); });
}

}  // namespace

/// Accumulates the changes of the position variance, and the distance travelled without one.
void ObstacleMemory::measure_drift(const MemorySweep& sweep) {
  const Vector2d here = sweep.X_WL.translation.head<2>();
  const Vector2d jumped = sweep.jumped - jumped_;
  jumped_ = sweep.jumped;
  const std::optional<double> variance = sweep.sigma_m ? std::optional(*sweep.sigma_m * *sweep.sigma_m) : std::nullopt;
  const double changed = variance && variance_ ? std::abs(*variance - *variance_) : 0;
  if (!jumped.isZero(0)) move_along(jumped, variance, changed);
  wander_ += changed;
  if (variance) {
    variance_ = variance;
  } else if (last_place_) {
    unmeasured_ += (here - jumped - *last_place_).norm();
  }
  last_place_ = here;
}

/// Moves what was seen since the drift began; `changed` is the change of variance that the jump brings.
void ObstacleMemory::move_along(const Vector2d& by_W, const std::optional<double>& variance, double changed) {
  for (Entry& e : entries_) {
    if (e.seen.told) continue;
    const double drifted = wander_ - e.wander + modelled_since(e);
    if (!(drifted < (variance ? e.variance + *variance : by_W.squaredNorm()))) continue;
    set_outline(e, moved_by(e.seen.outline_W, by_W));
    e.wander += changed;  // the jump has put it right
  }
}

/// Variance of the drift where navigation gave none.
double ObstacleMemory::modelled_since(const Entry& e) const {
  const double drift = config_.drift_share * (unmeasured_ - e.unmeasured);
  return drift * drift;
}

double ObstacleMemory::variance_since(const Entry& e) const {
  const double both = e.variance + variance_.value_or(0);  // the most that the two positions may be off
  const double stated = e.seen.told ? both : std::min(wander_ - e.wander, both);
  return std::max(stated, 0.0) + modelled_since(e);
}

std::vector<ObstacleMemory::Sighting> ObstacleMemory::sightings_of(const MemorySweep& sweep) const {
  std::vector<Sighting> out;
  out.reserve(sweep.obstacles.size());
  for (std::size_t i = 0; i < sweep.obstacles.size(); ++i) {
    const Obstacle& o = sweep.obstacles[i];
    if (o.moves() || o.may_move || !usable(o.outline)) continue;
    Sighting s;
    s.index = i;
    s.number = o.number;
    for (const Vector2d& p : o.outline) {
      s.outline_W.emplace_back((sweep.X_WL * Eigen::Vector3d(p.x(), p.y(), 0)).head<2>());
    }
    const Circle c = circle_of(s.outline_W);
    s.centre = c.centre;
    s.radius = c.radius;
    s.area = area(s.outline_W);
    s.existence = std::clamp(std::isfinite(o.existence) ? o.existence : 0, 0.0, kSurest);
    s.doubtful = o.possible_multiple || !(s.existence >= config_.min_initial_existence);
    s.samples = spread_over(s.outline_W);
    out.push_back(std::move(s));
  }
  return out;
}

/// Whether the drift since the last sighting is large enough to matter.
bool ObstacleMemory::is_stale(const Entry& e) const {
  return variance_since(e) > 0.25 * config_.detection_sigma * config_.detection_sigma;
}

/// The shift from stored to seen places on which the most sightings agree; the shorter one if two are equal.
Vector2d ObstacleMemory::shift_of(const std::vector<Sighting>& sightings) const {
  struct Pair {
    std::size_t sighting;
    const Entry* entry;
    Vector2d apart;
  };
  std::vector<Pair> pairs;
  for (const Entry& e : entries_) {
    if (!is_stale(e) || e.seen.told) continue;
    const double reach = std::max(config_.confidence, 1.0) * std::sqrt(variance_since(e)) + config_.detection_sigma;
    for (std::size_t i = 0; i < sightings.size(); ++i) {
      const Vector2d apart = sightings[i].centre - e.centre;
      if (apart.norm() <= reach && similar(sightings[i].area, e.area)) pairs.push_back({i, &e, apart});
    }
  }
  std::stable_sort(pairs.begin(), pairs.end(),
                   [](const Pair& a, const Pair& b) { return a.apart.squaredNorm() < b.apart.squaredNorm(); });
  const double tolerance = 1.5 * config_.detection_sigma;
  Vector2d best = Vector2d::Zero();
  std::size_t most = 0;
  std::vector<std::uint8_t> agrees(sightings.size());
  const auto vote = [&](const Vector2d& shift) {
    Vector2d sum = Vector2d::Zero();
    std::size_t votes = 0;
    std::fill(agrees.begin(), agrees.end(), 0);
    for (const Pair& p : pairs) {
      if ((p.apart - shift).norm() > tolerance || agrees[p.sighting]) continue;
      agrees[p.sighting] = 1;
      sum += p.apart;
      ++votes;
    }
    if (votes > most) {
      most = votes;
      best = sum / static_cast<double>(votes);
    }
  };
  vote(Vector2d::Zero());
  for (std::size_t i = 0; i < std::min(pairs.size(), kShifts); ++i) vote(pairs[i].apart);
  return best;
}

/// The obstacle that overlaps the sighting most; if none overlaps it, the nearest one within reach of its drift.
ObstacleMemory::Entry* ObstacleMemory::match(const Sighting& s) {
  Entry* best = nullptr;
  double best_score = 0, nearest = std::numeric_limits<double>::infinity();
  for (Entry& e : entries_) {
    const Vector2d shift = is_stale(e) && !e.seen.told ? shift_ : Vector2d::Zero();
    const double drift = config_.confidence * std::sqrt(variance_since(e));
    const double apart = (s.centre - e.centre - shift).norm() - s.radius - e.radius;
    if (apart > (e.sweep == sweeps_ ? 0 : drift)) continue;
    const double score =
        share_inside(s.samples, -shift, e.seen.outline_W) + share_inside(e.samples, shift, s.outline_W);
    if (score > best_score) {
      best = &e;
      best_score = score;
    }
    if (best_score > 0 || e.sweep == sweeps_ || !is_stale(e)) continue;
    const double distance = gap(moved_by(e.seen.outline_W, shift), s.outline_W).norm();
    if (distance <= drift && distance < nearest) {
      best = &e;
      nearest = distance;
    }
  }
  return best;
}

}  // namespace isobath
