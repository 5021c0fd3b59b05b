// CornerNavigation: corrects the navigation of a run by the corners of charted walls that its scanning sonar detects
// (Auran, Silven 1995, 3.2; ledger S4-49). The chart is that of the run: coast, structures and obstructions.
//
// The echoes of one sweep, each placed by the pose of its own time, become lines, arcs and corners (scan_shapes.hpp);
// corners that match the chart give a fix (corner_fix.hpp). The fix moves an offset, which is added to every later
// navigation fix. Everything on board gets the corrected fixes. A move of the offset is a jump of the position, and the
// maps around the vehicle move along (Pipeline).
//
// An echo is placed on the axis of its beam, at the near edge of its bin: the edge of a beam at -3 dB is mostly too
// weak to be detected. In harbour_loop.toml corners are then 0.16 m too far away on average, with a standard deviation
// of 0.13 m along the line of sight and 0.2 m across; with the nearest point of the full beam they are 0.5 m too far.
//
// The offset and its drift are estimated from all fixes (drift_estimate.hpp), so that between two corners the position
// keeps the drift that the earlier ones have shown. Until the first corner fix the uncertainty is that which the
// navigation states; later it is not larger. A position fix of the navigation itself, which halves its stated variance,
// sets the offset back to 0.
//
// A corner fix is refused if it would move the position by more than `max_move_m`, or if no corner of the sweep matches
// a corner of the chart although the chart has one in the sonar's range. Of several scanning sonars only the first that
// is heard counts.
//
// Not corrected: heading, depth, velocity. Corners need echoes of both faces in one sweep. A chart whose walls are
// wrong by less than the gate moves the vehicle by as much.
//
// Offsets are north, east in W, m. A function of its input. `correct` belongs to the source thread, `on_*` to the
// mapping thread; `outcome` may be called when both rest.
#pragma once

#include <isobath/base/config.hpp>
#include <isobath/onboard/drift_estimate.hpp>
#include <isobath/perception/corner_fix.hpp>
#include <isobath/sonar/sensor_table.hpp>
#include <isobath/vehicle/navigation.hpp>
#include <isobath/world/result_sinks.hpp>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

namespace isobath {

struct CornerNavigationConfig {
  bool on = false;
  double drift_share = 0.01;    ///< growth of the position error, per axis, as a share of the way
  double drift_length_m = 200;  ///< correlation length of that growth
  double gate = 3;              ///< standard deviations within which a corner matches the chart
  double max_move_m = 3;
};
std::vector<Field> fields(CornerNavigationConfig& config);

/// The corner fixes of a run.
struct CornerFixOutcome {
  std::uint64_t charted = 0;         ///< corners of the chart
  std::uint64_t sweeps = 0;          ///< sweeps in which a corner was detected
  std::uint64_t taken = 0;           ///< corner fixes
  std::uint64_t refused = 0;         ///< sweeps whose corners contradict the chart
  std::vector<double> last_moves_m;  ///< how far the last fixes moved the position, at most five, the newest last
  double farthest_move_m = 0;
  Eigen::Vector2d offset = Eigen::Vector2d::Zero();  ///< corrected less uncorrected position, at the end
  double sigma_m = 0;                                ///< standard deviation of the corrected position, each axis
};

/// A move of the position by corner fixes.
struct CornerMove {
  Eigen::Vector2d by = Eigen::Vector2d::Zero();
  int corners = 0;     ///< of the newest fix
  double sigma_m = 0;  ///< of the position before, root mean square distance
  int version = 0;     ///< of the offset, after it

  [[nodiscard]] bool surprises() const { return by.norm() > sigma_m; }
};
/// "2 corners of the chart move the position by 0.62 m, to north 0.50 m, east -0.37 m; ...".
std::string to_text(const CornerMove& move);

class CornerNavigation {
 public:
  /// `contrast`: least contrast of an echo (ping_quality.hpp).
  CornerNavigation(const CornerNavigationConfig& config, double contrast, std::vector<ChartedCorner> charted);

  /// Corrects a fix. Returns the move of the position since the last fix, if there was one: all earlier poses must move
  /// by it.
  std::optional<CornerMove> correct(Navigation& fix);

  /// All poses from now on contain this move.
  void follow(const CornerMove& move) { followed_ = move.version; }
  void on_ping(const PosedPing& posed);
  void on_jump(const Eigen::Vector3d& by_W);
  /// The sweep of the pings since the last call has ended.
  void on_sweep(bool posed);

  [[nodiscard]] CornerFixOutcome outcome() const;

 private:
  struct Echo {
    Eigen::Vector2d from;  ///< the sonar, W
    Angle bearing;
    double range_m;
  };
  void advance(const Navigation& fix);
  [[nodiscard]] PlaneScan scan_of_sweep() const;
  void take(const CornerFix& fix, const PlanePosition& believed);
  [[nodiscard]] bool charted_near(const Eigen::Vector2d& from) const;

  CornerNavigationConfig config_;
  double contrast_;
  std::vector<ChartedCorner> charted_;

  // The sweep; mapping thread.
  SensorTable heads_;
  std::vector<Echo> echoes_;
  Angle width_;                     ///< of the beam of the last ping
  double bin_m_ = 0, reach_m_ = 0;  ///< likewise
  int followed_ = 0;                ///< version of the offset that the poses of pings contain

  // The offset; both threads.
  mutable std::mutex mutex_;
  DriftEstimate drift_;
  bool corrected_ = false;            ///< by a corner fix, and not by the navigation since
  CornerMove move_;                   ///< the newest
  int told_ = 0;                      ///< version of the newest move that `correct` has returned
  std::optional<Navigation> anchor_;  ///< uncorrected fix up to which the way is counted
  double heading_variance_ = 0;       ///< as the navigation states it, rad2
  CornerFixOutcome counts_;
};

}  // namespace isobath
