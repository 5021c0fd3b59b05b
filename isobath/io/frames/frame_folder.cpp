#include <algorithm>
#include <charconv>
#include <fmt/format.h>
#include <isobath/base/error.hpp>
#include <isobath/io/bytes/delimited_text.hpp>
#include <isobath/io/bytes/whole_file.hpp>
#include <isobath/io/frames/frame_folder.hpp>
#include <isobath/io/input/pose_track.hpp>
#include <map>
#include <set>

namespace isobath {
namespace {

namespace fs = std::filesystem;
using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr std::uint64_t kMaxGeometryBytes = 4u << 20;
constexpr const char* kAdvice = "put a geometry.json beside the frames (see the documentation of frame folders)";

struct PosedFrame {
  fs::path image;
  Time time;
  std::optional<Navigation> navigation;
  Pose X_BS;
};

std::vector<fs::path> files_of(const fs::path& folder, bool folders, const char* extension) {
  std::vector<fs::path> found;
  std::error_code problem;
  for (fs::directory_iterator at(folder, problem), end; !problem && at != end; at.increment(problem)) {
    std::error_code unknown;
    const bool wanted =
        folders ? at->is_directory(unknown) : at->is_regular_file(unknown) && at->path().extension() == extension;
    if (wanted) found.push_back(at->path());
  }
  std::sort(found.begin(), found.end());
  return found;
}

std::string whole_text(const fs::path& file) {
  const auto bytes = read_whole_file(file, kMaxGeometryBytes);
  return {bytes.begin(), bytes.end()};
}

/// geometry.json, else a file that looks like a geometry; a file that lists the angle of each beam has precedence.
fs::path geometry_file(const fs::path& folder) {
  fs::path best;
  for (const fs::path& file : files_of(folder, false, ".json")) {
    if (file.filename() == "geometry.json") return file;
    std::error_code unknown;
    if (fs::file_size(file, unknown) > kMaxGeometryBytes || unknown) continue;
    const std::string text = whole_text(file);
    if (!looks_like_frame_geometry(text)) continue;
    const bool lists_angles = text.find("\"azimuths") != std::string::npos;
    if (lists_angles) return file;
    if (best.empty()) best = file;
  }
  return best;
}

/// "<set>.csv" beside the set, if it has the columns of frames with poses.
fs::path poses_beside(const fs::path& set) {
  const fs::path file = set.parent_path() / (set.filename().string() + ".csv");
  std::error_code unknown;
  if (!fs::is_regular_file(file, unknown)) return {};
  try {
    const DelimitedText table = open_delimited_text(file.string());
    for (const char* name : {"frame", "pass", "t_s", "sx", "s00", "vx", "v00"}) {
      if (table.column(name) < 0) return {};
    }
    return file;
  } catch (const Error&) {
    return {};
  }
}

std::vector<FrameSet> sets_of(const fs::path& folder) {
  if (!frames_in(folder).empty()) return {{folder.filename().string(), folder, poses_beside(folder)}};
  std::vector<FrameSet> sets;
  for (const fs::path& sub : files_of(folder, true, "")) {
    if (!frames_in(sub).empty()) sets.push_back({sub.filename().string(), sub, poses_beside(sub)});
  }
  return sets;
}

fs::path without_slash(const fs::path& folder) { return folder.has_filename() ? folder : folder.parent_path(); }

fs::path geometry_of(const fs::path& folder) {
  const fs::path file = geometry_file(folder);
  return file.empty() && !frames_in(folder).empty() ? geometry_file(fs::absolute(folder).parent_path()) : file;
}

const FrameSet& chosen_set(const FrameLayout& layout, const fs::path& folder, const std::string& name) {
  if (name.empty()) return layout.sets.front();
  std::string names;
  for (const FrameSet& set : layout.sets) {
    if (set.name == name) return set;
    names += (names.empty() ? "" : ", ") + set.name;
  }
  throw Error("no set \"" + name + "\" here", {folder.string(), {}, {}, {}, "set"}, names);
}

/// Reads the rows of frames with poses. Columns are looked up once.
class PoseRows {
 public:
  explicit PoseRows(const fs::path& file) : table_(open_delimited_text(file.string())) {
    frame_ = table_.required("frame");
    pass_ = table_.required("pass");
    t_s_ = table_.required("t_s");
    sonar_ = pose_columns("s");
    vehicle_ = pose_columns("v");
    for (const char* name : {"velx", "vely", "velz"}) velocity_.push_back(table_.column(name));
  }

  struct Row {
    std::int64_t frame = 0;
    std::int64_t pass = 0;
    PosedFrame posed;
  };
  bool next() { return table_.next(); }
  /// Empty where a value is missing or not finite, or where the matrix is not a rotation.
  [[nodiscard]] std::optional<Row> row() const {
    const auto frame = table_.integer(frame_), pass = table_.integer(pass_);
    const auto t_s = table_.number(t_s_);
    const auto X_WS = pose(sonar_), X_WB = pose(vehicle_);
    if (!frame || !pass || !t_s || !representable_seconds(*t_s) || !X_WS || !X_WB) return std::nullopt;
    const Time time{seconds(*t_s)};
    Navigation fix{time, *X_WB, velocity(), std::nullopt};
    return Row{*frame, *pass, {{}, time, std::move(fix), X_WB->inverse() * *X_WS}};
  }

 private:
  /// Columns x y z, then the rotation by rows.
  [[nodiscard]] std::vector<int> pose_columns(const std::string& head) const {
    std::vector<int> columns;
    for (const char* name : {"x", "y", "z", "00", "01", "02", "10", "11", "12", "20", "21", "22"}) {
      columns.push_back(table_.required(head + name));
    }
    return columns;
  }

  [[nodiscard]] std::optional<Pose> pose(const std::vector<int>& columns) const {
    double v[12];
    for (int i = 0; i < 12; ++i) {
      const auto value = table_.number(columns[i]);
      if (!value) return std::nullopt;
      v[i] = *value;
    }
    const Matrix3d axes = (Matrix3d() << v[3], v[4], v[5], v[6], v[7], v[8], v[9], v[10], v[11]).finished();
    if (!Rotation::valid(axes)) return std::nullopt;
    const Vector3d forward_port_up(1, -1, -1);
    return Pose{Rotation::from_matrix(to_ned() * axes * forward_port_up.asDiagonal()),
                to_ned() * Vector3d(v[0], v[1], v[2])};
  }

  [[nodiscard]] std::optional<Vector3d> velocity() const {
    const auto x = table_.number(velocity_[0]), y = table_.number(velocity_[1]), z = table_.number(velocity_[2]);
    if (!x || !y || !z) return std::nullopt;
    return to_ned() * Vector3d(*x, *y, *z);
  }

  /// Converts from x east, y north, z up.
  static Matrix3d to_ned() { return (Matrix3d() << 0, 1, 0, 1, 0, 0, 0, 0, -1).finished(); }

  DelimitedText table_;
  int frame_ = -1, pass_ = -1, t_s_ = -1;
  std::vector<int> sonar_, vehicle_, velocity_;
};

std::map<std::int64_t, fs::path> frames_by_number(const fs::path& folder) {
  std::map<std::int64_t, fs::path> frames;
  for (const fs::path& file : frames_in(folder)) {
    const std::string stem = file.stem().string();
    std::int64_t number = 0;
    const auto [end, problem] = std::from_chars(stem.data(), stem.data() + stem.size(), number);
    if (problem == std::errc() && end == stem.data() + stem.size()) frames.emplace(number, file);
  }
  return frames;
}

std::vector<PosedFrame> frames_with_poses(const FrameSet& set, int wanted_pass, SourceReport& report) {
  const auto images = frames_by_number(set.folder);
  std::vector<PosedFrame> frames;
  std::set<std::int64_t> passes;
  std::optional<std::int64_t> pass;
  if (wanted_pass > 0) pass = wanted_pass;
  for (PoseRows rows(set.poses); rows.next();) {
    auto row = rows.row();
    if (!row) {
      ++report.rejected[kBadPose];
      continue;
    }
    passes.insert(row->pass);
    if (!pass) pass = row->pass;
    if (row->pass != *pass) continue;
    const auto image = images.find(row->frame);
    if (image == images.end()) {
      ++report.rejected["pose row without its frame"];
      continue;
    }
    row->posed.image = image->second;
    frames.push_back(std::move(row->posed));
  }
  if (wanted_pass > 0 && !passes.contains(wanted_pass)) {
    throw Error(fmt::format("no pass {} in the set {}", wanted_pass, set.name),
                {set.poses.string(), {}, {}, {}, "pass"}, fmt::format("{}", fmt::join(passes, ", ")));
  }
  if (pass) report.details["pass"] = std::to_string(*pass);
  return frames;
}

std::vector<PosedFrame> frames_with_times(const FrameSet& set, Angle mount_heading, SourceReport& report) {
  std::vector<PosedFrame> frames;
  for (const fs::path& file : frames_in(set.folder)) {
    if (file.stem().string().ends_with("_annotated")) continue;
    if (const auto time = time_of_frame(file)) {
      frames.push_back({file, *time, std::nullopt, {Rotation::from_heading(mount_heading), Vector3d::Zero()}});
    } else {
      ++report.rejected["frame whose name is not a time in microseconds"];
    }
  }
  std::stable_sort(frames.begin(), frames.end(), [](const auto& a, const auto& b) { return a.time < b.time; });
  return frames;
}

class FrameFolderSource final : public Source {
 public:
  FrameFolderSource(FrameGeometry geometry, const FrameSet& set, const InputConfig& config)
      : geometry_(std::move(geometry)), config_(config) {
    report_.format = "folder of polar frames";
    report_.details["set"] = set.name;
    report_.details["frames"] = fmt::format("{} beams x {} bins", geometry_.fan->beams(), geometry_.window.bins);
    frames_ = set.poses.empty() ? frames_with_times(set, config.mount_heading, report_)
                                : frames_with_poses(set, config.pass, report_);
    if (frames_.empty()) throw Error("holds no usable frame", {set.folder.string(), {}, {}, {}, {}});
    for (const PosedFrame& frame : frames_) report_.bytes_total += size_of(frame);
  }

  std::optional<Event> next() override {
    if (waiting_) return *std::exchange(waiting_, std::nullopt);
    while (at_ < frames_.size()) {
      const PosedFrame& frame = frames_[at_++];
      auto ping = load(frame);
      report_.bytes_read += size_of(frame);
      if (!ping) continue;
      ping->time = frame.time;
      ping->X_BS = frame.X_BS;
      if (!frame.navigation) return *std::move(ping);
      waiting_ = *std::move(ping);
      return *frame.navigation;
    }
    return std::nullopt;
  }
  [[nodiscard]] const SourceReport& report() const override { return report_; }

 private:
  static std::uint64_t size_of(const PosedFrame& frame) {
    std::error_code unknown;
    const auto size = fs::file_size(frame.image, unknown);
    return unknown ? 0 : size;
  }

  std::optional<Ping> load(const PosedFrame& frame) {
    try {
      auto ping = ping_from_frame(geometry_, read_gray_png(frame.image), config_);
      if (!ping) ++report_.rejected["frame of another size than the geometry's"];
      return ping;
    } catch (const Error&) {
      report_.add_damage(report_.bytes_read, size_of(frame), "unreadable frame " + frame.image.filename().string());
      ++report_.rejected["unreadable frame"];
      return std::nullopt;
    }
  }

  FrameGeometry geometry_;
  InputConfig config_;
  SourceReport report_;
  std::vector<PosedFrame> frames_;
  std::size_t at_ = 0;
  std::optional<Event> waiting_;
};

}  // namespace

std::vector<fs::path> frames_in(const fs::path& folder) { return files_of(folder, false, ".png"); }

std::optional<Time> time_of_frame(const fs::path& frame) {
  std::string stem = frame.stem().string();
  if (stem.ends_with("_raw")) stem.resize(stem.size() - 4);
  std::int64_t us = 0;
  const auto [end, problem] = std::from_chars(stem.data(), stem.data() + stem.size(), us);
  if (stem.empty() || problem != std::errc() || end != stem.data() + stem.size()) return std::nullopt;
  if (us < 0 || us > std::int64_t{9'000'000'000'000'000}) return std::nullopt;
  return Time{std::chrono::microseconds(us)};
}

FrameLayout frame_layout(const fs::path& given, const InputConfig& config) {
  const fs::path folder = without_slash(given);
  FrameLayout layout;
  layout.sets = sets_of(folder);
  if (layout.sets.empty()) throw Error("holds no PNG frames", {folder.string(), {}, {}, {}, {}});
  const fs::path file = geometry_of(folder);
  const bool posed =
      std::any_of(layout.sets.begin(), layout.sets.end(), [](const auto& s) { return !s.poses.empty(); });
  if (file.empty() && !posed)
    throw Error("no geometry file for the frames", {folder.string(), {}, {}, {}, {}}, "", kAdvice);
  layout.geometry = with_overrides(
      file.empty() ? simulated_frame_geometry() : parse_frame_geometry(whole_text(file), file.string()), config);
  return layout;
}

bool looks_like_frame_folder(const fs::path& given) {
  const fs::path folder = without_slash(given);
  std::error_code unknown;
  if (!fs::is_directory(folder, unknown)) return false;
  const auto sets = sets_of(folder);
  const bool posed = std::any_of(sets.begin(), sets.end(), [](const auto& s) { return !s.poses.empty(); });
  return !sets.empty() && (posed || !geometry_of(folder).empty());
}

std::unique_ptr<Source> open_frame_folder(const fs::path& folder, const InputConfig& config) {
  FrameLayout layout = frame_layout(folder, config);
  const FrameSet& set = chosen_set(layout, folder, config.set);
  return std::make_unique<FrameFolderSource>(layout.geometry, set, config);
}

}  // namespace isobath
