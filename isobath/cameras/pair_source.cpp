#include <deque>
#include <isobath/base/error.hpp>
#include <isobath/cameras/pair_source.hpp>
#include <isobath/io/input/pose_track.hpp>
#include <isobath/io/open_source.hpp>
#include <isobath/io/ros/ros_pairs.hpp>
#include <utility>

namespace isobath {
namespace {

/// The advice for a pair that the rig cannot be right about; null: another pair may be better.
const char* advice_against(PairFault fault) {
  switch (fault) {
    case PairFault::kSizesDiffer: return "both cameras must take pictures of one size";
    case PairFault::kTooSmall: return "larger pictures";
    case PairFault::kOtherSize: return "give the calibration of these cameras";
    case PairFault::kExchanged: return "exchange pairs.left and pairs.right";
    case PairFault::kRowsMiss: return "the calibration is of other cameras, or a camera has moved";
    case PairFault::kNone:
    case PairFault::kBlank:
    case PairFault::kNoRange: break;
  }
  return nullptr;
}

class PairSource final : public Source {
 public:
  /// `others`: fixes and other events, by time; null: none. `where`: what the pictures are read from.
  PairSource(std::unique_ptr<PairReader> pairs, const PairRig& rig, const CamerasConfig& cameras,
             std::unique_ptr<Source> others, SourceReport report, const std::string& where)
      : pairs_(std::move(pairs)),
        rig_(cameras, rig.cameras, rig.X_BL()),
        others_(std::move(others)),
        report_(std::move(report)) {
    refuse_wrong_rig(cameras, rig, where);
    if (others_) other_ = others_->next();
    update_report();
  }

  std::optional<Event> next() override {
    for (;;) {
      if (ahead_.empty()) {
        if (auto pair = pairs_->next(report_)) ahead_.push_back(std::move(*pair));
      }
      if (other_ && (ahead_.empty() || time_of(*other_) <= ahead_.front().time)) return next_other();
      if (ahead_.empty()) {
        update_report();
        return {};
      }
      const CameraPair pair = std::move(ahead_.front());
      ahead_.pop_front();
      auto swath = rig_.on_pair(pair);
      if (!swath) ++report_.rejected[to_text(rig_.fault())];
      update_report();
      if (swath) return *std::move(swath);
    }
  }
  [[nodiscard]] const SourceReport& report() const override { return report_; }

 private:
  /// Looks at the first pairs until one shows something. A rig of its own, which later pairs do not know of.
  void refuse_wrong_rig(const CamerasConfig& cameras, const PairRig& rig, const std::string& where) {
    constexpr std::size_t kMaxAhead = 8;
    PairRanger ranger(cameras.ranger, rig.cameras, {});
    while (ahead_.size() < kMaxAhead) {
      auto pair = pairs_->next(report_);
      if (!pair) return;
      ahead_.push_back(std::move(*pair));
      const PairFault fault = ranger.update(ahead_.back());
      if (fault == PairFault::kNone) return;
      if (const char* advice = advice_against(fault)) throw Error(to_text(fault), {where}, {}, advice);
    }
  }

  std::optional<Event> next_other() {
    std::optional<Event> event = std::exchange(other_, others_->next());
    if (auto* fix = event ? std::get_if<Navigation>(&*event) : nullptr) rig_.on_fix(*fix);
    update_report();
    return event;
  }

  void update_report() {
    rig_.describe("cameras", report_.details);
    if (!others_) return;
    const SourceReport& theirs = others_->report();
    report_.origin = theirs.origin;
    for (const auto& [name, text] : theirs.details) report_.details[name] = text;
    for (const auto& [reason, count] : theirs.rejected) {
      std::uint64_t& counted = counted_[reason];
      report_.rejected[reason] += count - std::exchange(counted, count);
    }
  }

  std::unique_ptr<PairReader> pairs_;
  CameraRig rig_;
  std::unique_ptr<Source> others_;
  SourceReport report_;
  std::map<std::string, std::uint64_t> counted_;  ///< rejections of the others that the report has
  std::deque<CameraPair> ahead_;
  std::optional<Event> other_;
};

std::unique_ptr<Source> open_folder_of_pairs(const std::filesystem::path& folder, const InputConfig& config,
                                             const CamerasConfig& cameras) {
  const PairRig rig = read_pair_rig(folder / PairRig::kFile);
  SourceReport report;
  auto pairs = open_pair_folder(folder, rig, report);
  std::unique_ptr<Source> poses;
  if (!config.navigation.empty()) {
    poses = open_navigation(config);
  } else if (!rig.poses.empty()) {
    poses = open_pose_track(rig.poses);
  }
  return std::make_unique<PairSource>(std::move(pairs), rig, cameras, std::move(poses), std::move(report),
                                      folder.string());
}

std::unique_ptr<Source> open_log_with_pairs(const std::filesystem::path& log, const InputConfig& config,
                                            const CamerasConfig& cameras) {
  const PairRig rig = read_pair_rig(config.cameras);
  auto pairs = open_ros_pairs(open_ros_recording(log), rig, log.string());
  auto others = open_source(log, config);
  SourceReport report = others->report();
  report.rejected.clear();
  report.format += " with camera pairs";
  return std::make_unique<PairSource>(std::move(pairs), rig, cameras, std::move(others), std::move(report),
                                      log.string());
}

}  // namespace

std::unique_ptr<Source> open_input(const std::filesystem::path& input, const InputConfig& config,
                                   const CamerasConfig& cameras) {
  std::error_code ignored;
  if (std::filesystem::is_directory(input, ignored)) {
    return looks_like_pair_folder(input) ? open_folder_of_pairs(input, config, cameras) : open_source(input, config);
  }
  return config.cameras.empty() ? open_source(input, config) : open_log_with_pairs(input, config, cameras);
}

}  // namespace isobath
