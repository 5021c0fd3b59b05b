#include <algorithm>
#include <isobath/base/error.hpp>
#include <isobath/stereo/pair_ranger.hpp>
#include <isobath/stereo/stereo_ranges.hpp>
#include <isobath/stereo/vertical_residual.hpp>

namespace isobath {
namespace {

/// The picture moved up by some rows; what is not known repeats the edge.
CameraImage moved_up(const CameraImage& image, int rows) {
  CameraImage moved(image.width, image.height, image.channels);
  const auto row_bytes = static_cast<std::ptrdiff_t>(image.width) * image.channels;
  for (int row = 0; row < image.height; ++row) {
    const int from = std::clamp(row + rows, 0, image.height - 1);
    std::copy_n(image.samples.begin() + from * row_bytes, row_bytes, moved.samples.begin() + row * row_bytes);
  }
  return moved;
}

/// Whether the pair, of which few pixels match, matches better with the right picture some rows higher or lower. Rows
/// that miss each other by so much leave vertical_residual too few matches.
bool rows_are_apart(const CameraImage& left, const CameraImage& right, const DisparityMap& map,
                    const StereoConfig& config) {
  constexpr double kFew = 0.4, kMore = 1.3, kEnough = 0.2;
  const double valid = map.share_of(PixelState::kValid);
  if (valid >= kFew) return false;
  DenseMatcher matcher(config);
  for (const int rows : {-6, -4, -2, 2, 4, 6}) {
    const double moved = matcher.match(left, moved_up(right, rows)).share_of(PixelState::kValid);
    if (moved > kMore * valid && moved > kEnough) return true;
  }
  return false;
}

/// Turns right, down, forward into forward, starboard, down.
Eigen::Matrix3d forward_first() { return (Eigen::Matrix3d() << 0, 0, 1, 1, 0, 0, 0, 1, 0).finished(); }

PairGeometry geometry_of(const StereoCalibration& calibration) {
  if (calibration.moves) throw Error("the calibration is of one camera that moves", {}, "two cameras side by side");
  if (calibration.rectified.focal_px > 0) return PairGeometry(calibration.rectified);
  if (calibration.left.width == 0) return PairGeometry(RectifiedPair{});  // until the first pair states the size
  return PairGeometry(calibration);
}

}  // namespace

std::vector<Field> fields(PairRangerConfig& c) {
  std::vector<Field> all = fields(c.matching);
  all.push_back(Field::integer("block_px", &c.block_px, {1, 256}, "pixels",
                               "Side of a block of pixels that becomes one range; larger ones are fewer and wider."));
  all.push_back(Field::real("max_range_m", &c.max_range_m, {0.1, 1000}, "m", "Ranges beyond this are left out."));
  all.push_back(Field::real("max_vertical_px", &c.max_vertical_px, {0.1, 100}, "pixels",
                            "Median vertical disparity above which a pair is refused."));
  all.push_back(Field::flag("colour", &c.colour, "Whether colour pairs are matched in colour."));
  return all;
}

PairRanger::PairRanger(const PairRangerConfig& config, const StereoCalibration& calibration, const Pose& X_BL)
    : config_(config),
      calibration_(calibration),
      geometry_(geometry_of(calibration)),
      X_BL_(X_BL),
      X_BV_(X_BL),
      matcher_(config.matching) {
  check(config.matching, "cameras");
}

PairFault PairRanger::update(const CameraPair& pair) {
  swath_ = {};
  if (const PairFault fault = check(pair.left, pair.right, &calibration_); fault != PairFault::kNone) return fault;
  if (calibration_.left.width == 0 && calibration_.rectified.focal_px <= 0) {  // OpenCV's files do not state it
    calibration_.left.width = calibration_.right.width = pair.left.width;
    calibration_.left.height = calibration_.right.height = pair.left.height;
    geometry_ = PairGeometry(calibration_);
  }
  if (geometry_.rectifies()) {
    const Eigen::Matrix3d R_LV = forward_first() * geometry_.R_VL().transpose() * forward_first().transpose();
    X_BV_ = X_BL_ * Pose{Rotation::from_matrix(R_LV), Eigen::Vector3d::Zero()};
  }
  left_ = geometry_.rectify(Eye::kLeft, pair.left);
  right_ = geometry_.rectify(Eye::kRight, pair.right);
  if (!config_.colour || left_.channels != right_.channels) {
    left_ = grey_of(left_);
    right_ = grey_of(right_);
  }
  matcher_.match(left_, right_, map_);
  if (const PairFault fault = check_match(); fault != PairFault::kNone) return fault;
  swath_ = stereo_swath(map_, geometry_, config_.matching.sigma_disparity, X_BV_, pair.time, config_.block_px,
                        config_.max_range_m);
  return swath_.soundings.empty() ? PairFault::kNoRange : PairFault::kNone;
}

/// Eyes and rows are compared until a pair of this rig has matched: they do not change places during a run, and turbid
/// pictures, which match little, would cost twice the time.
PairFault PairRanger::check_match() {
  if (!rows_known_ && exchanged_eyes(left_, right_, map_, config_.matching)) return PairFault::kExchanged;
  const auto rows = vertical_residual(left_, right_, map_);
  if (!rows) {
    const bool apart = !rows_known_ && rows_are_apart(left_, right_, map_, config_.matching);
    return apart ? PairFault::kRowsMiss : PairFault::kNone;
  }
  if (rows->median_absolute_px > config_.max_vertical_px) return PairFault::kRowsMiss;
  rows_known_ = true;
  return PairFault::kNone;
}

}  // namespace isobath
