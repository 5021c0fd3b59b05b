// CameraNavigation: carries the position of a vehicle on what a pair of cameras sees, while its own fixes are less sure
// (ledger S7-15: station keeping with optical sensing).
//
// A filter holds north, east and their rates. Each pair of pictures is compared with a key pair (PairMotion): the
// motion since the key, turned into W by the attitude that the fix states, gives a position relative to where the key
// was taken. The key stays as long as most of its points are seen, so that a vehicle that holds its station does not
// drift; a new one adds the variance of its place. Between pairs the velocity is kept, with white acceleration.
//
// A fix whose stated position is surer than the filter's passes unchanged, and the filter, with its key, moves to it:
// it begins where the last sure fix was. A less sure fix gets the filter's position in the plane, velocity in the plane
// and their covariance; its depth and attitude stay. A fix that states no covariance counts as exact.
//
// Frames: W, B; X_BV as PairRanger. One thread, events in the order of time. A function of the events.
#pragma once

#include <isobath/base/field.hpp>
#include <isobath/stereo/pair_motion.hpp>
#include <isobath/stereo/pair_ranger.hpp>
#include <isobath/vehicle/navigation.hpp>
#include <optional>
#include <vector>

namespace isobath {

struct CameraNavigationConfig {
  bool on = true;
  double acceleration = 0.1;
  Angle rotation_sigma = Angle::degrees(0.5);
  double min_seen_share = 0.5;
  PairMotionConfig motion;
};
std::vector<Field> fields(CameraNavigationConfig& config);

class CameraNavigation {
 public:
  struct Counts {
    std::uint64_t pairs = 0;  ///< that were compared with a key
    std::uint64_t moved = 0;  ///< whose motion was found
    std::uint64_t keys = 0;
    std::uint64_t carried = 0;  ///< fixes that got the position of the pictures
  };

  explicit CameraNavigation(const CameraNavigationConfig& config) : config_(config) {}

  /// The fix as the vehicle knows it by its cameras, too.
  void correct(Navigation& fix);
  /// After an update of the ranger without a fault.
  void on_pair(const PairRanger& ranger, Time time);
  [[nodiscard]] const Counts& counts() const { return counts_; }

 private:
  using Matrix4 = Eigen::Matrix4d;
  void predict(Time to);
  void follow(const Navigation& fix, double variance);
  [[nodiscard]] double variance() const;
  [[nodiscard]] Pose X_WV_now(const PairRanger& ranger) const;
  void take_key(const PairRanger& ranger);
  [[nodiscard]] bool compare(const PairRanger& ranger);

  CameraNavigationConfig config_;
  std::optional<Navigation> fix_;                ///< the last, as it came
  Eigen::Vector4d x_ = Eigen::Vector4d::Zero();  ///< north, east, their rates
  Matrix4 P_ = Matrix4::Zero();                  ///< relative to the key
  double anchor_variance_ = 0;                   ///< of the place of the key, an axis, m2
  Time time_{};
  std::optional<MotionKey> key_;
  Pose X_WK_;  ///< where the key was taken
  Counts counts_;
};

}  // namespace isobath
