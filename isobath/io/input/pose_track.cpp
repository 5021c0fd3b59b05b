#include <charconv>
#include <cmath>
#include <fstream>
#include <isobath/base/error.hpp>
#include <isobath/io/bytes/delimited_text.hpp>
#include <isobath/io/input/pose_track.hpp>
#include <utility>

namespace isobath {
namespace {

namespace fs = std::filesystem;
using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double kFarthest = 1e6;  // m from the origin: limit of the local plane

/// Columns, up to four, that are only valid together.
struct Group {
  int column[4] = {-1, -1, -1, -1};
  int count = 0;
  explicit operator bool() const { return count > 0; }
};

std::optional<int> digits(std::string_view text, std::size_t at, std::size_t count) {
  if (at + count > text.size()) return std::nullopt;
  int value = 0;
  const auto [end, problem] = std::from_chars(text.data() + at, text.data() + at + count, value);
  if (problem != std::errc() || end != text.data() + at + count || value < 0 || text[at] == '-') return std::nullopt;
  return value;
}

class PoseTrack final : public Source {
 public:
  explicit PoseTrack(DelimitedText table, std::uint64_t bytes) : table_(std::move(table)) {
    report_.format = "pose track (CSV)";
    report_.bytes_total = bytes;
    choose_time();
    choose_position();
    choose_attitude();
    velocity_ = group({"vn", "ve", "vd"});
  }

  std::optional<Event> next() override {
    while (table_.next()) {
      report_.bytes_read = table_.bytes_read();
      if (auto fix = row()) {
        last_ = fix->time;
        return *std::move(fix);
      }
    }
    if (table_.overlong() && report_.bytes_total > table_.bytes_read()) {
      const auto at = table_.bytes_read();
      report_.add_damage(at, report_.bytes_total - at, "line over 64 KiB in a pose track");
    }
    report_.bytes_read = report_.bytes_total;
    return std::nullopt;
  }
  [[nodiscard]] const SourceReport& report() const override { return report_; }

 private:
  static constexpr const char* kTimes = "t_s, time_us or time";
  static constexpr const char* kPositions = "north_m, east_m, depth_m; x, y, z; or lat_deg, lon_deg";
  static constexpr const char* kAttitudes = "heading_deg (pitch_deg, roll_deg), or qw, qx, qy, qz";

  /// All of the columns, or none. Throws Error if only some of them exist.
  [[nodiscard]] Group group(std::initializer_list<const char*> names) const {
    Group g;
    for (const char* name : names) {
      if (table_.column(name) >= 0) ++g.count;
    }
    if (g.count == 0) return g;
    int i = 0;
    for (const char* name : names) g.column[i++] = table_.required(name);
    return g;
  }

  void choose_time() {
    t_s_ = table_.column("t_s");
    time_us_ = table_.column("time_us");
    iso_ = table_.column("time");
    const int count = (t_s_ >= 0) + (time_us_ >= 0) + (iso_ >= 0);
    if (count != 1) table_.refuse_names(count ? "more than one column of time" : "no column of time", kTimes);
  }

  void choose_position() {
    depth_ = table_.column("depth_m");
    geographic_ = group({"lat_deg", "lon_deg"});
    const bool named = table_.column("north_m") >= 0 || table_.column("east_m") >= 0;
    if (named) local_ = group({"north_m", "east_m", "depth_m"});
    const Group xyz = group({"x", "y", "z"});
    if (named && xyz) table_.refuse_names("two kinds of position", kPositions);
    if (xyz) local_ = xyz;
    if (!local_ && !geographic_) table_.refuse_names("no columns of position", kPositions);
  }

  void choose_attitude() {
    quaternion_ = group({"qw", "qx", "qy", "qz"});
    heading_ = table_.column("heading_deg");
    pitch_ = table_.column("pitch_deg");
    roll_ = table_.column("roll_deg");
    if (heading_ < 0 && !quaternion_) table_.refuse_names("no columns of attitude", kAttitudes);
    if (heading_ >= 0 && quaternion_) table_.refuse_names("two kinds of attitude", kAttitudes);
  }

  std::optional<Navigation> row() {
    Navigation fix;
    const auto time = time_of_row();
    const auto rotation = attitude();
    const auto position = time && rotation ? position_of_row() : std::nullopt;
    if (!time || !rotation || !position) return refuse(kBadPose);
    if (last_ && *time < *last_) return refuse(kPoseBackwards);
    fix.time = *time;
    fix.X_WB = {*rotation, *position};
    if (velocity_) {
      fix.v_WB = vector(velocity_);
      if (!fix.v_WB) ++report_.rejected["pose row whose velocity is missing or not finite"];
    }
    return fix;
  }

  std::nullopt_t refuse(const char* reason) {
    ++report_.rejected[reason];
    return std::nullopt;
  }

  [[nodiscard]] std::optional<Time> time_of_row() const {
    if (iso_ >= 0) return time_from_iso(table_.cell(iso_));
    if (time_us_ >= 0) {
      const auto us = table_.integer(time_us_);
      const bool possible = us && std::abs(*us) < std::int64_t{9'000'000'000'000'000};
      return possible ? std::optional(Time{std::chrono::microseconds(*us)}) : std::nullopt;
    }
    const auto t = table_.number(t_s_);
    return t && representable_seconds(*t) ? std::optional(Time{seconds(*t)}) : std::nullopt;
  }

  [[nodiscard]] std::optional<Rotation> attitude() const {
    if (quaternion_) {
      Eigen::Vector4d q;
      for (int i = 0; i < 4; ++i) {
        const auto value = table_.number(quaternion_.column[i]);
        if (!value) return std::nullopt;
        q[i] = *value;
      }
      if (std::abs(q.norm() - 1) > 0.01) return std::nullopt;
      return Rotation::from_quaternion({q[0], q[1], q[2], q[3]});
    }
    const auto heading = table_.number(heading_);
    const auto pitch = pitch_ >= 0 ? table_.number(pitch_) : 0;
    const auto roll = roll_ >= 0 ? table_.number(roll_) : 0;
    if (!heading || !pitch || !roll || std::abs(*heading) > 3600 || std::abs(*pitch) > 90 || std::abs(*roll) > 360) {
      return std::nullopt;
    }
    return Rotation::from_heading_pitch_roll(Angle::degrees(*heading), Angle::degrees(*pitch), Angle::degrees(*roll));
  }

  [[nodiscard]] std::optional<Vector3d> vector(const Group& columns) const {
    const auto a = table_.number(columns.column[0]), b = table_.number(columns.column[1]),
               c = table_.number(columns.column[2]);
    return a && b && c ? std::optional(Vector3d(*a, *b, *c)) : std::nullopt;
  }

  std::optional<Vector3d> position_of_row() {
    const auto point = geo_point();
    if (!local_) return point ? on_plane(*point) : std::nullopt;
    const auto p = vector(local_);
    if (!p || p->norm() > kFarthest) return std::nullopt;
    if (point && !report_.origin) report_.origin = origin_from(*point, p->head<2>());
    return p;
  }

  [[nodiscard]] std::optional<GeoPoint> geo_point() const {
    if (!geographic_) return std::nullopt;
    const auto latitude = table_.number(geographic_.column[0]), longitude = table_.number(geographic_.column[1]);
    if (!latitude || !longitude) return std::nullopt;
    const GeoPoint point{*latitude, *longitude};
    return valid(point) ? std::optional(point) : std::nullopt;
  }

  std::optional<Vector3d> on_plane(const GeoPoint& point) {
    const auto depth = depth_ >= 0 ? table_.number(depth_) : 0;
    if (!depth) return std::nullopt;
    if (!report_.origin) report_.origin = point;
    const Vector2d p = LocalPlane(*report_.origin).to_plane(point);
    if (p.norm() > kFarthest) return std::nullopt;
    return Vector3d(p.x(), p.y(), *depth);
  }

  DelimitedText table_;
  SourceReport report_;
  int t_s_ = -1, time_us_ = -1, iso_ = -1, depth_ = -1, heading_ = -1, pitch_ = -1, roll_ = -1;
  Group local_, geographic_, quaternion_, velocity_;
  std::optional<Time> last_;
};

class MergedSource final : public Source {
 public:
  MergedSource(std::unique_ptr<Source> log, std::unique_ptr<Source> track)
      : log_(std::move(log)), track_(std::move(track)) {
    advance_log();
    fix_ = track_->next();
    update_report();
  }

  std::optional<Event> next() override {
    const bool fix_first = fix_ && (!event_ || time_of(*fix_) <= time_of(*event_));
    std::optional<Event> result = std::exchange(fix_first ? fix_ : event_, std::nullopt);
    if (fix_first) {
      fix_ = track_->next();
    } else if (result) {
      advance_log();
    }
    update_report();
    return result;
  }
  [[nodiscard]] const SourceReport& report() const override { return report_; }

 private:
  void advance_log() {
    while ((event_ = log_->next()) && std::holds_alternative<Navigation>(*event_)) ++replaced_;
  }

  void update_report() {
    // Copying a report is slow, the more damage it lists; the first and the last are exact.
    if ((event_ || fix_) && since_report_++ % 64 != 0) return;
    const SourceReport& track = track_->report();
    report_ = log_->report();
    if (replaced_ > 0) report_.rejected["fix of the log, replaced by the pose track"] = replaced_;
    for (const auto& [reason, count] : track.rejected) report_.rejected[reason] += count;
    for (const Damage& damage : track.damages) ++report_.rejected[damage.reason];
    if (track.origin) report_.origin = track.origin;
  }

  std::unique_ptr<Source> log_, track_;
  std::optional<Event> event_, fix_;
  SourceReport report_;
  std::uint64_t replaced_ = 0;
  std::uint64_t since_report_ = 0;
};

}  // namespace

std::unique_ptr<Source> open_pose_track(const fs::path& file) {
  std::error_code unknown;
  const auto bytes = fs::file_size(file, unknown);
  return std::make_unique<PoseTrack>(open_delimited_text(file.string()), unknown ? 0 : bytes);
}

std::unique_ptr<Source> open_pose_track(std::unique_ptr<std::istream> input, const std::string& name) {
  return std::make_unique<PoseTrack>(DelimitedText(std::move(input), name), 0);
}

std::optional<Time> time_from_iso(std::string_view text) {
  using namespace std::chrono;
  if (!text.empty() && text.back() == 'Z') text.remove_suffix(1);
  if (text.size() < 19 || text[4] != '-' || text[7] != '-' || (text[10] != 'T' && text[10] != ' ') || text[13] != ':' ||
      text[16] != ':') {
    return std::nullopt;
  }
  const auto y = digits(text, 0, 4), mo = digits(text, 5, 2), d = digits(text, 8, 2);
  const auto h = digits(text, 11, 2), mi = digits(text, 14, 2), s = digits(text, 17, 2);
  if (!y || !mo || !d || !h || !mi || !s || *y < 1970 || *y > 2200 || *h > 23 || *mi > 59 || *s > 60)
    return std::nullopt;
  const year_month_day date(year(*y), month(static_cast<unsigned>(*mo)), day(static_cast<unsigned>(*d)));
  if (!date.ok()) return std::nullopt;
  std::int64_t nanoseconds = 0;
  if (text.size() > 19) {
    const std::size_t places = text.size() - 20;
    const auto fraction = text[19] == '.' && places >= 1 && places <= 9 ? digits(text, 20, places) : std::nullopt;
    if (!fraction) return std::nullopt;
    nanoseconds = *fraction;
    for (std::size_t i = places; i < 9; ++i) nanoseconds *= 10;
  }
  return Time{sys_days(date).time_since_epoch() + hours(*h) + minutes(*mi) + std::chrono::seconds(*s) +
              Duration(nanoseconds)};
}

std::unique_ptr<Source> merge_by_time(std::unique_ptr<Source> log, std::unique_ptr<Source> track) {
  return std::make_unique<MergedSource>(std::move(log), std::move(track));
}

}  // namespace isobath
