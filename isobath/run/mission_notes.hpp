// MissionNotes: records estimated positions, detected obstacles and the hazards of chart and depth map, for the pages
// of a mission. Any thread may call on_message.
#pragma once

#include <isobath/mission/messages/messages.hpp>
#include <isobath/onboard/onboard_observer.hpp>
#include <isobath/report/mission_outcome.hpp>
#include <mutex>
#include <vector>

namespace isobath {

class MissionNotes : public OnboardObserver {
 public:
  void on_fix(const Navigation& fix) override;
  void on_scan(const ScanResult& scan) override;
  /// Every message of the agents.
  void on_message(const Envelope& envelope);
  [[nodiscard]] const std::vector<BelievedPlace>& believed() const { return believed_; }
  [[nodiscard]] const std::vector<SeenObstacle>& seen() const { return seen_; }
  /// Hazards of the chart as the mission began, and those that sonar had measured at its end.
  [[nodiscard]] std::vector<Hazard> charted() const { return hazards_of(first_hazards_, HazardKind::kCharted); }
  [[nodiscard]] std::vector<Hazard> mapped() const { return hazards_of(last_hazards_, HazardKind::kMapped); }

 private:
  using Hazards = std::shared_ptr<const std::vector<Hazard>>;
  [[nodiscard]] std::vector<Hazard> hazards_of(const Hazards& hazards, HazardKind kind) const;
  std::vector<BelievedPlace> believed_;
  std::vector<SeenObstacle> seen_;
  mutable std::mutex mutex_;
  Hazards first_hazards_, last_hazards_;  ///< guarded by mutex_
};

}  // namespace isobath
