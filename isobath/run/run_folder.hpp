// RunFolder: collects the results of a run and writes them as files for people and programs.
//
//   report.html         everything on one page       manifest.json       input, counts, rejections, files
//   obstacles.json      at the end, in L             configuration.toml  the configuration in force
//   scans.json          obstacles of every scan      obstacles.geojson   georeferenced, if the origin is known
//   occupancy.tif .png  the body grid                truth.json          scores of a simulated run
//   sonar.png           the last sweep in plan       detections.png      obstacles drawn over it
//   mission.json, decisions.json, mission.png, clearance.png: the mission (mission_pages.hpp)
//   placed.png, sharpness.png: the detections of a moving fan (placement_pages.hpp)
//   contacts.geojson: the sounds that a passive array heard (contact_text.hpp)
//   depth.tif, chart.png, confidence.png, contours.geojson: the depth map (depth_pages.hpp)
#pragma once

#include <filesystem>
#include <isobath/onboard/onboard_observer.hpp>
#include <isobath/report/depth_pages.hpp>
#include <isobath/report/embedded_replay.hpp>
#include <isobath/report/html_report.hpp>
#include <isobath/report/mission_pages.hpp>
#include <isobath/report/placement_pages.hpp>
#include <isobath/report/result_text.hpp>
#include <isobath/report/run_outcome.hpp>
#include <isobath/report/scan_pictures.hpp>
#include <isobath/report/track_profile.hpp>
#include <isobath/report/voxel_pages.hpp>
#include <isobath/run/run_request.hpp>
#include <optional>
#include <string>
#include <vector>

namespace isobath {

class Onboard;

class RunFolder : public OnboardObserver {
 public:
  /// Creates the folder; throws Error if that fails.
  RunFolder(std::filesystem::path folder, Configuration configuration);

  void on_ping(const PosedPing& ping) override;
  void on_jump(const Eigen::Vector3d& by_W) override;
  void on_scan(const ScanResult& scan) override;

  /// True outlines of the bodies, in L of the last scan; for the pictures.
  void show_truth(std::vector<Polygon> outlines) { truth_ = std::move(outlines); }
  /// The replay of the run, for the report.
  void show_run(EmbeddedReplay& replay, Time last, const DisplayState& items);
  /// The detections of a moving fan, for the pictures.
  void show_placement(PlacementView view) { placement_ = std::move(view); }
  /// Writes all files and lists them in `outcome.files`.
  void write(const RunRequest& request, const Onboard& onboard, RunOutcome& outcome);
  [[nodiscard]] const std::vector<Obstacle>& obstacles() const { return obstacles_; }

 private:
  struct Pictures {  ///< PNG; empty without a grid
    std::string occupancy, sonar, detections, track;
    DepthPictures depth;
    VoxelPictures voxels;
    std::string sphere_above, sphere_solid;
    PlacementPictures placement;
    MissionPictures mission;
    TrackProfile profile;
  };
  void write_occupancy(const BodyGrid& grid, const Pose& X_WL, const std::optional<GeoOrigin>& origin) const;
  void write_text(const std::string& name, const std::string& bytes, RunOutcome& outcome) const;
  [[nodiscard]] Pictures draw(const RunRequest& request, const Onboard& onboard, RunOutcome& outcome) const;
  void add_scan(HtmlReport& page, const Pictures& pictures) const;
  static void add_sphere(HtmlReport& page, const SphericalOutcome& sphere, const Pictures& pictures);
  void add_replay(HtmlReport& page) const;
  [[nodiscard]] std::string report(const RunRequest& request, const RunOutcome& outcome,
                                   const Pictures& pictures) const;

  std::filesystem::path folder_;
  Configuration configuration_;
  std::vector<ScanPing> sweep_, last_sweep_;  ///< the open sweep, and the last complete one
  std::vector<ScanRecord> scans_;
  std::vector<Obstacle> obstacles_;
  std::vector<Polygon> truth_;
  std::optional<PlacementView> placement_;
  std::string replay_page_, replay_text_;  ///< the page with the replay, and its caption; empty: no replay
};

}  // namespace isobath
