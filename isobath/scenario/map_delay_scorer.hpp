// MapDelayScorer: how long after its first echo a body of the scene stands in the depth map (Oskard, Hong, Shaffer
// 1990, V; ledger S1-26, S1-D01). Only for simulated runs, whose bodies are known; it changes nothing.
//
// A body is heard when a range sonar that looks ahead has an echo within the accepted range whose end lies at the body,
// within half the width of the cone there and 1 m. The body stands in the map when a forward sonar has written a pixel
// there that is shallower than the vehicle's depth plus 1 m. The vehicle places the map by its estimate, so
// the scorer moves the body by the error of that estimate. It looks at the map every kLook_s.
#pragma once

#include <isobath/onboard/onboard_observer.hpp>
#include <isobath/scenario/scenario.hpp>
#include <string>
#include <vector>

namespace isobath {

struct MappedBody {
  std::string name;
  double first_echo_s = 0, first_echo_m = 0;
  double in_map_s = -1;  ///< -1: it never stood in the map
};

class MapDelayScorer : public SimulatedSource::TruthSink, public OnboardObserver {
 public:
  static constexpr double kLook_s = 0.3;
  /// `range_cap_m`: longest accepted range.
  MapDelayScorer(const Simulator& simulator, double range_cap_m);

  void on_truth(const EchoTruth&) override {}
  void on_truth(const TrueMotion& motion) override { X_WB_ = motion.state.X_WB; }
  void on_event(const Event& event) override;
  void on_mapped(Time time, const Pipeline& pipeline, const DepthModel& depths, const VoxelModel& voxels) override;

  /// The bodies that were heard, in the order of the scene.
  [[nodiscard]] std::vector<MappedBody> bodies() const;

 private:
  struct Watch {
    MappedBody body;
    bool heard = false;
    double tolerance_m = 0;
  };
  void hear(const RangeReading& reading);
  [[nodiscard]] bool stands(const DepthModel& depths, std::size_t body, double tolerance_m) const;

  const Simulator& simulator_;
  double range_cap_m_;
  std::vector<Watch> watches_;
  Pose X_WB_;                                        ///< true
  Eigen::Vector2d error_ = Eigen::Vector2d::Zero();  ///< of the estimated position
  double next_look_s_ = 0;
};

}  // namespace isobath
