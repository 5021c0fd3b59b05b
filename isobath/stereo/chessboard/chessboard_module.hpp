// The interface of isobath_chessboard.so, the module that links OpenCV, so that only calibrations load it. Both sides
// exchange plain data; the module uses nothing else of Isobath. The loader searches for it as for isobath_vdb.so.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace isobath {

struct ChessboardPairs {
  int width = 0, height = 0;  ///< of all pictures, pixels
  int columns = 9, rows = 6;  ///< inner corners of the board
  double square_m = 0.025;
  std::vector<const std::uint8_t*> left, right;  ///< grey pictures, row by row
};

/// Matrices row by row; lenses: k1, k2, p1, p2, k3; p_R = R p_L + T.
struct ChessboardResult {
  int used = 0;       ///< pairs in which both cameras see the whole board
  double rms_px = 0;  ///< of all corners
  double M1[9]{}, D1[5]{}, M2[9]{}, D2[5]{}, R[9]{}, T[3]{};
};

/// The module's only function, isobath_calibrate_pair. False if it fails; `why` then holds the reason.
using CalibratePair = bool(const ChessboardPairs& pairs, ChessboardResult& result, std::string& why);

}  // namespace isobath
