#include <algorithm>
#include <array>
#include <cmath>
#include <fmt/format.h>
#include <isobath/base/angle.hpp>
#include <isobath/base/lower_case.hpp>
#include <isobath/io/bytes/delimited_text.hpp>
#include <isobath/io/input/pose_track.hpp>
#include <isobath/io/input/position_table.hpp>
#include <limits>
#include <span>

namespace isobath {
namespace {

constexpr double kKnot = 1852.0 / 3600;
constexpr double kUnknownKnots = 102.2;  // AIS: 102.3 is "not available"
constexpr double kLatestSecond = 9e9;

class PositionReader {
 public:
  explicit PositionReader(const std::filesystem::path& file) : table_(open_delimited_text(file.string())) {
    time_ = find({"time", "time_s", "timestamp"});
    latitude_ = find({"latitude", "latitude_degrees", "latitude_deg", "lat"});
    longitude_ = find({"longitude", "longitude_degrees", "longitude_deg", "lon"});
    north_ = find({"north", "north_m"});
    east_ = find({"east", "east_m"});
    body_ = find({"mmsi", "id", "body"});
    course_ = find({"cog_degrees", "course_deg"});
    knots_ = find({"sog_knots", "speed_knots"});
    speed_ = find({"speed_mps"});
    geographic_ = latitude_ >= 0 && longitude_ >= 0;
    if (time_ < 0 || (!geographic_ && (north_ < 0 || east_ < 0))) {
      table_.refuse_names("no columns of time and position", "time, and latitude and longitude or north and east");
    }
  }

  PositionTable read() {
    while (table_.next()) add_row();
    if (table_.overlong()) ++out_.left_out["line over 64 KiB, and all after it"];
    std::ranges::stable_sort(out_.rows, {}, &PositionTable::Row::time);
    return std::move(out_);
  }

 private:
  int find(std::initializer_list<std::string_view> names) const {
    const auto& columns = table_.names();
    for (std::size_t i = 0; i < columns.size(); ++i) {
      if (std::ranges::find(names, to_lower_case(columns[i])) != names.end()) return static_cast<int>(i);
    }
    return -1;
  }

  void add_row() {
    const auto time = time_of_row();
    const auto point = time ? point_of_row() : std::nullopt;
    if (!point || point->norm() > PositionTable::kFarthest) {
      ++out_.left_out[!time ? "row without a time" : !point ? "row without a possible position" : "row too far away"];
      return;
    }
    if (out_.rows.size() >= PositionTable::kMostRows) {
      throw Error(fmt::format("more than {} positions", PositionTable::kMostRows), {}, "a shorter table");
    }
    out_.out_of_order += *time < latest_;
    latest_ = std::max(latest_, *time);
    out_.rows.push_back({*time, *point, body_of_row(), velocity_of_row()});
  }

  [[nodiscard]] std::optional<Time> time_of_row() const {
    if (const auto t = table_.number(time_)) {
      return std::abs(*t) < kLatestSecond ? std::optional(Time{seconds(*t)}) : std::nullopt;
    }
    return time_from_iso(table_.cell(time_));
  }

  std::optional<Eigen::Vector2d> point_of_row() {
    const auto a = table_.number(geographic_ ? latitude_ : north_);
    const auto b = table_.number(geographic_ ? longitude_ : east_);
    if (!a || !b) return std::nullopt;
    if (!geographic_) return Eigen::Vector2d(*a, *b);
    const GeoPoint point{*a, *b};
    if (!valid(point)) return std::nullopt;
    if (!plane_) {
      plane_.emplace(point);
      out_.origin = point;
    }
    if (distance_m(point, plane_->origin()) > 2 * PositionTable::kFarthest) {  // the plane does not reach farther
      return Eigen::Vector2d::Constant(2 * PositionTable::kFarthest);
    }
    return plane_->to_plane(point);
  }

  std::optional<std::size_t> body_of_row() {
    if (body_ < 0 || table_.cell(body_).empty()) return std::nullopt;
    const auto [found, is_new] = index_.try_emplace(std::string(table_.cell(body_)), index_.size());
    if (is_new) out_.names.push_back(found->first);
    return found->second;
  }

  /// A number of the row; NaN where the column or the number is missing.
  [[nodiscard]] double number(int column) const {
    constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
    return column >= 0 ? table_.number(column).value_or(kNone) : kNone;
  }

  [[nodiscard]] std::optional<Eigen::Vector2d> velocity_of_row() const {
    const double course = number(course_), knots = number(knots_);
    const double speed = knots < kUnknownKnots ? knots * kKnot : number(speed_);
    if (!(course >= 0 && course < 360) || !(speed >= 0)) return std::nullopt;
    const Angle a = Angle::degrees(course);
    return speed * Eigen::Vector2d(cos(a), sin(a));
  }

  DelimitedText table_;
  int time_, latitude_, longitude_, north_, east_, body_, course_, knots_, speed_;
  bool geographic_ = false;
  std::optional<LocalPlane> plane_;
  std::map<std::string, std::size_t> index_;
  Time latest_ = Time::min();
  PositionTable out_;
};

}  // namespace

PositionTable read_positions(const std::filesystem::path& file) {
  PositionTable table = PositionReader(file).read();
  if (table.rows.empty()) throw Error("no row with a time and a position", {file.string()});
  return table;
}

}  // namespace isobath
