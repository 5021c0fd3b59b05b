// MissionStory: what a run must show, stage by stage, for a demonstration to count (Ganesan 2015, chapter 6; ledger
// S6-54, S6-55, S6-58, S6-D05 to S6-D08). A suite lists the stages ([[stage]]); eval looks for them in every run.
//
// A run shows the story if all stages happen in their order, each within its limits of time and of scans after the
// stage before, and if the run reaches its goal without a collision. The first stage counts from the start of the
// mission. Each stage takes the first scan or decision that fits, at or after the stage before. Scans are what the
// vehicle believes: their obstacles are placed with its estimated pose. Only `spurious` and the clearance of injected
// outlines use the ground truth.
#pragma once

#include <isobath/base/config.hpp>
#include <isobath/run/closed_loop.hpp>
#include <string>
#include <vector>

namespace isobath {

enum class StageKind : std::uint8_t {
  kSeen,       ///< a scan shows an obstacle at `at`
  kSpurious,   ///< a scan shows an obstacle where no body is
  kFaded,      ///< a scan looks at an obstacle of the last stage seen or spurious, and no longer shows it
  kPlanned,    ///< the Navigator plans a leg to `point`
  kReplanned,  ///< the Navigator plans or replans a route around an obstacle at `at`
  kDropped     ///< the Executive Officer drops `point`
};

struct StoryStage {
  Place place;
  std::string name;
  StageKind what = StageKind::kSeen;
  Eigen::Vector2d at = {0, 0};  ///< north, east, m
  double within_m = 5;
  std::string point;                   ///< name of a mission point
  std::string reason;                  ///< text that the reason of the decision contains; empty: any
  Eigen::Vector2d after_s = {0, 1e6};  ///< minimum and maximum
  Eigen::Vector2d scans = {0, 1e6};    ///< minimum and maximum number of scans
};
/// Bound to `stage`.
std::vector<Field> fields(StoryStage& stage);

/// How one run went through the stages.
struct StoryCheck {
  std::vector<double> after_s;  ///< per stage that happened in time: since the stage before
  std::vector<int> scans;       ///< likewise: scans since the stage before
  std::string failure;          ///< the stage that failed, and why; empty: none did
  double min_injected_m = -1;   ///< least distance of the hull's centre from an injected outline; -1: none
  [[nodiscard]] bool all(std::size_t stages) const { return after_s.size() == stages; }
};

/// Keeps what the scans of a run show.
class StoryLog : public OnboardObserver {
 public:
  struct Scan {
    double time_s = 0;
    Pose X_WB;
    std::vector<Polygon> outlines;  ///< W, as estimated
  };
  void on_scan(const ScanResult& scan) override;
  [[nodiscard]] const std::vector<Scan>& scans() const { return scans_; }

 private:
  std::vector<Scan> scans_;
};

/// `bodies`: outlines of the true bodies.
StoryCheck follow_story(const std::vector<StoryStage>& stages, const Scenario& scenario,
                        const std::vector<Polygon>& bodies, const StoryLog& log, const LoopResult& result);

}  // namespace isobath
