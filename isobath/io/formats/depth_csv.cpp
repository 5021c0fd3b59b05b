#include <algorithm>
#include <array>
#include <fmt/format.h>
#include <fstream>
#include <isobath/io/bytes/delimited_text.hpp>
#include <isobath/io/bytes/log_source.hpp>
#include <isobath/io/bytes/text_lines.hpp>
#include <isobath/io/formats/depth_csv.hpp>
#include <isobath/io/input/pose_track.hpp>
#include <isobath/io/input/survey_input.hpp>

namespace isobath {
namespace {

namespace fs = std::filesystem;

constexpr Angle kBeamWidth = Angle::degrees(7);
constexpr double kStep = 1;  // m, shortest step that gives a course

enum Column : std::uint8_t { kTime, kLatitude, kLongitude, kNorthing, kEasting, kDepth, kHeading, kColumns };
constexpr std::array<std::string_view, kColumns> kKeys{"time",    "latitude", "longitude", "northing",
                                                       "easting", "depth",    "heading"};

Place setting(const char* key) { return {{}, {}, {}, {}, std::string("input.") + key}; }

/// Name of the column for each key; empty: not declared.
std::array<std::string, kColumns> declared(const std::string& text) {
  std::array<std::string, kColumns> names;
  std::string_view part;
  for (TextRow row(text, ','); row.next(part);) {
    const std::size_t equals = part.find('=');
    const auto key = std::ranges::find(kKeys, trimmed(part.substr(0, equals)));
    if (equals == std::string_view::npos || key == kKeys.end()) {
      throw Error("\"" + std::string(trimmed(part)) + "\" declares no column", setting("csv_columns"),
                  fmt::format("{}, each with = and a name", fmt::join(kKeys, ", ")));
    }
    names[static_cast<std::size_t>(key - kKeys.begin())] = trimmed(part.substr(equals + 1));
  }
  return names;
}

class DepthCsv final : public Source {
 public:
  DepthCsv(DelimitedText table, std::uint64_t bytes, const InputConfig& config)
      : table_(std::move(table)),
        survey_(config.survey),
        fixes_(survey_, report_),
        utm_(utm_zone_of(survey_.csv_position)),
        width_(config.beam_width.radians() > 0 ? config.beam_width : kBeamWidth) {
    scale_ = metres_of(survey_.csv_depth_unit) * (survey_.csv_depth_sign == DepthSign::kUp ? -1 : 1);
    report_.format = "depth CSV";
    report_.bytes_total = bytes;
    choose_columns();
    report_.details["columns"] = survey_.csv_columns;
    if (column_[kTime] < 0) report_.details["time"] = "none in the log: one second from row to row";
  }

  std::optional<Event> next() override {
    if (waiting_) return *std::exchange(waiting_, std::nullopt);
    while (table_.next()) {
      report_.bytes_read = table_.bytes_read();
      if (auto fix = row()) return *std::move(fix);
    }
    if (table_.overlong() && report_.bytes_total > table_.bytes_read()) {
      const auto at = table_.bytes_read();
      report_.add_damage(at, report_.bytes_total - at, "line over 64 KiB in a table");
    }
    report_.bytes_read = report_.bytes_total;
    return std::nullopt;
  }
  [[nodiscard]] const SourceReport& report() const override { return report_; }

 private:
  void choose_columns() {
    const auto names = declared(survey_.csv_columns);
    for (std::size_t i = 0; i < kColumns; ++i) {
      if (names[i].empty()) continue;
      column_[i] = table_.column(names[i]);
      if (column_[i] < 0) {
        table_.refuse_names("no column \"" + names[i] + "\", which input.csv_columns names",
                            fmt::format("{}", fmt::join(table_.names(), ", ")));
      }
    }
    const bool positions =
        utm_ ? column_[kNorthing] >= 0 && column_[kEasting] >= 0 : column_[kLatitude] >= 0 && column_[kLongitude] >= 0;
    if (positions && column_[kDepth] >= 0) return;
    const char* needed = utm_ ? "northing, easting and depth" : "latitude, longitude and depth";
    table_.refuse_names(fmt::format("input.csv_columns must declare the columns of {}", needed),
                        fmt::format("{}", fmt::join(table_.names(), ", ")));
  }

  std::optional<Event> row() {
    const auto time = time_of_row();
    const auto point = point_of_row();
    const auto fix = time && point ? fixes_.fix(*time, *point, {}) : std::nullopt;
    if (!fix) {
      ++report_.rejected[time ? "row with a missing or impossible position" : "row with a missing or impossible time"];
      return std::nullopt;
    }
    Navigation turned = *fix;
    turned.X_WB.rotation = Rotation::from_heading(heading(turned.X_WB.translation.head<2>()));
    waiting_ = sounding(*time);
    if (column_[kTime] < 0) clock_ += std::chrono::seconds(1);
    return turned;
  }

  std::optional<Event> sounding(Time time) {
    const auto depth = table_.number(column_[kDepth]);
    const double range = depth ? *depth * scale_ - survey_.transducer_depth_m : 0;
    if (!(range > 0) || range >= kAnyDepth) {
      ++report_.rejected["no bottom"];
      return std::nullopt;
    }
    RangeReading reading;
    reading.time = time;
    reading.range_m = range;
    reading.max_range_m = kAnyDepth;
    reading.width = width_;
    reading.X_BS = looking_down(survey_.transducer_depth_m);
    return reading;
  }

  [[nodiscard]] std::optional<Time> time_of_row() const {
    if (column_[kTime] < 0) return clock_;
    const Duration offset = seconds(survey_.utc_offset_h * 3600);
    if (survey_.csv_time == CsvTime::kIso) {
      const auto time = time_from_iso(table_.cell(column_[kTime]));
      return time ? std::optional(*time - offset) : std::nullopt;
    }
    const auto t = table_.number(column_[kTime]);
    return t && std::abs(*t) < 9e9 ? std::optional(Time{seconds(*t)} - offset) : std::nullopt;
  }

  [[nodiscard]] std::optional<GeoPoint> point_of_row() const {
    const auto a = table_.number(column_[utm_ ? kNorthing : kLatitude]);
    const auto b = table_.number(column_[utm_ ? kEasting : kLongitude]);
    if (!a || !b) return std::nullopt;
    return utm_ ? from_utm(utm_->zone, utm_->northern, *b, *a) : GeoPoint{*a, *b};
  }

  Angle heading(const Eigen::Vector2d& position) {
    const auto stated = column_[kHeading] >= 0 ? table_.number(column_[kHeading]) : std::nullopt;
    if (!course_from_) course_from_ = position;
    const Eigen::Vector2d step = position - *course_from_;
    if (step.norm() >= kStep) {
      course_ = Angle::radians(std::atan2(step.y(), step.x()));
      course_from_ = position;
    }
    return stated && std::abs(*stated) <= 360 ? Angle::degrees(*stated) + survey_.declination : course_;
  }

  DelimitedText table_;
  SurveyInput survey_;
  SourceReport report_;
  BoatFixes fixes_;
  std::optional<UtmZone> utm_;
  Angle width_;
  double scale_ = 1;  ///< factor from the written depth to metres below the water
  std::array<int, kColumns> column_{-1, -1, -1, -1, -1, -1, -1};
  Time clock_{};
  Angle course_;
  std::optional<Eigen::Vector2d> course_from_;
  std::optional<Event> waiting_;
};

std::string_view without_quotes(std::string_view name) {
  name = trimmed(name);
  if (name.size() >= 2 && name.front() == '"' && name.back() == '"') name = name.substr(1, name.size() - 2);
  return trimmed(name);
}

/// The line of names, found by the same rule as in DelimitedText.
std::string_view line_of_names(Bytes head) {
  std::string_view text = text_of(head);
  if (text.starts_with("\xEF\xBB\xBF")) text.remove_prefix(3);
  while (!text.empty()) {
    const std::size_t end = text.find('\n');
    const std::string_view line = trimmed(text.substr(0, end));
    if (!line.empty() && line.front() != '#') return line;
    text.remove_prefix(end == std::string_view::npos ? text.size() : end + 1);
  }
  return {};
}

}  // namespace

std::optional<UtmZone> utm_zone_of(std::string_view text) {
  if (text == "degrees") return std::nullopt;
  UtmZone utm;
  const bool named = text.starts_with("utm ") && (text.ends_with('N') || text.ends_with('S'));
  if (!named || !parse_number(text.substr(4, text.size() - 5), utm.zone) || utm.zone < 1 || utm.zone > 60) {
    throw Error("unknown kind of positions \"" + std::string(text) + "\"", setting("csv_position"),
                "degrees, or a zone such as utm 33N");
  }
  utm.northern = text.ends_with('N');
  return utm;
}

double metres_of(DepthUnit unit) {
  if (unit == DepthUnit::kFoot) return 0.3048;
  return unit == DepthUnit::kFathom ? 1.8288 : 1;
}

bool looks_like_depth_csv(Bytes head, const SurveyInput& config) {
  if (config.csv_columns.empty() || !looks_like_text(head)) return false;
  const auto names = declared(config.csv_columns);
  std::string_view name;
  for (TextRow row(line_of_names(head), ','); row.next(name);) {
    if (!without_quotes(name).empty() && std::ranges::find(names, without_quotes(name)) != names.end()) return true;
  }
  return false;
}

std::vector<std::string> table_columns(Bytes head) {
  if (!looks_like_text(head)) return {};
  std::vector<std::string> names;
  std::string_view name;
  for (TextRow row(line_of_names(head), ','); row.next(name);) {
    name = without_quotes(name);
    double number = 0;
    if (name.empty() || name.size() > 60 || parse_number(name, number)) return {};
    names.emplace_back(name);
  }
  return names.size() >= 2 ? names : std::vector<std::string>();
}

std::unique_ptr<Source> open_depth_csv(const fs::path& file, const InputConfig& config) {
  std::error_code unknown;
  const auto bytes = fs::file_size(file, unknown);
  return std::make_unique<DepthCsv>(open_delimited_text(file.string()), unknown ? 0 : bytes, config);
}

std::unique_ptr<Source> open_depth_csv(std::unique_ptr<std::istream> input, const std::string& name,
                                       const InputConfig& config) {
  return std::make_unique<DepthCsv>(DelimitedText(std::move(input), name), 0, config);
}

}  // namespace isobath
