#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <isobath/base/error.hpp>
#include <isobath/sim/camera_simulator.hpp>
#include <isobath/stereo/pair_fault.hpp>
#include <isobath/studies/stereo_study.hpp>
#include <limits>

namespace isobath {
namespace {

using Eigen::Vector3d;

constexpr float kUnknownRange = std::numeric_limits<float>::quiet_NaN();
constexpr double kReadingRange_m = 20;

void check_picture(const CameraImage& image, const std::filesystem::path& file) {
  if (!is_blank(image)) return;
  const auto [low, high] = std::minmax_element(image.samples.begin(), image.samples.end());
  throw Error(fmt::format("shows nothing: all its pixels have a brightness of {} to {} of 255", *low, *high),
              {file.string()}, {}, "a black or blank picture cannot be matched");
}

void check_pair(const CameraImage& left, const CameraImage& right, const StereoRequest& request) {
  if (left.width != right.width || left.height != right.height) {
    throw Error(fmt::format("the pictures differ in size: {} x {} and {} x {} pixels", left.width, left.height,
                            right.width, right.height),
                {request.right.string()});
  }
  if (left.width < kMinPairWidth || left.height < kMinPairHeight)
    throw Error(fmt::format("has only {} x {} pixels", left.width, left.height), {request.left.string()},
                fmt::format("at least {} x {}", kMinPairWidth, kMinPairHeight));
  check_picture(left, request.left);
  check_picture(right, request.right);
}

/// A calibration of OpenCV does not state the size of the pictures; one in TOML does.
void check_size(const CameraImage& image, CameraModel& camera, const StereoRequest& request) {
  if (camera.width == 0) {
    camera.width = image.width;
    camera.height = image.height;
  }
  if (camera.width == image.width && camera.height == image.height) return;
  throw Error(fmt::format("is of pictures of {} x {} pixels; these have {} x {}", camera.width, camera.height,
                          image.width, image.height),
              {request.calibration.front().string()});
}

/// The true z of each pixel of the picture that is matched, from the line of sight that the camera really has there.
std::vector<float> true_z(const CameraSimulator& simulator, const Pose& X_WL, const StereoPair& pair) {
  const StereoCalibration& c = pair.calibration;
  const Eigen::Matrix3d R_VL = c.moves ? Eigen::Matrix3d::Identity() : pair.geometry.R_VL();
  std::vector<float> all;
  for (int row = 0; row < pair.left.height; ++row) {
    for (int column = 0; column < pair.left.width; ++column) {
      const Eigen::Vector2d n =
          c.moves ? c.left.normalised({column, row}) : pair.geometry.in_air(Eye::kLeft, column, row);
      FlatPort::Ray ray{{0, 0, 0}, Vector3d(n.x(), n.y(), 1).normalized()};
      if (c.in_water) ray = c.port.ray(n);
      const auto hit = simulator.first_hit(X_WL * ray.origin, X_WL.rotation * ray.direction);
      all.push_back(hit ? static_cast<float>((R_VL * (X_WL.inverse() * *hit)).z()) : kUnknownRange);
    }
  }
  return all;
}

StereoPair simulated_pair(const StereoRequest& request, const StereoCalibration& calibration) {
  const Scene scene = load_scene(request.scene.string());
  const World world(scene);
  const CameraSimulator simulator(world, static_cast<std::uint64_t>(request.seed), request.matching.threads);
  const Pose X_WB{Rotation::from_heading(scene.vehicle.heading), scene.vehicle.start};
  const Pose X_WL = looking_ahead(X_WB);
  CameraOptics optics{calibration.left, calibration.in_water, calibration.port, calibration.light, 1};
  optics.isoluminant = calibration.isoluminant;
  StereoPair pair;
  pair.simulated = true;
  pair.left = simulator.take(optics, X_WL, 0);
  if (!calibration.moves) optics.model = calibration.right;
  pair.right = simulator.take(optics, X_WL * calibration.X_LR(), 1);
  pair.calibration = calibration;
  if (calibration.moves) {
    if (calibration.in_water)
      throw Error("a moving camera behind a port is not supported: set port.in_water = false",
                  {request.calibration.front().string()});
    pair.truth_z = true_z(simulator, X_WL, pair);
    return pair;
  }
  StereoCalibration for_ranges = calibration;
  if (request.in_air) for_ranges.in_water = false;
  pair.geometry = PairGeometry(for_ranges);
  pair.left = pair.geometry.rectify(Eye::kLeft, pair.left);
  pair.right = pair.geometry.rectify(Eye::kRight, pair.right);
  pair.truth_z = true_z(simulator, X_WL, pair);
  if (calibration.in_water) return pair;
  const RectifiedPair& rectified = pair.geometry.pair();
  for (const float z : pair.truth_z)
    pair.truth.push_back(static_cast<float>(rectified.focal_px * rectified.baseline_m / z));
  return pair;
}

double middle_of(std::vector<double> values) {
  if (values.empty()) return 0;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

struct FoundRange {
  int column, row;
  double z, truth;
};

RangeScore score_ranges(const std::vector<FoundRange>& found, double cx, double width) {
  RangeScore score;
  std::vector<double> off, off_axis, sizes;
  std::size_t close = 0;
  for (const FoundRange& one : found) {
    const double error = one.z / one.truth - 1;
    off.push_back(error);
    sizes.push_back(std::abs(error));
    if (std::abs(one.column - cx) < 0.1 * width) off_axis.push_back(error);
    close += std::abs(one.z - one.truth) < 0.05;
  }
  score.pixels = found.size();
  score.bias = middle_of(off);
  score.axis_bias = middle_of(off_axis);
  score.median_error = middle_of(sizes);
  score.within_5cm = found.empty() ? 0 : static_cast<double>(close) / static_cast<double>(found.size());
  return score;
}

/// The farthest half metre of true ranges of whose pixels at least half are valid.
double usable_range(std::span<const float> truth, std::span<const float> found) {
  constexpr double kBin_m = 0.5;
  std::vector<std::pair<int, int>> bins;  // pixels, valid
  for (std::size_t i = 0; i < truth.size(); ++i) {
    if (!std::isfinite(truth[i])) continue;
    const auto bin = static_cast<std::size_t>(truth[i] / kBin_m);
    if (bin >= bins.size()) bins.resize(bin + 1);
    ++bins[bin].first;
    bins[bin].second += std::isfinite(found[i]);
  }
  double farthest = 0;
  for (std::size_t i = 0; i < bins.size(); ++i) {
    if (bins[i].first >= 200 && 2 * bins[i].second >= bins[i].first) farthest = kBin_m * static_cast<double>(i + 1);
  }
  return farthest;
}

/// Throws where the pair fits better with left and right exchanged.
void check_eyes(const StereoPair& pair, const DisparityMap& map, const StereoRequest& request) {
  const auto eyes = exchanged_eyes(pair.left, pair.right, map, matching_of(request));
  if (!eyes) return;
  throw Error(
      fmt::format("left and right are exchanged: {:.0f} % of the pixels match this way round, {:.0f} % the other",
                  100 * eyes->valid, 100 * eyes->exchanged),
      {request.left.string()}, {}, "give the left picture first");
}

}  // namespace

std::vector<Section> sections(StereoRequest& request) {
  std::vector<Field> matching = fields(request.matching);
  matching.push_back(Field::flag("colour", &request.colour, "Whether colour pairs are matched in colour."));
  matching.push_back(Field::real("max_vertical_px", &request.max_vertical_px, {0.1, 100}, "pixels",
                                 "Median vertical disparity above which the calibration is refused."));
  return {{"stereo", "Dense matching of a rectified pair.", std::move(matching)},
          {"motion_stereo", "Ranges from one camera that moves.", fields(request.motion)}};
}

StereoConfig matching_of(const StereoRequest& request) {
  check(request.matching, "stereo");
  return request.matching;
}

namespace {

StereoPair pair_of(const StereoRequest& request) {
  matching_of(request);
  std::optional<StereoCalibration> calibration;
  if (!request.calibration.empty()) calibration = read_stereo_calibration(request.calibration);
  if (!request.scene.empty()) {
    if (!calibration || calibration->rectified.focal_px > 0)
      throw Error("a simulated pair needs the cameras", {request.scene.string()}, {}, "--calibration RIG.toml");
    return simulated_pair(request, *calibration);
  }
  StereoPair pair;
  pair.left = read_camera_image(request.left);
  pair.right = read_camera_image(request.right);
  check_pair(pair.left, pair.right, request);
  if (calibration && calibration->rectified.focal_px > 0) {
    pair.geometry = PairGeometry(calibration->rectified);
  } else if (calibration) {
    check_size(pair.left, calibration->left, request);
    if (!calibration->moves) {
      check_size(pair.right, calibration->right, request);
      if (request.in_air) calibration->in_water = false;
      pair.geometry = PairGeometry(*calibration);
      pair.left = pair.geometry.rectify(Eye::kLeft, pair.left);
      pair.right = pair.geometry.rectify(Eye::kRight, pair.right);
    }
  }
  if (calibration) pair.calibration = *calibration;
  if (request.truth.empty()) return pair;
  NumberMap truth = read_number_map(request.truth, request.truth_scale);
  if (truth.width != pair.left.width || truth.height != pair.left.height) {
    throw Error(fmt::format("the truth has {} x {} pixels, the pictures have {} x {}", truth.width, truth.height,
                            pair.left.width, pair.left.height),
                {request.truth.string()});
  }
  pair.truth = std::move(truth.values);
  return pair;
}

}  // namespace

StereoPair prepare_pair(const StereoRequest& request) {
  StereoPair pair = pair_of(request);
  if (pair.left.channels != pair.right.channels || (!request.colour && !pair.calibration.moves)) {
    pair.left = grey_of(pair.left);
    pair.right = grey_of(pair.right);
  }
  return pair;
}

StereoStudy study_pair(const StereoPair& pair, DisparityMap map, const StereoRequest& request) {
  StereoStudy study;
  study.map = std::move(map);
  check_eyes(pair, study.map, request);
  study.vertical = vertical_residual(pair.left, pair.right, study.map);
  if (study.vertical && study.vertical->median_absolute_px > request.max_vertical_px) {
    const std::filesystem::path& at = request.calibration.empty() ? request.right : request.calibration.front();
    throw Error(fmt::format("the rows of the pair miss each other by {:.1f} pixels (median)",
                            study.vertical->median_absolute_px),
                {at.string()}, fmt::format("up to {:g}", request.max_vertical_px),
                request.calibration.empty() ? "the pair is not rectified: give --calibration"
                                            : "the calibration is of other cameras, or a camera has moved");
  }
  if (!pair.truth.empty()) study.score = score_disparity(study.map, pair.truth, request.matching.disparities);
  study.points = stereo_points(study.map, pair.geometry, request.matching.sigma_disparity);
  study.readings =
      stereo_readings(study.map, pair.geometry, request.matching.sigma_disparity, {}, {}, 16, kReadingRange_m).size();
  if (pair.truth_z.empty()) return study;
  std::vector<FoundRange> found;
  for (const StereoPoint& point : study.points) {
    const float truth = pair.truth_z[study.map.index(point.column, point.row)];
    if (std::isfinite(truth)) found.push_back({point.column, point.row, point.p_V.z(), truth});
  }
  study.ranges = score_ranges(found, pair.geometry.pair().cx, pair.left.width);
  study.ranges->usable_range_m = usable_range(pair.truth_z, study.map.disparity);
  return study;
}

StereoStudy study_motion(const StereoPair& pair, const StereoRequest& request) {
  StereoStudy study;
  const StereoCalibration& c = pair.calibration;
  study.motion = motion_depth(pair.left, pair.right, c.left, c.R_AB, c.p_AB, request.motion);
  const MotionDepth& depth = *study.motion;
  std::vector<FoundRange> found, off_focus;
  std::vector<float> truth;
  const Vector3d ahead = c.p_AB.normalized();
  for (std::size_t i = 0; i < depth.depth_m.size(); ++i) {
    const int column = static_cast<int>(i % static_cast<std::size_t>(depth.width)) * depth.every;
    const int row = static_cast<int>(i / static_cast<std::size_t>(depth.width)) * depth.every;
    if (!pair.truth_z.empty()) {
      truth.push_back(pair.truth_z[static_cast<std::size_t>(row) * static_cast<std::size_t>(pair.left.width) +
                                   static_cast<std::size_t>(column)]);
    }
    if (!std::isfinite(depth.depth_m[i])) continue;
    const Eigen::Vector2d n = c.left.normalised({column, row});
    const double z = depth.depth_m[i];
    study.points.push_back({column, row, Vector3d(n.x() * z, n.y() * z, z), depth.sigma_m[i]});
    if (truth.empty() || !std::isfinite(truth.back())) continue;
    found.push_back({column, row, z, truth.back()});
    const double off = std::acos(std::min(1.0, std::abs(Vector3d(n.x(), n.y(), 1).normalized().dot(ahead))));
    if (off > Angle::degrees(10).radians()) off_focus.push_back(found.back());
  }
  if (truth.empty()) return study;
  study.ranges = score_ranges(found, c.left.cx, pair.left.width);
  study.ranges->usable_range_m = usable_range(truth, depth.depth_m);
  study.ranges_off_focus = score_ranges(off_focus, c.left.cx, pair.left.width);
  return study;
}

}  // namespace isobath
