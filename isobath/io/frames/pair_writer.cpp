#include <fmt/format.h>
#include <isobath/base/error.hpp>
#include <isobath/base/pending_file.hpp>
#include <isobath/io/frames/camera_pictures.hpp>
#include <isobath/io/frames/pair_writer.hpp>

namespace isobath {
namespace {

constexpr const char *kCalibration = "rig.toml", *kPoses = "poses.csv";

}  // namespace

PairFolderWriter::PairFolderWriter(const std::filesystem::path& folder, PairRig rig, const std::string& calibration)
    : folder_(folder) {
  std::error_code problem;
  std::filesystem::create_directories(folder, problem);
  if (problem) throw Error("the folder cannot be made: " + problem.message(), {folder.string()});
  rig.calibration = kCalibration;
  rig.poses = kPoses;
  write_whole_file(folder / kCalibration, calibration);
  write_whole_file(folder / PairRig::kFile, pair_rig_toml(rig));
  poses_.open(folder / kPoses);
  poses_ << "t_s,north_m,east_m,depth_m,qw,qx,qy,qz,vn,ve,vd\n";
}

void PairFolderWriter::write(const CameraPair& pair) {
  const auto us = std::chrono::duration_cast<std::chrono::microseconds>(pair.time.time_since_epoch()).count();
  write_camera_image(folder_ / fmt::format("left_{}.png", us), pair.left);
  write_camera_image(folder_ / fmt::format("right_{}.png", us), pair.right);
  ++pairs_;
}

void PairFolderWriter::write(const Navigation& fix) {
  const Eigen::Vector3d& p = fix.X_WB.translation;
  const Eigen::Quaterniond& q = fix.X_WB.rotation.quaternion();
  const Eigen::Vector3d v = fix.v_WB.value_or(Eigen::Vector3d::Zero());
  poses_ << fmt::format("{:.6f},{:.9g},{:.9g},{:.9g},{:.12g},{:.12g},{:.12g},{:.12g},{:.9g},{:.9g},{:.9g}\n",
                        to_seconds(fix.time.time_since_epoch()), p.x(), p.y(), p.z(), q.w(), q.x(), q.y(), q.z(), v.x(),
                        v.y(), v.z());
}

void PairFolderWriter::close() {
  poses_.close();
  if (!poses_) throw Error("cannot be written", {(folder_ / kPoses).string()});
}

}  // namespace isobath
