// CameraRig: a pair of cameras of a vehicle as a sensor: each pair of pictures becomes a Swath of ranges, and its
// motion carries the fixes (PairRanger, CameraNavigation; ledger S8-07 S7-15 S1-79).
#pragma once

#include <isobath/cameras/camera_navigation.hpp>
#include <isobath/event/event.hpp>
#include <isobath/stereo/pair_ranger.hpp>
#include <map>
#include <string>

namespace isobath {

/// The settings of cameras: [cameras].
struct CamerasConfig {
  PairRangerConfig ranger;
  CameraNavigationConfig navigation;
};
std::vector<Field> fields(CamerasConfig& config);

class CameraRig {
 public:
  /// As PairRanger. Throws Error.
  CameraRig(const CamerasConfig& config, const StereoCalibration& calibration, const Pose& X_BL)
      : ranger_(config.ranger, calibration, X_BL), navigation_(config.navigation) {}

  /// The ranges of the pair; empty: it has none, and `fault` says why.
  std::optional<Swath> on_pair(const CameraPair& pair);
  [[nodiscard]] PairFault fault() const { return fault_; }
  void on_fix(Navigation& fix) { navigation_.correct(fix); }
  /// What the rig has found so far, for SourceReport::details.
  void describe(const std::string& name, std::map<std::string, std::string>& details) const;

 private:
  PairRanger ranger_;
  CameraNavigation navigation_;
  PairFault fault_ = PairFault::kNone;
  std::uint64_t pairs_ = 0, ranged_ = 0, ranges_ = 0;
};

}  // namespace isobath
