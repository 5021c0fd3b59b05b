#include <algorithm>
#include <array>
#include <cmath>
#include <isobath/planning/grid_search.hpp>
#include <isobath/planning/pilot_search.hpp>
#include <optional>

namespace isobath {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr std::int32_t kRowsRead = 64;  // at a time: a quadtree reads whole squares
constexpr double kWidest = 500;         // pixels, half-width of a vehicle: every step checks its whole corridor

/// Which pixels of an area are clear, and what a metre of way over each costs beyond its length.
class Area {
 public:
  Area(const DepthField& map, PixelWindow window, double vehicle_z, const PilotSearchConfig& config,
       std::span<const ChartObstacle> chart, const RiskGrid* threats)
      : grid_(map.grid()), window_(window) {
    std::vector<DepthPixel> rows(static_cast<std::size_t>(window.width) * kRowsRead);
    clear_.reserve(size());
    for (std::int32_t r = 0; r < window.height; r += kRowsRead) {
      const std::int32_t height = std::min(kRowsRead, window.height - r);
      const std::span band(rows.data(), static_cast<std::size_t>(window.width) * static_cast<std::size_t>(height));
      map.read({window.column, window.row + r, window.width, height}, band);
      for (const DepthPixel& p : band) {
        clear_.push_back(p.known() && p.confidence() >= config.passage.min_confidence &&
                         p.depth_m() - vehicle_z >= config.passage.clearance_m);
      }
    }
    for (const ChartObstacle& o : chart) {
      if (o.top_m - vehicle_z < config.passage.clearance_m) block(o);
    }
    measure_risk(config);
    if (threats != nullptr) add_threats(*threats, config.threat_weight_m);
    for (std::size_t i = 0; i < kGridSteps.size(); ++i) {
      footprints_[i] = footprint({kGridSteps[i].column, kGridSteps[i].row}, config.passage.half_width_m);
    }
  }

  [[nodiscard]] std::size_t size() const {
    return static_cast<std::size_t>(window_.width) * static_cast<std::size_t>(window_.height);
  }
  [[nodiscard]] bool contains(Pixel p) const { return window_.contains(p); }
  [[nodiscard]] std::size_t index(Pixel p) const {
    return static_cast<std::size_t>(p.row - window_.row) * static_cast<std::size_t>(window_.width) +
           static_cast<std::size_t>(p.column - window_.column);
  }
  [[nodiscard]] Pixel pixel(std::size_t i) const {
    const auto width = static_cast<std::size_t>(window_.width);
    return {window_.column + static_cast<std::int32_t>(i % width), window_.row + static_cast<std::int32_t>(i / width)};
  }
  [[nodiscard]] bool clear(Pixel p) const { return contains(p) && clear_[index(p)]; }
  [[nodiscard]] bool clear(std::size_t i) const { return clear_[i]; }
  [[nodiscard]] double risk(std::size_t i) const { return risk_[i]; }

  [[nodiscard]] bool step_is_clear(Pixel from, std::size_t step) const {
    return std::all_of(footprints_[step].begin(), footprints_[step].end(), [&](Pixel off) {
      return clear({from.column + off.column, from.row + off.row});
    });
  }
  /// Whether the corridor of a short leg to the centre of a pixel is clear.
  [[nodiscard]] bool leg_is_clear(const Vector2d& from, const Vector2d& to, double half_width) const {
    const std::array<Vector3d, 2> leg = {Vector3d(from.x(), from.y(), 0), Vector3d(to.x(), to.y(), 0)};
    const auto swept = sweep(grid_, leg, half_width);
    return swept && std::all_of(swept->begin(), swept->end(), [&](const SweptPixel& s) { return clear(s.pixel); });
  }
  /// Length and risk, by steps of at most a pixel.
  [[nodiscard]] double leg_cost(const Vector2d& from, const Vector2d& to) const {
    const double length = (to - from).norm();
    const int steps = std::max(1, static_cast<int>(std::ceil(length / grid_.pixel_m)));
    double risk = 0;
    for (int i = 0; i < steps; ++i) risk += risk_at(from + (i + 0.5) / steps * (to - from));
    return length * (1 + risk / steps);
  }

 private:
  [[nodiscard]] double risk_at(const Vector2d& p) const {
    const Pixel at = grid_.at(p);
    return contains(at) ? risk_[index(at)] : 0;
  }

  void block(const ChartObstacle& o) {
    const std::array<Vector3d, 2> line = {Vector3d(o.a.x(), o.a.y(), 0), Vector3d(o.b.x(), o.b.y(), 0)};
    const double reach = window_.width * grid_.pixel_m + window_.height * grid_.pixel_m + o.radius_m;
    const Vector2d middle = grid_.centre({window_.column + window_.width / 2, window_.row + window_.height / 2});
    if (!within_reach_of_segment(o.a, o.b, middle, middle, reach)) return;
    const auto covered = sweep(grid_, line, o.radius_m);
    if (!covered) {  // too large to sweep: block all pixels rather than none
      std::fill(clear_.begin(), clear_.end(), false);
      return;
    }
    for (const SweptPixel& p : *covered) {
      if (contains(p.pixel)) clear_[index(p.pixel)] = false;
    }
  }

  /// -w ln T by sums over rectangles; pixels outside the area do not count.
  void measure_risk(const PilotSearchConfig& config) {
    risk_.assign(size(), 0);
    if (config.risk_weight == 0) return;
    const std::int32_t w = window_.width, h = window_.height;
    const auto stride = static_cast<std::size_t>(w) + 1;
    std::vector<std::int32_t> sum(stride * (static_cast<std::size_t>(h) + 1), 0);
    const auto at = [&](std::int32_t column, std::int32_t row) -> std::int32_t& {
      return sum[static_cast<std::size_t>(row) * stride + static_cast<std::size_t>(column)];
    };
    for (std::int32_t r = 0; r < h; ++r) {
      for (std::int32_t c = 0; c < w; ++c) {
        const std::int32_t here = clear_[index({window_.column + c, window_.row + r})] ? 1 : 0;
        at(c + 1, r + 1) = here + at(c, r + 1) + at(c + 1, r) - at(c, r);
      }
    }
    const double far = std::min(config.risk_reach_m / grid_.pixel_m, 1e6);
    const auto reach = static_cast<std::int32_t>(std::lround(far));
    for (std::int32_t r = 0; r < h; ++r) {
      const std::int32_t north = std::max(0, r - reach), south = std::min(h, r + reach + 1);
      for (std::int32_t c = 0; c < w; ++c) {
        const std::int32_t west = std::max(0, c - reach), east = std::min(w, c + reach + 1);
        const std::int32_t safe = at(east, south) - at(west, south) - at(east, north) + at(west, north);
        const double all = static_cast<double>(east - west) * (south - north);
        risk_[index({window_.column + c, window_.row + r})] = -config.risk_weight * std::log(std::max(safe, 1) / all);
      }
    }
  }

  void add_threats(const RiskGrid& threats, double weight_m) {
    for (std::size_t i = 0; i < risk_.size(); ++i) {
      risk_[i] += weight_m * threats.rate_at(grid_.centre(pixel(i)));
    }
  }

  [[nodiscard]] std::vector<Pixel> footprint(Pixel step, double half_width) const {
    const PixelGrid unit{{0, 0}, grid_.pixel_m};
    const Vector2d a = unit.centre({0, 0}), b = unit.centre(step);
    const std::array<Vector3d, 2> leg = {Vector3d(a.x(), a.y(), 0), Vector3d(b.x(), b.y(), 0)};
    std::vector<Pixel> offsets;
    const auto swept = sweep(unit, leg, half_width);
    ISOBATH_ASSERT(swept.has_value());
    for (const SweptPixel& p : *swept) offsets.push_back(p.pixel);
    return offsets;
  }

  PixelGrid grid_;
  PixelWindow window_;
  std::vector<bool> clear_;
  std::vector<double> risk_;  ///< a metre of way
  std::array<std::vector<Pixel>, 8> footprints_;
};

/// The area as a ground of GridSearch.
struct PilotGround {
  const Area& area;
  double pixel_m;

  [[nodiscard]] bool enterable(std::size_t /*from*/, std::size_t to, std::size_t /*step*/) const {
    return area.clear(to);
  }
  [[nodiscard]] bool passable(std::size_t from, std::size_t step) const {
    return area.step_is_clear(area.pixel(from), step);
  }
  [[nodiscard]] double step_cost(std::size_t from, std::size_t to, std::size_t step) const {
    return pixel_m * step_length(step) * (1 + (area.risk(from) + area.risk(to)) / 2);
  }
};

/// Pixels at which the direction changes, with both ends.
std::vector<Pixel> corners(const Area& area, const GridSearch<PilotGround>& search,
                           const std::vector<std::size_t>& cells) {
  std::vector<Pixel> pixels;
  for (std::size_t i = 0; i < cells.size(); ++i) {
    const bool inside = i > 0 && i + 1 < cells.size();
    if (inside && search.step_to(cells[i]) == search.step_to(cells[i + 1])) continue;
    pixels.push_back(area.pixel(cells[i]));
  }
  return pixels;
}

/// The way with the corners left out that a straight leg of no higher cost makes needless: the eight directions of the
/// grid make detours that a vehicle need not sail.
std::vector<Vector2d> straightened(const Area& area, const std::vector<Vector2d>& way,
                                   const PilotSearchConfig& config) {
  std::vector<double> cost{0};  // from the start
  for (std::size_t i = 1; i < way.size(); ++i) {
    cost.push_back(cost.back() + area.leg_cost(way[i - 1], way[i]));
  }
  std::vector<Vector2d> kept{way.front()};
  for (std::size_t at = 0; at + 1 < way.size();) {
    std::size_t next = at + 1;
    for (std::size_t to = at + 2; to < way.size(); ++to) {
      const bool cheaper = area.leg_cost(way[at], way[to]) <= cost[to] - cost[at];
      if (cheaper && area.leg_is_clear(way[at], way[to], config.passage.half_width_m)) next = to;
    }
    kept.push_back(way[next]);
    at = next;
  }
  return kept;
}

/// The box of both with a margin, and room for the corridor.
std::optional<PixelWindow> window_round(const PixelGrid& grid, const Vector3d& a, const Vector3d& b, double margin) {
  const Vector2d low = a.head<2>().cwiseMin(b.head<2>()) - Vector2d::Constant(margin);
  const Vector2d high = a.head<2>().cwiseMax(b.head<2>()) + Vector2d::Constant(margin);
  const double area = (high - low).prod() / (grid.pixel_m * grid.pixel_m);
  const double farthest =
      std::max((low - grid.corner_m).cwiseAbs().maxCoeff(), (high - grid.corner_m).cwiseAbs().maxCoeff());
  if (!(area < static_cast<double>(kMaxSearchedPixels)) || !(farthest < 0x1p29 * grid.pixel_m)) return std::nullopt;
  const Pixel north_west = grid.at({high.x(), low.y()}), south_east = grid.at({low.x(), high.y()});
  const PixelWindow w{north_west.column, north_west.row, south_east.column - north_west.column + 1,
                      south_east.row - north_west.row + 1};
  if (std::int64_t{w.width} * w.height > kMaxSearchedPixels) return std::nullopt;
  return w;
}

}  // namespace

std::vector<Field> fields(PilotSearchConfig& c) {
  std::vector<Field> all = fields(c.passage);
  std::vector<Field> own = {
      Field::real("risk_weight", &c.risk_weight, {0, 1000}, "1",
                  "Detour in metres that one e-fold of risk is worth per metre of path."),
      Field::real("risk_reach_m", &c.risk_reach_m, {0, 1000}, "m", "Shallow water within this distance is a risk."),
      Field::real("threat_weight_m", &c.threat_weight_m, {0, 1e6}, "m",
                  "Detour that one e-fold less chance of passing the threats unharmed is worth."),
      Field::real("margin_m", &c.margin_m, {0, 100000}, "m", "Margin of the search around the box of start and goal."),
      Field::integer("max_expanded", &c.max_expanded, {1, 100'000'000}, "1",
                     "Maximum number of pixels that a search expands.")
          .was("most_expanded"),
  };
  all.insert(all.end(), own.begin(), own.end());
  return all;
}

const char* to_text(PilotRefusal refusal) {
  switch (refusal) {
    case PilotRefusal::kNotFinite: return "start or goal is not finite";
    case PilotRefusal::kAreaTooLarge: return "start and goal are too far apart for the map's pixels";
    case PilotRefusal::kStartBlocked: return "the start is not clear";
    case PilotRefusal::kGoalBlocked: return "the goal is not clear";
    case PilotRefusal::kNoPath: return "no path within the margin";
    case PilotRefusal::kOutOfBudget: return "no path within the budget";
  }
  return "";
}

Result<PilotPath, PilotRefusal> search_path(const DepthField& map, const Vector3d& start, const Vector3d& goal,
                                            const PilotSearchConfig& config, std::span<const ChartObstacle> chart,
                                            const RiskGrid* threats) {
  // 1. the area, and its clear pixels
  if (!start.allFinite() || !goal.allFinite()) return tl::unexpected(PilotRefusal::kNotFinite);
  const PixelGrid grid = map.grid();
  const double half_width = config.passage.half_width_m;
  if (half_width > kWidest * grid.pixel_m) return tl::unexpected(PilotRefusal::kAreaTooLarge);
  const auto window = window_round(grid, start, goal, config.margin_m + half_width + grid.pixel_m);
  if (!window) return tl::unexpected(PilotRefusal::kAreaTooLarge);
  const double z = std::max(start.z(), goal.z());
  const Area area(map, *window, z, config, chart, threats);
  // 2. both ends
  const Pixel from = grid.at(start.head<2>()), to = grid.at(goal.head<2>());
  const Vector2d begin = start.head<2>(), end = goal.head<2>();
  if (!area.leg_is_clear(begin, grid.centre(from), half_width)) return tl::unexpected(PilotRefusal::kStartBlocked);
  if (!area.leg_is_clear(end, grid.centre(to), half_width)) return tl::unexpected(PilotRefusal::kGoalBlocked);
  // 3. the search
  PilotPath path;
  path.map_version = map.version();
  const std::size_t first = area.index(from), last = area.index(to);
  const PilotGround ground{area, grid.pixel_m};
  GridSearch<PilotGround> search(ground, window->width, window->height, grid.pixel_m);
  const GridOutcome outcome = search.run(first, last, config.max_expanded);
  path.queries = search.queries();
  path.expanded = search.expanded();
  if (outcome == GridOutcome::kOutOfBudget) return tl::unexpected(PilotRefusal::kOutOfBudget);
  if (outcome == GridOutcome::kNoPath) return tl::unexpected(PilotRefusal::kNoPath);
  // 4. the path
  path.cost = search.cost(last);
  const std::vector<std::size_t> cells = search.path_to(last);
  for (std::size_t i = 1; i < cells.size(); ++i) path.length_m += grid.pixel_m * step_length(search.step_to(cells[i]));
  std::vector<Vector2d> way;
  const auto add = [&](const Vector2d& p) {
    if (way.empty() || (way.back() - p).norm() > 1e-9) way.push_back(p);
  };
  add(begin);
  for (const Pixel p : corners(area, search, cells)) add(grid.centre(p));
  add(end);
  for (const Vector2d& p : straightened(area, way, config)) path.points.emplace_back(p.x(), p.y(), z);
  return path;
}

}  // namespace isobath
