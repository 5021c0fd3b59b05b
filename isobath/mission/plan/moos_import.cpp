#include <algorithm>
#include <charconv>
#include <cmath>
#include <fmt/format.h>
#include <isobath/mission/plan/mission_import.hpp>

namespace isobath {
namespace {

constexpr std::size_t kMaxPoints = 10'000;  // of a file, with all repeats
constexpr const char* kNoSuchSetting = "a mission has no such setting";

std::string_view trimmed(std::string_view text) {
  const std::size_t first = text.find_first_not_of(" \t\r");
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(" \t\r") - first + 1);
}

std::string lower(std::string_view text) {
  std::string out;
  for (const char c : text) out += c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
  return out;
}

/// Replaces bytes that are not printable: files may hold any bytes.
std::string printable(std::string_view text) {
  std::string out(text.substr(0, 80));
  for (char& c : out) {
    if (c < ' ' || c > '~') c = '?';
  }
  return out;
}

std::optional<double> number(std::string_view text) {
  text = trimmed(text);
  if (text.starts_with('+')) text.remove_prefix(1);
  double value = 0;
  const auto [end, failed] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (failed != std::errc() || end != text.data() + text.size() || !std::isfinite(value)) return std::nullopt;
  return value;
}

/// The text up to the separator; removes both from `rest`.
std::string_view split(std::string_view& rest, char separator) {
  const std::size_t at = std::min(rest.find(separator), rest.size());
  const std::string_view part = trimmed(rest.substr(0, at));
  rest = rest.substr(std::min(at + 1, rest.size()));
  return part;
}

/// A line without its comment; a line without '=' is a value without a key.
struct Entry {
  std::uint64_t line = 0;
  std::string key;  ///< lower case
  std::string_view value;
};

class Lines {
 public:
  explicit Lines(std::string_view text) : rest_(text) {}

  bool next(Entry& entry) {
    while (!rest_.empty()) {
      std::string_view line = split(rest_, '\n');
      ++number_;
      if (const std::size_t comment = line.find("//"); comment != std::string_view::npos) {
        line = trimmed(line.substr(0, comment));
      }
      if (line.empty()) continue;
      const std::size_t equals = line.find('=');
      entry.line = number_;
      entry.key = equals == std::string_view::npos ? "" : lower(trimmed(line.substr(0, equals)));
      entry.value = trimmed(equals == std::string_view::npos ? line : line.substr(equals + 1));
      return true;
    }
    return false;
  }

 private:
  std::string_view rest_;
  std::uint64_t number_ = 0;
};

/// The settings of one BHV_Waypoint, or of the lines outside all behaviours.
struct PointList {
  std::string name;
  std::vector<Eigen::Vector2d> points;  ///< north, east
  std::vector<std::uint64_t> lines;
  double speed = 0;
  int repeat = 0;
  bool reverse = false;
};

class MoosReader {
 public:
  MoosReader(std::string file, std::optional<GeoOrigin> origin) : file_(std::move(file)) {
    plan_.place.file = file_;
    plan_.import.format = "MOOS behaviour file";
    plan_.origin = origin;
  }

  MissionPlan read(std::string_view text) {
    Lines lines(text);
    for (Entry entry; lines.next(entry);) {
      if (entry.key.empty()) {
        take_mark(entry);
      } else {
        take(entry);
      }
    }
    close();
    finish();
    return std::move(plan_);
  }

 private:
  void leave_out(const std::string& what, const std::string& why) { plan_.import.leave_out(what, why); }
  [[nodiscard]] Place place(const Entry& entry) const { return {file_, {}, entry.line, {}, printable(entry.key)}; }

  void take_mark(const Entry& entry) {
    if (entry.value.starts_with('}')) {
      close();
    } else if (!entry.value.starts_with('{')) {
      leave_out("line \"" + printable(entry.value) + "\"", "neither a behaviour nor a setting");
    }
  }

  void open(std::string_view behaviour) {
    close();
    while (!behaviour.empty() && (behaviour.back() == '{' || behaviour.back() == ' ')) behaviour.remove_suffix(1);
    behaviour_ = lower(behaviour);
    const bool known = waypoints() || region() || behaviour_ == "bhv_constantdepth";
    if (!known) leave_out("behaviour " + printable(behaviour), "a mission has no such behaviour");
  }
  [[nodiscard]] bool waypoints() const { return behaviour_.empty() || behaviour_ == "bhv_waypoint"; }
  [[nodiscard]] bool region() const { return behaviour_.starts_with("bhv_opregion"); }

  void close() {
    behaviour_.clear();
    if (list_.reverse) {
      std::reverse(list_.points.begin(), list_.points.end());
      std::reverse(list_.lines.begin(), list_.lines.end());
    }
    for (int turn = 0; turn <= list_.repeat; ++turn) {
      for (std::size_t i = 0; i < list_.points.size(); ++i) add_point(list_, i);
    }
    if (plan_.title.empty() && !list_.points.empty()) plan_.title = list_.name;
    list_ = {};
  }

  void add_point(const PointList& list, std::size_t i) {
    MissionPoint point;
    point.place = {file_, {}, list.lines[i], {}, "points"};
    if (plan_.points.size() >= kMaxPoints) {
      throw Error("too many points", point.place, fmt::format("up to {} with all repeats", kMaxPoints));
    }
    point.name = fmt::format("point {}", plan_.points.size() + 1);
    point.north_east = list.points[i];
    point.speed = list.speed;
    plan_.points.push_back(std::move(point));
    ++plan_.import.taken;
  }

  void take(const Entry& entry) {
    if (entry.key == "behavior") return open(entry.value);
    if (entry.key.starts_with("set ") || entry.key.starts_with("initialize ")) {
      if (entry.value.ends_with('{')) behaviour_ = "set";  // its conditions follow
      return leave_out(entry.key.substr(0, entry.key.find(' ')), kNoSuchSetting);
    }
    if (entry.key == "processconfig") {
      close();
      behaviour_ = "processconfig";
      return leave_out("ProcessConfig " + printable(entry.value), "a mission has no such section");
    }
    if (entry.value.find("$(") != std::string_view::npos || entry.value.find("%(") != std::string_view::npos) {
      return leave_out(printable(entry.key), "a macro that nsplug fills in");
    }
    if (waypoints()) return take_waypoint_key(entry);
    if (region()) return take_region_key(entry);
    if (behaviour_ == "bhv_constantdepth" && entry.key == "depth") {
      depth_m_ = value(entry);
      ++plan_.import.taken;
    } else if (behaviour_ == "bhv_constantdepth") {
      leave_out(printable(entry.key), kNoSuchSetting);
    }  // settings of other behaviours are left out with them
  }

  void take_waypoint_key(const Entry& entry) {
    const bool inside = !behaviour_.empty();
    if (entry.key == "points" || entry.key == "point" || (inside && entry.key == "polygon")) {
      take_points(entry, inside);
    } else if (entry.key == "polygon") {
      take_fence(entry);
    } else if (entry.key == "speed") {
      list_.speed = value(entry);
      if (!said_speed_ && list_.speed > 0) plan_.speed = list_.speed;
      said_speed_ = true;
      ++plan_.import.taken;
    } else if (entry.key == "order") {
      list_.reverse = lower(entry.value) == "reverse" || lower(entry.value) == "reversed";
      if (!list_.reverse && lower(entry.value) != "normal")
        leave_out("order " + printable(entry.value), kNoSuchSetting);
    } else if (entry.key == "repeat") {
      const auto times = number(entry.value);
      const bool fits = times && *times >= 0 && *times <= static_cast<double>(kMaxPoints);
      if (fits) list_.repeat = static_cast<int>(*times);
      if (!fits) leave_out("repeat " + printable(entry.value), "a mission must end");
    } else if (entry.key == "name" || entry.key == "label") {
      list_.name = printable(entry.value);
    } else if (entry.key == "latorigin" || entry.key == "longorigin") {
      (entry.key == "latorigin" ? latitude_deg_ : longitude_deg_) = value(entry);
    } else {
      leave_out(printable(entry.key), kNoSuchSetting);
    }
  }

  /// In a behaviour the last list replaces the others, as in pHelmIvP; outside behaviours, lists follow one another.
  void take_points(const Entry& entry, bool replaces) {
    std::vector<Eigen::Vector2d> points;
    if (!vertices(entry, points)) return;
    if (replaces && !list_.points.empty()) {
      leave_out("list of points", "a later list of the same behaviour replaces it");
      list_.points.clear();
      list_.lines.clear();
    }
    list_.lines.insert(list_.lines.end(), points.size(), entry.line);
    list_.points.insert(list_.points.end(), points.begin(), points.end());
  }

  void take_region_key(const Entry& entry) {
    if (entry.key == "polygon" || entry.key == "core_poly") {
      take_fence(entry);
    } else if (entry.key == "max_depth") {
      plan_.limits.max_depth_m = value(entry);
      ++plan_.import.taken;
    } else if (entry.key == "min_altitude") {
      plan_.limits.min_altitude_m = value(entry);
      ++plan_.import.taken;
    } else if (entry.key == "max_time") {
      plan_.limits.max_duration_s = value(entry);
      ++plan_.import.taken;
    } else {
      leave_out(printable(entry.key), kNoSuchSetting);
    }
  }

  void take_fence(const Entry& entry) {
    if (!plan_.fence.empty()) return leave_out("polygon of a region", "there is a fence already");
    if (!vertices(entry, plan_.fence)) return;
    plan_.fence_place = place(entry);
    ++plan_.import.taken;
  }

  [[nodiscard]] double value(const Entry& entry) const {
    if (const auto found = number(entry.value)) return *found;
    throw Error("\"" + printable(entry.value) + "\" is not a number", place(entry), "a finite number");
  }

  /// x is east, y is north. False where a pattern generates the points.
  bool vertices(const Entry& entry, std::vector<Eigen::Vector2d>& out) {
    std::string_view text = entry.value;
    if (text.find("format") != std::string_view::npos) {
      leave_out("pattern of points", "give its points as a list");
      return false;
    }
    if (const std::size_t open = text.find("pts={"); open != std::string_view::npos) {
      const std::size_t close_at = text.find('}', open);
      if (close_at == std::string_view::npos) throw Error("pts={ without its }", place(entry));
      text = text.substr(open + 5, close_at - open - 5);
    }
    while (!text.empty() && (text.front() == '"' || text.front() == '{')) text.remove_prefix(1);
    while (!text.empty() && (text.back() == '"' || text.back() == '}')) text.remove_suffix(1);
    while (!trimmed(text).empty()) out.push_back(vertex(entry, split(text, ':')));
    return true;
  }

  Eigen::Vector2d vertex(const Entry& entry, std::string_view text) {
    const std::string said = printable(text);
    const auto x = number(split(text, ',')), y = number(split(text, ','));
    if (!x || !y) throw Error("\"" + said + "\" is not a vertex", place(entry), "x,y");
    if (!text.empty()) leave_out("rest of a vertex", "x and y only");
    return {*y, *x};
  }

  void finish() {
    if (latitude_deg_ && longitude_deg_) plan_.origin = GeoOrigin{*latitude_deg_, *longitude_deg_};
    if (plan_.title.empty()) plan_.title = "MOOS way-points";
    if (!depth_m_) return;
    for (MissionPoint& point : plan_.points) point.depth_m = *depth_m_;
  }

  std::string file_;
  MissionPlan plan_;
  std::string behaviour_;  ///< in lower case; empty: outside of all
  PointList list_;
  bool said_speed_ = false;
  std::optional<double> depth_m_, latitude_deg_, longitude_deg_;
};

}  // namespace

Eigen::Vector2d metres_of(const LocalPlane& plane, const GeoPoint& point, const Place& place) {
  if (!valid(point)) throw Error("not a place on the globe", place, "-90 .. 90 deg and -180 .. 180 deg");
  if (distance_m(plane.origin(), point) > kMaxMetres) {
    throw Error(fmt::format("{}, {} is far from the origin", point.latitude_deg, point.longitude_deg), place,
                fmt::format("within {} m of it", kMaxMetres));
  }
  return plane.to_plane(point);
}

bool looks_like_moos(std::string_view text) {
  Lines lines(text);
  bool found = false;
  for (Entry entry; lines.next(entry);) {
    if (entry.key.starts_with('[') || (entry.key.empty() && entry.value.starts_with('['))) return false;
    const bool quoted = !entry.value.empty() && (entry.value.front() == '"' || entry.value.front() == '[');
    found = found || entry.key == "behavior" || ((entry.key == "points" || entry.key == "point") && !quoted);
  }
  return found;
}

MissionPlan import_moos(std::string_view text, const std::string& file, std::optional<GeoOrigin> origin) {
  return MoosReader(file, origin).read(text);
}

std::optional<GeoOrigin> moos_origin(std::string_view text) {
  std::optional<double> latitude, longitude;
  Lines lines(text);
  for (Entry entry; lines.next(entry);) {
    if (entry.key == "latorigin") latitude = number(entry.value);
    if (entry.key == "longorigin") longitude = number(entry.value);
  }
  if (!latitude || !longitude) return std::nullopt;
  const GeoOrigin origin{*latitude, *longitude};
  return valid(origin) ? std::optional(origin) : std::nullopt;
}

}  // namespace isobath
