// OpeningWatch: follows the opening that the route leads through from scan to scan: how much of it the maps know to be
// free, and the helix that looks round it (Horner et al. c. 2009, 6; ledger S5-40 to S5-46, S5-D09).
//
// The common beam of a flat and an upright fan is narrow: straight ahead, it shows the middle of an opening only. On a
// helix about the line of approach it is swept to both sides, so that more of the opening is known from farther away.
// The opening is what the sonar has detected (planning/opening_finder.hpp), and what is known of it is what the voxel
// map has measured; nothing is taken from the scene. One opening at a time. Frame W, m.
#pragma once

#include <functional>
#include <isobath/mission/messages/messages.hpp>
#include <isobath/planning/opening_finder.hpp>
#include <isobath/vehicle/vehicle_parameters.hpp>
#include <optional>
#include <string>
#include <vector>

namespace isobath {

struct OpeningConfig {
  enum class Mode : std::uint8_t { kOff, kWatch, kHelix } mode = Mode::kOff;
  double max_width_m = 30;
  double max_side_m = 6;
  double farthest_m = 75;
  HelixConfig helix;
};
std::vector<Field> fields(OpeningConfig& config);

class OpeningWatch {
 public:
  OpeningWatch(const OpeningConfig& config, const VehicleParameters& vehicle);

  enum class News : std::uint8_t {
    kNone,
    kFound,    ///< an opening is tracked from now on
    kKnown,    ///< the required share of it is known to be free
    kUnknown,  ///< it is not, where the vehicle can turn away for the last time
  };
  /// Whether openings are looked for at all.
  [[nodiscard]] bool on() const { return config_.mode != OpeningConfig::Mode::kOff; }
  /// Once a scan. `way`: the vehicle's place and the rest of its route, (north, east); `bodies` in W.
  News see(std::span<const Hazard> bodies, std::span<const Eigen::Vector2d> way, double depth_m, double speed,
           const OccupancySnapshot& map);
  /// A helix from the vehicle's place on that `clear` accepts, at its full amplitude or at half of it; it counts as
  /// flown from now on. Empty where it is off, where there is no room, where the helix would hardly look farther aside
  /// than a straight approach, or where the opening is known already.
  std::optional<HelixPlan> begin(const Eigen::Vector3d& p_W, double speed,
                                 const std::function<bool(const SpacePath&)>& clear);
  /// The rest of the helix that is flown, where the opening turned out to be elsewhere since it was planned.
  std::optional<HelixPlan> improved(const Eigen::Vector3d& p_W);
  /// The vehicle no longer flies the helix.
  void leave() { flight_.reset(); }
  [[nodiscard]] bool flies() const { return flight_.has_value(); }

  void forget();
  void move(const Eigen::Vector2d& by);  ///< the position jumped
  /// The tracked opening as the vehicle knows it. Requires a tracked opening.
  [[nodiscard]] OpeningSighting sighting() const;
  /// The same for a person, with the sides of the opening and the angles that it subtends.
  [[nodiscard]] std::string text() const;

 private:
  struct Tracked {
    FoundOpening found;
    double distance_m = 0;  ///< from the vehicle to its plane, along the passage
    double free_share = 0;
    bool said_known = false, said_unknown = false;
    Eigen::Vector2d from = Eigen::Vector2d::Zero();  ///< the vehicle
  };
  /// The helix that is flown.
  struct Flight {
    HelixPlanner planner;
    Opening planned;  ///< the opening that its last plan leads through
    double amplitude;
  };
  [[nodiscard]] OpeningSearch search(double depth_m) const;
  [[nodiscard]] std::optional<FoundOpening> ahead(std::span<const Hazard> bodies, std::span<const Eigen::Vector2d> way,
                                                  double latest_m, double depth_m, const OccupancySnapshot& map) const;
  void follow(std::span<const Hazard> bodies, const Eigen::Vector2d& vehicle, double depth_m, double latest_m,
              const OccupancySnapshot& map);

  OpeningConfig config_;
  VehicleParameters vehicle_;
  std::optional<Tracked> tracked_;
  std::optional<Flight> flight_;
};

}  // namespace isobath
