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

void add_echoes(SonarLook& look, const Ping& ping, const EchoDecisions& decisions, bool decided, const Pose& X_WB,
                double contrast) {
  const Pose X_WL = level(X_WB);
  look.X_WL = X_WL;
  look.decided = decided;
  look.echoes_L.clear();
  look.blind_m = ping.blind_m;
  if (decided) {
    int first = 0;
    while (first < decisions.bins() && !decisions.usable(first)) ++first;
    look.blind_m = ping.window.edge(first);
    nearest_echoes(ping, decisions, X_WL.rotation.inverse() * X_WB.rotation, contrast, look.echoes_L);
  }
}

}  // namespace isobath
