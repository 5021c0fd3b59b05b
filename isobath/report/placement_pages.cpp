#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <isobath/report/placement_pages.hpp>
#include <isobath/report/plot/mission_plot.hpp>
#include <isobath/report/plot/picture.hpp>
#include <nlohmann/json.hpp>
#include <unordered_map>

namespace isobath {
namespace {

using Eigen::Vector2d;
using nlohmann::ordered_json;

constexpr int kPlacementPixels = 1000, kPlacementPanelPixels = 700;
constexpr int kDarkest = 8;  // scans in one cell
constexpr Colour kWaterPaper{0.94, 0.96, 0.98, 1};

double hundredths(double value) { return std::round(value * 100) / 100; }

/// Near-white blue for a single scan, ink for many.
Colour scans_colour(int scans) {
  const double share = std::clamp(std::log2(scans + 1.0) / std::log2(kDarkest + 1.0), 0.0, 1.0);
  const double light = 0.80 - 0.68 * share;
  return {light, light, light + 0.02, 1};
}

/// The frame: all that two scans agree on, the tracks and the obstacles.
PlanExtent extent_of_placement(const PlacementView& view) {
  Eigen::AlignedBox2d box;
  for (const auto& cell : view.cells) {
    if (cell.scans < 2) continue;
    box.extend(Vector2d(cell.index.cast<double>() * PlacedDetections::kCell_m));
    box.extend(Vector2d((cell.index.cast<double>() + Vector2d(1, 1)) * PlacedDetections::kCell_m));
  }
  for (const Vector2d& p : view.track) box.extend(p);
  for (const Vector2d& p : view.reference) box.extend(p);
  for (const RememberedObstacle& o : view.remembered) {
    for (const Vector2d& p : o.outline_W) box.extend(p);
  }
  if (box.isEmpty()) box.extend(Vector2d(0, 0));
  return frame_around(box);
}

/// "-1 to +2 degrees"
std::string offsets(Angle low, Angle high) {
  if (low == high) return fmt::format("{:+.0f} degrees", low.degrees());
  return fmt::format("{:+.0f} to {:+.0f} degrees", low.degrees(), high.degrees());
}

std::string advice_on(const Sharpness& s) {
  if (!s.tells()) return "no offset of the headings is clearly better than others: poses or detections are too poor";
  if (4 * s.mirrored < 3 * s.cells) return "far fewer with port and starboard exchanged: the bearings are mirrored";
  if (s.low.radians() <= 0 && s.high.radians() >= 0) return "heading and mount agree with the detections";
  return fmt::format("turn the sonar by setting input.mount_heading_deg {:+.0f} degrees higher", s.best.degrees());
}

}  // namespace

// Pictures -----------------------------------------------------------------------------------------------------------

std::string placement_picture(const PlacementView& view) {
  const PlanExtent extent = extent_of_placement(view);
  const bool compared = !view.reference.empty();
  MissionPlot plot(extent, kPlacementPixels,
                   compared ? "Remembered obstacles beside what really stands there"
                            : "What the fan has seen, and remembered obstacles",
                   view.origin, kPlacementPanelPixels);
  std::unordered_map<std::uint64_t, int> scans;
  for (const auto& cell : view.cells) scans[PlacedDetections::key_of(cell.index)] = cell.scans;
  std::vector<Colour> colours;
  colours.reserve(static_cast<std::size_t>(plot.rows()) * static_cast<std::size_t>(plot.columns()));
  for (int row = 0; row < plot.rows(); ++row) {
    for (int column = 0; column < plot.columns(); ++column) {
      const Vector2d p(extent.x_max - (row + 0.5) * plot.metres_per_px(),
                       extent.y_min + (column + 0.5) * plot.metres_per_px());
      const auto found = scans.find(PlacedDetections::key_of(PlacedDetections::cell_of(p)));
      colours.push_back(found == scans.end() ? kWaterPaper : scans_colour(found->second));
    }
  }
  plot.raster(colours);
  const Colour filling{palette::kObstacle.red, palette::kObstacle.green, palette::kObstacle.blue, 0.18};
  for (const RememberedObstacle& o : view.remembered) plot.area(o.outline_W, filling, {palette::kObstacle, 1.6, false});
  if (compared) plot.polyline(view.reference, false, {palette::kTruth, 2.2, false});
  plot.polyline(view.track, false, {palette::kTrack, 2.2, compared});
  if (!view.track.empty()) plot.vehicle(view.track.back(), view.heading.radians());
  plot.north_arrow_and_scale();
  plot.legend_fill(scans_colour(1), "echo in one scan");
  plot.legend_fill(scans_colour(kDarkest), fmt::format("echoes in {} scans or more", kDarkest));
  plot.legend_line({palette::kObstacle, 2, false}, "obstacle as the vehicle remembers it");
  if (compared) plot.legend_line({palette::kTruth, 2.2, false}, "track by the reference");
  plot.legend_line({palette::kTrack, 2.2, compared}, "track, as the vehicle estimates it");
  plot.gap();
  ChartSource source = view.source;
  source.cell_m = PlacedDetections::kCell_m;
  plot.about(source, "No geographic position: metres from the origin of the log.");
  plot.finish();
  return plot.png();
}

std::string sharpness_picture(const Sharpness& sharpness) {
  std::vector<double> offset, cells;
  for (const SharpnessPoint& point : sharpness.curve) {
    offset.push_back(point.offset.degrees());
    cells.push_back(static_cast<double>(point.cells));
  }
  const double top = 1.1 * *std::ranges::max_element(cells);
  ChartPicture chart(760, 400, "Sharpness of the detections by offset of the headings",
                     {"offset of the headings, degrees clockwise", offset.front(), offset.back()},
                     {fmt::format("cells of {:g} m with a detection: fewer is sharper", sharpness.cell_m), 0, top});
  chart.curve(offset, cells, {palette::kTrack, 2.2, false}, "cells");
  chart.mark(sharpness.best.degrees(),
             fmt::format("{:+.0f} degrees, {} cells", sharpness.best.degrees(), sharpness.best_cells),
             palette::kObstacle);
  chart.finish();
  return chart.png();
}

// Words --------------------------------------------------------------------------------------------------------------

std::string to_text(const Sharpness& s) {
  return fmt::format(
      "sharpness: {} detections of {} scans fill {} cells of {:g} m ({} mirrored); fewest, {}, with the headings "
      "turned by {}; {}",
      s.detections, s.scans, s.cells, s.cell_m, s.mirrored, s.best_cells, offsets(s.low, s.high), advice_on(s));
}

std::string to_text(const DriftOutcome& d) {
  std::string text =
      fmt::format("drift from the reference: {:.1f} m after {:.0f} m of track, rms {:.1f} m, at most {:.1f} m",
                  d.last_m, d.travelled_m, d.rms_m, d.max_m);
  if (d.reference_cells > 0) {
    text += fmt::format("; the detections fill {} cells, with the reference {}", d.cells, d.reference_cells);
  }
  if (d.remembered > 0) {
    text += fmt::format("; {} remembered obstacles are misplaced by {:.1f} m (median), at most {:.1f} m", d.remembered,
                        d.placed_median_m, d.placed_max_m);
  }
  if (d.sightings > 0) {
    text += fmt::format(
        "; since their last echo known obstacles moved by {:.1f} m relative to the vehicle (median), {:.1f} m (95 %), "
        "and the margin, {:.1f} m (median), covers {:.0f} % of them; that is {:.0f} % of the path since (median), "
        "{:.0f} % "
        "(95 %), where memory.drift_share applies",
        d.moved_median_m, d.moved_95_m, d.margin_median_m, 100 * d.covered, 100 * d.share_median, 100 * d.share_95);
  }
  return text;
}

ordered_json sharpness_json(const Sharpness& s) {
  ordered_json curve = ordered_json::array();
  for (const SharpnessPoint& point : s.curve) {
    curve.push_back({{"offset_deg", std::round(point.offset.degrees())}, {"cells", point.cells}});
  }
  return {{"cell_m", s.cell_m},
          {"detections", s.detections},
          {"scans", s.scans},
          {"cells", s.cells},
          {"mirrored_cells", s.mirrored},
          {"best_offset_deg", std::round(s.best.degrees())},
          {"best_cells", s.best_cells},
          {"low_offset_deg", std::round(s.low.degrees())},
          {"high_offset_deg", std::round(s.high.degrees())},
          {"tells", s.tells()},
          {"curve", curve}};
}

ordered_json drift_json(const DriftOutcome& d) {
  return {{"scans", d.scans},
          {"travelled_m", hundredths(d.travelled_m)},
          {"last_m", hundredths(d.last_m)},
          {"rms_m", hundredths(d.rms_m)},
          {"max_m", hundredths(d.max_m)},
          {"cells", d.cells},
          {"reference_cells", d.reference_cells},
          {"remembered", d.remembered},
          {"placed_median_m", hundredths(d.placed_median_m)},
          {"placed_max_m", hundredths(d.placed_max_m)},
          {"sightings", d.sightings},
          {"moved_median_m", hundredths(d.moved_median_m)},
          {"moved_95_m", hundredths(d.moved_95_m)},
          {"margin_median_m", hundredths(d.margin_median_m)},
          {"covered", hundredths(d.covered)},
          {"share_median", hundredths(d.share_median)},
          {"share_95", hundredths(d.share_95)}};
}

void add_placement(HtmlReport& page, const Sharpness& sharpness, const std::optional<DriftOutcome>& drift,
                   const PlacementPictures& pictures) {
  const auto whole = [](std::string text) {
    text[0] = static_cast<char>(text[0] - 'a' + 'A');
    return text + ".";
  };
  page.heading("Detections of the moving fan");
  page.paragraph(whole(to_text(sharpness)));
  if (drift) page.paragraph(whole(to_text(*drift)));
  page.figure(pictures.placed,
              "All detections in the plan, north up: walls appear as dark lines where many scans agree. Orange: the "
              "obstacles that the vehicle remembers at the end.");
  page.figure(pictures.sharpness,
              "How many cells the detections fill if all headings are turned. Right poses and a right mount have their "
              "minimum at 0.");
}

}  // namespace isobath
