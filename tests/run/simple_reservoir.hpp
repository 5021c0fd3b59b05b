// SimpleReservoir: a second, deliberately simple maker of echoes, so that simulator and estimator cannot agree in
// error. It shares no code with isobath/sim: a vehicle with a sector-scanning sonar passes two mooring buoys and an
// embankment, as in the Pandan trials (Ganesan 2015, 4.1 and 6.2; ledger S6-01, S6-60).
//
// Echoes are formed in the horizontal plane, in closed form: buoys are point targets, the embankment is a Lambert line;
// the beam is Gaussian across (-3 dB at half its width); the background is Gaussian as measured at the lake (S6-D01);
// now and then a spurious return shows up once (S6-30). The first bins ring with the transmission (S6-09). Everything
// comes from one seed. Intensities are 8 bits; positions are in W, m; the vehicle stays at 0.5 m depth.
#pragma once

#include <Eigen/Core>
#include <isobath/base/random.hpp>
#include <isobath/sonar/ping.hpp>
#include <isobath/vehicle/navigation.hpp>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

namespace isobath::test {

struct SimpleReservoirConfig {
  int seed = 1;
  double duration_s = 20;
  double speed = 1.5;            ///< m/s over ground
  double noise_mean = 40;        ///< counts
  double noise_sigma = 12;       ///< counts
  double snr_db = 13;            ///< of a buoy on the axis, A^2 / sigma^2 (equation 4.1)
  double spurious_share = 0.05;  ///< pings with one spurious return
};

class SimpleReservoir {
 public:
  explicit SimpleReservoir(const SimpleReservoirConfig& config);

  /// The vehicle's fix and the ping that it transmits there; empty when the duration is over.
  std::optional<std::pair<Navigation, Ping>> step();

  /// Truth, for those who judge results: centres of the buoys, and the embankment as a line (N, E; m).
  [[nodiscard]] static const std::vector<Eigen::Vector2d>& buoys();
  [[nodiscard]] static const std::vector<Eigen::Vector2d>& embankment();

 private:
  [[nodiscard]] Pose body_at(double t) const;
  void add_buoys(const Pose& X_WB, Angle azimuth, std::vector<double>& profile) const;
  void add_embankment(const Pose& X_WB, Angle azimuth, std::vector<double>& profile) const;

  SimpleReservoirConfig config_;
  Random random_;
  std::vector<std::shared_ptr<const BeamFan>> fans_;  ///< one a bearing
  int ping_ = 0;
};

}  // namespace isobath::test
