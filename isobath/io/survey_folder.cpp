#include <algorithm>
#include <fmt/format.h>
#include <isobath/base/file_access.hpp>
#include <isobath/io/bytes/name_patterns.hpp>
#include <isobath/io/survey_folder.hpp>
#include <map>

namespace isobath {
namespace {

namespace fs = std::filesystem;
using Eigen::Vector2d;

constexpr Duration kBetweenUndated = std::chrono::seconds(10);
constexpr Time kDated{std::chrono::days(3653)};  // as in to_text: earlier times belong to logs without a date
constexpr double kFarthest = 9e5;                // m: limit of the local plane
constexpr std::size_t kNamedFiles = 40;          // maximum number of files named in the details

struct SurveyFile {
  fs::path path;
  std::string name;
  std::uint64_t bytes = 0;
  Time first;
};

struct LeftOut {
  std::string name, reason;
};

struct Survey {
  std::string format;
  std::vector<SurveyFile> files;
  std::vector<LeftOut> left_out;
};

bool chosen(const std::string& name, const SurveyInput& config) {
  return (config.only.empty() || fits(name, config.only)) && !fits(name, config.without);
}

/// The files of the most common format among the selected files.
Survey survey_of(const fs::path& folder, const InputConfig& config, const LogFiles& logs) {
  Survey survey;
  std::vector<std::pair<std::string, SurveyFile>> known;
  std::map<std::string, int> count;
  for (const fs::path& path : regular_files(folder)) {
    const std::string name = path.filename().string();
    const std::string format = logs.format_of(path, config);
    const fs::path log = format.empty() ? fs::path() : logs.log_of_water_column(path, config);
    if (!log.empty() && chosen(log.filename().string(), config.survey)) {
      survey.left_out.push_back({name, "water column, read with its log"});
    } else if (format.empty()) {
      survey.left_out.push_back({name, "not a known log"});
    } else if (!chosen(name, config.survey)) {
      survey.left_out.push_back({name, "not chosen"});
    } else {
      std::error_code unknown;
      const auto bytes = fs::file_size(path, unknown);
      known.push_back({format, {path, name, unknown ? 0 : bytes, {}}});
      const int now = ++count[format];
      if (survey.format.empty() || now > count[survey.format]) survey.format = format;
    }
  }
  for (auto& [format, file] : known) {
    if (format == survey.format) {
      survey.files.push_back(std::move(file));
    } else {
      survey.left_out.push_back({file.name, format});
    }
  }
  return survey;
}

/// Finds the first time of each file, leaves out files without events, and sorts.
void order_by_time(Survey& survey, const InputConfig& config, const LogFiles& logs) {
  std::vector<SurveyFile> usable;
  for (SurveyFile& file : survey.files) {
    try {
      const auto source = logs.open(file.path, config);
      const auto event = source->next();
      file.bytes = source->report().bytes_total;  // includes the file beside it, if there is one
      if (event) {
        file.first = time_of(*event);
        usable.push_back(std::move(file));
      } else {
        survey.left_out.push_back({file.name, "contains no event"});
      }
    } catch (const Error& error) {
      survey.left_out.push_back({file.name, error.what()});
    }
  }
  std::ranges::stable_sort(usable, [](const SurveyFile& a, const SurveyFile& b) {  // files are already by name
    const bool dated = a.first >= kDated || b.first >= kDated;
    return dated && a.first < b.first;
  });
  survey.files = std::move(usable);
}

/// A list such as "not a known log: README.md, lake.shp; not chosen: 1.sum".
std::string listed(const std::vector<LeftOut>& files) {
  std::map<std::string, std::string> names;
  for (std::size_t i = 0; i < std::min(files.size(), kNamedFiles); ++i) {
    std::string& list = names[files[i].reason];
    list += (list.empty() ? "" : ", ") + files[i].name;
  }
  std::string text;
  for (const auto& [reason, list] : names) text += (text.empty() ? "" : "; ") + reason + ": " + list;
  if (files.size() > kNamedFiles) text += fmt::format("; and {} more", files.size() - kNamedFiles);
  return text;
}

class SurveyFolder final : public Source {
 public:
  SurveyFolder(Survey survey, const InputConfig& config, const LogFiles& logs)
      : survey_(std::move(survey)), config_(config), logs_(logs) {
    for (const SurveyFile& file : survey_.files) finished_.bytes_total += file.bytes;
    update_report();
  }

  std::optional<Event> next() override {
    for (;;) {
      if (!source_ && !open_next()) {
        update_report();
        return std::nullopt;
      }
      auto event = source_->next();
      if (!event) {
        close();
        continue;
      }
      std::visit([&](auto& e) { e.time += shift_; }, *event);
      const Time time = time_of(*event);
      if (last_ && first_of_file_ && time < *last_) ++overlaps_;
      first_of_file_ = false;
      last_ = last_ ? std::max(*last_, time) : time;
      auto* const fix = std::get_if<Navigation>(&*event);
      if (fix && !place(*fix)) continue;
      report_.bytes_read = finished_.bytes_read + source_->report().bytes_read;
      return event;
    }
  }
  [[nodiscard]] const SourceReport& report() const override { return report_; }

 private:
  bool open_next();
  void close();
  bool place(Navigation& fix);
  void update_report();

  Survey survey_;
  InputConfig config_;
  LogFiles logs_;
  std::size_t at_ = 0;  ///< index of the next file to open
  std::unique_ptr<Source> source_;
  std::size_t files_read_ = 0;
  std::uint64_t overlaps_ = 0;
  Duration shift_{};
  std::optional<Time> last_;
  bool first_of_file_ = false;
  std::optional<std::optional<GeoOrigin>> origin_;  ///< empty before the first fix
  SourceReport finished_;                           ///< the sum over the finished files
  SourceReport report_;
};

bool SurveyFolder::open_next() {
  while (at_ < survey_.files.size()) {
    const SurveyFile& file = survey_.files[at_++];
    try {
      source_ = logs_.open(file.path, config_);
    } catch (const Error& error) {  // it has changed since it was listed
      survey_.left_out.push_back({file.name, error.what()});
      continue;
    }
    const bool follows = last_ && file.first < kDated;
    shift_ = follows ? *last_ + kBetweenUndated - file.first : Duration{};
    first_of_file_ = true;
    update_report();
    return true;
  }
  return false;
}

void SurveyFolder::close() {
  const SurveyFile& file = survey_.files[at_ - 1];
  const SourceReport& report = source_->report();
  finished_.bytes_read += file.bytes;
  finished_.bytes_skipped += report.bytes_skipped;
  for (const Damage& damage : report.damages) {
    if (finished_.damages.size() == SourceReport::kMaxDamages) break;
    finished_.damages.push_back({damage.offset, damage.bytes, file.name + ": " + damage.reason});
  }
  for (const auto& [reason, count] : report.rejected) finished_.rejected[reason] += count;
  for (const auto& [key, value] : report.details) finished_.note_setting(key, value);
  ++files_read_;
  source_.reset();
  update_report();
}

/// Converts a fix to the plane of the first fix; false if that is impossible.
bool SurveyFolder::place(Navigation& fix) {
  const std::optional<GeoOrigin>& own = source_->report().origin;
  if (!origin_) {
    origin_ = own;
    finished_.origin = report_.origin = own;
  }
  if (own == *origin_) return true;
  if (!own || !*origin_) {
    ++finished_.rejected["fix without a position on the globe in a survey whose first fix has one, or the reverse"];
    return false;
  }
  if (!(fix.X_WB.translation.norm() < kFarthest)) {
    ++finished_.rejected["fix too far from the origin of its log"];
    return false;
  }
  const LocalPlane to(**origin_);
  fix = in_plane(fix, LocalPlane(*own), to);
  return true;
}

void SurveyFolder::update_report() {
  const std::uint64_t position = report_.bytes_read;
  report_ = finished_;
  report_.bytes_read = std::max(position, finished_.bytes_read);
  report_.format = "folder of " + survey_.format;
  report_.details["files"] = fmt::format("{} of {} read", files_read_, survey_.files.size());
  if (!survey_.left_out.empty()) report_.details["left out"] = listed(survey_.left_out);
  if (overlaps_ > 0) report_.details["overlap"] = fmt::format("{} files begin before the previous one ends", overlaps_);
}

}  // namespace

Navigation in_plane(const Navigation& fix, const LocalPlane& from, const LocalPlane& to) {
  if (from.origin() == to.origin()) return fix;
  constexpr double kArm = 500;  // m: long against rounding, short against the curvature
  const auto moved = [&](const Vector2d& p) { return to.to_plane(from.to_geo(p)); };
  const Vector2d p = fix.X_WB.translation.head<2>(), arm(kArm, 0);
  const Vector2d north = moved(p + arm) - moved(p - arm);
  const Rotation turn = Rotation::from_heading(Angle::radians(std::atan2(north.y(), north.x())));
  Navigation result = fix;
  result.X_WB.translation.head<2>() = moved(p);
  result.X_WB.rotation = turn * fix.X_WB.rotation;
  if (fix.v_WB) result.v_WB = turn * *fix.v_WB;
  if (fix.covariance) {
    Eigen::Matrix<double, 6, 6> change = Eigen::Matrix<double, 6, 6>::Identity();
    change.topLeftCorner<3, 3>() = turn.matrix();
    result.covariance = change * *fix.covariance * change.transpose();
  }
  return result;
}

bool looks_like_survey_folder(const fs::path& folder, const InputConfig& config, const LogFiles& logs) {
  return std::ranges::any_of(regular_files(folder),
                             [&](const fs::path& file) { return !logs.format_of(file, config).empty(); });
}

std::unique_ptr<Source> open_survey_folder(const fs::path& folder, const InputConfig& config, const LogFiles& logs) {
  InputConfig one = config;
  one.navigation.clear();  // the pose track is for the survey, not for each file
  Survey survey = survey_of(folder, one, logs);
  if (survey.files.empty()) {
    throw Error("input.only and input.without leave no log", {folder.string(), {}, {}, {}, {}}, {},
                "left out: " + listed(survey.left_out));
  }
  order_by_time(survey, one, logs);
  if (survey.files.empty()) {
    throw Error("holds no log that can be read", {folder.string(), {}, {}, {}, {}}, {},
                "left out: " + listed(survey.left_out));
  }
  return std::make_unique<SurveyFolder>(std::move(survey), one, logs);
}

}  // namespace isobath
