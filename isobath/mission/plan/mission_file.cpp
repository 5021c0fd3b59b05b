#include <algorithm>
#include <filesystem>
#include <fmt/format.h>
#include <isobath/mission/plan/mission_file.hpp>
#include <isobath/mission/plan/mission_import.hpp>

namespace isobath {
namespace {

using Eigen::Vector2d;

constexpr Range kMetres{-kMaxMetres, kMaxMetres};
constexpr Range kLatitude{-90, 90};
constexpr Range kLongitude{-180, 180};

Field end_field(std::string name, MissionEnd* end, std::string sentence) {
  using E = MissionEnd;
  return Field::choice(
      std::move(name), end,
      {{to_text(E::kHold), E::kHold}, {to_text(E::kSurface), E::kSurface}, {to_text(E::kReturn), E::kReturn}},
      std::move(sentence));
}

std::vector<Field> mission_fields(MissionKeys& k) {
  return {Field::text("title", &k.plan.title, "Title of the mission."),
          Field::real("speed", &k.plan.speed, {0.01, kMaxSpeed}, "m/s", "Speed on the way to points that give none."),
          end_field("at_end", &k.plan.at_end,
                    "What the vehicle does after the last point; return: goes back to where the mission started."),
          end_field("if_dropped", &k.plan.if_dropped, "What the vehicle does when the last point had to be dropped."),
          Field::flag(
              "waits_for_operator", &k.plan.waits_for_operator,
              "Whether the mission starts at the operator's command; else as soon as the vehicle has looked around."),
          Field::real("latitude_deg", &k.latitude_deg, kLatitude, "deg",
                      "Latitude of the origin of north and east; 0 with longitude 0: no origin."),
          Field::real("longitude_deg", &k.longitude_deg, kLongitude, "deg", "Longitude of the origin.")};
}

std::vector<Field> limit_fields(MissionLimits& l) {
  return {
      Field::real("min_depth_m", &l.min_depth_m, {0, 12000}, "m", "Minimum depth."),
      Field::real("max_depth_m", &l.max_depth_m, {0, 12000}, "m", "Maximum depth."),
      Field::real("min_altitude_m", &l.min_altitude_m, {0, 1000}, "m", "Minimum altitude above the bottom."),
      Field::real("max_position_sigma_m", &l.max_position_sigma_m, {0, 1e5}, "m",
                  "Maximum standard deviation of the estimated position; beyond it the mission is aborted."),
      Field::real("max_duration_s", &l.max_duration_s, {0, 1e8}, "s", "Maximum duration of the mission; 0: no limit."),
      Field::real("low_battery_share", &l.low_battery_share, {0, 1}, "1",
                  "Share of a full charge below which the mission is aborted.")};
}

std::vector<Field> fence_fields(MissionKeys& k) {
  return {
      Field::rows("corners", &k.corners, 2, kMetres, "m", "Corners of a simple polygon: north, east; none: no fence."),
      Field::rows("corners_deg", &k.corners_deg, 2, {-180, 180}, "deg",
                  "Corners as latitude, longitude, instead of `corners`.")};
}

std::vector<Field> search_fields(SearchArea& a) {
  return {Field::numbers("corner", a.corner.data(), 2, kMetres, "m", "Corner of the area: north, east."),
          Field::degrees("heading_deg", &a.heading, {-360, 360}, "Heading of the lanes."),
          Field::real("length_m", &a.length_m, {0, 1e4}, "m", "Length of the area along the heading; 0: no area."),
          Field::real("breadth_m", &a.breadth_m, {1, 1e4}, "m", "Breadth of the area, to starboard of the corner."),
          Field::real("spacing_m", &a.spacing_m, {1, 1e3}, "m", "Greatest distance between two lanes."),
          Field::real("station_m", &a.station_m, {1, 1e4}, "m", "Greatest distance between two stations of a lane."),
          Field::real(
              "together_s", &a.together_s, {0, 86400}, "s",
              "How long the vehicles of a group wait for one another before their first lanes, to begin together; 0: "
              "each begins as soon as it is there."),
          Field::real("run_out_m", &a.run_out_m, {0, 1000}, "m",
                      "Length of a lane beyond the area at both ends, where the vehicle turns."),
          Field::real("depth_m", &a.depth_m, {0, 12000}, "m", "Depth of the lanes."),
          Field::real("drop_distance_m", &a.drop_distance_m, {0, 1000}, "m",
                      "An obstacle that is nearer to a station blocks it; 0: navigator.drop_distance_m.")};
}

std::vector<Field> point_fields(PointKeys& k) {
  MissionPoint& p = k.point;
  return {
      Field::text("name", &p.name, "Name of the point in reports."),
      Field::real("north", &p.north_east.x(), kMetres, "m", "North of the origin."),
      Field::real("east", &p.north_east.y(), kMetres, "m", "East of the origin."),
      Field::real(
          "latitude_deg", &k.latitude_deg, kLatitude, "deg",
          "Latitude, instead of north and east, where the mission has an origin; 0 with longitude 0: not given."),
      Field::real("longitude_deg", &k.longitude_deg, kLongitude, "deg", "Longitude, with latitude_deg."),
      Field::real("depth_m", &p.depth_m, {0, 12000}, "m", "Depth below the surface, where no altitude is given."),
      Field::real("altitude_m", &k.altitude_m, {0, 12000}, "m", "Altitude above the bottom; 0: depth_m is used."),
      Field::real("speed", &p.speed, {0, kMaxSpeed}, "m/s", "Speed on the way to the point; 0: that of the mission."),
      Field::real("hold_s", &p.hold_s, {0, 1e7}, "s", "How long the vehicle stays at the point."),
      Field::real("radius_m", &p.radius_m, {0, 1000}, "m",
                  "Distance within which the point counts as reached; 0: pilot.point_radius."),
      Field::real("drop_distance_m", &p.drop_distance_m, {0, 1000}, "m",
                  "An obstacle that is nearer blocks the point; 0: navigator.drop_distance_m."),
      Field::real("move_m", &p.move_m, {0, 1e4}, "m",
                  "How far the point may be moved off an obstacle that stands on it; 0: the point is dropped."),
      Field::real("deviation_m", &p.deviation_m, {0, 1e5}, "m",
                  "Most distance of the way to the point from the straight line; 0: any."),
      Field::text(
          "task", &p.task,
          "Task at the point: one of the mission itself, or of a back-seat driver, such as \"survey length_m=80\"; "
          "empty: none.")};
}

std::vector<Field> outline_fields(OutlineKeys& k) {
  return {Field::real("at_s", &k.at_s, {0, 1e7}, "s", "Time after the start of the mission."),
          Field::rows("outline", &k.outline, 2, kMetres, "m", "Corners of a convex obstacle: north, east.")};
}

std::vector<Field> passage_fields(PassageKeys& k) {
  return {Field::text("name", &k.passage.name, "Name of the passage in reports."),
          Field::rows("outline", &k.outline, 2, kMetres, "m", "Corners of a convex polygon: north, east.")};
}

Place place_of(const Schema& read, const std::string& section) {
  for (const Section& s : read.sections) {
    if (s.name == section) return s.place;
  }
  return {};
}

Polygon polygon_of(const std::vector<double>& rows) {
  Polygon polygon;
  for (std::size_t i = 0; i + 1 < rows.size(); i += 2) polygon.emplace_back(rows[i], rows[i + 1]);
  return polygon;
}

std::vector<double> rows_of(const Polygon& polygon) {
  std::vector<double> rows;
  for (const Vector2d& p : polygon) rows.insert(rows.end(), {p.x(), p.y()});
  return rows;
}

[[noreturn]] void refuse(Place place, const std::string& key, const std::string& problem, const std::string& allowed) {
  place.key += (place.key.empty() ? "" : ".") + key;
  throw Error(problem, std::move(place), allowed);
}

std::optional<GeoOrigin> given(double latitude_deg, double longitude_deg) {
  if (latitude_deg == 0 && longitude_deg == 0) return std::nullopt;
  return GeoOrigin{latitude_deg, longitude_deg};
}

/// Converts degrees to metres of the mission.
class Degrees {
 public:
  explicit Degrees(const std::optional<GeoOrigin>& origin) {
    if (origin) plane_.emplace(*origin);
  }

  [[nodiscard]] Vector2d metres(const GeoPoint& point, const Place& place, const std::string& key) const {
    if (!plane_) refuse(place, key, "degrees in a mission without an origin", "mission.latitude_deg, longitude_deg");
    Place where = place;
    where.key += (where.key.empty() ? "" : ".") + key;
    return metres_of(*plane_, point, where);
  }

 private:
  std::optional<LocalPlane> plane_;
};

MissionPoint point_of(const PointKeys& keys, const Degrees& degrees) {
  MissionPoint point = keys.point;
  if (keys.altitude_m != 0) point.altitude_m = keys.altitude_m;
  if (const auto place = given(keys.latitude_deg, keys.longitude_deg)) {
    if (point.north_east != Vector2d::Zero()) {
      refuse(point.place, "latitude_deg", "the point is given in degrees and in metres", "one of the two");
    }
    point.north_east = degrees.metres(*place, point.place, "latitude_deg");
  }
  return point;
}

Polygon fence_of(const MissionKeys& keys, const Degrees& degrees, const Place& place) {
  if (keys.corners_deg.empty()) return polygon_of(keys.corners);
  if (!keys.corners.empty())
    refuse(place, "corners_deg", "the fence is given in degrees and in metres", "one of the two");
  Polygon fence;
  for (const Vector2d& p : polygon_of(keys.corners_deg)) {
    fence.push_back(degrees.metres({p.x(), p.y()}, place, "corners_deg"));
  }
  return fence;
}

void turn_positive(Polygon& outline) {
  if (area(outline) < 0) std::reverse(outline.begin(), outline.end());
}

void inject(const OutlineKeys& keys, std::vector<InjectedMap>& maps) {
  Polygon outline = polygon_of(keys.outline);
  check_outline(outline, keys.place);
  auto map = std::find_if(maps.begin(), maps.end(), [&](const InjectedMap& m) { return m.at_s == keys.at_s; });
  if (map == maps.end()) map = maps.insert(map, {keys.place, keys.at_s, {}});
  turn_positive(outline);
  map->outlines.push_back(std::move(outline));
}

/// The stations of the lanes become the points of the mission.
void add_lanes(MissionPlan& plan) {
  const SearchArea& area = plan.search;
  if (!plan.points.empty()) {
    refuse(area.place, "length_m", "there are mission points and a search area", "one of the two");
  }
  if (area.lanes() > kMaxLanes) {
    refuse(area.place, "spacing_m", fmt::format("{} lanes", area.lanes()), fmt::format("up to {} lanes", kMaxLanes));
  }
  if (area.lanes() * area.stations() > kMaxStations) {
    refuse(area.place, "station_m", fmt::format("{} stations", area.lanes() * area.stations()),
           fmt::format("up to {} stations", kMaxStations));
  }
  const std::size_t stations = area.stations();
  for (const Lane& lane : lanes_of(area)) {
    const std::size_t number = plan.points.size() / stations + 1;
    for (std::size_t i = 0; i < stations; ++i) {
      MissionPoint& point = plan.points.emplace_back();
      point.place = area.place;
      point.name = fmt::format("lane {}, station {}", number, i + 1);
      point.north_east = lane.at(area.share_of_station(i));
      point.depth_m = area.depth_m;
      point.drop_distance_m = area.drop_distance_m;
    }
  }
  plan.group = {GroupMember{}};
}

/// The section name under which an element of a list is written.
std::string in_brackets(const char* list) { return fmt::format("[{}]", list); }

}  // namespace

Schema schema(MissionKeys& k) {
  Schema all;
  all.sections = {{"mission", "What the vehicle is asked to do.", mission_fields(k)},
                  {"mission_limits", "Limits that hold during the whole mission.", limit_fields(k.plan.limits)},
                  {"geofence", "Area that the vehicle must not leave.", fence_fields(k)},
                  {"search_area", "A rectangle that is searched in lanes, instead of mission points.",
                   search_fields(k.plan.search)},
                  {"priorities", "What a way costs, beside time.", fields(k.plan.priorities)}};
  all.lists = {
      {"mission_point", "The points of the mission, in order.",
       [&k](const Place& place) {
         PointKeys& point = k.points.emplace_back();
         point.point.place = place;
         point.point.name = fmt::format("point {}", k.points.size());
         return point_fields(point);
       }},
      {"injected_map",
       "An obstacle that counts as seen from a given time on; obstacles with the same time make one map.",
       [&k](const Place& place) {
         OutlineKeys& outline = k.outlines.emplace_back();
         outline.place = place;
         return outline_fields(outline);
       }},
      {"risk_area", "A circle in which the vehicle may be detected or destroyed.",
       [&k](const Place& place) {
         RiskArea& risk = k.risks.emplace_back();
         risk.place = place;
         return fields(risk);
       }},
      {"task_step", "A step of a task of the mission; the steps of a task stand in their order.",
       [&k](const Place& place) {
         TaskStep& step = k.steps.emplace_back();
         step.place = place;
         step.name = fmt::format("step {}", k.steps.size());
         return fields(step);
       }},
      {"passage", "Narrow water that the vehicles of a group go through one at a time.", [&k](const Place& place) {
         PassageKeys& passage = k.passages.emplace_back();
         passage.passage.place = place;
         passage.passage.name = fmt::format("passage {}", k.passages.size());
         return passage_fields(passage);
       }}};
  return all;
}

MissionPlan make_plan(const MissionKeys& keys, const Schema& read, std::optional<GeoOrigin> origin) {
  MissionPlan plan = keys.plan;
  plan.place = place_of(read, "mission");
  plan.fence_place = place_of(read, "geofence");
  plan.origin = given(keys.latitude_deg, keys.longitude_deg);
  if (!plan.origin) plan.origin = origin;
  const Degrees degrees(plan.origin);
  plan.fence = fence_of(keys, degrees, plan.fence_place);
  for (const PointKeys& point : keys.points) plan.points.push_back(point_of(point, degrees));
  plan.search.place = place_of(read, "search_area");
  if (plan.search.on()) add_lanes(plan);
  for (const OutlineKeys& outline : keys.outlines) inject(outline, plan.injected);
  plan.risks = keys.risks;
  plan.steps = keys.steps;
  for (const PassageKeys& passage : keys.passages) {
    GroupPassage& read_passage = plan.passages.emplace_back(passage.passage);
    read_passage.outline = polygon_of(passage.outline);
    turn_positive(read_passage.outline);
  }
  return plan;
}

namespace {

MissionPlan parse_toml(std::string_view text, const std::string& file) {
  MissionKeys keys;
  Schema all = schema(keys);
  read_toml(text, file, all);
  MissionPlan plan = make_plan(keys, all);
  if (plan.place.file.empty()) plan.place.file = file;
  return plan;
}

/// The origin of a .moos file of the same name beside a behaviour file.
std::optional<GeoOrigin> origin_beside(const std::string& file) {
  std::filesystem::path beside = file;
  beside.replace_extension(".moos");
  if (beside == file || !std::filesystem::is_regular_file(beside)) return std::nullopt;
  return moos_origin(text_of_file(beside.string()));
}

}  // namespace

MissionPlan parse_mission(std::string_view text, const std::string& file) {
  MissionPlan plan = looks_like_json(text)   ? import_qground_plan(text, file)
                     : looks_like_moos(text) ? import_moos(text, file)
                                             : parse_toml(text, file);
  check_mission(plan);
  return plan;
}

MissionPlan load_mission(const std::string& file) {
  const std::string text = text_of_file(file);
  MissionPlan plan = parse_mission(text, file);
  if (!plan.origin && looks_like_moos(text)) plan.origin = origin_beside(file);
  return plan;
}

bool looks_like_mission(std::string_view text) {
  for (const std::string_view header : {"[mission]", "[[mission_point]]", "[search_area]"}) {
    for (std::size_t at = text.find(header); at != std::string_view::npos; at = text.find(header, at + 1)) {
      if (at == 0 || text[at - 1] == '\n') return true;
    }
  }
  return false;
}

std::string write_mission(const MissionPlan& plan) {
  MissionKeys keys;
  keys.plan = plan;
  if (plan.origin) {
    keys.latitude_deg = plan.origin->latitude_deg;
    keys.longitude_deg = plan.origin->longitude_deg;
  }
  keys.corners = rows_of(plan.fence);
  const Schema head = schema(keys);
  std::string text = write_toml(head.sections, false);
  for (const MissionPoint& point : plan.search.on() ? std::vector<MissionPoint>() : plan.points) {
    PointKeys point_keys{point, 0, 0, point.altitude_m.value_or(0)};
    text += "\n" + write_toml({{in_brackets("mission_point"), "", point_fields(point_keys)}}, false);
  }
  for (const InjectedMap& map : plan.injected) {
    for (const Polygon& outline : map.outlines) {
      OutlineKeys outline_keys{{}, map.at_s, rows_of(outline)};
      text += "\n" + write_toml({{in_brackets("injected_map"), "", outline_fields(outline_keys)}}, false);
    }
  }
  for (RiskArea risk : plan.risks) text += "\n" + write_toml({{in_brackets("risk_area"), "", fields(risk)}}, false);
  for (TaskStep step : plan.steps) text += "\n" + write_toml({{in_brackets("task_step"), "", fields(step)}}, false);
  for (const GroupPassage& passage : plan.passages) {
    PassageKeys passage_keys{passage, rows_of(passage.outline)};
    text += "\n" + write_toml({{in_brackets("passage"), "", passage_fields(passage_keys)}}, false);
  }
  return text;
}

}  // namespace isobath
