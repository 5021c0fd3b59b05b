// CameraSimulator: pictures of a scene as a camera under water takes them (ledger S8-10 S8-11 S8-13).
//
// Each pixel is the mean of 2 x 2 rays, bent by the flat port if there is one, traced to the nearest surface (World).
// Its colour is a texture fixed to the place (value noise of five wavelengths from 1 to 20 cm, each channel its own),
// lit from the camera, then dimmed and veiled by the water (water_light.hpp). Sensor noise is white. The same seed
// gives the same bytes on any number of threads. Frames: C as camera_model.hpp. Where no surface is within kFar there
// is only the veil.
#pragma once

#include <isobath/geometry/pose.hpp>
#include <isobath/sim/world.hpp>
#include <isobath/stereo/optics/camera_image.hpp>
#include <isobath/stereo/optics/camera_model.hpp>
#include <isobath/stereo/optics/flat_port.hpp>
#include <isobath/stereo/optics/water_light.hpp>

namespace isobath {

struct CameraOptics {
  CameraModel model;
  bool through_port = false;
  FlatPort port;
  WaterLight light;
  double noise = 1;  ///< standard deviation, grey levels
  /// Red and green of a texture change against each other, so that its brightness (grey_of) stays.
  bool isoluminant = false;
};

/// The pose of a camera that looks ahead: right is starboard, down is down, z is forward.
Pose looking_ahead(const Pose& X_WB);

class CameraSimulator {
 public:
  static constexpr double kFar = 60;  ///< m

  CameraSimulator(const World& world, std::uint64_t seed, int threads)
      : world_(world), seed_(seed), threads_(threads) {}

  /// `exposure` distinguishes the noise of pictures. Colour.
  [[nodiscard]] CameraImage take(const CameraOptics& optics, const Pose& X_WC, std::uint64_t exposure) const;
  /// Where a line of sight ends; empty: nowhere.
  [[nodiscard]] std::optional<Eigen::Vector3d> first_hit(const Eigen::Vector3d& p_W, const Eigen::Vector3d& u_W) const;

 private:
  [[nodiscard]] Eigen::Vector3d colour(const CameraOptics& optics, const Pose& X_WC,
                                       const Eigen::Vector2d& pixel) const;
  [[nodiscard]] Eigen::Vector3d texture(const Eigen::Vector3d& p_W) const;  ///< red, green, blue, 0..1

  const World& world_;
  std::uint64_t seed_;
  int threads_;
};

}  // namespace isobath
