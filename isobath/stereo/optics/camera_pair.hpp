// CameraPair: what two cameras side by side have taken at one time, as they took it.
#pragma once

#include <isobath/base/time.hpp>
#include <isobath/stereo/optics/camera_image.hpp>

namespace isobath {

struct CameraPair {
  Time time;
  CameraImage left, right;
  std::size_t rig = 0;  ///< which pair of the vehicle, if it has several
};

}  // namespace isobath
