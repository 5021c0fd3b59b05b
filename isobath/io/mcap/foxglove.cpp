#include <algorithm>
#include <cmath>
#include <cstring>
#include <isobath/base/base64.hpp>
#include <isobath/base/error.hpp>
#include <isobath/io/mcap/foxglove.hpp>
#include <nlohmann/json.hpp>

namespace isobath {
namespace {

using Message = nlohmann::ordered_json;
using Eigen::Vector3d;

constexpr const char* kMap = "map";
constexpr int kNumberU8 = 1, kNumberF32 = 7;

double rounded_place(double metres) { return std::round(metres * 1e4) / 1e4; }
double rounded_share(double value) { return std::round(value * 1e6) / 1e6; }

Message stamp(Time time) {
  const std::int64_t ns = std::max<std::int64_t>(time.time_since_epoch().count(), 0);
  return {{"sec", ns / 1'000'000'000}, {"nsec", ns % 1'000'000'000}};
}

Message foxglove_json(const Vector3d& p) {
  return {{"x", rounded_place(p.x())}, {"y", rounded_place(p.y())}, {"z", rounded_place(p.z())}};
}

Message foxglove_json(const Rotation& rotation) {
  const Eigen::Quaterniond& q = rotation.quaternion();
  return {{"x", rounded_share(q.x())},
          {"y", rounded_share(q.y())},
          {"z", rounded_share(q.z())},
          {"w", rounded_share(q.w())}};
}

Message foxglove_json(const Pose& pose) {
  return {{"position", foxglove_json(pose.translation)}, {"orientation", foxglove_json(pose.rotation)}};
}

Message foxglove_json(const FoxgloveColor& c) { return {{"r", c.r}, {"g", c.g}, {"b", c.b}, {"a", c.a}}; }

std::string base64_text(std::span<const std::uint8_t> bytes) {
  return to_base64({reinterpret_cast<const char*>(bytes.data()), bytes.size()});
}

std::string json_text(const Message& message) {
  return message.dump(-1, ' ', false, Message::error_handler_t::replace);
}

Message packed(const char* name, int offset, int type) { return {{"name", name}, {"offset", offset}, {"type", type}}; }

Message points_of(const std::vector<Vector3d>& points_W) {
  Message points = Message::array();
  for (const Vector3d& p : points_W) {
    if (p.allFinite()) points.push_back(foxglove_json(to_east_north_up(p)));
  }
  return points;
}

/// An entity without content.
Message entity_json(Time time, const std::string& id) {
  Message entity{{"timestamp", stamp(time)},
                 {"frame_id", kMap},
                 {"id", id},
                 {"lifetime", {{"sec", 0}, {"nsec", 0}}},
                 {"frame_locked", false}};
  for (const char* name :
       {"metadata", "arrows", "cubes", "spheres", "cylinders", "lines", "triangles", "texts", "models"}) {
    entity[name] = Message::array();
  }
  return entity;
}

Message foxglove_json(Time time, const FoxgloveEntity& e) {
  Message entity = entity_json(time, e.id);
  for (const FoxgloveLine& line : e.lines) {
    entity["lines"].push_back({{"type", line.closed ? 1 : 0},
                               {"pose", foxglove_json(Pose{})},
                               {"thickness", line.pixels},
                               {"scale_invariant", true},
                               {"points", points_of(line.points_W)},
                               {"color", foxglove_json(line.color)},
                               {"colors", Message::array()},
                               {"indices", Message::array()}});
  }
  for (const FoxgloveBall& ball : e.balls) {
    if (!ball.at_W.allFinite()) continue;
    entity["spheres"].push_back({{"pose", foxglove_json(Pose{{}, to_east_north_up(ball.at_W)})},
                                 {"size", foxglove_json(Vector3d(Vector3d::Constant(2 * ball.radius_m)))},
                                 {"color", foxglove_json(ball.color)}});
  }
  for (const FoxgloveText& words : e.texts) {
    if (!words.at_W.allFinite()) continue;
    entity["texts"].push_back({{"pose", foxglove_json(Pose{{}, to_east_north_up(words.at_W)})},
                               {"billboard", true},
                               {"font_size", 12.0},
                               {"scale_invariant", true},
                               {"color", foxglove_json(words.color)},
                               {"text", words.text}});
  }
  return entity;
}

}  // namespace

Vector3d to_east_north_up(const Vector3d& p_W) { return {p_W.y(), p_W.x(), -p_W.z()}; }

Pose to_east_north_up(const Pose& X_WB) {
  // R = A R_WB B, where A swaps north and east and negates down, and B negates starboard and down.
  const Eigen::Matrix3d A = (Eigen::Matrix3d() << 0, 1, 0, 1, 0, 0, 0, 0, -1).finished();
  const Eigen::Matrix3d R = A * X_WB.rotation.matrix() * Vector3d(1, -1, -1).asDiagonal();
  return {Rotation::from_quaternion(Eigen::Quaterniond(R)), to_east_north_up(X_WB.translation)};
}

std::string foxglove_transform(Time time, const Pose& X_WB) {
  if (!X_WB.is_finite()) return {};
  const Pose pose = to_east_north_up(X_WB);
  return json_text({{"timestamp", stamp(time)},
                    {"parent_frame_id", kMap},
                    {"child_frame_id", "body"},
                    {"translation", foxglove_json(pose.translation)},
                    {"rotation", foxglove_json(pose.rotation)}});
}

std::string foxglove_pose(Time time, const Pose& X_WB) {
  if (!X_WB.is_finite()) return {};
  return json_text({{"timestamp", stamp(time)}, {"frame_id", kMap}, {"pose", foxglove_json(to_east_north_up(X_WB))}});
}

std::string foxglove_location(Time time, const FoxglovePlace& place) {
  if (!valid(place.at) || !std::isfinite(place.depth_m)) return {};
  const auto degrees = [](double value) { return std::round(value * 1e9) / 1e9; };
  const bool known = place.covariance_W && place.covariance_W->allFinite();
  Message covariance = Message::array();
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column) {
      constexpr int kAxis[] = {1, 0, 2};  // east, north, up
      const double sign = (row == 2) != (column == 2) ? -1 : 1;
      covariance.push_back(known ? rounded_share(sign * (*place.covariance_W)(kAxis[row], kAxis[column])) : 0.0);
    }
  }
  Message message{{"timestamp", stamp(time)},
                  {"frame_id", kMap},
                  {"latitude", degrees(place.at.latitude_deg)},
                  {"longitude", degrees(place.at.longitude_deg)},
                  {"altitude", rounded_place(-place.depth_m)},
                  {"position_covariance", std::move(covariance)},
                  {"position_covariance_type", known ? 3 : 0}};
  if (place.heading && std::isfinite(place.heading->radians())) {
    message["heading"] = rounded_share(place.heading->wrapped_positive().radians());
  }
  return json_text(message);
}

std::string foxglove_points(Time time, std::span<const FoxglovePoint> points, const char* value) {
  std::vector<std::uint8_t> bytes;
  bytes.reserve(16 * points.size());
  for (const FoxglovePoint& p : points) {
    if (!p.p_W.allFinite() || !std::isfinite(p.value)) continue;
    const float numbers[4] = {p.p_W.y(), p.p_W.x(), -p.p_W.z(), p.value};
    const auto* raw = reinterpret_cast<const std::uint8_t*>(numbers);
    bytes.insert(bytes.end(), raw, raw + sizeof numbers);
  }
  return json_text({{"timestamp", stamp(time)},
                    {"frame_id", kMap},
                    {"pose", foxglove_json(Pose{})},
                    {"point_stride", 16},
                    {"fields", Message::array({packed("x", 0, kNumberF32), packed("y", 4, kNumberF32),
                                               packed("z", 8, kNumberF32), packed(value, 12, kNumberF32)})},
                    {"data", base64_text(bytes)}});
}

std::string foxglove_grid(Time time, const FoxgloveGrid& grid, const char* value) {
  ISOBATH_ASSERT(grid.values.size() == static_cast<std::size_t>(grid.cells_x) * static_cast<std::size_t>(grid.cells_y));
  if (!grid.corner_W.allFinite() || !std::isfinite(grid.heading.radians())) return {};
  // The message's rows run to port, since its z axis points up: the first row is the farthest to starboard.
  std::vector<std::uint8_t> rows;
  rows.reserve(grid.values.size());
  for (int y = grid.cells_y - 1; y >= 0; --y) {
    for (int x = 0; x < grid.cells_x; ++x) {
      rows.push_back(grid.values[static_cast<std::size_t>(x) * static_cast<std::size_t>(grid.cells_y) +
                                 static_cast<std::size_t>(y)]);
    }
  }
  const Pose X_WG{Rotation::from_heading(grid.heading), grid.corner_W};
  const Pose corner{X_WG.rotation, X_WG * Vector3d(0, grid.cells_y * grid.cell_m, 0)};
  return json_text({{"timestamp", stamp(time)},
                    {"frame_id", kMap},
                    {"pose", foxglove_json(to_east_north_up(corner))},
                    {"column_count", grid.cells_x},
                    {"cell_size", {{"x", grid.cell_m}, {"y", grid.cell_m}}},
                    {"row_stride", grid.cells_x},
                    {"cell_stride", 1},
                    {"fields", Message::array({packed(value, 0, kNumberU8)})},
                    {"data", base64_text(rows)}});
}

std::string foxglove_scene(Time time, std::span<const FoxgloveEntity> entities) {
  Message list = Message::array();
  for (const FoxgloveEntity& entity : entities) list.push_back(foxglove_json(time, entity));
  return json_text({{"deletions", Message::array()}, {"entities", std::move(list)}});
}

std::string foxglove_image(Time time, int width, int height, std::span<const std::uint8_t> pixels) {
  ISOBATH_ASSERT(pixels.size() == static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
  return json_text({{"timestamp", stamp(time)},
                    {"frame_id", "sonar"},
                    {"width", width},
                    {"height", height},
                    {"encoding", "mono8"},
                    {"step", width},
                    {"data", base64_text(pixels)}});
}

std::string foxglove_log(Time time, FoxgloveLevel level, std::string_view name, std::string_view message) {
  return json_text({{"timestamp", stamp(time)},
                    {"level", static_cast<int>(level)},
                    {"message", std::string(message)},
                    {"name", std::string(name)},
                    {"file", ""},
                    {"line", 0}});
}

}  // namespace isobath
