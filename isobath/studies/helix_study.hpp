// HelixStudy: two approaches to an opening in open water by the same simulated vehicle under its autopilot, straight
// and by the helix manoeuvre, and what a pair of fans learns of the opening on the way (ledger S5-40, S5-45 to S5-47,
// S5-53, S5-58, S5-D07 to S5-D09). It also runs the path-following law by itself, from two starts off the helix.
//
// The vehicle decides by its map (OpeningMap): voxels of one metre in the water from the start to the opening, made by
// looks that miss echoes and give false ones. Its free share of the opening, and what it holds occupied, are what the
// approach is planned by, anew with each image; a rock that is asked for stands in it as soon as echoes show it. What
// the fans have looked at, whatever they heard, is stated beside it (OpeningView). A pure function of its request.
#pragma once

#include <isobath/planning/awareness.hpp>
#include <isobath/planning/opening_approach.hpp>
#include <isobath/planning/opening_view.hpp>
#include <isobath/studies/opening_map.hpp>
#include <isobath/vehicle/path_following.hpp>
#include <isobath/vehicle/path_helm.hpp>
#include <isobath/vehicle/plant.hpp>
#include <string>
#include <utility>
#include <vector>

namespace isobath {

struct HelixRequest {
  double width_m = 25, height_m = 8;  ///< of the opening; its upper edge is the water surface
  double from_m = 60;                 ///< start of the approach, before the opening
  Angle course = Angle::degrees(0);   ///< of the approach line
  double speed = 1.5;                 ///< m/s
  double images_per_s = 5;
  PlantKind plant = PlantKind::kDynamic;
  std::string vehicle;                                           ///< file; empty: the embedded torpedo-shaped one
  double rock_radius_m = 0;                                      ///< of a rock before the opening; 0: there is none
  double rock_before_m = 35, rock_aside_m = 0, rock_down_m = 0;  ///< from the opening's centre; to starboard, down
  HelixConfig helix;
  PathFollowingConfig following;
  PathHelmConfig helm;
  FanPair fans;
  FanEchoes echoes;
};

/// All settings, as `--config` and `--set` name them; bound to `request`, which must outlive them.
std::vector<Section> sections(HelixRequest& request);

/// One image of an approach.
struct ApproachSample {
  double time_s = 0;
  double distance_m = 0;                               ///< before the opening
  Eigen::Vector3d p_O = Eigen::Vector3d::Zero();       ///< in the opening's frame: ahead, to starboard, down
  Eigen::Vector3d target_O = Eigen::Vector3d::Zero();  ///< of the virtual target
  Angle heading, pitch;                                ///< heading off the approach line
  double known_share = 0;                              ///< of the opening: both fans have looked at it
  double free_share = 0;                               ///< of the opening: free in the map
  double bits_a_voxel = 1;
  ApproachPhase phase = ApproachPhase::kHelix;
};

struct ApproachLog {
  std::vector<ApproachSample> samples;
  OpeningView view;
  std::vector<double> look_distance_m;  ///< of each look of the view
  double leave_m = 0;                   ///< distance at which the helix was left; 0: none was flown
  double way_m = 0;                     ///< from the start to where the helix was left
  double nearest_m = 0;                 ///< to the opening's plane; 0: went through
  double vertical_rms_m = 0;            ///< from the target, during the helix
  double lateral_rms_m = 0;

  /// In the map, at the last image taken this far before the opening or farther.
  [[nodiscard]] double free_share_at(double distance_m) const;
};

/// The law from one start: errors and V over time.
struct Convergence {
  Eigen::Vector3d start_F;
  std::vector<double> time_s, off_m, lyapunov;
  std::vector<Eigen::Vector3d> way;  ///< of the vehicle, in the helix's frame
  double greatest_rise = 0;          ///< of V from one step to the next
};

struct WorthPoint {
  EllipticHelix helix;
  HelixWorth worth;
};

struct HelixStudy {
  Opening opening;
  VehicleParameters parameters;
  double latest_decision_m = 0;
  DepthLoop depth_loop;
  ApproachLog helix, straight;
  std::vector<Convergence> convergence;
  EllipticHelix reference;  ///< that of the paper's form, with A, B, C as configured by default
  std::vector<WorthPoint> worth;
};

/// Throws Error if the request is invalid.
HelixStudy study_helix(const HelixRequest& request);

/// How an approach swings while it is on the helix: largest magnitudes off the line in its first and second half, and
/// the correlation of heading and pitch, which is 0 where they are a quarter of a turn apart (S5-44, S5-D07).
struct Swing {
  Angle heading_first, heading_second, pitch_first, pitch_second;
  double correlation = 0;
};
Swing swing_of(const ApproachLog& log);

/// The angles of the opening as seen from the straight approach, every ten metres (S5-43).
struct SeenOpening {
  double distance_m = 0;
  OpeningAngles angles;
};
std::vector<SeenOpening> seen_openings(const HelixStudy& study);

/// The results, one line each: quantity and value.
std::vector<std::pair<std::string, std::string>> helix_facts(const HelixStudy& study);

/// Flies one approach; `share` above 0: by helix, 0: straight.
ApproachLog fly_approach(const HelixRequest& request, const VehicleModel& model, const DepthLoop& loop, double share);

}  // namespace isobath
