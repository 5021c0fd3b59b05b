// placement_pages: what a run tells of the detections of a moving fan: how sharply the poses place them, how far the
// poses drift from a reference, as text, JSON and pictures, and the part of the report that shows them.
#pragma once

#include <isobath/geometry/geodesy.hpp>
#include <isobath/map/occupancy/obstacle_memory.hpp>
#include <isobath/report/html_report.hpp>
#include <isobath/report/plot/chart_layout.hpp>
#include <isobath/world/placed_detections.hpp>
#include <isobath/world/track_drift.hpp>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

namespace isobath {

/// The data of the plan view, in W.
struct PlacementView {
  std::vector<PlacedDetections::FilledCell> cells;  ///< by the reference, if there is one, else by the run's poses
  std::vector<RememberedObstacle> remembered;       ///< by the run's poses
  std::vector<Eigen::Vector2d> track, reference;    ///< of the vehicle; `reference` may be empty
  Angle heading;                                    ///< of the vehicle at the end of `track`
  std::optional<GeoOrigin> origin;
  ChartSource source;
};

/// Detections as cells, darker where more scans agree, with the remembered obstacles and the tracks over them: PNG.
std::string placement_picture(const PlacementView& view);
/// Cells by offset of the heading: PNG.
std::string sharpness_picture(const Sharpness& sharpness);

struct PlacementPictures {
  std::string placed, sharpness;  ///< PNG
};
void add_placement(HtmlReport& page, const Sharpness& sharpness, const std::optional<DriftOutcome>& drift,
                   const PlacementPictures& pictures);

/// "sharpness: 42055 detections of 382 scans fill 4053 cells of 0.5 m (15561 mirrored); fewest, 4053, with ..."
std::string to_text(const Sharpness& sharpness);
/// "drift from the reference: 27.7 m after 379 m of track, rms 18.6 m, ..."
std::string to_text(const DriftOutcome& drift);
nlohmann::ordered_json sharpness_json(const Sharpness& sharpness);
nlohmann::ordered_json drift_json(const DriftOutcome& drift);

}  // namespace isobath
