#include <algorithm>
#include <array>
#include <fmt/ranges.h>
#include <isobath/io/bytes/text_lines.hpp>
#include <isobath/io/formats/aris.hpp>
#include <isobath/io/formats/depth_csv.hpp>
#include <isobath/io/formats/fan_detections.hpp>
#include <isobath/io/formats/fish_finder.hpp>
#include <isobath/io/formats/kongsberg/kongsberg.hpp>
#include <isobath/io/formats/mavlink/dataflash_log.hpp>
#include <isobath/io/formats/mavlink/telemetry_log.hpp>
#include <isobath/io/formats/nmea.hpp>
#include <isobath/io/formats/oculus/oculus_logs.hpp>
#include <isobath/io/formats/ping/ping_logs.hpp>
#include <isobath/io/formats/point_files.hpp>
#include <isobath/io/formats/scan_csv.hpp>
#include <isobath/io/formats/sonar3d.hpp>
#include <isobath/io/formats/sontek_sum.hpp>
#include <isobath/io/formats/tritech/tritech_logs.hpp>
#include <isobath/io/formats/xtf.hpp>
#include <isobath/io/frames/frame_folder.hpp>
#include <isobath/io/input/pose_track.hpp>
#include <isobath/io/mcap/mcap.hpp>
#include <isobath/io/mcap/native_log.hpp>
#include <isobath/io/open_source.hpp>
#include <isobath/io/pooled_bins.hpp>
#include <isobath/io/ros/ros1_bag.hpp>
#include <isobath/io/ros/ros2_database.hpp>
#include <isobath/io/ros/ros_mcap.hpp>
#include <isobath/io/survey_folder.hpp>
#include <string_view>
#include <vector>

namespace isobath {
namespace {
namespace fs = std::filesystem;

constexpr std::size_t kHead = 1 << 18;  // bytes that probes may read, since a stream may begin with noise

std::string lower_case(std::string text) {
  std::ranges::transform(text, text.begin(), [](char x) { return x >= 'A' && x <= 'Z' ? char(x - 'A' + 'a') : x; });
  return text;
}

/// The input to recognise: a folder, or a file with its first bytes.
struct Candidate {
  const fs::path& path;
  bool is_folder;
  Bytes head;
  const InputConfig& config;
};

struct Format {
  const char* name;
  bool (*probe)(const Candidate&);
  std::unique_ptr<Source> (*open)(const fs::path&, const InputConfig&);
};

/// The entry of a format that is recognised by the first bytes of a file and read through a ByteWindow.
template <bool (*probe)(Bytes), std::unique_ptr<Source> (*open)(ByteWindow, const InputConfig&)>
constexpr Format file(const char* name) {
  return {name, [](const Candidate& c) { return !c.is_folder && probe(c.head); },
          [](const fs::path& path, const InputConfig& config) { return open(ByteWindow::open(path), config); }};
}

/// The entry of a format that opens its files itself.
template <bool (*probe)(std::span<const std::uint8_t>),
          std::unique_ptr<Source> (*open)(const fs::path&, const InputConfig&)>
constexpr Format own_file(const char* name) {
  return {name,
          [](const Candidate& c) {
            return !c.is_folder && probe({reinterpret_cast<const std::uint8_t*>(c.head.data()), c.head.size()});
          },
          open};
}

/// The entry of a format that is a folder.
template <bool (*probe)(const fs::path&), std::unique_ptr<Source> (*open)(const fs::path&, const InputConfig&)>
constexpr Format folder(const char* name) {
  return {name, [](const Candidate& c) { return c.is_folder && probe(c.path); }, open};
}

/// "log.KMWCD", "kmall" -> the existing one of "log.kmall" and "log.KMALL"; empty: none.
fs::path file_beside(const fs::path& file, std::string ending) {
  std::error_code ignored;
  for (int i = 0; i < 2; ++i) {
    fs::path beside = file;
    beside.replace_extension(ending);
    if (fs::is_regular_file(beside, ignored)) return beside;
    std::ranges::transform(ending, ending.begin(),
                           [](char x) { return x >= 'a' && x <= 'z' ? char(x - 'a' + 'A') : x; });
  }
  return {};
}

/// File endings of a log and of the file with its water columns, and the probe for both.
struct SurveyEndings {
  const char *log, *water;
  bool (*probe)(Bytes);
};
constexpr SurveyEndings kKmallEndings{"kmall", "kmwcd", looks_like_kmall};
constexpr SurveyEndings kAllEndings{"all", "wcd", looks_like_kongsberg_all};

struct SurveyPair {
  fs::path log, water;  ///< `water` is empty if there is none
};

bool holds_format(const fs::path& file, bool (*probe)(Bytes)) {
  try {
    ByteWindow window = ByteWindow::open(file);
    const Bytes head = window.want(kHead);
    return probe(head.first(std::min(head.size(), kHead)));
  } catch (const Error&) {
    return false;
  }
}

/// The log and its water column file, given either of them.
SurveyPair pair_of(const fs::path& file, const SurveyEndings& endings, const InputConfig& config) {
  const std::string ending = lower_case(file.extension().string());
  const bool is_log = ending == std::string(".") + endings.log, is_water = ending == std::string(".") + endings.water;
  if (!config.water_column || (!is_log && !is_water)) return {file, {}};
  const fs::path other = file_beside(file, is_log ? endings.water : endings.log);
  if (other.empty() || !holds_format(other, endings.probe)) return {file, {}};
  return is_log ? SurveyPair{file, other} : SurveyPair{other, file};
}

/// The entry of a survey log format with water columns in a file beside the log.
template <const SurveyEndings& endings, std::unique_ptr<Source> (*open)(ByteWindow, const InputConfig&),
          std::unique_ptr<Source> (*open_both)(ByteWindow, ByteWindow, const InputConfig&)>
constexpr Format survey_log(const char* name) {
  return {name, [](const Candidate& c) { return !c.is_folder && endings.probe(c.head); },
          [](const fs::path& path, const InputConfig& config) {
            const SurveyPair pair = pair_of(path, endings, config);
            if (pair.water.empty()) return open(ByteWindow::open(pair.log), config);
            return open_both(ByteWindow::open(pair.log), ByteWindow::open(pair.water), config);
          }};
}

/// An MCAP file is Isobath's own log, or holds messages of ROS.
std::unique_ptr<Source> open_mcap(const fs::path& file, const InputConfig& config) {
  return holds_ros_messages(file) ? open_ros_mcap(file, config) : open_native_log(file, config);
}

constexpr LogFiles kLogFiles{format_of_file, log_of_water_column, open_source};

/// The first format that fits is used. Formats with a signature come before formats that need a search.
constexpr std::array kFormats{
    folder<looks_like_frame_folder, open_frame_folder>("folder of PNG frames"),
    folder<looks_like_fan_folder, open_fan_folder>("folder of fan detections"),
    Format{"survey folder",
           [](const Candidate& c) { return c.is_folder && looks_like_survey_folder(c.path, c.config, kLogFiles); },
           [](const fs::path& path, const InputConfig& config) { return open_survey_folder(path, config, kLogFiles); }},
    own_file<looks_like_mcap, open_mcap>("MCAP"),
    own_file<looks_like_ros1_bag, open_ros1_bag>("ROS 1 bag"),
    Format{"ROS 2 bag (SQLite)", [](const Candidate& c) { return !c.is_folder && looks_like_ros2_database(c.head); },
           open_ros2_database},
    file<looks_like_telemetry_log, open_telemetry_log>("MAVLink telemetry log"),
    file<looks_like_dataflash_log, open_dataflash_log>("ArduPilot DataFlash log"),
    file<looks_like_lowrance, open_lowrance>("Lowrance .sl2"),
    Format{"Humminbird .SON", [](const Candidate& c) { return !c.is_folder && looks_like_humminbird(c.head); },
           open_humminbird_file},
    own_file<looks_like_pcd, open_pcd>("point cloud (PCD)"),
    file<looks_like_ping_viewer_log, open_ping_viewer_log>("Ping Viewer log"),
    file<looks_like_sontek_sum, open_sontek_sum>("SonTek .sum"),
    file<looks_like_nmea, open_nmea>("NMEA 0183"),
    file<looks_like_scan_csv, open_scan_csv>("scan CSV"),
    file<looks_like_ping360_arc, open_ping360_arc>("Ping360 arc table"),
    file<looks_like_ping_messages, open_ping_messages>("printed ping messages"),
    Format{"fan detections (CSV)", [](const Candidate& c) { return !c.is_folder && looks_like_fan_detections(c.head); },
           [](const fs::path& path, const InputConfig& config) { return open_fan_detections(path, config); }},
    file<looks_like_seanet_csv, open_seanet_csv>("Seanet CSV"),
    file<looks_like_oculus_container, open_oculus_container>(".oculus log"),
    file<looks_like_aris, open_aris>("ARIS recording"),
    file<looks_like_sonar3d, open_sonar3d>("Sonar 3D-15"),
    file<looks_like_xtf, open_xtf>("XTF"),
    survey_log<kKmallEndings, open_kmall, open_kmall_with_water>("Kongsberg .kmall"),
    survey_log<kAllEndings, open_kongsberg_all, open_kongsberg_all_with_water>("Kongsberg .all"),
    file<looks_like_oculus_stream, open_oculus_stream>("Oculus message stream"),
    file<looks_like_ping_stream, open_ping_stream>("ping protocol stream"),
    file<looks_like_tritech_stream, open_tritech_stream>("Tritech serial stream"),
    Format{"depth CSV",
           [](const Candidate& c) { return !c.is_folder && looks_like_depth_csv(c.head, c.config.survey); },
           [](const fs::path& path, const InputConfig& config) { return open_depth_csv(path, config); }},
    own_file<looks_like_xyz, open_xyz>("grid of x, y and depth (text)"),
};

const Format* format_of(const Candidate& candidate) {
  const auto* const found = std::ranges::find_if(kFormats, [&](const Format& f) { return f.probe(candidate); });
  return found == kFormats.end() ? nullptr : found;
}

std::string known_formats() {
  std::string names;
  for (const Format& format : kFormats) names += (names.empty() ? "" : ", ") + std::string(format.name);
  return names;
}

/// What an SQLite file is, by its tables.
std::string sqlite_kind(std::string_view head) {
  const std::vector<std::string> tables = sqlite_tables(head);
  const auto has = [&](const char* name) { return std::ranges::find(tables, name) != tables.end(); };
  if (has("gpkg_contents")) return "is a GeoPackage: a chart, not a log";
  if (has("layer") && has("block")) return "holds the voxels of a map, not a log";
  if (has("object") && has("attribute")) return "holds the objects of a map, not a log";
  std::string names;
  for (const std::string& table : tables) names += (names.empty() ? " with the tables " : ", ") + table;
  return "is an SQLite file" + names + "; ViewPoint 2 writes such files, which have no public description";
}

/// Throws for an unknown format; names known formats that cannot be read, with an alternative.
[[noreturn]] void refuse(const Candidate& c) {
  const std::string file = c.path.string();
  if (text_of(c.head).starts_with("SQLite format 3")) {
    const std::string kind = sqlite_kind(text_of(c.head));
    throw Error(kind, {file}, known_formats(),
                kind.ends_with("description") ? "record with ViewPoint 1 or take the messages off the network" : "");
  }
  const std::string ending = lower_case(c.path.extension().string());
  if (ending == ".v4log") {
    throw Error("not a known format; V4LOG of Seanet Pro has no public description", {file}, known_formats(),
                "export it to CSV with Seanet Pro");
  }
  if (const auto columns = table_columns(c.head); !columns.empty() && !c.is_folder) {
    const std::string names = fmt::format("{}", fmt::join(columns, ", "));
    const std::string problem = c.config.survey.csv_columns.empty()
                                    ? "is a table whose columns are not declared: " + names
                                    : "is a table without the columns that input.csv_columns names: " + names;
    throw Error(problem, {file}, {}, kDeclareColumns);
  }
  const char* kind = c.is_folder ? ": a folder" : looks_like_text(c.head) ? ": looks like text" : "";
  throw Error(std::string("not a known format") + kind, {file}, known_formats());
}

/// The fixes of another source.
class FixesOnly final : public Source {
 public:
  explicit FixesOnly(std::unique_ptr<Source> source) : source_(std::move(source)) {}
  std::optional<Event> next() override {
    auto event = source_->next();
    while (event && !std::holds_alternative<Navigation>(*event)) event = source_->next();
    return event;
  }
  [[nodiscard]] const SourceReport& report() const override { return source_->report(); }

 private:
  std::unique_ptr<Source> source_;
};

}  // namespace

std::unique_ptr<Source> open_navigation(const InputConfig& config) {
  const auto is_log = [](Bytes head) { return !looks_like_text(head) || looks_like_nmea(head); };
  if (!holds_format(config.navigation, is_log)) return open_pose_track(config.navigation);
  InputConfig own = config;
  own.navigation.clear();
  return std::make_unique<FixesOnly>(open_source(config.navigation, own));
}

std::unique_ptr<Source> open_source(const fs::path& input, const InputConfig& config) {
  std::error_code ignored;  // opening reports inputs that cannot be examined
  const bool is_folder = fs::is_directory(input, ignored);
  std::optional<ByteWindow> window;
  if (!is_folder) window = ByteWindow::open(input);
  const Bytes head = window ? window->want(kHead) : Bytes();
  const Candidate candidate{input, is_folder, head.first(std::min(head.size(), kHead)), config};
  const Format* const format = format_of(candidate);
  if (format == nullptr) refuse(candidate);
  auto source = with_pooled_bins(format->open(input, config), config.max_bins);
  return config.navigation.empty() ? std::move(source) : merge_by_time(std::move(source), open_navigation(config));
}

fs::path log_of_water_column(const fs::path& file, const InputConfig& config) {
  for (const SurveyEndings* endings : {&kKmallEndings, &kAllEndings}) {
    const SurveyPair pair = pair_of(file, *endings, config);
    if (pair.water == file) return pair.log;
  }
  return {};
}

std::unique_ptr<Source> open_reference(const fs::path& input, const InputConfig& config) {
  if (!config.reference.empty()) return open_pose_track(config.reference);
  if (config.track == LogTrack::kGnss && config.navigation.empty()) return nullptr;  // the run uses that track
  std::error_code ignored;
  if (!fs::is_directory(input, ignored) || !looks_like_fan_folder(input)) return nullptr;
  return open_reference_of_fan_folder(input, config);
}

std::string format_of_file(const fs::path& file, const InputConfig& config) {
  try {
    ByteWindow window = ByteWindow::open(file);
    const Bytes head = window.want(kHead);
    const Format* const format = format_of({file, false, head.first(std::min(head.size(), kHead)), config});
    return format == nullptr ? std::string() : format->name;
  } catch (const Error&) {
    return {};
  }
}

}  // namespace isobath
