#include <algorithm>
#include <cmath>
#include <isobath/world/map_changes.hpp>
#include <map>
#include <set>
#include <tuple>

namespace isobath {
namespace {

constexpr int kSide = DepthTile::kSide;

enum class Sense : std::uint8_t { kSame, kShoaler, kDeeper };

/// Adjacent changed pixels of one row.
struct Run {
  std::int32_t begin = 0, end = 0;
  Sense sense = Sense::kSame;
  std::size_t region = 0;
};

/// Joins the runs of consecutive rows, from the north, into regions.
class RegionList {
 public:
  explicit RegionList(const PixelGrid& grid) : grid_(grid) {}

  /// Runs come in the order of their columns, rows from the north; empty rows may be left out.
  void add_row(std::int32_t row, std::vector<Run> runs) {
    if (row != row_ + 1) above_.clear();
    std::size_t first = 0;
    for (Run& run : runs) {
      run.region = root_of(run.region);
      while (first < above_.size() && above_[first].end < run.begin) ++first;
      for (std::size_t i = first; i < above_.size() && above_[i].begin <= run.end; ++i) {
        if (above_[i].sense == run.sense) run.region = join(run.region, above_[i].region);
      }
    }
    above_ = std::move(runs);
    row_ = row;
  }

  std::size_t open(bool shoaler) {
    parents_.push_back(parents_.size());
    regions_.emplace_back().shoaler = shoaler;
    return parents_.size() - 1;
  }

  void add_pixel(std::size_t region, Pixel p, const DepthPixel& pixel, double charted_m) {
    ChangedRegion one;
    const Eigen::Vector2d centre = grid_.centre(p), half = Eigen::Vector2d::Constant(grid_.pixel_m / 2);
    one.south_west = centre - half;
    one.north_east = centre + half;
    one.pixels = 1;
    one.shoalest_at = centre;
    one.shoalest_m = pixel.depth_m();
    one.charted_m = charted_m;
    one.confidence = pixel.confidence();
    one.last_minute = pixel.minute();
    const bool down = pixel.has(kSeenByDepth), ahead = pixel.has(kSeenByObstacle);
    ++(down && ahead ? one.by_both : down ? one.by_depth_sonar : one.by_obstacle_sonar);
    merge(regions_[region], one);
  }

  std::vector<ChangedRegion> take() {
    std::vector<ChangedRegion> all;
    for (std::size_t i = 0; i < regions_.size(); ++i) {
      if (parents_[i] != i) continue;
      regions_[i].area_m2 = static_cast<double>(regions_[i].pixels) * grid_.pixel_m * grid_.pixel_m;
      all.push_back(regions_[i]);
    }
    return all;
  }

 private:
  static void merge(ChangedRegion& into, const ChangedRegion& from) {
    if (into.pixels == 0 || from.shoalest_m < into.shoalest_m) {
      into.shoalest_at = from.shoalest_at;
      into.shoalest_m = from.shoalest_m;
      into.charted_m = from.charted_m;
      into.confidence = from.confidence;
    }
    into.south_west = into.pixels == 0 ? from.south_west : into.south_west.cwiseMin(from.south_west).eval();
    into.north_east = into.pixels == 0 ? from.north_east : into.north_east.cwiseMax(from.north_east).eval();
    into.pixels += from.pixels;
    into.by_depth_sonar += from.by_depth_sonar;
    into.by_obstacle_sonar += from.by_obstacle_sonar;
    into.by_both += from.by_both;
    into.last_minute = std::max(into.last_minute, from.last_minute);
  }

  std::size_t root_of(std::size_t region) {
    while (parents_[region] != region) region = parents_[region] = parents_[parents_[region]];
    return region;
  }

  std::size_t join(std::size_t a, std::size_t b) {
    a = root_of(a);
    b = root_of(b);
    if (a == b) return a;
    const std::size_t older = std::min(a, b), younger = std::max(a, b);
    merge(regions_[older], regions_[younger]);
    parents_[younger] = older;
    return older;
  }

  PixelGrid grid_;
  std::vector<ChangedRegion> regions_;
  std::vector<std::size_t> parents_;
  std::vector<Run> above_;
  std::int32_t row_ = -2;
};

/// The rows of tiles, each with the columns of the tiles that hold sensed pixels or track.
std::map<std::int32_t, std::set<std::int32_t>> tiles_in_use(const DepthTrees& trees) {
  std::map<std::int32_t, std::set<std::int32_t>> tiles;
  trees.state().for_each_leaf(trees.extent(), [&](std::uint32_t word, const PixelWindow& leaf) {
    const DepthPixel pixel{0, word};
    if (!pixel.has(kSensed) && !pixel.has(kTrack)) return;
    for (int row = leaf.row / kSide; row <= (leaf.row + leaf.height - 1) / kSide; ++row) {
      std::set<std::int32_t>& columns = tiles[row];
      for (int c = leaf.column / kSide; c <= (leaf.column + leaf.width - 1) / kSide; ++c) columns.insert(c);
    }
  });
  return tiles;
}

void extend_track(MapChanges& changes, Pixel p) {
  ++changes.track_pixels;
  if (!changes.track.empty()) {
    PixelWindow& last = changes.track.back();
    if (last.row == p.row && last.column + last.width == p.column) {
      ++last.width;
      return;
    }
  }
  changes.track.push_back({p.column, p.row, 1, 1});
}

}  // namespace

MapChanges find_changes(const DepthTrees& trees, const PixelGrid& grid, double margin_m) {
  MapChanges changes;
  RegionList regions(grid);
  const auto margin_cm = static_cast<std::int32_t>(std::lround(100 * margin_m));
  std::vector<DepthPixel> pixels(kSide * kSide);
  std::vector<std::uint32_t> charted(kSide * kSide);
  std::vector<std::vector<DepthPixel>> rows(kSide);
  struct Strip {
    std::vector<DepthPixel> pixels;
    std::vector<std::uint32_t> charted;
  };
  for (const auto& [tile_row, columns] : tiles_in_use(trees)) {
    std::map<std::int32_t, Strip> strip;
    for (const std::int32_t column : columns) {
      const PixelWindow window{column * kSide, tile_row * kSide, kSide, kSide};
      trees.read(window, pixels);
      trees.prior().read(window, charted.data(), kSide);
      strip[column] = {pixels, charted};
    }
    for (int r = 0; r < kSide; ++r) {
      std::vector<Run> runs;
      for (const auto& [column, tile] : strip) {
        for (int c = 0; c < kSide; ++c) {
          const std::size_t i = static_cast<std::size_t>(r) * kSide + c;
          const DepthPixel& pixel = tile.pixels[i];
          const Pixel p{column * kSide + c, tile_row * kSide + r};
          if (pixel.has(kTrack)) extend_track(changes, p);
          if (!pixel.has(kSensed) || !pixel.known()) continue;
          ++changes.sensed_pixels;
          if (tile.charted[i] == DepthPixel::kUnknownDepth) {
            ++changes.uncharted_pixels;
            continue;
          }
          const DepthPixel chart{tile.charted[i], 0};
          const std::int32_t deeper_by = pixel.depth_cm() - chart.depth_cm();
          if (std::abs(deeper_by) <= margin_cm) continue;
          ++changes.changed_pixels;
          const Sense sense = deeper_by < 0 ? Sense::kShoaler : Sense::kDeeper;
          if (runs.empty() || runs.back().end != p.column || runs.back().sense != sense) {
            runs.push_back({p.column, p.column, sense, regions.open(sense == Sense::kShoaler)});
          }
          runs.back().end = p.column + 1;
          regions.add_pixel(runs.back().region, p, pixel, chart.depth_m());
        }
      }
      if (!runs.empty()) regions.add_row(tile_row * kSide + r, std::move(runs));
    }
  }
  changes.regions = regions.take();
  const auto order = [](const ChangedRegion& r) {
    return std::tuple(!r.is_obstacle(), -static_cast<std::int64_t>(r.pixels), -r.north_east.x(), r.south_west.y());
  };
  std::sort(changes.regions.begin(), changes.regions.end(),
            [&](const ChangedRegion& a, const ChangedRegion& b) { return order(a) < order(b); });
  return changes;
}

DepthSource ChangedRegion::source() const {
  if (2 * by_obstacle_sonar > pixels) return DepthSource::kObstacleSonar;
  return 2 * by_depth_sonar > pixels ? DepthSource::kDepthSonar : DepthSource::kBoth;
}

std::size_t MapChanges::obstacles() const {
  return static_cast<std::size_t>(
      std::count_if(regions.begin(), regions.end(), [](const ChangedRegion& r) { return r.is_obstacle(); }));
}

const char* to_text(DepthSource source) {
  switch (source) {
    case DepthSource::kNone: return "nothing";
    case DepthSource::kPrior: return "chart";
    case DepthSource::kDepthSonar: return "depth sonar";
    case DepthSource::kObstacleSonar: return "forward sonar";
    case DepthSource::kBoth: return "both";
  }
  return "";
}

const char* kind_of(const ChangedRegion& region) {
  return region.is_obstacle() ? "obstacle" : region.shoaler ? "shoaler" : "deeper";
}

}  // namespace isobath
