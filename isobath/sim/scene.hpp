// Scene: the content of a scene file: water, bottom, bodies, vehicle, sonars, sensors and faults. World (world.hpp) is
// its geometry for ray casting.
//
// Files are TOML and strict: an unknown key, a value out of range or a missing file is an Error with line and column.
// Positions are in W (north, east, depth), metres; the water surface is depth 0. A body with a path moves. The path has
// rows of time (s), north, east, depth of the body's reference point. The body moves in straight lines between rows and
// rests before the first and after the last.
//
// A scene can also be made in code: a Scene is plain data with the defaults of a file.
//
//   Scene scene;
//   scene.bodies = {{.name = "pile", .shape = Cylinder{.centre = {20, 0, 5}, .radius = 0.4, .length = 10}}};
//   scene.sonars = {sonar_preset("micron")};
#pragma once

#include <Eigen/Core>
#include <isobath/base/config.hpp>
#include <isobath/geometry/geodesy.hpp>
#include <isobath/geometry/pose.hpp>
#include <isobath/sim/acoustic_link.hpp>
#include <isobath/sim/camera_config.hpp>
#include <isobath/sim/dead_reckoning.hpp>
#include <isobath/sim/fault_config.hpp>
#include <isobath/sim/navigation_sensors.hpp>
#include <isobath/sim/sonar_config.hpp>
#include <isobath/sim/sound_config.hpp>
#include <isobath/sim/water.hpp>
#include <isobath/vehicle/plant_difference.hpp>
#include <optional>
#include <string>
#include <variant>
#include <vector>

namespace isobath {

/// Acoustic properties of a surface at the frequencies of imaging sonars.
///
/// Backscatter: mu cos^2 (Lambert) plus the Kirchhoff facet law R^2 / (8 pi s^2) sec^4 exp(-tan^2 / 2 s^2) of a surface
/// with slopes s. Its integral over a sphere is the textbook a^2 R^2 / 4, that over a plane is the mirror image (Urick
/// 1983; Jackson and Richardson 2007). Listed values: bottoms after APL-UW TR 9407 for high frequency, rounded; others
/// estimated from impedance.
struct Material {
  std::string name = "material";
  double lambert_db = -20;     ///< 10 log10 mu
  double reflection_db = -10;  ///< 20 log10 R at normal incidence
  double roughness = 0.2;      ///< rms slope s, rad
};
const std::vector<Material>& listed_materials();

struct Cylinder {
  Eigen::Vector3d centre = {0, 0, 0};
  Eigen::Vector3d axis = {0, 0, 1};  ///< any length but 0
  double radius = 0.5, length = 2;
};
struct Sphere {
  Eigen::Vector3d centre = {0, 0, 0};
  double radius = 0.5;
};
struct Box {
  Eigen::Vector3d centre = {0, 0, 0}, size = {1, 1, 1};
  Angle heading = {}, pitch = {}, roll = {};
};
/// A sheet along a polyline. With a batter its foot is offset to the right, seen along the line.
struct Wall {
  std::vector<double> line = {};  ///< rows of north, east
  double top = 0, bottom = 10;
  Angle batter = {};  ///< from the vertical
};
/// Sheets along line segments and arcs; from top to bottom they change only by a scale about the centre (S4-31, S4-34).
struct Prism {
  std::vector<double> lines = {};  ///< rows of north, east, north, east
  std::vector<double> arcs = {};  ///< rows of north, east, radius, first and last direction (deg, clockwise from north)
  double top = 0, bottom = 10;
  double bottom_scale = 1;
};
/// A row of vertical cylinders.
struct Pylons {
  Eigen::Vector2d first = {0, 0}, step = {0, 5};
  int count = 4;
  double radius = 0.5, top = 0, bottom = 10;
};
struct Mesh {
  std::string file = {};
  Eigen::Vector3d position = {0, 0, 0};
  Angle heading = {}, pitch = {}, roll = {};
  double scale = 1;
  bool z_up = true;  ///< the file's axes are east-north-up; else north-east-down
};

struct Body {
  Place place = {};
  std::string name = {};
  std::string material = "concrete";
  std::vector<double> path = {};  ///< rows of t, north, east, depth
  std::variant<Cylinder, Sphere, Box, Wall, Prism, Pylons, Mesh> shape = {};
};

enum class BottomKind : std::uint8_t { kNone, kFlat, kTerrain, kRaster, kMesh };
struct BottomConfig {
  Place place = {};
  BottomKind kind = BottomKind::kNone;
  std::string material = "sand";
  double depth = 10;                       ///< flat: depth; terrain: mean depth; raster or mesh: added to its depths
  double extent_m = 500;                   ///< flat, terrain: half the side, centred on the origin
  double cell_m = 2;                       ///< terrain
  double relief_m = 2, wavelength_m = 60;  ///< terrain: rms height and longest wave
  Eigen::Vector2d slope = {0, 0};          ///< terrain: increase of depth per metre north and east
  int seed = 1;                            ///< terrain
  std::string file = {};                   ///< raster or mesh
  bool elevation = true;                   ///< raster: values are heights; false: depths
  Eigen::Vector2d origin = {0, 0};         ///< raster: easting, northing (or longitude, latitude) of W's origin
  bool centred = true;                     ///< raster, mesh: W's origin is the middle; false: `origin`
  double scale = 1;                        ///< mesh
  bool allow_holes = false;
};

struct VehicleConfig {
  Place place = {};
  std::string name = "vehicle";
  std::string file = {};  ///< vehicle file; empty: a body of half a metre that turns instantly
  bool dynamic = false;
  std::optional<ControlKind> control = {};  ///< empty: that of the vehicle file
  Eigen::Vector3d start = {0, 0, 1};
  Angle heading = {};
  double speed = 1.5;
  double dive_amplitude = 0, dive_period_s = 60, dive_noise = 0;  ///< sine in depth (S4-35)
  double endurance_h = 8;                                         ///< endurance on a full battery
  double lost_s = 0;  ///< in a group: time from which it neither moves nor speaks; 0: never
};

/// A further vehicle of a group. It is of the kind of [vehicle], with the same sonars.
struct GroupVehicle {
  Place place = {};
  std::string name = {};
  Eigen::Vector3d start = {0, 0, 1};
  Angle heading = {};
  double lost_s = 0;
};

/// The names of the sonars in faults: imaging sonars are "sonar", "sonar.2" ... in the order of the file, range sonars
/// "altimeter" ...
std::vector<std::string> fault_names(const std::vector<SonarConfig>& sonars);

inline constexpr std::size_t kMaxGroup = 8;  ///< vehicles of a group

struct WaypointConfig {
  double north = 0, east = 0, depth = 1, speed = 0;  ///< speed 0: the vehicle's
};

struct SceneConfig {
  std::string title = "a scene", text;
  int seed = 1;
  double duration_s = 60;
  double latitude_deg = 0, longitude_deg = 0;  ///< position of W's origin; both 0: not georeferenced
};

struct Scene {
  std::string file;
  SceneConfig about;
  WaterConfig water;
  Place water_place;
  std::vector<Material> materials = listed_materials();  ///< and the file's own
  BottomConfig bottom;
  std::vector<Body> bodies;
  VehicleConfig vehicle;
  PlantDifference plant;            ///< of the simulated vehicle from its file
  PlantDifference control_model;    ///< what the control takes it for
  std::vector<GroupVehicle> group;  ///< the vehicles beside it
  AcousticLinkConfig link;          ///< between the vehicles
  std::vector<WaypointConfig> waypoints;
  std::vector<SonarConfig> sonars;
  std::vector<CameraPairConfig> cameras;
  HydrophonesConfig hydrophones;
  std::vector<SoundConfig> sounds;
  DeadReckoningConfig navigator{.kind = NavigatorKind::kTruth};
  NavigationSensorsConfig navigation;
  std::vector<FaultConfig> faults;

  [[nodiscard]] const Material* material(const std::string& name) const;
  /// Geographic origin of W; empty if the scene is not georeferenced.
  [[nodiscard]] std::optional<GeoOrigin> origin() const;
};

/// Checks that concern several fields. A file is checked when it is read, a scene made in code when a Simulator gets
/// it. Throws Error.
void check(const Scene& scene);
/// The number of pings and readings in a run of a scene. A longer run is refused: it would keep the program busy for
/// hours, and a typing mistake is likelier.
constexpr double kMaxSceneEvents = 20e6;
/// Throws Error unless the sonars and sensors of a scene give no more in this time.
void check_length(const Scene& scene, double duration_s);

/// Throws Error if the scene has no sonar of this name.
void switch_off(Scene& scene, const std::string& sonar);

/// The schema writes to `scene`, which must outlive it.
Schema schema(Scene& scene);
/// Throws Error with line and column.
Scene load_scene(const std::string& file);
Scene parse_scene(std::string_view text, const std::string& file);
/// The same for a file that holds more than a scene: `more` is read too.
Scene parse_scene(std::string_view text, const std::string& file, Schema& more);
/// Whether a file is a scene, by its first bytes: TOML with a [scene] section.
bool looks_like_scene(std::string_view head);

/// Displacement of a moving body at t seconds from the first row of its path.
Eigen::Vector3d displacement(const Body& body, double t_s);

}  // namespace isobath
