// Messages in the JSON schemas that Foxglove and other viewers know without a plug-in (https://docs.foxglove.dev).
// Each function returns the text of one message for a channel whose schema has the name of the message.
//
// The frames are converted here: inputs are in W (north-east-down) and B (forward-starboard-down), messages are in the
// frames "map" (east-north-up, same origin) and "body" (forward-port-up). JSON has no non-finite numbers: a non-finite
// point is left out, and for a non-finite pose or position the text is empty. Numbers are rounded: positions to 0.1 mm,
// directions to 1e-6. Times before 1970 become 1970.
#pragma once

#include <cstdint>
#include <isobath/base/time.hpp>
#include <isobath/geometry/geodesy.hpp>
#include <isobath/geometry/pose.hpp>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace isobath {

enum class FoxgloveKind : std::uint8_t {
  kFrameTransform,
  kPoseInFrame,
  kLocationFix,
  kPointCloud,
  kGrid,
  kSceneUpdate,
  kRawImage,
  kLog,
};
/// "foxglove.FrameTransform".
const char* foxglove_name(FoxgloveKind kind);
/// JSON Schema, as in the package @foxglove/schemas without the descriptions.
std::string foxglove_schema(FoxgloveKind kind);

Eigen::Vector3d to_east_north_up(const Eigen::Vector3d& p_W);
/// Converts the pose of B in W to the pose, in "map", of the body with axes x forward, y to port, z up.
Pose to_east_north_up(const Pose& X_WB);

/// The pose of the body in "map", as foxglove.FrameTransform and as foxglove.PoseInFrame.
std::string foxglove_transform(Time time, const Pose& X_WB);
std::string foxglove_pose(Time time, const Pose& X_WB);

struct FoxglovePlace {
  GeoPoint at;
  double depth_m = 0;
  std::optional<Eigen::Matrix3d> covariance_W = {};  ///< north, east, down, m2
  std::optional<Angle> heading = {};
};
std::string foxglove_location(Time time, const FoxglovePlace& place);

struct FoxglovePoint {
  Eigen::Vector3f p_W;
  float value = 0;
};
/// Fields x, y, z and a field named `value`, each a float.
std::string foxglove_points(Time time, std::span<const FoxglovePoint> points, const char* value);

/// Square cells in a level plane: cell (x, y) at x * cells_y + y, x along the heading, y to starboard of it.
struct FoxgloveGrid {
  Eigen::Vector3d corner_W;  ///< outer corner of cell (0, 0)
  Angle heading;
  int cells_x = 0, cells_y = 0;
  double cell_m = 1;
  std::span<const std::uint8_t> values;
};
/// One field named `value`: a byte.
std::string foxglove_grid(Time time, const FoxgloveGrid& grid, const char* value);

struct FoxgloveColor {
  double r = 1, g = 1, b = 1, a = 1;
};
struct FoxgloveLine {
  std::vector<Eigen::Vector3d> points_W;
  bool closed = false;
  FoxgloveColor color;
  double pixels = 2;
};
struct FoxgloveBall {
  Eigen::Vector3d at_W;
  double radius_m = 1;
  FoxgloveColor color;
};
struct FoxgloveText {
  Eigen::Vector3d at_W;
  std::string text;
  FoxgloveColor color;
};
/// Replaces an earlier entity of the same id.
struct FoxgloveEntity {
  std::string id;
  std::vector<FoxgloveLine> lines = {};
  std::vector<FoxgloveBall> balls = {};
  std::vector<FoxgloveText> texts = {};
};
std::string foxglove_scene(Time time, std::span<const FoxgloveEntity> entities);

/// mono8, row after row from the top.
std::string foxglove_image(Time time, int width, int height, std::span<const std::uint8_t> pixels);

enum class FoxgloveLevel : std::uint8_t { kDebug = 1, kInfo, kWarning, kError, kFatal };
std::string foxglove_log(Time time, FoxgloveLevel level, std::string_view name, std::string_view message);

}  // namespace isobath
