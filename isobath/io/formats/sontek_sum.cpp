#include <algorithm>
#include <array>
#include <fmt/format.h>
#include <isobath/io/bytes/log_source.hpp>
#include <isobath/io/bytes/text_lines.hpp>
#include <isobath/io/formats/sontek_sum.hpp>
#include <isobath/io/input/survey_input.hpp>

namespace isobath {
namespace {

constexpr int kSlantBeams = 4;
constexpr Angle kLean = Angle::degrees(25);
constexpr std::array<Angle, kSlantBeams> kAzimuths{Angle::degrees(315), Angle::degrees(225), Angle::degrees(135),
                                                   Angle::degrees(45)};
constexpr Angle kBeamWidth = Angle::degrees(3);
constexpr std::size_t kMaxFields = 64;
constexpr const char* kNoTime = "sample without a readable time";
constexpr const char* kNoPosition = "sample without a valid position";

/// The columns that are read, by their names in the heading.
enum Column : std::uint8_t { kTime, kLatitude, kLongitude, kHeading, kPitch, kRoll, kVertical, kSlant1, kColumns = 11 };
constexpr std::array<std::string_view, kColumns> kNames{
    "Date/Time",    "Latitude (deg)",     "Longitude (deg)",    "Heading (deg)",      "Pitch (deg)",       "Roll (deg)",
    "VB Depth (m)", "BT Beam1 Depth (m)", "BT Beam2 Depth (m)", "BT Beam3 Depth (m)", "BT Beam4 Depth (m)"};

/// Reads an integer up to the separator `until`, and removes both; 0: up to the end of the text.
bool take(std::string_view& rest, char until, int& value) {
  const std::size_t end = until == 0 ? rest.size() : rest.find(until);
  if (end == std::string_view::npos || !parse_number(rest.substr(0, end), value)) return false;
  rest.remove_prefix(std::min(end + 1, rest.size()));
  return value >= 0;
}

/// The time in a text such as "1/17/2025 4:03:47 PM"; without AM or PM, on a 24-hour clock.
std::optional<Time> time_from_us(std::string_view text) {
  using namespace std::chrono;
  text = trimmed(text);
  const bool am = text.ends_with("AM"), pm = text.ends_with("PM");
  if (am || pm) text = trimmed(text.substr(0, text.size() - 2));
  int month = 0, day = 0, year = 0, hour = 0, minute = 0, second = 0;
  if (!take(text, '/', month) || !take(text, '/', day) || !take(text, ' ', year) || !take(text, ':', hour) ||
      !take(text, ':', minute) || !take(text, 0, second)) {
    return std::nullopt;
  }
  const bool possible = year >= 1990 && year <= 2200 && month <= 12 && day <= 31 && minute < 60 && second <= 60 &&
                        (am || pm ? hour >= 1 && hour <= 12 : hour < 24);
  if (!possible) return std::nullopt;
  const year_month_day date(std::chrono::year(year), std::chrono::month(static_cast<unsigned>(month)),
                            std::chrono::day(static_cast<unsigned>(day)));
  if (!date.ok()) return std::nullopt;
  if (am || pm) hour = hour % 12 + (pm ? 12 : 0);
  return Time{sys_days(date).time_since_epoch() + hours(hour) + minutes(minute) + std::chrono::seconds(second)};
}

/// The angle in a text such as 52<degree sign> 20' 32.37": one to three numbers, separated by anything but digits.
std::optional<double> degrees_from_dms(std::string_view text) {
  text = trimmed(text);
  const bool negative = text.starts_with('-') || text.ends_with('S') || text.ends_with('W');
  const auto of_number = [](char c) { return (c >= '0' && c <= '9') || c == '.'; };
  double part[3] = {0, 0, 0};
  int parts = 0;
  while (!text.empty()) {
    const auto* const begin = std::ranges::find_if(text, of_number);
    if (begin == text.end()) break;
    const auto* const end = std::find_if_not(begin, text.end(), of_number);
    if (parts == 3 || !parse_number(std::string_view(begin, end), part[parts++])) return std::nullopt;
    text = std::string_view(end, text.end());
  }
  if (parts == 0 || part[1] > 60 || part[2] > 60) return std::nullopt;  // 60.00 is rounded from 59.996
  const double degrees = part[0] + part[1] / 60 + part[2] / 3600;
  return negative ? -degrees : degrees;
}

class SontekSum final : public LogSource {
 public:
  SontekSum(ByteWindow input, const InputConfig& config)
      : LogSource(std::move(input), "SonTek .sum"), survey_(config.survey), fixes_(survey_, report_) {
    width_ = config.beam_width.radians() > 0 ? config.beam_width : kBeamWidth;
    find_columns();
    events_.reserve(2 + kSlantBeams);
    report_.details["sonar"] = fmt::format("vertical beam and {} beams that lean {:g} degrees, each {:g} degrees wide",
                                           kSlantBeams, kLean.degrees(), width_.degrees());
    report_.details["time"] = survey_.utc_offset_h == 0
                                  ? "local, taken as UTC; set input.utc_offset_h"
                                  : fmt::format("local, UTC {:+g} h as configured", survey_.utc_offset_h);
  }

 private:
  using Fields = std::array<std::string_view, kColumns>;

  std::optional<Event> read() override {
    while (at_ == events_.size()) {
      const auto line = next_line(input_, report_, LineEnd::kAny);
      if (!line) return std::nullopt;
      if (!trimmed(line->text).empty()) parse(*line);
    }
    return events_[at_++];
  }
  void find_columns();
  void parse(const TextLine& line);
  void add_reading(const Navigation& fix, double depth, const Pose& X_BS);

  SurveyInput survey_;
  BoatFixes fixes_;
  Angle width_;
  std::array<std::size_t, kColumns> column_{};
  std::vector<Event> events_;  ///< the events of one sample
  std::size_t at_ = 0;
};

void SontekSum::find_columns() {
  const auto heading = next_line(input_, report_, LineEnd::kAny);
  std::vector<std::string_view> names;
  std::string_view name;
  for (TextRow row(heading ? heading->text : std::string_view(), ','); row.next(name);) names.push_back(trimmed(name));
  const Place place{input_.name(), {}, 1, {}, {}};
  for (std::size_t i = 0; i < kColumns; ++i) {
    const auto found = std::ranges::find(names, kNames[i]);
    if (found != names.end()) {
      column_[i] = static_cast<std::size_t>(found - names.begin());
      if (column_[i] < kMaxFields) continue;
    }
    const bool feet = std::ranges::find(names, "VB Depth (ft)") != names.end();
    throw Error(feet ? "depths in feet" : fmt::format("heading without the column \"{}\"", kNames[i]), place, {},
                "export it from RiverSurveyor Live in metric units");
  }
}

void SontekSum::parse(const TextLine& line) {
  events_.clear();
  at_ = 0;
  std::array<std::string_view, kMaxFields> all;
  std::size_t count = 0;
  for (TextRow row(line.text, ','); count < kMaxFields && row.next(all[count]);) ++count;
  Fields field;
  for (std::size_t i = 0; i < kColumns; ++i) {
    if (column_[i] >= count) return line.add_damage(report_, "line with fewer fields than the heading");
    field[i] = all[column_[i]];
  }
  std::array<double, kColumns> number{};
  for (std::size_t i = kHeading; i < kColumns; ++i) {
    if (!parse_number(field[i], number[i])) return line.add_damage(report_, "line with a field that is not a number");
  }
  auto time = time_from_us(field[kTime]);
  if (!time) return reject(kNoTime);
  *time -= seconds(survey_.utc_offset_h * 3600);
  const auto latitude = degrees_from_dms(field[kLatitude]), longitude = degrees_from_dms(field[kLongitude]);
  if (!latitude || !longitude) return reject(kNoPosition);
  if (std::abs(number[kHeading]) > 360 || std::abs(number[kPitch]) > 60 || std::abs(number[kRoll]) > 60) {
    return reject("sample with an impossible attitude");
  }
  const Rotation R_WB =
      Rotation::from_heading_pitch_roll(Angle::degrees(number[kHeading]) + survey_.declination,
                                        Angle::degrees(number[kPitch]), Angle::degrees(number[kRoll]));
  const auto fix = fixes_.fix(*time, {*latitude, *longitude}, R_WB);
  if (!fix) return reject(kNoPosition);
  events_.emplace_back(*fix);
  const Pose down = looking_down(survey_.transducer_depth_m);
  if (number[kVertical] == 0) reject("no lock of the vertical beam");
  add_reading(*fix, number[kVertical], down);
  for (int beam = 0; beam < kSlantBeams; ++beam) {
    const double depth = number[static_cast<std::size_t>(kSlant1) + static_cast<std::size_t>(beam)];
    if (depth == 0) reject("no lock of a slant beam");
    const Rotation R_BS =
        Rotation::from_heading_pitch_roll(kAzimuths[static_cast<std::size_t>(beam)], kLean - Angle::degrees(90), {});
    add_reading(*fix, depth, {R_BS, down.translation});
  }
}

/// Adds a reading with the range at which the beam's axis reaches the recorded depth.
void SontekSum::add_reading(const Navigation& fix, double depth, const Pose& X_BS) {
  if (depth == 0) return;
  const Pose X_WS = fix.X_WB * X_BS;
  const double down = (X_WS.rotation * Eigen::Vector3d::UnitX()).z();
  const double range = (depth - X_WS.translation.z()) / down;
  if (down < 0.1 || !(range > 0) || range >= kAnyDepth) return reject("impossible depth");
  RangeReading reading;
  reading.time = fix.time;
  reading.range_m = range;
  reading.max_range_m = kAnyDepth;
  reading.width = width_;
  reading.X_BS = X_BS;
  events_.emplace_back(reading);
}

}  // namespace

bool looks_like_sontek_sum(Bytes head) {
  std::string_view line = text_of(head);
  line = line.substr(0, line.find_first_of("\r\n"));
  return line.starts_with("Sample #,Date/Time,") && line.find("VB Depth") != std::string_view::npos;
}

std::unique_ptr<Source> open_sontek_sum(ByteWindow input, const InputConfig& config) {
  return std::make_unique<SontekSum>(std::move(input), config);
}

}  // namespace isobath
