// calibrate_chessboard: the calibration of two cameras from pairs of pictures of a chessboard (ledger S8-09), by
// OpenCV: corners to a fraction of a pixel, each camera by itself, then both together with their pose (Zhang 2000).
//
// OpenCV is optional; a module loads it (chessboard/chessboard_module.hpp). Throws Error without it, if the pictures
// differ in size, or if fewer than three pairs show the whole board.
#pragma once

#include <isobath/stereo/optics/camera_image.hpp>
#include <isobath/stereo/optics/stereo_calibration.hpp>

namespace isobath {

struct Chessboard {
  int columns = 9, rows = 6;  ///< inner corners
  double square_m = 0.025;
};

struct ChessboardCalibration {
  StereoCalibration calibration;
  int used = 0;       ///< pairs
  double rms_px = 0;  ///< of all corners
};

[[nodiscard]] bool has_chessboard_calibration();
ChessboardCalibration calibrate_chessboard(std::span<const CameraImage> left, std::span<const CameraImage> right,
                                           const Chessboard& board);

}  // namespace isobath
