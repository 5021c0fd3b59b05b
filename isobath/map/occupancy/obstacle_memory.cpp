#include <algorithm>
#include <array>
#include <cmath>
#include <isobath/map/occupancy/obstacle_memory.hpp>
#include <isobath/map/occupancy/obstacle_outline.hpp>
#include <numbers>
#include <utility>

namespace isobath {
namespace {

using Eigen::Vector2d;

constexpr double kSpread = 1.5;          // standard deviations from the middle place to the eight around it
constexpr double kFree = 0.8;            // share of an outline that must be free before it counts as a miss
constexpr double kExplained = 0.95;      // share of an outline that must be in view before it counts as seen whole
constexpr double kInside = 0.9;          // share of an outline within another that makes it part of that one
constexpr double kLooseness = 1.25;      // area of a hull over the areas that it joins
constexpr double kFreeInHull = 0.15;     // share of a hull that may be free water
constexpr std::size_t kCorners = 24;     // maximum of an outline
constexpr double kToldExistence = 0.95;  // only what its teller is sure of is told
constexpr std::size_t kToldCorners = 12;
constexpr double kMiddleBelief = 0.36;  // mass of a normal distribution nearer to the middle than to the other places

Vector2d offset_of(std::size_t place, double sigma) {
  constexpr double kHalf = std::numbers::sqrt2 / 2;
  static const std::array<Vector2d, 9> unit = {
      Vector2d(0, 0),          Vector2d(1, 0),           Vector2d(0, 1),
      Vector2d(-1, 0),         Vector2d(0, -1),          Vector2d(kHalf, kHalf),
      Vector2d(-kHalf, kHalf), Vector2d(-kHalf, -kHalf), Vector2d(kHalf, -kHalf)};
  return kSpread * sigma * unit[place];
}

/// A polygon about the circle.
Polygon circle_outline(const Vector2d& centre, double radius) {
  const double step = 2 * std::numbers::pi / static_cast<double>(kToldCorners), out = radius / std::cos(step / 2);
  Polygon outline;
  for (std::size_t i = 0; i < kToldCorners; ++i) {
    const double a = step * static_cast<double>(i);
    outline.emplace_back(centre + out * Vector2d(std::cos(a), std::sin(a)));
  }
  return outline;
}

}  // namespace

std::vector<Field> fields(ObstacleMemoryConfig& c) {
  return {
      Field::real("confidence", &c.confidence, {0, 10}, "1",
                  "Margin of a remembered obstacle, in standard deviations."),
      Field::real("detection_sigma", &c.detection_sigma, {0.01, 100}, "m",
                  "Standard deviation of an outline relative to the vehicle when it is seen."),
      Field::real("drift_share", &c.drift_share, {0, 1}, "1",
                  "Drift as a share of the distance travelled, where navigation gives no variance."),
      Field::real("min_initial_existence", &c.min_initial_existence, {0, 1}, "1",
                  "Minimum existence of an obstacle that is stored.")
          .was("least_seen"),
      Field::integer("confirmations", &c.confirmations, {1, 100}, "sweeps", "Sightings before an obstacle counts."),
      Field::real("unconfirmed_age", &c.unconfirmed_age, {0, 1e6}, "s",
                  "An obstacle with fewer sightings is forgotten this long after the last one."),
      Field::real("miss", &c.miss, {0.01, 0.99}, "1", "Chance that a sweep sees an obstacle's place as free."),
      Field::real("min_existence", &c.min_existence, {0, 1}, "1", "Below this existence an obstacle is forgotten.")
          .was("least_existence"),
      Field::real("max_age", &c.max_age, {1, 1e9}, "s", "An obstacle is forgotten this long after its last sighting."),
      Field::real("max_margin", &c.max_margin, {0.1, 1e6}, "m", "An obstacle with a larger margin is forgotten."),
      Field::integer("clear_looks", &c.clear_looks, {1, 100}, "sweeps", "Agreeing sweeps before an outline shrinks."),
      Field::integer("max_obstacles", &c.max_obstacles, {1, 100'000}, "1",
                     "Maximum number of obstacles; the least certain go first.")
          .was("most"),
  };
}

/// The free water of a sweep, queried by positions in W.
struct ObstacleMemory::View {
  explicit View(const MemorySweep& sweep) : water(sweep.water), here(sweep.X_WL.translation.head<2>()) {
    const Angle turn = water.heading - sweep.X_WL.rotation.heading();
    R_GW << cos(turn), -sin(turn), sin(turn), cos(turn);
    const CartesianGrid& cells = water.cells;
    if (water.free.size() != cells.size()) water.free = {};
    cells_a_metre = 1 / cells.cell_m;
    for (int i = 0; i < 4 && !water.free.empty(); ++i) {
      const Vector2d corner(i < 2 ? 0 : cells.cells_x * cells.cell_m, i % 2 == 0 ? 0 : cells.cells_y * cells.cell_m);
      reach = std::max(reach, (corner - water.position).norm());
    }
  }
  [[nodiscard]] Vector2d to_grid(const Vector2d& p_W) const { return water.position + R_GW * (p_W - here); }
  [[nodiscard]] bool is_free(const Vector2d& p_G) const {
    const double x = p_G.x() * cells_a_metre, y = p_G.y() * cells_a_metre;
    if (water.free.empty() || !(x >= 0 && x < water.cells.cells_x && y >= 0 && y < water.cells.cells_y)) return false;
    return water.free[water.cells.index({static_cast<int>(x), static_cast<int>(y)})] != 0;
  }
  [[nodiscard]] double share_free(std::span<const Vector2d> samples) const {
    const auto free =
        std::count_if(samples.begin(), samples.end(), [&](const Vector2d& p) { return is_free(to_grid(p)); });
    return static_cast<double>(free) / static_cast<double>(samples.size());
  }

  FreeWater water;
  Vector2d here;
  Eigen::Matrix2d R_GW;
  double cells_a_metre = 0;
  double reach = 0;
};

ObstacleMemory::ObstacleMemory(const ObstacleMemoryConfig& config) : config_(config) {}

bool ObstacleMemory::add(const MemorySweep& sweep) {
  const bool stated = !sweep.sigma_m || (std::isfinite(*sweep.sigma_m) && *sweep.sigma_m >= 0);
  if (!sweep.X_WL.is_finite() || !stated || (last_time_ && sweep.time < *last_time_)) {
    ++refused_;
    return false;
  }
  ++sweeps_;
  last_time_ = sweep.time;
  measure_drift(sweep);
  const View view(sweep);
  const std::vector<Sighting> sightings = sightings_of(sweep);
  shift_ = shift_of(sightings);
  seen_as_.assign(sweep.obstacles.size(), 0);
  for (const Sighting& s : sightings) seen_as_[s.index] = take(s, view, sweep.time);
  drop_contained();
  for (Entry& e : entries_) look_again(e, sightings, view);
  drop_moving(sweep);
  forget(sweep.time);
  return true;
}

/// What was stored of an obstacle before it was known to move, or that it may move: the entry of its number, and those
/// that it lies on.
void ObstacleMemory::drop_moving(const MemorySweep& sweep) {
  for (const Obstacle& o : sweep.obstacles) {
    if (!o.moves() && !o.may_move) continue;
    const Vector2d middle_W = (sweep.X_WL * Eigen::Vector3d(o.centre.x(), o.centre.y(), 0)).head<2>();
    std::erase_if(entries_,
                  [&](const Entry& e) { return e.seen.number == o.number || contains(e.seen.outline_W, middle_W); });
  }
}

std::uint32_t ObstacleMemory::take(const Sighting& s, const View& view, Time time) {
  if (Entry* known = match(s)) {
    see_again(*known, s, time);
    const double within = share_inside(s.samples, Vector2d::Zero(), known->seen.outline_W);
    if (within >= kInside || grow(*known, s, view)) return known->seen.id;
    // Free water lies between both, yet it is the same obstacle: it has drifted while it was in view.
    if (similar(s.area, known->area) && within >= 0.5) {
      set_outline(*known, s.outline_W);
      return known->seen.id;
    }
  }
  if (s.doubtful) return 0;
  Entry fresh;
  fresh.seen.id = next_id_++;
  fresh.seen.first_seen = time;
  fresh.seen.existence = s.existence;
  fresh.seen.number = s.number;
  set_outline(fresh, s.outline_W);
  stamp(fresh, time);
  entries_.push_back(std::move(fresh));
  return entries_.back().seen.id;
}

void ObstacleMemory::stamp(Entry& e, Time time) const {
  if (e.sweep != sweeps_) ++e.seen.sightings;
  e.sweep = sweeps_;
  e.seen.last_seen = time;
  e.variance = variance_.value_or(0);
  e.wander = wander_;
  e.unmeasured = unmeasured_;
  believe_middle(e);
  e.seen.told = false;
}

void ObstacleMemory::believe_middle(Entry& e) {
  e.belief.fill((1 - kMiddleBelief) / (kPlaces - 1));
  e.belief[0] = kMiddleBelief;
}

bool ObstacleMemory::tell(const ToldObstacle& told, Time now) {
  if (!told.centre_W.allFinite() || !std::isfinite(told.radius_m + told.sigma_m) || told.radius_m <= 0) {
    ++refused_;
    return false;
  }
  const double variance = told.sigma_m * told.sigma_m + variance_.value_or(0);
  const auto is_near = [&](const Entry& e) {
    const double sigma = std::sqrt(variance + variance_since(e) + config_.detection_sigma * config_.detection_sigma);
    return (e.centre - told.centre_W).norm() <= e.radius + told.radius_m + config_.confidence * sigma;
  };
  const auto stored = std::ranges::find_if(entries_, is_near);
  if (stored != entries_.end()) {
    const bool same = stored->seen.told && stored->teller == told.teller && stored->key == told.key;
    if (same) take_told(*stored, told, now);
    return false;
  }
  Entry fresh;
  fresh.seen.id = next_id_++;
  fresh.seen.first_seen = now;
  fresh.seen.existence = kToldExistence;
  fresh.seen.sightings = config_.confirmations;
  fresh.seen.told = true;
  fresh.teller = told.teller;
  fresh.key = told.key;
  believe_middle(fresh);
  take_told(fresh, told, now);
  entries_.push_back(std::move(fresh));
  return true;
}

void ObstacleMemory::take_told(Entry& e, const ToldObstacle& told, Time now) {
  e.seen.last_seen = now;
  e.variance = told.sigma_m * told.sigma_m;
  e.wander = wander_;
  e.unmeasured = unmeasured_;
  set_outline(e, circle_outline(told.centre_W, told.radius_m));
  e.seen.margin_m = margin_of(e);
}

double ObstacleMemory::margin_of(const Entry& e) const {
  return config_.confidence * std::sqrt(variance_since(e) + config_.detection_sigma * config_.detection_sigma);
}

// Moves the obstacle to where it is seen now.
void ObstacleMemory::see_again(Entry& e, const Sighting& s, Time time) {
  if (e.seen.told) {
    set_outline(e, s.outline_W);  // a circle was told
  } else if (e.sweep != sweeps_ && is_stale(e)) {
    Vector2d shift = shift_;
    if (share_inside(e.samples, shift, s.outline_W) + share_inside(s.samples, -shift, e.seen.outline_W) <= 0) {
      shift = similar(s.area, e.area) ? Vector2d(s.centre - e.centre) : gap(e.seen.outline_W, s.outline_W);
    }
    set_outline(e, moved_by(e.seen.outline_W, shift));
  }
  if (e.sweep != sweeps_) e.seen.number = s.number;  // of several pieces the nearest, which comes first
  e.seen.existence = std::min(kSurest, e.seen.existence + 0.5 * (1 - e.seen.existence) * s.existence);
  stamp(e, time);
}

bool ObstacleMemory::grow(Entry& e, const Sighting& s, const View& view) const {
  std::vector<Vector2d> corners = e.seen.outline_W;
  corners.insert(corners.end(), s.outline_W.begin(), s.outline_W.end());
  Polygon hull = convex_hull(std::move(corners));
  const double apart = 1 - share_inside(s.samples, Vector2d::Zero(), e.seen.outline_W);
  if (area(hull) > kLooseness * (e.area + apart * s.area)) return false;
  if (view.share_free(spread_over(hull)) > kFreeInHull) return false;
  set_outline(e, std::move(hull));
  return true;
}

void ObstacleMemory::set_outline(Entry& e, Polygon outline) {
  if (outline.size() > kCorners) outline = fewer_corners(outline);
  const Circle c = circle_of(outline);
  e.centre = c.centre;
  e.radius = c.radius;
  e.area = area(outline);
  e.samples = spread_over(outline);
  e.seen.outline_W = std::move(outline);
}

// Updates an obstacle from the free water of the sweep.
void ObstacleMemory::look_again(Entry& e, const std::vector<Sighting>& sightings, const View& view) const {
  if (e.sweep != sweeps_) {
    look_for_missing(e, view);
    return;
  }
  const double rim = view.water.free.empty() ? 0 : view.water.cells.cell_m;  // cells beside evidence are not free
  std::size_t free = 0, shown = 0;
  const Sighting* fullest = nullptr;
  double most = 0;
  for (const Sighting& s : sightings) {
    if ((s.centre - e.centre).norm() > s.radius + e.radius) continue;
    const double share = share_inside(e.samples, Vector2d::Zero(), s.outline_W);
    if (share > most) {
      most = share;
      fullest = &s;
    }
  }
  for (const Vector2d& p : e.samples) {
    const bool seen = std::any_of(sightings.begin(), sightings.end(), [&](const Sighting& s) {
      return (s.centre - p).norm() <= s.radius + rim && (nearest_point(s.outline_W, p) - p).norm() <= rim;
    });
    shown += seen;
    free += !seen && view.is_free(view.to_grid(p));
  }
  const auto all = static_cast<double>(e.samples.size());
  e.seen.whole = static_cast<double>(shown + free) >= kExplained * all;
  const bool clear = e.seen.whole && fullest && static_cast<double>(free) >= kFreeInHull * all;
  e.clear_looks = clear ? e.clear_looks + 1 : 0;
  if (e.clear_looks < config_.clear_looks) return;
  set_outline(e, fullest->outline_W);
  e.clear_looks = 0;
}

// The obstacle was not seen: checks whether it was in view, for each place where drift may have put it.
void ObstacleMemory::look_for_missing(Entry& e, const View& view) const {
  e.seen.whole = false;
  e.clear_looks = 0;
  const double sigma = std::sqrt(variance_since(e));
  if ((e.centre - view.here).norm() > view.reach + e.radius + kSpread * sigma) return;
  std::vector<Vector2d> samples_G;
  samples_G.reserve(e.samples.size());
  for (const Vector2d& p : e.samples) samples_G.push_back(view.to_grid(p));
  const auto misses = [&](std::size_t place) {
    const Vector2d moved = view.R_GW * offset_of(place, sigma);
    const auto free =
        std::count_if(samples_G.begin(), samples_G.end(), [&](const Vector2d& p) { return view.is_free(p + moved); });
    return static_cast<double>(free) >= kFree * static_cast<double>(samples_G.size());
  };
  double left = 0;                         // of the belief
  if (sigma <= config_.detection_sigma) {  // the places are the same
    left = misses(0) ? config_.miss : 1;
  } else {
    for (std::size_t i = 0; i < kPlaces; ++i) {
      if (misses(i)) e.belief[i] *= config_.miss;
      left += e.belief[i];
    }
    for (double& b : e.belief) b /= left;
  }
  const double p = e.seen.existence;
  e.seen.existence = p * left / (p * left + 1 - p);
}

// Removes obstacles that another one contains after it has grown.
void ObstacleMemory::drop_contained() {
  std::vector<std::size_t> gone;
  for (std::size_t i = 0; i < entries_.size(); ++i) {
    const Entry& small = entries_[i];
    if (small.sweep != sweeps_) continue;
    for (std::size_t k = 0; k < entries_.size(); ++k) {
      const Entry& large = entries_[k];
      const bool other = k != i && large.sweep == sweeps_ && !std::binary_search(gone.begin(), gone.end(), k);
      if (!other || large.area < small.area || (large.area == small.area && k > i)) continue;
      if ((large.centre - small.centre).norm() > large.radius) continue;
      if (share_inside(small.samples, Vector2d::Zero(), large.seen.outline_W) < kInside) continue;
      entries_[k].seen.sightings = std::max(large.seen.sightings, small.seen.sightings);
      std::replace(seen_as_.begin(), seen_as_.end(), small.seen.id, large.seen.id);
      gone.push_back(i);
      break;
    }
  }
  for (auto i = gone.rbegin(); i != gone.rend(); ++i)
    entries_.erase(entries_.begin() + static_cast<std::ptrdiff_t>(*i));
}

void ObstacleMemory::forget(Time now) {
  const auto confirmed = [this](const Entry& e) { return e.seen.sightings >= config_.confirmations; };
  std::erase_if(entries_, [&](Entry& e) {
    e.seen.margin_m = margin_of(e);
    const double age = to_seconds(now - e.seen.last_seen);
    return e.seen.existence < config_.min_existence || age > config_.max_age || e.seen.margin_m > config_.max_margin ||
           (!confirmed(e) && age > config_.unconfirmed_age);
  });
  const auto most = static_cast<std::size_t>(config_.max_obstacles);
  if (entries_.size() <= most) return;
  std::stable_sort(entries_.begin(), entries_.end(), [&](const Entry& a, const Entry& b) {
    if ((a.sweep == sweeps_) != (b.sweep == sweeps_)) return a.sweep == sweeps_;
    if (confirmed(a) != confirmed(b)) return confirmed(a);
    if (a.seen.margin_m != b.seen.margin_m) return a.seen.margin_m < b.seen.margin_m;
    return a.seen.last_seen > b.seen.last_seen;
  });
  entries_.resize(most);
  std::sort(entries_.begin(), entries_.end(), [](const Entry& a, const Entry& b) { return a.seen.id < b.seen.id; });
}

std::vector<RememberedObstacle> ObstacleMemory::known(const Vector2d& north_east, double radius_m) const {
  std::vector<RememberedObstacle> out;
  for (const Entry& e : entries_) {
    if (e.seen.sightings < config_.confirmations) continue;
    const double distance = (nearest_point(e.seen.outline_W, north_east) - north_east).norm();
    if (distance - e.seen.margin_m <= radius_m) out.push_back(e.seen);
  }
  return out;
}

}  // namespace isobath
