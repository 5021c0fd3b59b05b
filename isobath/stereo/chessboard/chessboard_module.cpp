#include <isobath/stereo/chessboard/chessboard_module.hpp>
#include <opencv2/calib3d.hpp>
#include <opencv2/imgproc.hpp>

namespace {

using Corners = std::vector<cv::Point2f>;

bool find_corners(const isobath::ChessboardPairs& pairs, const std::uint8_t* samples, Corners& corners) {
  const cv::Mat grey(pairs.height, pairs.width, CV_8UC1, const_cast<std::uint8_t*>(samples));
  const cv::Size board(pairs.columns, pairs.rows);
  if (!cv::findChessboardCorners(grey, board, corners)) return false;
  cv::cornerSubPix(grey, corners, {11, 11}, {-1, -1}, {cv::TermCriteria::EPS + cv::TermCriteria::COUNT, 40, 1e-3});
  return true;
}

void copy_out(const cv::Mat& from, double* to, int count) {
  const cv::Mat flat = from.reshape(1, 1);
  for (int i = 0; i < count && i < flat.cols; ++i) to[i] = flat.at<double>(0, i);
}

}  // namespace

extern "C" bool isobath_calibrate_pair(const isobath::ChessboardPairs& pairs, isobath::ChessboardResult& result,
                                       std::string& why) try {
  std::vector<cv::Point3f> board;
  for (int row = 0; row < pairs.rows; ++row) {
    for (int column = 0; column < pairs.columns; ++column) {
      board.emplace_back(static_cast<float>(column * pairs.square_m), static_cast<float>(row * pairs.square_m), 0.0F);
    }
  }
  std::vector<Corners> left, right;
  for (std::size_t i = 0; i < pairs.left.size(); ++i) {
    Corners a, b;
    if (!find_corners(pairs, pairs.left[i], a) || !find_corners(pairs, pairs.right[i], b)) continue;
    left.push_back(a);
    right.push_back(b);
  }
  result.used = static_cast<int>(left.size());
  if (result.used < 3) {
    why = "the whole board is seen by both cameras in " + std::to_string(result.used) + " pairs";
    return false;
  }
  const std::vector<std::vector<cv::Point3f>> boards(left.size(), board);
  const cv::Size size(pairs.width, pairs.height);
  cv::Mat M1, D1, M2, D2, R, T, E, F, rotations, places;
  cv::calibrateCamera(boards, left, size, M1, D1, rotations, places);
  cv::calibrateCamera(boards, right, size, M2, D2, rotations, places);
  result.rms_px =
      cv::stereoCalibrate(boards, left, right, M1, D1, M2, D2, size, R, T, E, F, cv::CALIB_USE_INTRINSIC_GUESS,
                          {cv::TermCriteria::EPS + cv::TermCriteria::COUNT, 100, 1e-6});
  copy_out(M1, result.M1, 9);
  copy_out(D1, result.D1, 5);
  copy_out(M2, result.M2, 9);
  copy_out(D2, result.D2, 5);
  copy_out(R, result.R, 9);
  copy_out(T, result.T, 3);
  return true;
} catch (const std::exception& problem) {
  why = problem.what();
  return false;
}
