// MissionNotes: records estimated positions and detected obstacles, for the pages of a mission.
#pragma once

#include <isobath/onboard/onboard_observer.hpp>
#include <isobath/report/mission_outcome.hpp>
#include <vector>

namespace isobath {

class MissionNotes : public OnboardObserver {
 public:
  void on_event(const Event& event) override;
  void on_scan(const ScanResult& scan) override;
  [[nodiscard]] const std::vector<BelievedPlace>& believed() const { return believed_; }
  [[nodiscard]] const std::vector<SeenObstacle>& seen() const { return seen_; }

 private:
  std::vector<BelievedPlace> believed_;
  std::vector<SeenObstacle> seen_;
};

}  // namespace isobath
