#include <algorithm>
#include <fmt/format.h>
#include <isobath/base/pending_file.hpp>
#include <isobath/io/exports/voxel_files.hpp>
#include <isobath/io/exports/voxel_vdb.hpp>
#include <isobath/map/voxel/seen_voxels.hpp>
#include <isobath/report/plot/chart_layout.hpp>
#include <isobath/report/plot/picture.hpp>
#include <isobath/report/voxel_pages.hpp>
#include <limits>
#include <optional>
#include <utility>

namespace isobath {
namespace {

constexpr int kVoxelPlotPixels = 820, kVoxelPanelPixels = 700;
constexpr Colour kNeverSeen{0.93, 0.93, 0.93, 1}, kFreeWater{1, 1, 1, 1}, kUnsure{0.82, 0.86, 0.9, 1},
    kSuspected{0.98, 0.82, 0.6, 1};

/// Minimum and maximum indices of a set of voxels.
struct VoxelBox {
  VoxelIndex least = VoxelIndex::Constant(std::numeric_limits<int>::max());
  VoxelIndex most = VoxelIndex::Constant(std::numeric_limits<int>::min());
  void add(const VoxelIndex& v) {
    least = least.cwiseMin(v);
    most = most.cwiseMax(v);
  }
  [[nodiscard]] bool empty() const { return least.x() > most.x(); }
};

/// Whether a voxel is clearly more probable than its prior.
bool is_suspected(const VoxelMap& map, const VoxelIndex& v) { return map.probability(v) > 2 * map.config().prior; }

/// A view of the map along one of its axes: the nearest occupied voxel of each line of sight, else what is known there.
class Shadow {
 public:
  Shadow(const VoxelMap& map, const VoxelBox& box, int right, int up, int along, bool from_most)
      : map_(map),
        box_(box),
        right_(right),
        up_(up),
        along_(along),
        from_most_(from_most),
        columns_(box.most[right] - box.least[right] + 1) {
    const int rows = box.most[up] - box.least[up] + 1;
    cells_.resize(static_cast<std::size_t>(rows) * static_cast<std::size_t>(columns_));
    for_each_seen(map, [&](const VoxelIndex& v) {
      if ((v.array() < box.least.array()).any() || (v.array() > box.most.array()).any()) return;
      const Space space = map.space(v);
      Cell& cell = at(v[up], v[right]);
      cell.seen = true;
      cell.free = cell.free || space == Space::kFree;
      cell.suspected = cell.suspected || is_suspected(map, v);
      if (space != Space::kOccupied) return;
      const int near = from_most ? box.most[along] - v[along] : v[along] - box.least[along];
      cell.near = std::min(cell.near, near);
    });
  }

  struct Look {
    std::string title = {}, axes = {};  ///< axes: of a view from the side; empty: the view is a map
    std::string caption = {};           ///< of the colour bar: what it says of the nearest voxel; empty: no bar
    bool height = false;                ///< up is upwards on the page, and counts as height
    std::optional<GeoOrigin> origin = {};
    ChartSource source = {};
  };
  [[nodiscard]] std::string picture(const Look& look) const {
    const double edge = map_.voxel_m(), sign = look.height ? -1 : 1;
    const double a = sign * edge * box_.least[up_], b = sign * edge * (box_.most[up_] + 1);
    const PlanExtent extent{std::min(a, b), std::max(a, b), edge * box_.least[right_], edge * (box_.most[right_] + 1)};
    ChartLayout layout(extent, kVoxelPlotPixels, look.title, look.origin, kVoxelPanelPixels);
    if (!look.axes.empty()) layout.name_axes(look.axes);
    const double metres = layout.metres_per_px();
    std::vector<Colour> colours;
    for (int row = 0; row < layout.rows(); ++row) {
      const int up = static_cast<int>(std::floor(sign * (extent.x_max - (row + 0.5) * metres) / edge));
      for (int column = 0; column < layout.columns(); ++column) {
        const double right = extent.y_min + (column + 0.5) * metres;
        colours.push_back(colour_of(at(up, static_cast<int>(std::floor(right / edge)))));
      }
    }
    layout.raster(colours);
    layout.north_arrow_and_scale(look.axes.empty() ? "N" : "");
    if (look.caption.empty()) {
      layout.legend_fill(intensity_colour(1), "occupied");
    } else {
      add_bar(layout, look.caption);
    }
    layout.legend_fill(kSuspected, "suspected");
    layout.legend_fill(kFreeWater, "free");
    layout.legend_fill(kUnsure, "unsure");
    layout.legend_fill(kNeverSeen, "not observed");
    layout.note("");
    layout.about(look.source, "No geographic position: metres from the origin of the log.");
    layout.finish();
    return layout.png();
  }

 private:
  static constexpr int kNone = std::numeric_limits<int>::max();
  struct Cell {
    int near = kNone;
    bool seen = false, free = false, suspected = false;
  };
  [[nodiscard]] Colour colour_of(const Cell& cell) const {
    const double depth = std::max(1, box_.most[along_] - box_.least[along_]);
    if (cell.near < kNone) return intensity_colour(1 - 0.85 * cell.near / depth);
    if (cell.suspected) return kSuspected;
    return !cell.seen ? kNeverSeen : cell.free ? kFreeWater : kUnsure;
  }
  /// The place of the nearest voxel along the line of sight, nearest at the top.
  void add_bar(ChartLayout& layout, const std::string& caption) const {
    const double least = map_.voxel_m() * box_.least[along_], most = map_.voxel_m() * (box_.most[along_] + 1);
    const double near = from_most_ ? most : least, far = from_most_ ? least : most;
    layout.colour_bars(caption, near, far, ticks(least, most, 5),
                       {{"", [=](double v) { return intensity_colour(1 - 0.85 * (v - near) / (far - near)); }}});
  }
  [[nodiscard]] std::size_t index(int up, int right) const {
    const int row = std::clamp(up, box_.least[up_], box_.most[up_]) - box_.least[up_];
    const int column = std::clamp(right, box_.least[right_], box_.most[right_]) - box_.least[right_];
    return static_cast<std::size_t>(row) * static_cast<std::size_t>(columns_) + static_cast<std::size_t>(column);
  }
  Cell& at(int up, int right) { return cells_[index(up, right)]; }
  [[nodiscard]] const Cell& at(int up, int right) const { return cells_[index(up, right)]; }

  const VoxelMap& map_;
  VoxelBox box_;
  int right_, up_, along_;
  bool from_most_;
  int columns_;
  std::vector<Cell> cells_;
};

VoxelBox box_around(const VoxelMap& map) {
  VoxelBox seen, occupied;
  for_each_seen(map, [&](const VoxelIndex& v) {
    seen.add(v);
    if (map.space(v) == Space::kOccupied || is_suspected(map, v)) occupied.add(v);
  });
  if (occupied.empty()) return seen;
  constexpr int kMargin = 8;
  occupied.least = (occupied.least.array() - kMargin).matrix().cwiseMax(seen.least);
  occupied.most = (occupied.most.array() + kMargin).matrix().cwiseMin(seen.most);
  return occupied;
}

}  // namespace

VoxelPictures write_voxel_files(const VoxelMap& map, bool vdb, ChartSource source,
                                const std::optional<GeoOrigin>& origin, const std::filesystem::path& folder,
                                VoxelOutcome& outcome, std::vector<std::filesystem::path>& files) {
  const auto write = [&](const char* name, const std::string& bytes) {
    write_whole_file(folder / name, bytes);
    files.emplace_back(name);
  };
  const OctoMapFile tree = octomap_file(map);
  outcome.left_out = tree.left_out;
  write("voxels.bt", tree.bytes);
  write("voxels.ply", ply_file(map));
  if (vdb) {
    write_vdb(map, folder / "voxels.vdb");
    files.emplace_back("voxels.vdb");
  }
  VoxelPictures pictures;
  const VoxelBox box = box_around(map);
  if (box.empty()) return pictures;
  constexpr int kNorth = 0, kEast = 1, kDown = 2;
  source.cell_m = map.voxel_m();
  pictures.above = Shadow(map, box, kEast, kNorth, kDown, false)
                       .picture({.title = "Occupied voxels from above",
                                 .caption = "Depth of the shallowest, m",
                                 .origin = origin,
                                 .source = source});
  pictures.from_south = Shadow(map, box, kEast, kDown, kNorth, false)
                            .picture({.title = "Occupied voxels from the south",
                                      .axes = "height above the datum and east, in metres",
                                      .caption = "North of the nearest, m",
                                      .height = true,
                                      .source = source});
  pictures.from_east = Shadow(map, box, kNorth, kDown, kEast, true)
                           .picture({.title = "Occupied voxels from the east",
                                     .axes = "height above the datum and north, in metres",
                                     .caption = "East of the nearest, m",
                                     .height = true,
                                     .source = source});
  VoxelBox level = box;
  level.least[kDown] = level.most[kDown] = map.voxel_at({0, 0, outcome.vehicle_depth_m}).z();
  pictures.at_depth = Shadow(map, level, kEast, kNorth, kDown, false)
                          .picture({.title = fmt::format("At the vehicle's depth, {:.1f} m", outcome.vehicle_depth_m),
                                    .origin = origin,
                                    .source = source});
  write("voxels-depth.png", pictures.at_depth);
  write("voxels.png", pictures.above);
  write("voxels-south.png", pictures.from_south);
  write("voxels-east.png", pictures.from_east);
  return pictures;
}

namespace {

std::string reliability_picture(const VoxelTruth& truth) {
  ChartPicture chart(560, 360, "Reliability of the probabilities", {"predicted probability", 0, 1},
                     {"observed share", 0, 1});
  std::vector<double> said, is;
  for (const VoxelTruth::Said& s : truth.by_probability) {
    if (s.voxels == 0) continue;
    said.push_back(s.probability);
    is.push_back(static_cast<double>(s.surface) / static_cast<double>(s.voxels));
  }
  const std::vector<double> ends{0, 1};
  chart.curve(ends, ends, {palette::kFaint, 1, true}, "ideal");
  chart.curve(said, is, {palette::kTrack, 2, false}, "voxels");
  chart.points(said, is, palette::kTrack, "");
  chart.finish();
  return chart.png();
}

void add_truth(HtmlReport& page, const VoxelTruth& truth) {
  page.paragraph(fmt::format(
      "{} voxels were compared with the scene. {} hold a surface; {:.1f} % of these were found to within a voxel. {} "
      "are mapped as occupied; {:.1f} % of these are right to within a voxel. Log-loss {:.4f} nats per voxel.",
      truth.judged, truth.surface, 100 * truth.recall(), truth.occupied, 100 * truth.precision(), truth.log_loss));
  page.figure(reliability_picture(truth),
              "Share of the voxels that hold a surface, by the probability that the map gives them.");
}

}  // namespace

void add_voxels(HtmlReport& page, const VoxelOutcome& outcome, const VoxelPictures& pictures) {
  page.heading("Voxel map");
  if (!pictures.above.empty()) {
    page.begin_row();
    page.figure(pictures.above, "Occupied voxels from above, north up. Upper voxels hide lower ones.");
    page.figure(pictures.from_south, "The same from the south. Height is above the datum.");
    page.figure(pictures.from_east, "The same from the east. North is to the right.");
    page.end_row();
    page.figure(pictures.at_depth, "Occupancy at the depth of the vehicle at the end of the run.");
  }
  const auto number = [](std::uint64_t count) { return fmt::format("{}", count); };
  const double cubic = outcome.voxel_m * outcome.voxel_m * outcome.voxel_m;
  std::vector<HtmlReport::Row> rows{{"edge of a voxel", fmt::format("{:g} m", outcome.voxel_m)}};
  for (const auto& layer : outcome.layers)
    rows.push_back({"pings of the layer \"" + layer.sensor + "\"", number(layer.pings)});
  rows.push_back(
      {"voxels observed", fmt::format("{} ({:.1f} m3)", outcome.seen, static_cast<double>(outcome.seen) * cubic)});
  rows.push_back({"of these occupied", number(outcome.occupied)});
  rows.push_back({"of these free", number(outcome.free)});
  rows.push_back({"memory", fmt::format("{} MB in {} blocks", outcome.megabytes, outcome.blocks)});
  if (outcome.spilled) rows.push_back({"blocks on disk only (voxels.sqlite)", number(*outcome.spilled)});
  if (outcome.moved > 0) rows.push_back({"jumps of the position that moved the map", number(outcome.moved)});
  if (outcome.left_out > 0) rows.push_back({"blocks too far away for voxels.bt", number(outcome.left_out)});
  page.table({"what", "value"}, rows);
  if (outcome.truth) add_truth(page, *outcome.truth);
}

}  // namespace isobath
