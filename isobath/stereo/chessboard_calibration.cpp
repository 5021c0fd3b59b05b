#include <dlfcn.h>
#include <fmt/format.h>
#include <isobath/base/error.hpp>
#include <isobath/stereo/chessboard/chessboard_module.hpp>
#include <isobath/stereo/chessboard_calibration.hpp>

namespace isobath {
namespace {

CalibratePair* pair_calibrator() {
#ifdef ISOBATH_HAS_CHESSBOARD
  static CalibratePair* const calibrator = [] {
    void* module = dlopen("isobath_chessboard.so", RTLD_NOW | RTLD_LOCAL | RTLD_NODELETE);
    return module ? reinterpret_cast<CalibratePair*>(dlsym(module, "isobath_calibrate_pair")) : nullptr;
  }();
  return calibrator;
#else
  return nullptr;
#endif
}

void take_lens(const double (&matrix)[9], const double (&lens)[5], int width, int height, CameraModel& camera) {
  camera = {width, height, matrix[0], matrix[4], matrix[2], matrix[5], lens[0], lens[1], lens[2], lens[3], lens[4]};
}

}  // namespace

bool has_chessboard_calibration() { return pair_calibrator() != nullptr; }

ChessboardCalibration calibrate_chessboard(std::span<const CameraImage> left, std::span<const CameraImage> right,
                                           const Chessboard& board) {
  CalibratePair* const calibrate = pair_calibrator();
  if (!calibrate) {
    throw Error("cannot calibrate: this program was built without OpenCV, or isobath_chessboard.so is not found", {},
                {}, "on Debian install libopencv-calib3d-dev and build again");
  }
  ISOBATH_ASSERT(left.size() == right.size() && !left.empty());
  std::vector<CameraImage> grey;  // the pictures, left and right in turn
  for (std::size_t i = 0; i < left.size(); ++i) {
    grey.push_back(grey_of(left[i]));
    grey.push_back(grey_of(right[i]));
  }
  ChessboardPairs pairs;
  pairs.width = grey.front().width;
  pairs.height = grey.front().height;
  pairs.columns = board.columns;
  pairs.rows = board.rows;
  pairs.square_m = board.square_m;
  for (std::size_t i = 0; i < grey.size(); ++i) {
    if (grey[i].width != pairs.width || grey[i].height != pairs.height)
      throw Error(fmt::format("pair {} has another size than the first", i / 2 + 1));
    (i % 2 == 0 ? pairs.left : pairs.right).push_back(grey[i].samples.data());
  }
  ChessboardResult result;
  std::string why;
  if (!calibrate(pairs, result, why)) {
    throw Error("cannot calibrate: " + why, {}, "at least 3 pairs",
                fmt::format("the board is looked for with {} x {} inner corners", board.columns, board.rows));
  }
  ChessboardCalibration out;
  out.used = result.used;
  out.rms_px = result.rms_px;
  take_lens(result.M1, result.D1, pairs.width, pairs.height, out.calibration.left);
  take_lens(result.M2, result.D2, pairs.width, pairs.height, out.calibration.right);
  out.calibration.R_RL = Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(result.R);
  out.calibration.p_RL = Eigen::Map<const Eigen::Vector3d>(result.T);
  return out;
}

}  // namespace isobath
