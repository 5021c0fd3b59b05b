#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <isobath/map/occupancy/whole_obstacle.hpp>
#include <isobath/report/plot/mission_plot.hpp>
#include <isobath/report/plot/plan_image.hpp>
#include <isobath/report/scan_pictures.hpp>

namespace isobath {
namespace {

using Eigen::AlignedBox2d;
using Eigen::Vector2d;

constexpr int kScanPixels = 820, kScanPanelPixels = 700;
constexpr Colour kNoData{0.93, 0.93, 0.93, 1};
constexpr const char* kBodyFrame = "Level body frame at the end of the scan: metres from the vehicle, forward is up.";

/// Pose of each ping's sensor in L of the last one.
Pose in_body(const ScanView& view, const ScanPing& kept) {
  return level(view.pings.back().X_WB).inverse() * kept.X_WB * kept.ping.X_BS;
}

/// Extends a box by the water that the beams of a ping cover, as PlanImage draws them.
void cover(AlignedBox2d& box, const Ping& ping, const Pose& X_LS) {
  const BeamFan& fan = *ping.fan;
  for (int b = 0; b < fan.beams(); ++b) {
    for (const double side : {-0.5, 0.0, 0.5}) {
      const Angle azimuth = fan.azimuth[b] + fan.width[b] * side;
      const Eigen::Vector3d axis = X_LS.rotation * Eigen::Vector3d(cos(azimuth), sin(azimuth), 0);
      const Vector2d towards = axis.head<2>().normalized();
      if (!towards.allFinite()) continue;
      box.extend(Vector2d(X_LS.translation.head<2>() + ping.window.start_m * towards));
      box.extend(Vector2d(X_LS.translation.head<2>() + ping.window.end_m() * towards));
    }
  }
}

/// A plot of a scan, and the echoes of its pings.
class ScanPlot : public MissionPlot {
 public:
  ScanPlot(const ScanView& view, const std::string& title)
      : MissionPlot(scan_extent(view), kScanPixels, title, std::nullopt, kScanPanelPixels),
        extent_(scan_extent(view)),
        image_(extent_, metres_per_px()) {
    name_axes("forward and starboard in metres");
    for (const ScanPing& kept : view.pings) image_.add(kept.ping, in_body(view, kept));
  }

  /// The strongest echo at a place, as a share of the strongest of all; empty where no beam was.
  [[nodiscard]] std::optional<double> echo(double x, double y) const { return image_.share(x, y); }

  /// Fills the plot by the colour of the place under each pixel.
  template <class ColourAt>
  void paint(const ColourAt& colour_at) {
    std::vector<Colour> colours;
    colours.reserve(static_cast<std::size_t>(rows()) * static_cast<std::size_t>(columns()));
    for (int row = 0; row < rows(); ++row) {
      for (int column = 0; column < columns(); ++column) {
        colours.push_back(
            colour_at(extent_.x_max - (row + 0.5) * metres_per_px(), extent_.y_min + (column + 0.5) * metres_per_px()));
      }
    }
    raster(colours);
  }

  /// Rings of equal range and the vehicle, on top of all else.
  void rings_and_vehicle() {
    const double reach = std::max({extent_.x_max, -extent_.x_min, extent_.y_max, -extent_.y_min});
    const std::vector<double> steps = ticks(0, reach, 4);
    for (std::size_t i = 1; i < steps.size(); ++i) {
      circle({0, 0}, steps[i], {palette::kFaint, 0.8, true});
      name({steps[i], 0}, fmt::format("{:g} m", steps[i]), palette::kInk);
    }
    vehicle({0, 0}, 0);
  }

 private:
  PlanExtent extent_;
  PlanImage image_;
};

constexpr int kArrow_s = 10;

const std::vector<double> kPercents = {0, 25, 50, 75, 100};

}  // namespace

PlanExtent scan_extent(const ScanView& view) {
  AlignedBox2d box;
  box.extend(Vector2d(0, 0));
  for (const ScanPing& kept : view.pings) cover(box, kept.ping, in_body(view, kept));
  for (const Obstacle& o : view.obstacles) {
    for (const Vector2d& p : o.outline) box.extend(p);
  }
  return frame_around(box);
}

std::string echo_picture(const ScanView& view) {
  ScanPlot plot(view, "Echoes of the last scan");
  plot.paint([&](double x, double y) {
    const auto share = plot.echo(x, y);
    return share ? intensity_colour(std::sqrt(*share)) : kNoData;
  });
  plot.rings_and_vehicle();
  plot.north_arrow_and_scale("forward");
  plot.colour_bars("Echo, % of the strongest", 0, 100, kPercents,
                   {{"", [](double percent) { return intensity_colour(std::sqrt(percent / 100)); }}});
  plot.legend_fill(kNoData, "no data");
  plot.gap();
  plot.about(view.source, kBodyFrame);
  plot.finish();
  return plot.png();
}

std::string obstacle_picture(const ScanView& view) {
  const std::vector<WholeObstacle> whole = whole_obstacles(view.obstacles);
  ScanPlot plot(view, fmt::format("Obstacles of the last scan: {}", whole.size()));
  plot.paint([&](double x, double y) {
    const double shade = 1 - 0.75 * std::sqrt(plot.echo(x, y).value_or(0.0));
    return Colour{shade, shade, shade, 1};
  });
  for (const Polygon& outline : view.truth) plot.area(outline, {0, 0, 0, 0}, {palette::kTruth, 2, false});
  for (const Obstacle& o : view.obstacles) {
    const Colour colour = o.behind ? palette::kHidden : palette::kObstacle;
    plot.area(o.outline, {colour.red, colour.green, colour.blue, 0.15}, {colour, 2, o.possible_multiple});
  }
  const Rotation R_LW = Rotation::from_heading(-view.heading);
  for (const Obstacle& o : view.obstacles) {
    if (!o.moves()) continue;
    const Eigen::Vector3d v_W(o.motion.velocity_W.x(), o.motion.velocity_W.y(), 0);
    const std::vector<Vector2d> way{o.centre, o.centre + kArrow_s * (R_LW * v_W).head<2>()};
    plot.polyline(way, false, {palette::kObstacle, 2.5, false});
  }
  for (const WholeObstacle& o : whole) {
    if (!o.behind) plot.numbered(o.nearest->nearest, o.number, palette::kObstacle);
  }
  plot.rings_and_vehicle();
  const auto any = [&](bool Obstacle::*mark) {
    return std::any_of(view.obstacles.begin(), view.obstacles.end(), [mark](const Obstacle& o) { return o.*mark; });
  };
  plot.north_arrow_and_scale("forward");
  if (!whole.empty()) plot.legend_number(palette::kObstacle, "obstacle: number, nearest point");
  if (std::any_of(view.obstacles.begin(), view.obstacles.end(), [](const Obstacle& o) { return o.moves(); })) {
    plot.legend_line({palette::kObstacle, 2.5, false}, fmt::format("way of a moving body in {} s", kArrow_s));
  }
  if (any(&Obstacle::behind)) plot.legend_line({palette::kHidden, 2, false}, "behind a nearer obstacle");
  if (any(&Obstacle::possible_multiple)) plot.legend_line({palette::kObstacle, 2, true}, "possible multiple echo");
  if (!view.truth.empty()) plot.legend_line({palette::kTruth, 2, false}, "ground truth");
  plot.legend_fill({0.4, 0.4, 0.4, 1}, "echoes, darker where stronger");
  plot.gap();
  plot.about(view.source, kBodyFrame);
  plot.finish();
  return plot.png();
}

std::string occupancy_picture(const ScanView& view, const BodyGrid& grid) {
  ScanPlot plot(view, "Occupancy around the vehicle");
  const double prior = grid.config().prior;
  plot.paint([&](double x, double y) {
    const auto cell = grid.cell_at({x, y});
    return cell ? occupancy_colour(grid.probability(*cell), prior) : kNoData;
  });
  plot.rings_and_vehicle();
  plot.north_arrow_and_scale("forward");
  plot.colour_bars("Probability of an obstacle, %", 0, 100, kPercents,
                   {{"", [prior](double percent) {
                       return occupancy_colour(std::clamp(percent / 100, 0.1 * prior, 0.999), prior);
                     }}});
  plot.legend_fill(occupancy_colour(0.1 * prior, prior), "free");
  plot.legend_fill(occupancy_colour(prior, prior), "unknown: not free");
  plot.gap();
  ChartSource source = view.source;
  source.cell_m = grid.cells().cell_m;
  plot.about(source, kBodyFrame);
  plot.finish();
  return plot.png();
}

std::string track_picture(std::span<const ScanRecord> scans, const std::optional<GeoOrigin>& origin,
                          const ChartSource& source) {
  AlignedBox2d box;
  std::vector<Vector2d> track;
  std::vector<std::pair<Polygon, double>> outlines;  // with their existence
  for (const ScanRecord& scan : scans) {
    const Pose X_WL = level(scan.X_WB);
    track.emplace_back(X_WL.translation.head<2>());
    box.extend(track.back());
    for (const Obstacle& o : scan.obstacles) {
      if (o.behind) continue;
      Polygon& outline = outlines.emplace_back(Polygon{}, o.existence).first;
      for (const Vector2d& p : o.outline) {
        outline.emplace_back((X_WL * Eigen::Vector3d(p.x(), p.y(), 0)).head<2>());
        box.extend(outline.back());
      }
    }
  }
  MissionPlot plot(frame_around(box), kScanPixels, "Track and obstacles of all scans", origin, kScanPanelPixels);
  const auto orange = [](double alpha) { return Colour{0.84, 0.37, 0.0, alpha}; };
  for (const auto& [outline, existence] : outlines) {
    plot.area(outline, orange(0.05 * existence), {orange(0.25 * existence), 1, false});
  }
  plot.polyline(track, false, {palette::kTrack, 2.2, false});
  plot.vehicle(track.back(), scans.back().X_WB.rotation.heading().radians());
  plot.north_arrow_and_scale();
  plot.legend_line({palette::kTrack, 2.2, false}, "track, as estimated");
  plot.legend_fill(orange(0.35), "obstacles; darker where seen again");
  plot.gap();
  plot.about(source, "No geographic position: metres from the origin of the log.");
  plot.finish();
  return plot.png();
}

}  // namespace isobath
