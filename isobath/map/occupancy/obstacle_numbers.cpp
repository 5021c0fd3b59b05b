#include <algorithm>
#include <isobath/map/occupancy/obstacle_numbers.hpp>
#include <isobath/map/occupancy/obstacle_outline.hpp>
#include <limits>
#include <tuple>
#include <utility>

namespace isobath {
namespace {

using Eigen::Vector2d;

/// Area of the outlines of `a` that lies within those of `b`, m2, to a tenth of an outline.
double shared_area(const std::vector<Polygon>& a, const std::vector<Polygon>& b) {
  double shared = 0;
  for (const Polygon& outline : a) {
    const std::vector<Vector2d> samples = spread_over(outline);
    const auto inside = std::count_if(samples.begin(), samples.end(), [&](const Vector2d& p) {
      return std::any_of(b.begin(), b.end(), [&](const Polygon& other) { return contains(other, p); });
    });
    shared += area(outline) * static_cast<double>(inside) / static_cast<double>(samples.size());
  }
  return shared;
}

double distance_between(const std::vector<Polygon>& a, const std::vector<Polygon>& b) {
  double least = std::numeric_limits<double>::infinity();
  for (const Polygon& one : a) {
    for (const Polygon& other : b) least = std::min(least, gap(one, other).norm());
  }
  return least;
}

/// An obstacle of the scan that may be a known one.
struct NumberMatch {
  double shared_m2 = 0, apart_m = 0;
  std::size_t known = 0, region = 0;

  /// Best first; the rest of the order makes it unique.
  bool operator<(const NumberMatch& other) const {
    return std::tuple(-shared_m2, apart_m, known, region) <
           std::tuple(-other.shared_m2, other.apart_m, other.known, other.region);
  }
};

}  // namespace

std::vector<ObstacleNumbers::Region> ObstacleNumbers::regions_of(std::span<const Obstacle> pieces, const Pose& X_WL) {
  std::vector<Region> regions;
  for (const Obstacle& o : pieces) {
    if (o.outline.empty()) continue;
    auto region =
        std::find_if(regions.begin(), regions.end(), [&](const Region& r) { return r.number_in_scan == o.number; });
    if (region == regions.end()) region = regions.insert(regions.end(), Region{o.number, {}, 0});
    region->place.velocity_W = o.motion.velocity_W;
    Polygon& outline = region->place.outlines_W.emplace_back();
    for (const Vector2d& p : o.outline) {
      outline.emplace_back((X_WL * Eigen::Vector3d(p.x(), p.y(), 0)).head<2>());
      region->place.box.extend(outline.back());
    }
  }
  return regions;
}

void ObstacleNumbers::match(std::vector<Region>& regions) {
  std::vector<NumberMatch> candidates;
  for (std::size_t k = 0; k < known_.size(); ++k) {
    const Place& known = known_[k].place;
    for (std::size_t r = 0; r < regions.size(); ++r) {
      const Place& seen = regions[r].place;
      if (known.box.exteriorDistance(seen.box) > kSame_m) continue;
      const double shared = shared_area(seen.outlines_W, known.outlines_W);
      const double apart = shared > 0 ? 0 : distance_between(seen.outlines_W, known.outlines_W);
      if (apart <= kSame_m) candidates.push_back({shared, apart, k, r});
    }
  }
  std::sort(candidates.begin(), candidates.end());
  std::vector<bool> given(known_.size(), false);
  for (const NumberMatch& c : candidates) {
    if (given[c.known] || regions[c.region].number > 0) continue;
    given[c.known] = true;
    regions[c.region].number = known_[c.known].number;
  }
}

void ObstacleNumbers::remember(Region& region, Time time) {
  const auto known = std::lower_bound(known_.begin(), known_.end(), region.number,
                                      [](const Known& k, int number) { return k.number < number; });
  if (known == known_.end() || known->number != region.number) {
    known_.insert(known, {region.number, std::move(region.place), scan_, time});
  } else {
    *known = {region.number, std::move(region.place), scan_, time};
  }
}

void ObstacleNumbers::drop_the_oldest() {
  while (known_.size() > kMax) {
    known_.erase(std::min_element(known_.begin(), known_.end(), [](const Known& a, const Known& b) {
      return std::pair(a.scan, a.number) < std::pair(b.scan, b.number);
    }));
  }
}

void ObstacleNumbers::keep(std::span<Obstacle> pieces, const Pose& X_WL, Time time) {
  ++scan_;
  for (Known& known : known_) {
    if (!known.place.velocity_W.isZero(0)) known.place.move(to_seconds(time - known.time) * known.place.velocity_W);
    known.time = time;
  }
  std::vector<Region> regions = regions_of(pieces, X_WL);
  match(regions);
  for (Region& region : regions) {
    if (region.number == 0) region.number = ++last_;
  }
  for (Obstacle& o : pieces) {
    const auto region =
        std::find_if(regions.begin(), regions.end(), [&](const Region& r) { return r.number_in_scan == o.number; });
    if (region != regions.end()) o.number = region->number;
  }
  for (Region& region : regions) remember(region, time);
  drop_the_oldest();
}

void ObstacleNumbers::Place::move(const Vector2d& by_W) {
  box.translate(by_W);
  for (Polygon& outline : outlines_W) outline = moved_by(std::move(outline), by_W);
}

void ObstacleNumbers::move(const Vector2d& by_W) {
  for (Known& known : known_) known.place.move(by_W);
}

}  // namespace isobath
