#include <algorithm>
#include <cmath>
#include <isobath/mission/safety/sonar_health_sample.hpp>
#include <isobath/sonar/ping_quality.hpp>

namespace isobath {
namespace {

constexpr double kLevel = 0.25;  // of the height of the beams: tilt up to which their silence says something

}  // namespace

SonarHealthSample look_of(const Ping& ping, std::string sonar) {
  const PingQuality quality = quality_of(ping);
  SonarHealthSample look;
  look.time = ping.time;
  look.sonar = std::move(sonar);
  look.digest = quality.digest;
  look.mean = quality.mean;
  look.full_scale = quality.full_scale;
  look.silent = quality.silent;
  look.roughness = quality.roughness;
  look.port = quality.port;
  look.starboard = quality.starboard;
  look.bearing = quality.bearing;
  return look;
}

std::optional<SonarEchoes> echoes_of(const Ping& ping, const EchoDecisions& decisions, const Pose& X_WB,
                                     double contrast) {
  int first = 0;
  while (first < decisions.bins() && !decisions.usable(first)) ++first;
  if (first == decisions.bins()) return std::nullopt;
  SonarEchoes echoes;
  echoes.time = ping.time;
  echoes.X_WL = level(X_WB);
  echoes.blanking_m = ping.window.edge(first);
  const Rotation R_LB = echoes.X_WL.rotation.inverse() * X_WB.rotation;
  nearest_echoes(ping, decisions, R_LB, contrast, echoes.echoes_L, echoes.silent_m);
  const Rotation R_LS = R_LB * ping.X_BS.rotation;
  // Beams that the vehicle's pitch or the mount tilts do not look ahead at its depth.
  const double down = (R_LS * Eigen::Vector3d::UnitX()).z();
  if (std::abs(std::asin(std::clamp(down, -1.0, 1.0))) <= kLevel * ping.fan->height.radians()) echoes.fan = ping.fan;
  echoes.sonar_L = (R_LB * ping.X_BS.translation).head<2>();
  echoes.boresight_L = R_LS.heading();
  return echoes;
}

}  // namespace isobath
