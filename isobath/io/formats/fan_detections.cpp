#include <algorithm>
#include <cmath>
#include <complex>
#include <fmt/format.h>
#include <fstream>
#include <isobath/base/error.hpp>
#include <isobath/base/file_access.hpp>
#include <isobath/io/bytes/byte_window.hpp>
#include <isobath/io/bytes/delimited_text.hpp>
#include <isobath/io/formats/depth_csv.hpp>
#include <isobath/io/formats/fan_detections.hpp>
#include <isobath/io/input/pose_track.hpp>
#include <isobath/io/input/scanning_head.hpp>
#include <isobath/io/input/survey_input.hpp>
#include <set>
#include <utility>
#include <vector>

namespace isobath {
namespace {

namespace fs = std::filesystem;
using Plane = std::complex<double>;  // north + i east

constexpr std::size_t kHeadOfTable = 4096;
constexpr double kFarthestTrack = 1e6;      // m from the origin: limit of the local plane
constexpr double kFarthestDetection = 1e4;  // m
constexpr double kMaxTheta = 1000;          // rad: some compasses count turns
constexpr Angle kFanHeight = Angle::degrees(20);

// Tables and their kinds ---------------------------------------------------------------------------------------------

enum class TableKind : std::uint8_t { kNone, kDetections, kSatellite, kDeadReckoning };

TableKind kind_of_table(Bytes head) {
  const std::vector<std::string> columns = table_columns(head);
  const std::set<std::string, std::less<>> names(columns.begin(), columns.end());
  const auto all = [&](std::initializer_list<const char*> wanted) {
    return std::ranges::all_of(wanted, [&](const char* name) { return names.contains(name); });
  };
  if (all({"time_s", "range_m", "bearing_deg"})) return TableKind::kDetections;
  if (names.size() == 4 && all({"time", "x", "y", "theta"})) return TableKind::kSatellite;
  if (names.size() == 3 && all({"time", "x", "y"})) return TableKind::kDeadReckoning;
  return TableKind::kNone;
}

TableKind kind_of_file(const fs::path& file) {
  try {
    ByteWindow window = ByteWindow::open(file);
    const Bytes head = window.want(kHeadOfTable);
    return kind_of_table(head.first(std::min(head.size(), kHeadOfTable)));
  } catch (const Error&) {
    return TableKind::kNone;
  }
}

/// The tables of a folder; an empty path: there is none of the kind.
struct FanFolder {
  fs::path detections, satellite, dead_reckoning;
  std::string left_out;  ///< names of the other files
};

FanFolder tables_of(const fs::path& folder) {
  FanFolder tables;
  const auto put = [&](fs::path& place, const fs::path& file, const char* what) {
    if (!place.empty()) {
      throw Error(
          fmt::format("holds two tables of {}: {} and {}", what, place.filename().string(), file.filename().string()),
          {folder.string()}, {}, "give each recording a folder of its own");
    }
    place = file;
  };
  for (const fs::path& file : regular_files(folder)) {
    switch (kind_of_file(file)) {
      case TableKind::kDetections: put(tables.detections, file, "detections"); break;
      case TableKind::kSatellite: put(tables.satellite, file, "satellite fixes"); break;
      case TableKind::kDeadReckoning: put(tables.dead_reckoning, file, "dead reckoning"); break;
      case TableKind::kNone: tables.left_out += (tables.left_out.empty() ? "" : ", ") + file.filename().string(); break;
    }
  }
  return tables;
}

std::unique_ptr<std::istream> stream_of(const fs::path& file) {
  auto input = std::make_unique<std::ifstream>(file, std::ios::binary);
  if (!*input) throw Error("cannot be read", {file.string()});
  return input;
}

// Detections ---------------------------------------------------------------------------------------------------------

class FanDetections final : public Source {
 public:
  FanDetections(DelimitedText table, std::uint64_t bytes, const InputConfig& config)
      : table_(std::move(table)),
        mount_(config.mount_heading),
        width_(config.beam_width),
        height_(config.beam_height.radians() > 0 ? config.beam_height : kFanHeight),
        time_(table_.required("time_s")),
        range_(table_.required("range_m")),
        bearing_(table_.required("bearing_deg")) {
    report_.format = "fan detections (CSV)";
    report_.bytes_total = bytes;
    report_.details["sonar"] =
        fmt::format("imaging fan, {:g} degrees high{}: range and bearing of its detections, without intensity",
                    height_.degrees(), config.beam_height.radians() > 0 ? "" : " (assumed)");
  }

  std::optional<Event> next() override {
    Swath swath;
    swath.beam_width = width_;
    swath.beam_height = height_;
    while (first_ || advance()) {
      if (!swath.soundings.empty() && (first_->time != swath.time || swath.soundings.size() == Swath::kMaxSoundings))
        return swath;
      swath.time = first_->time;
      add(swath, *std::exchange(first_, std::nullopt));
    }
    if (!swath.soundings.empty()) return swath;
    return std::nullopt;
  }
  [[nodiscard]] const SourceReport& report() const override { return report_; }
  SourceReport& report() { return report_; }

 private:
  struct Row {
    Time time;
    double range_m;
    Angle bearing;
  };

  /// Reads the next usable row into first_; false at the end.
  bool advance() {
    while (table_.next()) {
      report_.bytes_read = table_.bytes_read();
      const auto time = table_.number(time_), range = table_.number(range_), bearing = table_.number(bearing_);
      if (time && range && bearing && representable_seconds(*time) && *range > 0 && *range <= kFarthestDetection &&
          std::abs(*bearing) <= 180) {
        first_ = {Time{seconds(*time)}, *range, Angle::degrees(*bearing)};
        return true;
      }
      ++report_.rejected[kBadDetection];
    }
    if (table_.overlong() && report_.bytes_total > table_.bytes_read()) {
      const auto at = table_.bytes_read();
      report_.add_damage(at, report_.bytes_total - at, "line over 64 KiB in a table of detections");
    }
    report_.bytes_read = report_.bytes_total;
    return false;
  }

  void add(Swath& swath, const Row& row) const {
    const Angle azimuth = mount_ + row.bearing;
    Sounding& s = swath.soundings.emplace_back();
    s.point = Eigen::Vector3d(row.range_m * cos(azimuth), row.range_m * sin(azimuth), 0).cast<float>();
    s.range_m = static_cast<float>(row.range_m);
    s.beam = static_cast<std::uint16_t>(swath.soundings.size() - 1);
    s.kind = Sounding::Kind::kWater;
  }

  DelimitedText table_;
  SourceReport report_;
  Angle mount_, width_, height_;
  int time_, range_, bearing_;
  std::optional<Row> first_;  ///< of the next swath
};

// Tracks -------------------------------------------------------------------------------------------------------------

/// The rows of a table with a time and a place.
class TrackRows {
 public:
  TrackRows(std::unique_ptr<std::istream> input, const std::string& name, bool with_theta, SourceReport& report)
      : report_(report),
        table_(std::move(input), name),
        time_(table_.required("time")),
        x_(table_.required("x")),
        y_(table_.required("y")),
        theta_(with_theta ? table_.required("theta") : -1) {}

  struct Row {
    Time time;
    double north, east;
    std::optional<double> theta;
  };
  /// The next row in order of time; empty at the end.
  std::optional<Row> next() {
    while (table_.next()) {
      const auto time = table_.number(time_), x = table_.number(x_), y = table_.number(y_);
      const auto theta = table_.number(theta_);
      const bool possible = time && representable_seconds(*time) && x && y && std::hypot(*x, *y) <= kFarthestTrack &&
                            (theta_ < 0 || (theta && std::abs(*theta) <= kMaxTheta));
      if (!possible) {
        ++report_.rejected[kBadPose];
        continue;
      }
      const Time at{seconds(*time)};
      if (last_ && at < *last_) {
        ++report_.rejected[kPoseBackwards];
        continue;
      }
      last_ = at;
      return Row{at, *y, *x, theta};
    }
    return std::nullopt;
  }

 private:
  SourceReport& report_;
  DelimitedText table_;
  int time_, x_, y_, theta_;
  std::optional<Time> last_;
};

Navigation flat_fix(Time time, double north, double east, Angle heading) {
  Navigation fix;
  fix.time = time;
  fix.X_WB = {Rotation::from_heading_pitch_roll(heading, {}, {}), {north, east, 0}};
  return fix;
}

class SatelliteTrack final : public Source {
 public:
  SatelliteTrack(std::unique_ptr<std::istream> input, const std::string& name, const InputConfig& config)
      : rows_(std::move(input), name, true, report_), survey_(config.survey) {
    report_.format = "satellite track (CSV)";
  }

  std::optional<Event> next() override {
    const auto row = rows_.next();
    if (!row) return std::nullopt;
    Navigation fix = flat_fix(row->time, row->north, row->east, Angle::radians(row->theta.value_or(0)).wrapped());
    const double position = survey_.position_sigma_m, heading = survey_.heading_sigma.radians();
    auto& covariance = fix.covariance.emplace().setZero();
    covariance.diagonal().head<2>().setConstant(position * position);
    covariance.diagonal().segment<2>(3).setConstant(kTiltSigma.radians() * kTiltSigma.radians());
    covariance(5, 5) = heading * heading;
    return fix;
  }
  [[nodiscard]] const SourceReport& report() const override { return report_; }

 private:
  SourceReport report_;
  TrackRows rows_;
  SurveyInput survey_;
};

class DeadReckoning final : public Source {
 public:
  DeadReckoning(std::unique_ptr<std::istream> input, const std::string& name, std::unique_ptr<Source> track) {
    report_.format = "dead reckoning (CSV)";
    PoseTimeline compass;
    while (const auto event = track->next()) compass.add(std::get<Navigation>(*event));
    report_.rejected = track->report().rejected;
    TrackRows rows(std::move(input), name, false, report_);
    std::optional<Pose> start;
    Plane ahead = 0;  // sum of all steps, each against the heading
    double steps_m = 0;
    while (const auto row = rows.next()) {
      const auto pose = compass.at(row->time);
      if (!pose) {
        ++report_.rejected[kNoHeading];
        continue;
      }
      if (!start) start = pose;
      const Plane place(row->north, row->east);
      if (!fixes_.empty()) {
        const Plane step = place - place_of(fixes_.back());
        ahead += step * std::polar(1.0, -pose->rotation.heading().radians());
        steps_m += std::abs(step);
      }
      fixes_.push_back(flat_fix(row->time, row->north, row->east, pose->rotation.heading()));
    }
    if (!fixes_.empty()) place_onto(*start, steps_m > 0 ? std::arg(ahead) : 0.0);
  }

  std::optional<Event> next() override {
    if (at_ == fixes_.size()) return std::nullopt;
    return fixes_[at_++];
  }
  [[nodiscard]] const SourceReport& report() const override { return report_; }

 private:
  static Plane place_of(const Navigation& fix) { return {fix.X_WB.translation.x(), fix.X_WB.translation.y()}; }

  /// Turns the frame so that the vehicle moves ahead on average, and shifts it to the start.
  void place_onto(const Pose& start, double course_rad) {
    const Plane turn = std::polar(1.0, -course_rad), from = place_of(fixes_.front());
    const Plane to(start.translation.x(), start.translation.y());
    for (Navigation& fix : fixes_) {
      const Plane place = to + turn * (place_of(fix) - from);
      fix.X_WB.translation.head<2>() = Eigen::Vector2d(place.real(), place.imag());
    }
    report_.details["frame of the dead reckoning"] = fmt::format(
        "turned by {:.1f} degrees, so that the vehicle moves ahead by the compass; shifted to the first fix",
        Angle::radians(-course_rad).wrapped().degrees());
  }

  SourceReport report_;
  std::vector<Navigation> fixes_;
  std::size_t at_ = 0;
};

std::unique_ptr<FanDetections> detections_of(const fs::path& file, const InputConfig& config) {
  std::error_code unknown;
  const auto bytes = fs::file_size(file, unknown);
  return std::make_unique<FanDetections>(open_delimited_text(file.string()), unknown ? 0 : bytes, config);
}

std::string table_name(const fs::path& file) { return file.filename().string(); }

}  // namespace

// Opening ------------------------------------------------------------------------------------------------------------

bool looks_like_fan_detections(Bytes head) { return kind_of_table(head) == TableKind::kDetections; }

bool looks_like_fan_folder(const fs::path& folder) {
  return std::ranges::any_of(regular_files(folder),
                             [](const fs::path& file) { return kind_of_file(file) == TableKind::kDetections; });
}

std::unique_ptr<Source> open_fan_detections(const fs::path& file, const InputConfig& config) {
  return detections_of(file, config);
}

std::unique_ptr<Source> open_fan_detections(std::unique_ptr<std::istream> input, const std::string& name,
                                            const InputConfig& config) {
  return std::make_unique<FanDetections>(DelimitedText(std::move(input), name), 0, config);
}

std::unique_ptr<Source> open_satellite_track(std::unique_ptr<std::istream> input, const std::string& name,
                                             const InputConfig& config) {
  return std::make_unique<SatelliteTrack>(std::move(input), name, config);
}

std::unique_ptr<Source> open_dead_reckoning(std::unique_ptr<std::istream> input, const std::string& name,
                                            std::unique_ptr<Source> compass) {
  return std::make_unique<DeadReckoning>(std::move(input), name, std::move(compass));
}

std::unique_ptr<Source> open_fan_folder(const fs::path& folder, const InputConfig& config) {
  const FanFolder tables = tables_of(folder);
  auto log = detections_of(tables.detections, config);
  auto& details = log->report().details;
  log->report().format = "folder of fan detections";
  details["detections"] = table_name(tables.detections);
  if (!tables.left_out.empty()) details["left out"] = tables.left_out;
  if (!config.navigation.empty()) return log;  // its poses replace those of the log
  if (tables.satellite.empty()) {
    throw Error("holds detections but no track with time, x, y and theta, the heading of the compass",
                {folder.string()}, {}, "give the poses of the vehicle with input.navigation");
  }
  auto track = open_satellite_track(stream_of(tables.satellite), tables.satellite.string(), config);
  details["track"] = "satellite receiver and compass, " + table_name(tables.satellite);
  if (config.track == LogTrack::kDeadReckoning) {
    if (tables.dead_reckoning.empty()) {
      throw Error("holds no dead reckoning: no table with only time, x and y", {folder.string()}, {},
                  "set input.track to gnss");
    }
    track = open_dead_reckoning(stream_of(tables.dead_reckoning), tables.dead_reckoning.string(), std::move(track));
    details["track"] = "dead reckoning, " + table_name(tables.dead_reckoning) + ", with the compass of " +
                       table_name(tables.satellite);
    for (const auto& [key, value] : track->report().details) details[key] = value;
  }
  return merge_by_time(std::move(log), std::move(track));
}

std::unique_ptr<Source> open_reference_of_fan_folder(const fs::path& folder, const InputConfig& config) {
  const FanFolder tables = tables_of(folder);
  if (tables.satellite.empty()) return nullptr;
  return open_satellite_track(stream_of(tables.satellite), tables.satellite.string(), config);
}

}  // namespace isobath
