#include <algorithm>
#include <cmath>
#include <isobath/base/error.hpp>
#include <isobath/io/gdal/geotiff.hpp>
#include <isobath/perception/sounding_comparison.hpp>
#include <isobath/world/map_raster.hpp>
#include <limits>

namespace isobath {
namespace {

constexpr double kMaxCells = 16e6;
constexpr float kNothing = std::numeric_limits<float>::quiet_NaN();

DepthSource source_of(unsigned flags) {
  if ((flags & kSensed) == 0) return DepthSource::kPrior;
  const bool down = (flags & kSeenByDepth) != 0, ahead = (flags & kSeenByObstacle) != 0;
  return down && ahead ? DepthSource::kBoth : down ? DepthSource::kDepthSonar : DepthSource::kObstacleSonar;
}

/// Extends the window `all` to include `part`.
void extend(PixelWindow& all, const PixelWindow& part) {
  if (all.width == 0) {
    all = part;
    return;
  }
  const int right = std::max(all.column + all.width, part.column + part.width);
  const int bottom = std::max(all.row + all.height, part.row + part.height);
  all.column = std::min(all.column, part.column);
  all.row = std::min(all.row, part.row);
  all.width = right - all.column;
  all.height = bottom - all.row;
}

}  // namespace

PixelWindow known_extent(const DepthTrees& trees) {
  PixelWindow all;
  for (const RegionQuadtree* tree : {&trees.prior(), &trees.sensed()}) {
    tree->for_each_leaf(trees.extent(), [&](std::uint32_t word, const PixelWindow& leaf) {
      if (word != DepthPixel::kUnknownDepth) extend(all, leaf);
    });
  }
  return all;
}

MapRaster read_raster(const DepthSnapshot& snapshot, const PixelWindow& pixels, int pixels_a_cell) {
  int factor = pixels_a_cell;
  if (factor <= 0) {
    factor = 1;
    while (double{1} * pixels.width * pixels.height / factor / factor > kMaxCells) factor *= 2;
  }
  const auto down = [factor](int p) { return p >= 0 ? p / factor : -((-p + factor - 1) / factor); };
  MapRaster raster;
  raster.grid = {snapshot.grid().corner_m, snapshot.grid().pixel_m * factor};
  raster.window = {down(pixels.column), down(pixels.row), 0, 0};
  raster.window.width = down(pixels.column + pixels.width - 1) - raster.window.column + 1;
  raster.window.height = down(pixels.row + pixels.height - 1) - raster.window.row + 1;
  const std::size_t cells = static_cast<std::size_t>(raster.window.width) * raster.window.height;
  raster.depth_m.assign(cells, kNothing);
  raster.confidence.assign(cells, 255);
  raster.flags.assign(cells, 0);
  raster.age_min.assign(cells, kNothing);
  std::vector<DepthPixel> strip(static_cast<std::size_t>(raster.window.width) * factor * factor);
  for (int row = 0; row < raster.window.height; ++row) {
    const int width = raster.window.width * factor;
    snapshot.read({raster.window.column * factor, (raster.window.row + row) * factor, width, factor}, strip);
    for (std::size_t i = 0; i < strip.size(); ++i) {
      const DepthPixel& pixel = strip[i];
      const std::size_t column = i % static_cast<std::size_t>(width) / static_cast<std::size_t>(factor);
      const std::size_t cell = static_cast<std::size_t>(row) * raster.window.width + column;
      if (pixel.has(kTrack)) raster.flags[cell] |= kTrack;
      if (!pixel.known()) continue;
      const auto depth = static_cast<float>(pixel.depth_m());
      if (depth >= raster.depth_m[cell]) continue;  // false for NaN: the first known pixel counts
      raster.depth_m[cell] = depth;
      raster.confidence[cell] = static_cast<std::uint8_t>(pixel.confidence());
      raster.flags[cell] = static_cast<std::uint8_t>(pixel.flags() | (raster.flags[cell] & kTrack));
      raster.age_min[cell] = (pixel.flags() & (kSensed | kSeenByDepth | kSeenByObstacle)) != 0
                                 ? static_cast<float>(pixel.minute())
                                 : kNothing;
    }
  }
  return raster;
}

std::shared_ptr<const DepthSnapshot> snapshot_of(const StoredMap& map) {
  DepthMapConfig config;
  config.window_pixels = 64;
  config.pixel_m = map.facts.area.grid.pixel_m;
  return DepthMap(config, map.facts.area, map.trees, {0, 0}).snapshot();
}

std::vector<float> vertical_uncertainty(const MapRaster& raster, const RevisitRecord& revisits,
                                        const ReadingEvidenceConfig& margin) {
  std::vector<float> tvu(raster.depth_m.size(), kNothing);
  const auto uncertainty = revisits.uncertainty();
  if (!uncertainty) return tvu;
  const PixelWindow& all = raster.window;
  const auto read = [&](const PixelWindow& wanted, std::span<DepthPixel> out) {
    std::size_t i = 0;
    for (int row = wanted.row; row < wanted.row + wanted.height; ++row) {
      for (int column = wanted.column; column < wanted.column + wanted.width; ++column, ++i) {
        out[i] = DepthPixel{};
        if (!all.contains({column, row})) continue;
        const std::size_t cell = static_cast<std::size_t>(row - all.row) * all.width + (column - all.column);
        if (std::isnan(raster.depth_m[cell])) continue;
        out[i] = {DepthPixel::word_of_depth(static_cast<double>(raster.depth_m[cell])),
                  DepthPixel::word_of_state(raster.confidence[cell], raster.flags[cell], 0)};
      }
    }
  };
  SoundingComparison comparison(raster.grid);
  for (std::size_t cell = 0; cell < tvu.size(); ++cell) {
    if (std::isnan(raster.depth_m[cell]) || (raster.flags[cell] & kSeenByDepth) == 0) continue;
    const Pixel at{all.column + static_cast<int>(cell % static_cast<std::size_t>(all.width)),
                   all.row + static_cast<int>(cell / static_cast<std::size_t>(all.width))};
    const auto gradient = comparison.gradient(read, raster.grid.centre(at));
    const double within = agreement_margin(margin.margin_m, margin.margin_share, raster.depth_m[cell]);
    tvu[cell] = static_cast<float>(
        uncertainty->tvu_m(within, gradient ? std::optional<double>(gradient->norm()) : std::nullopt));
  }
  return tvu;
}

void write_map_geotiff(const MapRaster& raster, const MapFacts& facts, const ReadingEvidenceConfig& margin,
                       const std::filesystem::path& file) {
  Time newest = facts.epoch;
  for (const MapVisit& visit : facts.visits) newest = std::max(newest, visit.last);
  const auto until = static_cast<float>(to_seconds(newest - facts.epoch) / 60);
  std::vector<float> confidence, age, source;
  const std::vector<float> tvu = vertical_uncertainty(raster, facts.revisits, margin);
  for (std::size_t i = 0; i < raster.depth_m.size(); ++i) {
    const bool known_here = !std::isnan(raster.depth_m[i]);
    confidence.push_back(known_here ? static_cast<float>(raster.confidence[i]) / kFullConfidence : kNothing);
    age.push_back((until - raster.age_min[i]) / (60 * 24));
    source.push_back(known_here ? static_cast<float>(source_of(raster.flags[i])) : kNothing);
  }
  const RasterFrame frame{.columns = raster.window.width,
                          .rows = raster.window.height,
                          .cell_m = raster.grid.pixel_m,
                          .corner_m = {raster.grid.corner_m.x() - raster.window.row * raster.grid.pixel_m,
                                       raster.grid.corner_m.y() + raster.window.column * raster.grid.pixel_m},
                          .up = {},
                          .origin = facts.origin};
  const std::vector<RasterBand> bands{{{"depth below " + facts.datum, "m"}, raster.depth_m},
                                      {{"confidence, 0 to 1", ""}, confidence},
                                      {{"age of the last reading before the newest one", "day"}, age},
                                      {{"source: 1 prior, 2 depth sonar, 3 obstacle sonar, 4 both", ""}, source},
                                      {{"total vertical uncertainty, 95 %", "m"}, tvu}};
  write_geotiff(file, frame, bands);
}

}  // namespace isobath
