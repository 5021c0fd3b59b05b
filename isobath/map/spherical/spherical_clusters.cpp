#include <algorithm>
#include <cmath>
#include <isobath/base/error.hpp>
#include <isobath/map/spherical/spherical_clusters.hpp>
#include <numeric>
#include <utility>

namespace isobath {
namespace {

/// Disjoint sets: each element points towards the first of its set.
class JoinedSets {
 public:
  explicit JoinedSets(std::size_t count) : parent_(count) { std::iota(parent_.begin(), parent_.end(), 0u); }
  [[nodiscard]] std::uint32_t first_of(std::uint32_t i) {
    while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
    return i;
  }
  void join(std::uint32_t a, std::uint32_t b) {
    a = first_of(a);
    b = first_of(b);
    parent_[std::max(a, b)] = std::min(a, b);
  }

 private:
  std::vector<std::uint32_t> parent_;
};

/// Occupied cells of one direction: their layers, and the number of the first.
struct OccupiedRun {
  std::vector<int> layers;
  std::uint32_t first = 0;
};

void join_runs(const OccupiedRun& a, const OccupiedRun& b, JoinedSets& sets) {
  std::size_t low = 0;
  for (std::size_t i = 0; i < a.layers.size(); ++i) {
    while (low < b.layers.size() && b.layers[low] < a.layers[i] - 1) ++low;
    for (std::size_t k = low; k < b.layers.size() && b.layers[k] <= a.layers[i] + 1; ++k) {
      sets.join(a.first + static_cast<std::uint32_t>(i), b.first + static_cast<std::uint32_t>(k));
    }
  }
}

}  // namespace

std::vector<SphericalCluster> clusters(const SphericalGrid& grid, double probability) {
  const double least = std::log(probability / (1 - probability));
  const int azimuths = grid.buckets().azimuths(), elevations = grid.buckets().elevations();
  DirectionTable table(azimuths, elevations);
  std::vector<OccupiedRun> runs;
  std::vector<SphericalPlace> places;
  std::vector<const SphericalCell*> cells;
  grid.cells().each_beam([&](const SphericalDirection& d, std::span<const SphericalCell> beam) {
    OccupiedRun run{{}, static_cast<std::uint32_t>(places.size())};
    for (const SphericalCell& cell : beam) {
      if (static_cast<double>(cell.log_odds) < least) continue;
      run.layers.push_back(cell.layer);
      places.push_back({d, cell.layer});
      cells.push_back(&cell);
    }
    if (run.layers.empty()) return;
    table.set(d, static_cast<std::uint32_t>(runs.size()));
    runs.push_back(std::move(run));
  });
  JoinedSets sets(places.size());
  for (auto d = table.first(); d; d = table.after(*d)) {
    const OccupiedRun& run = runs[table.find(*d)];
    const bool at_pole = d->elevation == 0 || d->elevation == elevations - 1;
    const int around = at_pole ? azimuths - 1 : 1;
    for (int a = 0; a <= around; ++a) {
      for (int e = a == 0 ? 0 : -1; e <= 1; ++e) {  // each pair once
        const SphericalDirection other{(d->azimuth + a) % azimuths, d->elevation + e};
        if (other.elevation < 0 || other.elevation >= elevations || (a > 1 && e != 0)) continue;
        const std::uint32_t id = table.find(other);
        if (id != DirectionTable::kNone) join_runs(run, runs[id], sets);
      }
    }
  }
  std::vector<SphericalCluster> all;
  std::vector<std::uint32_t> number(places.size());
  for (std::uint32_t i = 0; i < places.size(); ++i) {
    const std::uint32_t first = sets.first_of(i);
    if (first == i) {
      number[i] = static_cast<std::uint32_t>(all.size());
      all.emplace_back().nearest_m = grid.layers().range_m();
    }
    SphericalCluster& cluster = all[number[first]];
    const Eigen::Vector3d p = grid.point_of(*cells[i]);
    cluster.cells.push_back(places[i]);
    cluster.echoes += cells[i]->echoes;
    cluster.centroid += p;
    cluster.nearest_m = std::min(cluster.nearest_m, p.norm());
  }
  for (SphericalCluster& cluster : all) cluster.centroid /= static_cast<double>(cluster.cells.size());
  std::stable_sort(all.begin(), all.end(), [](const SphericalCluster& a, const SphericalCluster& b) {
    return a.cells.size() > b.cells.size();
  });
  return all;
}

void zoom(const SphericalGrid& grid, ZoomRule rule, SphericalGrid& coarse) {
  ISOBATH_ASSERT(coarse.cells().size() == 0);
  coarse.turn((grid.turned() - coarse.turned()).wrapped());
  std::vector<std::pair<SphericalPlace, double>> parts;
  grid.cells().each_beam([&](const SphericalDirection&, std::span<const SphericalCell> beam) {
    for (const SphericalCell& cell : beam) {
      const Eigen::Vector3d p = grid.point_of(cell);
      const auto place = coarse.place_at(coarse.to_table(p));
      if (!place) continue;
      coarse.add_content(p, cell);
      parts.emplace_back(*place, static_cast<double>(cell.log_odds));
    }
  });
  std::stable_sort(parts.begin(), parts.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
  for (std::size_t i = 0; i < parts.size();) {
    const SphericalPlace place = parts[i].first;
    double largest = parts[i].second, number = 0;
    for (; i < parts.size() && parts[i].first == place; ++i) {
      largest = std::max(largest, parts[i].second);
      number += std::log1p(std::exp(parts[i].second));  // -ln(1 - P)
    }
    coarse.set_log_odds(place, rule == ZoomRule::kAny ? std::log(std::expm1(number)) : largest);
  }
}

// Halves the triangle along its longest side until each part is within half a cell of one place.
void add_known_triangle(SphericalGrid& grid, const std::array<Eigen::Vector3d, 3>& corners_G) {
  std::vector<std::array<Eigen::Vector3d, 3>> waiting{corners_G};
  while (!waiting.empty()) {
    const Eigen::Vector3d a = waiting.back()[0], b = waiting.back()[1], c = waiting.back()[2];
    waiting.pop_back();
    const double ab = (b - a).norm(), bc = (c - b).norm(), ca = (a - c).norm(), longest = std::max({ab, bc, ca});
    const Eigen::Vector3d middle = (a + b + c) / 3;
    const double range = middle.norm();
    if (range - longest > grid.layers().range_m()) continue;
    const double edge = std::max(range, 0.5 * grid.config().min_layer_m) * grid.config().bucket.radians();
    if (longest <= 0.5 * edge) {
      grid.add_known(middle, longest);
    } else if (ab == longest) {
      waiting.push_back({c, a, 0.5 * (a + b)});
      waiting.push_back({b, c, 0.5 * (a + b)});
    } else if (bc == longest) {
      waiting.push_back({a, b, 0.5 * (b + c)});
      waiting.push_back({c, a, 0.5 * (b + c)});
    } else {
      waiting.push_back({b, c, 0.5 * (c + a)});
      waiting.push_back({a, b, 0.5 * (c + a)});
    }
  }
}

}  // namespace isobath
