#include <algorithm>
#include <cmath>
#include <Eigen/Geometry>
#include <isobath/base/error.hpp>
#include <isobath/perception/depth_update.hpp>
#include <isobath/world/depth_prior.hpp>
#include <limits>

namespace isobath {
namespace {

constexpr int kSquaresAcross = 12;  // 2^12 squares span the area

constexpr double kLandAround = 50;  // m of land that an outline puts around its water

/// An outline makes everything outside it land. Removes the land farther than kLandAround from the water's box.
void keep_near_water(Prior& prior) {
  Eigen::AlignedBox2d water;
  for (const PriorArea& area : prior.areas) {
    if (area.kind != PriorAreaKind::kWater) continue;
    for (const Polygon& ring : area.rings) {
      for (const Eigen::Vector2d& corner : ring) water.extend(corner);
    }
  }
  if (water.isEmpty()) return;
  const PriorWindow& window = prior.raster.window;
  for (std::int32_t row = 0; row < window.rows; ++row) {
    for (std::int32_t column = 0; column < window.columns; ++column) {
      const Pixel p{column, row};
      if (water.exteriorDistance(window.grid.centre(p)) <= kLandAround) continue;
      prior.raster.depth_m[prior.raster.index(p)] = std::numeric_limits<float>::quiet_NaN();
    }
  }
}

/// Variance of the known depths of the 3 x 3 squares around one, m2.
double local_variance(const std::vector<std::uint32_t>& depth, int side, int row, int column) {
  double n = 0, sum = 0, squares = 0;
  for (int r = std::max(0, row - 1); r <= std::min(side - 1, row + 1); ++r) {
    for (int c = std::max(0, column - 1); c <= std::min(side - 1, column + 1); ++c) {
      const DepthPixel near{depth[static_cast<std::size_t>(r) * side + c], 0};
      if (!near.known()) continue;
      ++n;
      sum += near.depth_m();
      squares += near.depth_m() * near.depth_m();
    }
  }
  return n > 0 ? std::max(0.0, squares / n - sum * sum / (n * n)) : 0;
}

/// S1-72.
void doubt_rough_ground(const std::vector<std::uint32_t>& depth, std::vector<std::uint32_t>& state, int side,
                        double rough_m, const DepthRules& rules) {
  for (int row = 0; row < side; ++row) {
    for (int column = 0; column < side; ++column) {
      const std::size_t i = static_cast<std::size_t>(row) * side + column;
      if (depth[i] == DepthPixel::kUnknownDepth) continue;
      const double roughness = local_variance(depth, side, row, column) / (rough_m * rough_m);
      const int base = std::max(rules.threshold, static_cast<int>(std::lround(kFullConfidence / (1 + roughness))));
      state[i] = DepthPixel::word_of_state(std::min(base, DepthPixel{0, state[i]}.confidence()), 0, 0);
    }
  }
}

/// By how many levels the squares of the prior are coarser than pixels.
int coarser_by(const DepthPriorConfig& config, const DepthArea& area) {
  if (config.pixel_m <= 0) return std::max(0, area.levels - kSquaresAcross);
  const int wanted = static_cast<int>(std::lround(std::log2(config.pixel_m / area.grid.pixel_m)));
  return std::clamp(wanted, std::max(0, area.levels - 14), area.levels);
}

}  // namespace

std::vector<Field> fields(DepthPriorConfig& c) {
  std::vector<Field> all{
      Field::file("file", &c.file, "Chart, grid, outline or soundings that a new map starts from; empty: none."),
      Field::real("pixel_m", &c.pixel_m, {0, 1000}, "m", "Side of the prior's squares; 0: set by the area's size."),
      Field::real(
          "rough_m", &c.rough_m, {0, 1000}, "m",
          "Charted ground whose depths vary between squares by much more than this gets less confidence; 0: off."),
      Field::text("map_datum", &c.datum, "Vertical datum of the map's depths.")};
  for (Field& field : fields(c.reading)) {
    if (field.name() != "map_datum") all.push_back(std::move(field));
  }
  return all;
}

DepthTrees DepthPrior::trees(int levels) const { return depth ? DepthTrees(*depth, *state) : DepthTrees(levels); }

DepthPrior read_depth_prior(const std::vector<std::string>& files, const DepthPriorConfig& config,
                            const DepthMapperParts& mapper, const DepthArea& area,
                            const std::optional<GeoOrigin>& origin) {
  DepthPrior prior;
  if (!origin) {
    throw Error("a prior needs geographic positions, and the input has none", {files.front()}, {},
                "use a log with latitudes and longitudes");
  }
  const int coarser = coarser_by(config, area);
  const int levels = area.levels - coarser;
  const int side = 1 << levels;
  const PriorWindow window{{area.grid.corner_m, std::ldexp(area.grid.pixel_m, coarser)}, side, side};
  const LocalPlane plane(*origin);
  PriorConfig reading = config.reading;
  if (config.datum != DepthPriorConfig{}.datum) reading.map_datum = config.datum;
  std::vector<std::uint32_t> depth(static_cast<std::size_t>(side) * side, DepthPixel::kUnknownDepth);
  std::vector<std::uint32_t> state(depth.size(), 0);
  const DepthRules& rules = mapper.rules;
  for (const std::string& file : files) {
    Prior read = read_prior(file, reading, plane, window);
    keep_near_water(read);
    const PriorRaster& raster = read.raster;
    for (std::size_t i = 0; i < std::min(depth.size(), raster.depth_m.size()); ++i) {
      if (!std::isfinite(raster.depth_m[i]) || depth[i] != DepthPixel::kUnknownDepth) continue;
      depth[i] = DepthPixel::word_of_depth(static_cast<double>(raster.depth_m[i]));
      const double sigma = std::isfinite(raster.sigma_m[i]) ? static_cast<double>(raster.sigma_m[i]) : 1e3;
      const double share = evidence_share(sigma, mapper.evidence.margin_m);
      const int confidence = static_cast<int>(std::lround(rules.base_prior * share));
      state[i] = DepthPixel::word_of_state(std::clamp(confidence, rules.threshold, rules.base_prior), 0, 0);
    }
    read.raster = {};
    prior.sources.push_back(file);
    prior.files.push_back(std::move(read));
  }
  if (config.rough_m > 0) doubt_rough_ground(depth, state, side, config.rough_m, rules);
  // The tree of the squares is that of their pixels: the same quadrants with other numbers of levels.
  const auto finer = [&](const std::vector<std::uint32_t>& words) {
    const RegionQuadtree tree = RegionQuadtree::from_raster(levels, words, side, side, 0);
    return RegionQuadtree(area.levels, 0, tree.root(), tree.pool());
  };
  prior.depth = finer(depth);
  prior.state = finer(state);
  return prior;
}

}  // namespace isobath
