// Pictures of the last scan from above, as PNG: its echoes, the obstacles over them, and the occupancy around the
// vehicle, in the level body frame L (forward is up); and the track with the obstacles of all scans, in W.
//
// The frame holds what there is, with an even margin: the water that the pings cover, the obstacles, and the vehicle. A
// narrow fan gives a narrow picture. The three pictures of a scan have the same frame. Obstacles have their numbers
// (whole_obstacle.hpp), those behind nearer ones excepted.
#pragma once

#include <isobath/geometry/geodesy.hpp>
#include <isobath/map/occupancy/body_grid.hpp>
#include <isobath/map/occupancy/obstacle.hpp>
#include <isobath/report/plot/chart_layout.hpp>
#include <isobath/report/result_text.hpp>
#include <isobath/sonar/ping.hpp>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace isobath {

struct ScanPing {
  Ping ping;
  Pose X_WB;
};

/// The data of the pictures; the spans must outlive them.
struct ScanView {
  std::span<const ScanPing> pings;  ///< of the scan, in order
  std::span<const Obstacle> obstacles;
  std::span<const Polygon> truth;  ///< outlines of bodies in L; may be empty
  ChartSource source;
  Angle heading = {};  ///< of the vehicle at the end of the scan
};

/// The frame of the pictures of a scan: x forward is up.
PlanExtent scan_extent(const ScanView& view);

std::string echo_picture(const ScanView& view);
std::string obstacle_picture(const ScanView& view);
/// `grid` in L of the last ping.
std::string occupancy_picture(const ScanView& view, const BodyGrid& grid);
/// The vehicle at each scan, and the obstacles of all scans. There must be a scan. Empty `origin`: metres.
std::string track_picture(std::span<const ScanRecord> scans, const std::optional<GeoOrigin>& origin,
                          const ChartSource& source);

}  // namespace isobath
