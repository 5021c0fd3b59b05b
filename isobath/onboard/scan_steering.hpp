// ScanSteering: steers a scanning sonar by what the spherical grid is uncertain of (Auran, Silven 1995, 2, 3.2 and 5;
// ledger S4-40, S4-41). Sweeps of the whole sector and of a part of it take turns: the whole sector, because new
// obstacles appear anywhere; a part, chosen by ScanControl, because there an echo tells most.
//
// The whole sector is that of the first sweep. A head that turns all round is steered, too. Of several heads only the
// first that is heard is steered. Nothing is steered unless the configuration asks for it. One thread.
#pragma once

#include <isobath/base/config.hpp>
#include <isobath/geometry/pose.hpp>
#include <isobath/perception/scan_control.hpp>
#include <isobath/sonar/ping.hpp>
#include <isobath/sonar/scan_command.hpp>
#include <optional>

namespace isobath {

struct ScanSteeringConfig {
  bool on = false;
  ScanLimits limits{.sector = Angle::degrees(40), .height = Angle::degrees(20)};
};
std::vector<Field> fields(ScanSteeringConfig& config);

class ScanSteering {
 public:
  explicit ScanSteering(const ScanSteeringConfig& config = {}) : config_(config), control_(config.limits) {}

  void on_ping(const Ping& ping);
  /// Call at the end of a scan. The command for the next sweep; empty: it was not the head's, or the sweep goes on.
  std::optional<ScanCommand> on_sweep(const SphericalGrid& grid, const Pose& X_WB);

 private:
  ScanSteeringConfig config_;
  ScanControl control_;
  [[nodiscard]] bool is_head(const Ping& ping) const;

  std::optional<Pose> X_BS_;         ///< of the head that is steered
  Angle first_, last_;               ///< ends of the whole sector, in S; unwrapped
  Angle now_, step_;                 ///< azimuth of the last ping, in S, unwrapped; size of the last step
  bool of_head_ = false;             ///< whether the last ping was the head's
  int pings_ = 0, whole_pings_ = 0;  ///< since the last command; of a whole sweep
  bool whole_known_ = false, part_ = false;
};

}  // namespace isobath
