// Pairs of pictures of a simulated scene, from known poses: what tests of ranging, of motion and of folders look at.
#pragma once

#include <isobath/sim/camera_simulator.hpp>
#include <isobath/sim/scene.hpp>
#include <isobath/stereo/optics/camera_pair.hpp>
#include <isobath/stereo/optics/stereo_calibration.hpp>
#include <string>

namespace isobath::test {

/// A slanted wall with a boulder before it, over a flat bottom.
inline const char* const kWallAndBoulder = R"(
[scene]
title = "wall and boulder"
[bottom]
kind = "flat"
depth = 6.2
extent_m = 30
[vehicle]
start = [0, 0, 5]
[[box]]
name = "wall"
centre = [2.8, 0, 5.2]
size = [0.6, 6, 4]
heading_deg = 12
[[sphere]]
name = "boulder"
centre = [1.7, 0.3, 5.3]
radius = 0.3
)";

/// Two pinhole cameras side by side, 160 x 120 pixels, 12 cm apart, in air unless `in_water`.
inline StereoCalibration small_cameras(bool in_water = false) {
  StereoCalibration c;
  for (CameraModel* camera : {&c.left, &c.right}) {
    camera->width = 160;
    camera->height = 120;
    camera->fx = camera->fy = in_water ? 105 : 140;
    camera->cx = 79.5;
    camera->cy = 59.5;
  }
  c.in_water = in_water;
  return c;
}

class SimulatedPairs {
 public:
  explicit SimulatedPairs(const std::string& scene = kWallAndBoulder, StereoCalibration calibration = small_cameras())
      : cameras(std::move(calibration)),
        scene_(parse_scene(scene, "pairs.toml")),
        world_(scene_),
        simulator_(world_, 7, 1) {}

  /// `X_WL`: axes forward, starboard, down of the left camera.
  [[nodiscard]] CameraPair at(const Pose& X_WL, double t_s = 0) {
    CameraOptics optics{cameras.left, cameras.in_water, cameras.port, cameras.light, 1};
    const Pose X_WC = looking_ahead(X_WL);
    CameraPair pair{Time(seconds(t_s)), simulator_.take(optics, X_WC, exposures_), {}};
    optics.model = cameras.right;
    pair.right = simulator_.take(optics, X_WC * cameras.X_LR(), exposures_ + 1);
    exposures_ += 2;
    return pair;
  }
  [[nodiscard]] const World& world() const { return world_; }
  StereoCalibration cameras;

 private:
  Scene scene_;
  World world_;
  CameraSimulator simulator_;
  std::uint64_t exposures_ = 0;
};

}  // namespace isobath::test
