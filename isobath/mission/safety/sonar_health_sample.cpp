#include <isobath/mission/safety/sonar_health_sample.hpp>
#include <isobath/sonar/ping_quality.hpp>

namespace isobath {

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
  echoes.fan = ping.fan;
  echoes.sonar_L = (R_LB * ping.X_BS.translation).head<2>();
  echoes.boresight_L = (R_LB * ping.X_BS.rotation).heading();
  return echoes;
}

}  // namespace isobath
