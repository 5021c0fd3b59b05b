#include <algorithm>
#include <array>
#include <cmath>
#include <fmt/format.h>
#include <isobath/mission/plan/mission_import.hpp>
#include <limits>
#include <nlohmann/json.hpp>
#include <numbers>

namespace isobath {
namespace {

using Eigen::Vector2d;
using Json = nlohmann::json;

constexpr int kFenceSides = 32;  // of the polygon that replaces a circle

// Numbers of MAV_CMD, common.xml of MAVLink.
enum Command : int {
  kWaypoint = 16,
  kLoiterUnlimited = 17,
  kLoiterTurns = 18,
  kLoiterTime = 19,
  kReturn = 20,
  kLand = 21,
  kSpline = 82,
  kDelay = 93,
  kChangeSpeed = 178,
};

std::string command_text(int command) {
  static constexpr std::array<std::pair<int, const char*>, 15> kNames{{{22, "NAV_TAKEOFF"},
                                                                       {92, "NAV_GUIDED_ENABLE"},
                                                                       {112, "CONDITION_DELAY"},
                                                                       {115, "CONDITION_YAW"},
                                                                       {177, "DO_JUMP"},
                                                                       {183, "DO_SET_SERVO"},
                                                                       {195, "DO_SET_ROI_LOCATION"},
                                                                       {197, "DO_SET_ROI_NONE"},
                                                                       {201, "DO_SET_ROI"},
                                                                       {203, "DO_DIGICAM_CONTROL"},
                                                                       {205, "DO_MOUNT_CONTROL"},
                                                                       {206, "DO_SET_CAM_TRIGG_DIST"},
                                                                       {530, "SET_CAMERA_MODE"},
                                                                       {2000, "IMAGE_START_CAPTURE"},
                                                                       {2001, "IMAGE_STOP_CAPTURE"}}};
  const auto* const named =
      std::find_if(kNames.begin(), kNames.end(), [command](const auto& n) { return n.first == command; });
  return named == kNames.end() ? fmt::format("command {}", command)
                               : fmt::format("command {} ({})", command, named->second);
}

const Json* member(const Json& object, const char* name) {
  if (!object.is_object()) return nullptr;
  const auto found = object.find(name);
  return found == object.end() ? nullptr : &*found;
}

/// NaN where there is no number.
double number(const Json* node) {
  return node && node->is_number() ? node->get<double>() : std::numeric_limits<double>::quiet_NaN();
}
double number(const Json& object, const char* name) { return number(member(object, name)); }
double element(const Json& array, std::size_t i) {
  return number(array.is_array() && array.size() > i ? &array[i] : nullptr);
}

/// Printable, whatever the file holds.
std::string word(const Json& object, const char* name) {
  const Json* node = member(object, name);
  std::string text = node && node->is_string() ? node->get<std::string>().substr(0, 80) : std::string();
  for (char& c : text) {
    if (c < ' ' || c > '~') c = '?';
  }
  return text;
}

/// A list, or an empty one.
const Json& list(const Json& object, const char* name) {
  static const Json kNone = Json::array();
  const Json* node = member(object, name);
  return node && node->is_array() ? *node : kNone;
}

struct Item {
  Place place;
  int command = 0;
  int frame = 0;
  std::array<double, 7> params{};  ///< NaN where the file has null

  [[nodiscard]] bool has_place() const {
    return std::isfinite(params[4]) && std::isfinite(params[5]) && (params[4] != 0 || params[5] != 0);
  }
  [[nodiscard]] double or_zero(std::size_t i) const { return std::isfinite(params[i]) ? params[i] : 0; }
};

class PlanReader {
 public:
  explicit PlanReader(std::string file) { plan_.place.file = std::move(file); }

  MissionPlan read(const Json& root) {
    plan_.import.format = "QGroundControl plan";
    plan_.title = "QGroundControl plan";
    const Json* mission = member(root, "mission");
    if (!mission) throw Error("the plan has no mission", place("mission"));
    find_origin(*mission);
    take_speed(*mission);
    take_items(list(*mission, "items"), "mission.items");
    if (const Json* fence = member(root, "geoFence")) take_fences(*fence);
    if (const Json* rally = member(root, "rallyPoints")) {
      for (std::size_t i = 0; i < list(*rally, "points").size(); ++i) leave_out("rally point", "not supported");
    }
    return std::move(plan_);
  }

 private:
  [[nodiscard]] Place place(const std::string& key) const { return {plan_.place.file, {}, {}, {}, key}; }
  void leave_out(const std::string& what, const std::string& why) { plan_.import.leave_out(what, why); }

  /// The planned home, else the first item with a position.
  void find_origin(const Json& mission) {
    const Json& home = list(mission, "plannedHomePosition");
    GeoOrigin origin{element(home, 0), element(home, 1)};
    if (valid(origin)) {
      surface_ = std::isfinite(element(home, 2)) ? element(home, 2) : 0;
    } else if (const auto first = first_place(list(mission, "items"))) {
      origin = *first;
    } else {
      throw Error("neither a home nor an item with a position", place("mission.plannedHomePosition"));
    }
    plan_.origin = origin;
    plane_.emplace(origin);
  }

  std::optional<GeoOrigin> first_place(const Json& items) const {
    for (const Json& entry : items) {
      const auto item = item_of(entry, {});
      const bool placed = item && item->has_place() && valid(GeoPoint{item->params[4], item->params[5]});
      if (placed) return GeoOrigin{item->params[4], item->params[5]};
    }
    return std::nullopt;
  }

  /// The hover speed for multirotors, else the cruise speed.
  void take_speed(const Json& mission) {
    const double type = number(mission, "vehicleType");
    const bool hovers = type == 2 || type == 13 || type == 14 || type == 15;
    const double speed = number(mission, hovers ? "hoverSpeed" : "cruiseSpeed");
    if (speed >= 0.01 && speed <= kMaxSpeed) {
      plan_.speed = speed;
      ++plan_.import.taken;
    } else if (std::isfinite(speed)) {
      leave_out(fmt::format("speed {} m/s", speed), "not a speed of a vehicle in the water");
    }
  }

  [[nodiscard]] std::optional<Item> item_of(const Json& entry, Place where) const {
    const double command = number(entry, "command");
    if (!(command >= 0 && command < 65536)) return std::nullopt;
    Item item{std::move(where), static_cast<int>(command)};
    const double frame = number(entry, "frame");
    item.frame = frame >= 0 && frame < 256 ? static_cast<int>(frame) : -1;
    const Json& params = list(entry, "params");
    for (std::size_t i = 0; i < 7; ++i) item.params[i] = element(params, i);
    const Json& coordinate = list(entry, "coordinate");  // of the first version of the format
    if (params.size() < 7 && coordinate.size() == 3) {
      for (std::size_t i = 0; i < 3; ++i) item.params[4 + i] = element(coordinate, i);
    }
    return item;
  }

  void take_items(const Json& items, const std::string& key) {
    for (std::size_t i = 0; i < items.size(); ++i) {
      const std::string here = fmt::format("{}[{}]", key, i);
      if (word(items[i], "type") == "ComplexItem") {
        take_complex(items[i], here);
      } else if (const auto item = item_of(items[i], place(here))) {
        take(*item);
      } else {
        leave_out("item without a command", "there is nothing to do");
      }
    }
  }

  void take_complex(const Json& entry, const std::string& key) {
    const std::string type = word(entry, "complexItemType");
    const Json* transects = member(entry, "TransectStyleComplexItem");
    if (!transects || list(*transects, "Items").empty()) {
      leave_out("complex item " + type, "it has no way-points");
    } else if (in_complex_) {  // a survey holds plain items only
      leave_out("complex item " + type, "inside another complex item");
    } else {
      in_complex_ = true;
      take_items(list(*transects, "Items"), key + ".TransectStyleComplexItem.Items");
      in_complex_ = false;
    }
  }

  void take(const Item& item) {
    if (ended_) return leave_out(command_text(item.command), "after the end of the mission");
    switch (item.command) {
      case kSpline: leave_out("curve of a spline", "legs are straight"); [[fallthrough]];
      case kWaypoint:
      case kLoiterTime: return take_point(item, item.or_zero(0), "");
      case kLoiterTurns: return take_point(item, 0, circle_of(item));
      case kLoiterUnlimited: return take_end(item, MissionEnd::kHold);
      case kLand: return take_end(item, MissionEnd::kSurface);
      case kReturn: return take_end(item, MissionEnd::kReturn);
      case kDelay: return take_delay(item);
      case kChangeSpeed: return take_change(item);
      default: leave_out(command_text(item.command), "not supported");
    }
  }

  static std::string circle_of(const Item& item) {
    const double turns = std::clamp(item.or_zero(0), 1.0, 100.0), radius = std::abs(item.or_zero(2));
    std::string task = fmt::format("circle turns={}", std::lround(turns));
    if (radius > 0) task += fmt::format(" radius_m={}", radius);
    return task;
  }

  void take_point(const Item& item, double hold_s, const std::string& task) {
    if (!item.has_place()) return leave_out(command_text(item.command), "it has no position");
    MissionPoint point;
    point.place = item.place;
    point.name = fmt::format("point {}", plan_.points.size() + 1);
    point.north_east = metres_of(*plane_, {item.params[4], item.params[5]}, item.place);
    if (!take_height(item, point)) return leave_out(command_text(item.command), "its frame is unknown");
    point.speed = speed_;
    point.hold_s = std::max(0.0, hold_s);
    point.task = task;
    if (item.command == kWaypoint) point.radius_m = std::clamp(item.or_zero(1), 0.0, 1000.0);
    plan_.points.push_back(std::move(point));
    ++plan_.import.taken;
  }

  /// MAV_FRAME: 0, 5 above the sea; 3, 6 above home; 10, 11 above the ground.
  bool take_height(const Item& item, MissionPoint& point) {
    const double z = item.or_zero(6);
    switch (item.frame) {
      case 0:
      case 5: point.depth_m = surface_ - z; break;
      case 3:
      case 6: point.depth_m = -z; break;
      case 10:
      case 11: point.altitude_m = z; return true;
      default: return false;
    }
    if (point.depth_m < 0) {
      leave_out(fmt::format("altitude {} m above the water", -point.depth_m), "at the surface instead");
      point.depth_m = 0;
    }
    point.depth_m += 0.0;  // no negative zero
    return true;
  }

  void take_end(const Item& item, MissionEnd end) {
    if (item.command != kReturn && item.has_place()) take_point(item, 0, "");
    plan_.at_end = end;
    ended_ = true;
    ++plan_.import.taken;
  }

  void take_delay(const Item& item) {
    if (plan_.points.empty() || !(item.params[0] > 0))
      return leave_out(command_text(kDelay), "there is no point to wait at");
    plan_.points.back().hold_s += item.params[0];
    ++plan_.import.taken;
  }

  void take_change(const Item& item) {
    const double speed = item.params[1];
    if (!(speed >= 0.01 && speed <= kMaxSpeed)) {
      return leave_out(command_text(kChangeSpeed), "not a speed of a vehicle in the water");
    }
    speed_ = speed;
    ++plan_.import.taken;
  }

  Polygon polygon_of(const Json& corners, const std::string& key) const {
    Polygon polygon;
    for (std::size_t i = 0; i < corners.size(); ++i) {
      const GeoPoint corner{element(corners[i], 0), element(corners[i], 1)};
      polygon.push_back(metres_of(*plane_, corner, place(fmt::format("{}[{}]", key, i))));
    }
    if (polygon.size() > 3 && polygon.front() == polygon.back()) polygon.pop_back();
    return polygon;
  }

  /// A polygon inside the circle, or around it.
  Polygon circle_of(const Json& circle, bool inside, const std::string& key) const {
    const Json& centre = list(circle, "center");
    const Vector2d middle = metres_of(*plane_, {element(centre, 0), element(centre, 1)}, place(key + ".center"));
    double radius = number(circle, "radius");
    if (!(radius > 0 && radius <= kMaxMetres))
      throw Error("not a valid radius", place(key + ".radius"), "more than 0 m");
    if (!inside) radius /= std::cos(std::numbers::pi / kFenceSides);
    Polygon polygon;
    for (int i = 0; i < kFenceSides; ++i) {
      const double angle = 2 * std::numbers::pi * i / kFenceSides;
      polygon.emplace_back(middle + radius * Vector2d(std::cos(angle), std::sin(angle)));
    }
    return polygon;
  }

  void take_fence(Polygon polygon, bool keeps_in, const std::string& key) {
    if (keeps_in && plan_.fence.empty()) {
      plan_.fence = std::move(polygon);
      plan_.fence_place = place(key);
    } else if (keeps_in) {
      return leave_out("fence that keeps in", "there is one already");
    } else {
      Polygon hull = convex_hull(polygon);
      if (hull.size() < polygon.size()) leave_out("hollow of a fence that keeps out", "it counts as kept out");
      if (plan_.injected.empty()) plan_.injected.push_back({place(key), 0, {}});
      plan_.injected.front().outlines.push_back(std::move(hull));
    }
    ++plan_.import.taken;
  }

  static bool keeps_in(const Json& fence) {
    const Json* inclusion = member(fence, "inclusion");
    return !inclusion || !inclusion->is_boolean() || inclusion->get<bool>();
  }

  void take_fences(const Json& fences) {
    const Json& polygons = list(fences, "polygons");
    for (std::size_t i = 0; i < polygons.size(); ++i) {
      const std::string key = fmt::format("geoFence.polygons[{}]", i);
      take_fence(polygon_of(list(polygons[i], "polygon"), key), keeps_in(polygons[i]), key);
    }
    const Json& circles = list(fences, "circles");
    for (std::size_t i = 0; i < circles.size(); ++i) {
      const std::string key = fmt::format("geoFence.circles[{}]", i);
      const bool inside = keeps_in(circles[i]);
      const Json* circle = member(circles[i], "circle");
      take_fence(circle_of(circle ? *circle : Json(), inside, key), inside, key);
    }
    if (!list(fences, "polygon").empty()) {  // of the first version of the format
      take_fence(polygon_of(list(fences, "polygon"), "geoFence.polygon"), true, "geoFence.polygon");
    }
  }

  MissionPlan plan_;
  std::optional<LocalPlane> plane_;
  double surface_ = 0;  ///< above the sea, m
  double speed_ = 0;    ///< 0: the mission's
  bool ended_ = false;
  bool in_complex_ = false;
};

}  // namespace

bool looks_like_json(std::string_view text) {
  const std::size_t first = text.find_first_not_of(" \t\r\n\xef\xbb\xbf");
  return first != std::string_view::npos && text[first] == '{';
}

MissionPlan import_qground_plan(std::string_view text, const std::string& file) {
  Json root;
  try {
    root = Json::parse(text);
  } catch (const Json::parse_error& error) {
    throw Error("broken JSON", {file, error.byte > 0 ? error.byte - 1 : 0, {}, {}, {}});
  } catch (const Json::exception&) {
    throw Error("a number out of range in the JSON", {file});
  }
  if (word(root, "fileType") != "Plan") {
    throw Error("JSON that is not a QGroundControl plan", {file, {}, {}, {}, "fileType"}, "\"Plan\"");
  }
  return PlanReader(file).read(root);
}

}  // namespace isobath
