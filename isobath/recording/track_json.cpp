#include <isobath/recording/exact_json.hpp>
#include <isobath/recording/track_json.hpp>

namespace isobath {
namespace {

using Content = nlohmann::ordered_json;

Content covariance_content(const Eigen::Matrix2d& c) {
  return Content::array({exact_enough(c(0, 0)), exact_enough(c(0, 1)), exact_enough(c(1, 1))});
}

Content body_content(const Obstacle& o, const Pose& X_WB) {
  const Eigen::Vector3d centre_W = level(X_WB) * Eigen::Vector3d(o.centre.x(), o.centre.y(), 0);
  Content outline = Content::array();
  for (const Eigen::Vector2d& p_W : world_outline(o, X_WB)) outline.push_back(components_of<2>(p_W));
  return {{"track", o.motion.track},
          {"number", o.number},
          {"place", components_of<2>(centre_W.head<2>())},
          {"velocity", components_of<2>(o.motion.velocity_W)},
          {"position_covariance", covariance_content(o.motion.position_covariance)},
          {"velocity_covariance", covariance_content(o.motion.velocity_covariance)},
          {"outline", std::move(outline)},
          {"existence", exact_enough(o.existence)}};
}

}  // namespace

std::string tracks_json(const ScanResult& scan) {
  Content bodies = Content::array();
  for (const Obstacle& o : scan.detection.obstacles) {
    if (o.moves()) bodies.push_back(body_content(o, scan.detection.X_WB));
  }
  const Content json{{"scan", scan.number},
                     {"time_ns", scan.detection.time.time_since_epoch().count()},
                     {"bodies", std::move(bodies)}};
  return json.dump();
}

const char* tracks_schema() {
  return R"({"title": "isobath.Tracks", "type": "object", "properties": {"scan": {"type": "integer"},
"time_ns": {"type": "integer"}, "bodies": {"type": "array", "items": {"type": "object", "properties": {
"track": {"type": "integer"}, "number": {"type": "integer"}, "place": {"type": "array"}, "velocity": {"type": "array"},
"position_covariance": {"type": "array"}, "velocity_covariance": {"type": "array"}, "outline": {"type": "array"},
"existence": {"type": "number"}}, "required": ["track", "number", "place", "velocity", "position_covariance",
"velocity_covariance", "outline", "existence"]}}}, "required": ["scan", "time_ns", "bodies"]})";
}

}  // namespace isobath
