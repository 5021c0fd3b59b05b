// The messages of ROS of a fix: its pose and velocity, and the parts of it that sensors would state.
#include <array>
#include <isobath/io/mcap/foxglove.hpp>
#include <isobath/io/ros/ros_log_writer.hpp>
#include <limits>

namespace isobath {
namespace {

constexpr double kNotMeasured = -1;  // first element of a covariance of sensor_msgs/Imu
constexpr const char *kWorldFrame = "map", *kBodyFrame = "base_link";

Eigen::Matrix3d ned_to_enu() {
  Eigen::Matrix3d M;
  M << 0, 1, 0, 1, 0, 0, 0, 0, -1;
  return M;
}

template <int kSize>
std::vector<double> by_rows(const Eigen::Matrix<double, kSize, kSize>& matrix) {
  std::vector<double> rows;
  for (int i = 0; i < kSize * kSize; ++i) rows.push_back(matrix(i / kSize, i % kSize));
  return rows;
}

/// Covariance of position and rotation, both about the axes of "map"; zero: not known.
Eigen::Matrix<double, 6, 6> covariance_in_map(const Navigation& fix) {
  Eigen::Matrix<double, 6, 6> J = Eigen::Matrix<double, 6, 6>::Zero();
  if (!fix.covariance || !fix.covariance->allFinite()) return J;
  J.topLeftCorner<3, 3>() = ned_to_enu();
  J.bottomRightCorner<3, 3>() = ned_to_enu() * fix.X_WB.rotation.matrix();
  return J * *fix.covariance * J.transpose();
}

/// Components in base_link.
std::optional<Eigen::Vector3d> velocity_in_body(const Navigation& fix) {
  if (!fix.v_WB || !fix.v_WB->allFinite()) return {};
  const Eigen::Vector3d v_B = fix.X_WB.rotation.inverse() * *fix.v_WB;
  return Eigen::Vector3d(v_B.x(), -v_B.y(), -v_B.z());
}

/// TwistWithCovariance; no velocity: zeros. Variances that are not known are zero.
void put_twist(RosWriter& w, const Navigation& fix) {
  const Eigen::Vector3d v = velocity_in_body(fix).value_or(Eigen::Vector3d::Zero());
  w.numbers({v.x(), v.y(), v.z(), 0, 0, 0});
  Eigen::Matrix<double, 6, 6> C = Eigen::Matrix<double, 6, 6>::Zero();
  if (fix.v_sigma) C(0, 0) = C(1, 1) = *fix.v_sigma * *fix.v_sigma;
  w.array(by_rows<6>(C));
}

}  // namespace

const char* RosLogWriter::put(const Navigation& fix) {
  if (!fix.X_WB.is_finite()) return "fixes that are not finite";
  X_WB_ = fix.X_WB;
  put_odometry(fix);
  put_fix_parts(fix);
  return nullptr;
}

void RosLogWriter::put_odometry(const Navigation& fix) {
  const Pose X = to_east_north_up(fix.X_WB);
  const Eigen::Vector3d& p = X.translation;
  const Eigen::Quaterniond& q = X.rotation.quaternion();
  RosWriter& w = message("/odometry", "nav_msgs/Odometry").header(time_, kWorldFrame).text(kBodyFrame);
  w.numbers({p.x(), p.y(), p.z(), q.x(), q.y(), q.z(), q.w()}).array(by_rows<6>(covariance_in_map(fix)));
  put_twist(w, fix);
  send("/odometry");
  put_transform("/tf", {{kWorldFrame, kBodyFrame, X}}, false);
}

void RosLogWriter::put_fix_parts(const Navigation& fix) {
  if (velocity_in_body(fix)) {
    put_twist(message("/velocity", "geometry_msgs/TwistWithCovarianceStamped").header(time_, kBodyFrame), fix);
    send("/velocity");
  }
  const Eigen::Quaterniond q = to_east_north_up(fix.X_WB).rotation.quaternion();
  const std::array<double, 9> unknown{}, absent{kNotMeasured};
  message("/imu", "sensor_msgs/Imu")
      .header(time_, kBodyFrame)
      .numbers({q.x(), q.y(), q.z(), q.w()})
      .array(unknown)
      .numbers({0, 0, 0})
      .array(absent)
      .numbers({0, 0, 0})
      .array(absent);
  send("/imu");
  const double depth_pa = options_.water_density * kStandardGravity * fix.X_WB.translation.z();
  message("/pressure", "sensor_msgs/FluidPressure")
      .header(time_, kBodyFrame)
      .numbers({options_.surface_pressure_pa + depth_pa, 0});
  send("/pressure");
  constexpr double kPlaneRadius = 1e6;  // m, of LocalPlane
  if (!origin_ || fix.X_WB.translation.head<2>().norm() > kPlaneRadius) return;
  const GeoPoint at = LocalPlane(*origin_).to_geo(fix.X_WB.translation.head<2>());
  const Eigen::Matrix3d C = covariance_in_map(fix).topLeftCorner<3, 3>();
  constexpr double kKnown = 3;  // COVARIANCE_TYPE_KNOWN
  message("/fix", "sensor_msgs/NavSatFix")
      .header(time_, kBodyFrame)
      .numbers({0, 0, at.latitude_deg, at.longitude_deg})
      .number(std::numeric_limits<double>::quiet_NaN())  // no height above the ellipsoid is known
      .array(by_rows<3>(C))
      .number(C.isZero(0) ? 0 : kKnown);
  send("/fix");
}

}  // namespace isobath
