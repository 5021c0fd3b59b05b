#include <initializer_list>
#include <isobath/base/error.hpp>
#include <isobath/io/mcap/foxglove.hpp>
#include <nlohmann/json.hpp>
#include <utility>

namespace isobath {
namespace {

using SchemaJson = nlohmann::ordered_json;

SchemaJson number() { return {{"type", "number"}}; }
SchemaJson text() { return {{"type", "string"}}; }
SchemaJson flag() { return {{"type", "boolean"}}; }
SchemaJson natural() { return {{"type", "integer"}, {"minimum", 0}}; }
SchemaJson base64() { return {{"type", "string"}, {"contentEncoding", "base64"}}; }
SchemaJson list(SchemaJson items) { return {{"type", "array"}, {"items", std::move(items)}}; }

using Properties = std::initializer_list<std::pair<const char*, SchemaJson>>;

/// The properties named in `optional` are not required.
SchemaJson object(const char* title, Properties required, Properties optional = {}) {
  SchemaJson schema{
      {"title", title}, {"type", "object"}, {"properties", SchemaJson::object()}, {"required", SchemaJson::array()}};
  for (const auto& [name, property] : required) {
    schema["properties"][name] = property;
    schema["required"].push_back(name);
  }
  for (const auto& [name, property] : optional) schema["properties"][name] = property;
  return schema;
}

SchemaJson one_of(const char* title, std::initializer_list<const char*> names) {
  SchemaJson choices = SchemaJson::array();
  for (const char* name : names) choices.push_back({{"title", name}, {"const", choices.size()}});
  return {{"title", title}, {"oneOf", std::move(choices)}};
}

SchemaJson nanoseconds() { return {{"type", "integer"}, {"minimum", 0}, {"maximum", 999999999}}; }
SchemaJson time_schema() {
  return {{"type", "object"}, {"title", "time"}, {"properties", {{"sec", natural()}, {"nsec", nanoseconds()}}}};
}
SchemaJson duration() {
  return {{"type", "object"},
          {"title", "duration"},
          {"properties", {{"sec", {{"type", "integer"}}}, {"nsec", nanoseconds()}}}};
}
SchemaJson vector3() { return object("foxglove.Vector3", {{"x", number()}, {"y", number()}, {"z", number()}}); }
SchemaJson point3() { return object("foxglove.Point3", {{"x", number()}, {"y", number()}, {"z", number()}}); }
SchemaJson quaternion() {
  return object("foxglove.Quaternion", {{"x", number()}, {"y", number()}, {"z", number()}, {"w", number()}});
}
SchemaJson pose_schema() { return object("foxglove.Pose", {{"position", vector3()}, {"orientation", quaternion()}}); }
SchemaJson color() {
  return object("foxglove.Color", {{"r", number()}, {"g", number()}, {"b", number()}, {"a", number()}});
}
SchemaJson key_value() { return object("foxglove.KeyValuePair", {{"key", text()}, {"value", text()}}); }
SchemaJson packed_field() {
  return object("foxglove.PackedElementField",
                {{"name", text()},
                 {"offset", natural()},
                 {"type", one_of("foxglove.NumericType", {"UNKNOWN", "UINT8", "INT8", "UINT16", "INT16", "UINT32",
                                                          "INT32", "FLOAT32", "FLOAT64"})}});
}

SchemaJson scene_entity() {
  const SchemaJson arrow = object("foxglove.ArrowPrimitive", {{"pose", pose_schema()},
                                                              {"shaft_length", number()},
                                                              {"shaft_diameter", number()},
                                                              {"head_length", number()},
                                                              {"head_diameter", number()},
                                                              {"color", color()}});
  const SchemaJson cube =
      object("foxglove.CubePrimitive", {{"pose", pose_schema()}, {"size", vector3()}, {"color", color()}});
  const SchemaJson sphere =
      object("foxglove.SpherePrimitive", {{"pose", pose_schema()}, {"size", vector3()}, {"color", color()}});
  const SchemaJson cylinder = object("foxglove.CylinderPrimitive", {{"pose", pose_schema()},
                                                                    {"size", vector3()},
                                                                    {"bottom_scale", number()},
                                                                    {"top_scale", number()},
                                                                    {"color", color()}});
  const SchemaJson line =
      object("foxglove.LinePrimitive", {{"type", one_of("foxglove.LineType", {"LINE_STRIP", "LINE_LOOP", "LINE_LIST"})},
                                        {"pose", pose_schema()},
                                        {"thickness", number()},
                                        {"scale_invariant", flag()},
                                        {"points", list(point3())},
                                        {"color", color()},
                                        {"colors", list(color())},
                                        {"indices", list(natural())}});
  const SchemaJson triangles = object("foxglove.TriangleListPrimitive", {{"pose", pose_schema()},
                                                                         {"points", list(point3())},
                                                                         {"color", color()},
                                                                         {"colors", list(color())},
                                                                         {"indices", list(natural())}});
  const SchemaJson words = object("foxglove.TextPrimitive", {{"pose", pose_schema()},
                                                             {"billboard", flag()},
                                                             {"font_size", number()},
                                                             {"scale_invariant", flag()},
                                                             {"color", color()},
                                                             {"text", text()}});
  const SchemaJson model = object("foxglove.ModelPrimitive", {{"pose", pose_schema()},
                                                              {"scale", vector3()},
                                                              {"color", color()},
                                                              {"override_color", flag()},
                                                              {"url", text()},
                                                              {"media_type", text()},
                                                              {"data", base64()}});
  return object("foxglove.SceneEntity", {{"timestamp", time_schema()},
                                         {"frame_id", text()},
                                         {"id", text()},
                                         {"lifetime", duration()},
                                         {"frame_locked", flag()},
                                         {"metadata", list(key_value())},
                                         {"arrows", list(arrow)},
                                         {"cubes", list(cube)},
                                         {"spheres", list(sphere)},
                                         {"cylinders", list(cylinder)},
                                         {"lines", list(line)},
                                         {"triangles", list(triangles)},
                                         {"texts", list(words)},
                                         {"models", list(model)}});
}

SchemaJson location_fix() {
  SchemaJson covariance = list(number());
  covariance["minItems"] = covariance["maxItems"] = 9;
  return object("foxglove.LocationFix",
                {{"timestamp", time_schema()},
                 {"frame_id", text()},
                 {"latitude", number()},
                 {"longitude", number()},
                 {"altitude", number()},
                 {"position_covariance", covariance},
                 {"position_covariance_type",
                  one_of("foxglove.PositionCovarianceType", {"UNKNOWN", "APPROXIMATED", "DIAGONAL_KNOWN", "KNOWN"})}},
                {{"heading", number()}, {"velocity", vector3()}, {"color", color()}, {"metadata", list(key_value())}});
}

SchemaJson schema_json(FoxgloveKind kind) {
  switch (kind) {
    case FoxgloveKind::kFrameTransform:
      return object("foxglove.FrameTransform", {{"timestamp", time_schema()},
                                                {"parent_frame_id", text()},
                                                {"child_frame_id", text()},
                                                {"translation", vector3()},
                                                {"rotation", quaternion()}});
    case FoxgloveKind::kPoseInFrame:
      return object("foxglove.PoseInFrame",
                    {{"timestamp", time_schema()}, {"frame_id", text()}, {"pose", pose_schema()}});
    case FoxgloveKind::kLocationFix: return location_fix();
    case FoxgloveKind::kPointCloud:
      return object("foxglove.PointCloud", {{"timestamp", time_schema()},
                                            {"frame_id", text()},
                                            {"pose", pose_schema()},
                                            {"point_stride", natural()},
                                            {"fields", list(packed_field())},
                                            {"data", base64()}});
    case FoxgloveKind::kGrid:
      return object("foxglove.Grid", {{"timestamp", time_schema()},
                                      {"frame_id", text()},
                                      {"pose", pose_schema()},
                                      {"column_count", natural()},
                                      {"cell_size", object("foxglove.Vector2", {{"x", number()}, {"y", number()}})},
                                      {"row_stride", natural()},
                                      {"cell_stride", natural()},
                                      {"fields", list(packed_field())},
                                      {"data", base64()}});
    case FoxgloveKind::kSceneUpdate: {
      const SchemaJson deletion = object("foxglove.SceneEntityDeletion",
                                         {{"timestamp", time_schema()},
                                          {"type", one_of("foxglove.SceneEntityDeletionType", {"MATCHING_ID", "ALL"})},
                                          {"id", text()}});
      return object("foxglove.SceneUpdate", {{"deletions", list(deletion)}, {"entities", list(scene_entity())}});
    }
    case FoxgloveKind::kRawImage:
      return object("foxglove.RawImage", {{"timestamp", time_schema()},
                                          {"frame_id", text()},
                                          {"width", natural()},
                                          {"height", natural()},
                                          {"encoding", text()},
                                          {"step", natural()},
                                          {"data", base64()}});
    case FoxgloveKind::kLog:
      return object("foxglove.Log",
                    {{"timestamp", time_schema()},
                     {"level", one_of("foxglove.LogLevel", {"UNKNOWN", "DEBUG", "INFO", "WARNING", "ERROR", "FATAL"})},
                     {"message", text()},
                     {"name", text()},
                     {"file", text()},
                     {"line", natural()}});
  }
  return {};
}

}  // namespace

const char* foxglove_name(FoxgloveKind kind) {
  switch (kind) {
    case FoxgloveKind::kFrameTransform: return "foxglove.FrameTransform";
    case FoxgloveKind::kPoseInFrame: return "foxglove.PoseInFrame";
    case FoxgloveKind::kLocationFix: return "foxglove.LocationFix";
    case FoxgloveKind::kPointCloud: return "foxglove.PointCloud";
    case FoxgloveKind::kGrid: return "foxglove.Grid";
    case FoxgloveKind::kSceneUpdate: return "foxglove.SceneUpdate";
    case FoxgloveKind::kRawImage: return "foxglove.RawImage";
    case FoxgloveKind::kLog: return "foxglove.Log";
  }
  return "";
}

std::string foxglove_schema(FoxgloveKind kind) { return schema_json(kind).dump(); }

}  // namespace isobath
