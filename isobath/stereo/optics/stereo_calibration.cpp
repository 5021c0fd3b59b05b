#include <algorithm>
#include <charconv>
#include <cmath>
#include <isobath/stereo/optics/stereo_calibration.hpp>
#include <map>

namespace isobath {
namespace {

using Eigen::Matrix3d, Eigen::Vector3d;

/// What TOML gives, before it is a calibration.
struct CalibrationText {
  StereoCalibration c;
  double R[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1};
  double motion_deg[3] = {0, 0, 0};

  Schema schema() {
    Schema all;
    all.sections = {
        {"left", "The left camera, or the only one.", fields(c.left)},
        {"right", "The right camera.", fields(c.right)},
        {"pair",
         "How the right camera stands: p_R = rotation p_L + translation.",
         {Field::numbers("rotation", R, 9, {-1, 1}, "1", "Rotation matrix, row by row."),
          Field::numbers("translation_m", c.p_RL.data(), 3, {-100, 100}, "m",
                         "Right, down, forward; the first is negative, because the left camera is to the left.")}},
        {"port", "The flat port of underwater cameras.", port_fields()},
        {"light", "Light in the water, and on the textures, of simulated pictures.", light_fields()},
        {"motion",
         "One camera that moves between the pictures.",
         {Field::numbers("translation_m", c.p_AB.data(), 3, {-100, 100}, "m",
                         "From the first to the second position: right, down, forward in the first picture."),
          Field::numbers("rotation_deg", motion_deg, 3, {-180, 180}, "deg",
                         "Turn from the first to the second picture: about the axes right, down, forward, as one "
                         "rotation vector.")}},
        {"rectified",
         "A pair that is rectified already.",
         {Field::real("focal_px", &c.rectified.focal_px, {0, 1e6}, "pixels", "Focal length; 0: not rectified."),
          Field::real("cx", &c.rectified.cx, {-1e5, 1e5}, "pixels", "Where the optical axis meets the left picture."),
          Field::real("cy", &c.rectified.cy, {-1e5, 1e5}, "pixels", "The same from the top."),
          Field::real("baseline_m", &c.rectified.baseline_m, {0, 100}, "m", "Distance of the cameras."),
          Field::real("offset_px", &c.rectified.offset_px, {-1e4, 1e4}, "pixels",
                      "What is added to a disparity before it becomes a range.")}}};
    return all;
  }
  std::vector<Field> port_fields() {
    std::vector<Field> all = {
        Field::flag("in_water", &c.in_water, "Whether the cameras look through a port into water.")};
    for (Field& field : fields(c.port)) all.push_back(std::move(field));
    all.push_back(Field::real("nominal_range_m", &c.nominal_range_m, {0.1, 100}, "m",
                              "Range at which the rows of the rectified pair match exactly."));
    return all;
  }
  std::vector<Field> light_fields() {
    std::vector<Field> all = fields(c.light);
    all.push_back(Field::flag("isoluminant", &c.isoluminant,
                              "Whether textures have one brightness and differ in red and green only."));
    return all;
  }
  StereoCalibration finish(const std::string& file) {
    const Matrix3d rotation = Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(R);
    if (!Rotation::valid(rotation)) throw Error("is not a rotation", {file, {}, {}, {}, "pair.rotation"});
    c.R_RL = Rotation::from_matrix(rotation).matrix();
    const Vector3d turn = Vector3d(motion_deg[0], motion_deg[1], motion_deg[2]) * (std::acos(-1.0) / 180);
    c.R_AB = Rotation::exp(turn).matrix();
    c.moves = c.p_AB.norm() > 0;
    return c;
  }
};

/// The matrices and numbers of OpenCV's YAML, by name. Only what it writes itself: "name: number", and
/// "name: !!opencv-matrix" with rows, cols and data.
using Matrices = std::map<std::string, std::vector<double>>;

std::vector<double> numbers_in(std::string_view text, const Place& place) {
  std::vector<double> all;
  const char* at = text.data();
  const char* const end = at + text.size();
  while (at != end) {
    if (*at == ' ' || *at == ',' || *at == '\n' || *at == '\r') {
      ++at;
      continue;
    }
    double value = 0;
    const auto read = std::from_chars(at, end, value);
    if (read.ec != std::errc() || !std::isfinite(value)) throw Error("has a number that cannot be read", place);
    all.push_back(value);
    at = read.ptr;
    if (at != end && *at == '.') ++at;  // "1." is how OpenCV writes 1
  }
  return all;
}

Matrices matrices_of(const std::string& text, const std::string& file) {
  Matrices all;
  std::size_t at = 0;
  std::uint64_t line = 1;
  while (at < text.size()) {
    const std::size_t end = std::min(text.find('\n', at), text.size());
    const std::string_view row(text.data() + at, end - at);
    const std::size_t colon = row.find(": !!opencv-matrix");
    if (colon != std::string_view::npos) {
      const std::string name(row.substr(0, colon));
      const Place place{file, {}, line, {}, name};
      const std::size_t open = text.find("data: [", end), close = text.find(']', end);
      if (open == std::string::npos || close == std::string::npos || close < open)
        throw Error("a matrix without data: [ ... ]", place);
      all[name] = numbers_in(std::string_view(text).substr(open + 7, close - open - 7), place);
    }
    at = end + 1;
    ++line;
  }
  return all;
}

void take_camera(const Matrices& m, const std::string& matrix, const std::string& lens, const std::string& file,
                 CameraModel& camera) {
  const auto k = m.find(matrix), d = m.find(lens);
  if (k == m.end() || k->second.size() != 9)
    throw Error("has no camera matrix of nine numbers", {file, {}, {}, {}, matrix}, {},
                "OpenCV's stereo_calib writes M1, D1, M2 and D2 to intrinsics.yml");
  camera.fx = k->second[0];
  camera.cx = k->second[2];
  camera.fy = k->second[4];
  camera.cy = k->second[5];
  if (!(camera.fx > 0 && camera.fy > 0)) throw Error("a focal length is not positive", {file, {}, {}, {}, matrix});
  if (d == m.end()) return;
  if (d->second.size() > 5 && std::any_of(d->second.begin() + 5, d->second.end(), [](double v) { return v != 0; }))
    throw Error("has a lens model with more than five coefficients", {file, {}, {}, {}, lens}, "k1, k2, p1, p2, k3");
  double* const to[5] = {&camera.k1, &camera.k2, &camera.p1, &camera.p2, &camera.k3};
  for (std::size_t i = 0; i < std::min<std::size_t>(5, d->second.size()); ++i) *to[i] = d->second[i];
}

StereoCalibration from_opencv(const Matrices& m, const std::string& file) {
  StereoCalibration c;
  c.left.width = c.right.width = 0;  // not stated
  take_camera(m, "M1", "D1", file, c.left);
  take_camera(m, "M2", "D2", file, c.right);
  const auto R = m.find("R"), T = m.find("T");
  if (R == m.end() || T == m.end() || R->second.size() != 9 || T->second.size() != 3)
    throw Error("does not say how the right camera stands (R and T)", {file}, {},
                "OpenCV's stereo_calib writes them to extrinsics.yml; give both files");
  CalibrationText text;
  text.c = c;
  std::copy(R->second.begin(), R->second.end(), text.R);
  text.c.p_RL = Vector3d(T->second[0], T->second[1], T->second[2]);
  return text.finish(file);
}

}  // namespace

Pose StereoCalibration::X_LR() const {
  if (moves) return {Rotation::from_matrix(R_AB), p_AB};
  return Pose{Rotation::from_matrix(R_RL), p_RL}.inverse();
}

StereoCalibration read_stereo_calibration(std::span<const std::filesystem::path> files) {
  ISOBATH_ASSERT(!files.empty());
  Matrices matrices;
  for (const std::filesystem::path& file : files) {
    const std::string text = text_of_file(file.string());
    if (text.starts_with("%YAML")) {
      matrices.merge(matrices_of(text, file.string()));
      continue;
    }
    if (files.size() > 1) throw Error("is no YAML file of OpenCV, so it must be the only calibration", {file.string()});
    CalibrationText toml;
    Schema schema = toml.schema();
    read_toml(text, file.string(), schema);
    return toml.finish(file.string());
  }
  return from_opencv(matrices, files.back().string());
}

std::string stereo_calibration_toml(const StereoCalibration& calibration) {
  CalibrationText text;
  text.c = calibration;
  Eigen::Map<Eigen::Matrix<double, 3, 3, Eigen::RowMajor>> rotation(text.R);
  rotation = calibration.R_RL;
  Schema schema = text.schema();
  std::erase_if(schema.sections,
                [](const Section& s) { return s.name != "left" && s.name != "right" && s.name != "pair"; });
  return write_toml(schema.sections, true);
}

std::string stereo_calibration_template() {
  CalibrationText text;
  return write_template(text.schema());
}

}  // namespace isobath
