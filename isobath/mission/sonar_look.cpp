#include <isobath/mission/sonar_look.hpp>
#include <isobath/sonar/ping_vitals.hpp>

namespace isobath {

SonarLook look_of(const Ping& ping, std::string sonar) {
  const PingVitals vitals = vitals_of(ping);
  SonarLook look;
  look.time = ping.time;
  look.sonar = std::move(sonar);
  look.digest = vitals.digest;
  look.mean = vitals.mean;
  look.full_scale = vitals.full_scale;
  look.silent = vitals.silent;
  look.roughness = vitals.roughness;
  look.port = vitals.port;
  look.starboard = vitals.starboard;
  look.bearing = vitals.bearing;
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
  echoes.blind_m = ping.window.edge(first);
  nearest_echoes(ping, decisions, echoes.X_WL.rotation.inverse() * X_WB.rotation, contrast, echoes.echoes_L);
  return echoes;
}

}  // namespace isobath
