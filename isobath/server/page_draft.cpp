#include <cmath>
#include <fmt/format.h>
#include <isobath/server/page_draft.hpp>
#include <limits>
#include <nlohmann/json.hpp>
#include <utility>

namespace isobath {
namespace {

using nlohmann::json;
using Problem = tl::unexpected<std::string>;

struct NumberRule {
  const char* key;
  double least, most;
  bool whole = false;
};
constexpr NumberRule kNorth{"north", -kMaxMetres, kMaxMetres}, kEast{"east", -kMaxMetres, kMaxMetres};
constexpr NumberRule kDepth{"depth_m", 0, 12000}, kAltitude{"altitude_m", 0, 12000}, kPointSpeed{"speed", 0, kMaxSpeed};
constexpr NumberRule kFrom{"from", 0, 1e6, true};
constexpr NumberRule kMission{"mission", 0, std::numeric_limits<std::uint32_t>::max(), true};

/// The number under the key; `problem` says what is wrong with it.
std::optional<double> number_in(const json& object, const NumberRule& rule, const std::string& of,
                                std::string& problem) {
  const auto found = object.find(rule.key);
  if (found == object.end()) return std::nullopt;
  const double value = found->is_number() ? found->get<double>() : std::nan("");
  const bool fits = value >= rule.least && value <= rule.most && (!rule.whole || value == std::trunc(value));
  if (fits) return value;
  problem = fmt::format("{}{} must be a number from {:g} to {:g}", of, rule.key, rule.least, rule.most);
  return std::nullopt;
}

Result<DraftPoint, std::string> point_of(const json& object, std::size_t number) {
  const std::string of = fmt::format("point {}: ", number);
  if (!object.is_object()) return Problem(of + "not an object");
  DraftPoint point;
  std::string problem;
  const auto north = number_in(object, kNorth, of, problem), east = number_in(object, kEast, of, problem);
  const auto depth = number_in(object, kDepth, of, problem), from = number_in(object, kFrom, of, problem);
  point.altitude_m = number_in(object, kAltitude, of, problem);
  point.speed = number_in(object, kPointSpeed, of, problem).value_or(0);
  if (!problem.empty()) return Problem(problem);
  if (!north || !east) return Problem(of + "no north or no east");
  if (depth.has_value() == point.altitude_m.has_value()) return Problem(of + "either depth_m or altitude_m");
  const std::size_t read = 3 + (object.contains("speed") ? 1 : 0) + (from ? 1 : 0);
  if (object.size() != read) return Problem(of + "wrong keys");
  point.north_east = {*north, *east};
  point.depth_m = depth.value_or(point.depth_m);
  if (from) point.from = static_cast<std::size_t>(*from);
  return point;
}

Result<Polygon, std::string> fence_of(const json& corners) {
  if (!corners.is_array()) return Problem("the fence must be a list of corners");
  if (corners.size() > MissionDraft::kMaxCorners) {
    return Problem(
        fmt::format("the fence has {} corners; the page may send {}", corners.size(), MissionDraft::kMaxCorners));
  }
  Polygon fence;
  for (const json& corner : corners) {
    const bool pair = corner.is_array() && corner.size() == 2 && corner[0].is_number() && corner[1].is_number();
    if (!pair) return Problem("a corner of the fence must be two numbers, north and east");
    const Eigen::Vector2d p(corner[0].get<double>(), corner[1].get<double>());
    if (!(p.cwiseAbs().maxCoeff() <= kMaxMetres)) {
      return Problem(fmt::format("a corner of the fence lies more than {:g} m from the origin", kMaxMetres));
    }
    fence.push_back(p);
  }
  return fence;
}

}  // namespace

Result<MissionDraft, std::string> draft_of(const json& object) {
  if (!object.is_object()) return Problem("the draft must be an object");
  MissionDraft draft;
  std::string problem;
  const auto mission = number_in(object, kMission, "", problem);
  if (!mission) return Problem(problem.empty() ? "the draft does not name its mission" : problem);
  draft.mission = static_cast<std::uint32_t>(*mission);
  const auto points = object.find("points"), fence = object.find("fence");
  if (points == object.end() || !points->is_array()) return Problem("the draft has no points");
  if (object.size() != (fence == object.end() ? 2u : 3u)) return Problem("the draft has wrong keys");
  if (points->size() > MissionDraft::kMaxPoints) {
    return Problem(
        fmt::format("the draft has {} points; the page may send {}", points->size(), MissionDraft::kMaxPoints));
  }
  for (const json& point : *points) {
    auto read = point_of(point, draft.points.size() + 1);
    if (!read) return Problem(std::move(read.error()));
    draft.points.push_back(*std::move(read));
  }
  if (fence == object.end()) return draft;
  auto read = fence_of(*fence);
  if (!read) return Problem(std::move(read.error()));
  draft.fence = *std::move(read);
  return draft;
}

}  // namespace isobath
