// Detects echoes in one ping of an imaging sonar that was never calibrated.
//
// The ping is simulated in a scene that is made in code: a pile before a vehicle with an Oculus M750d.
#include <cstdio>
#include <isobath/sim/simulator.hpp>
#include <isobath/sonar/echo_detector.hpp>

using namespace isobath;

const Eigen::Vector2d kPile(18, 4);  // ahead, to starboard, m

Ping ping_of_the_pile() {
  Scene scene;
  scene.bottom = {.kind = BottomKind::kFlat, .depth = 12};
  scene.vehicle = {.start = {0, 0, 5}, .speed = 0};  // north, east, depth; it heads north
  scene.bodies = {{.name = "pile", .shape = Cylinder{.centre = {18, 4, 6}, .radius = 0.4, .length = 12}}};
  scene.sonars = {sonar_preset("oculus_m750d")};
  Simulator simulator(scene);
  while (auto event = simulator.next()) {
    if (auto* ping = std::get_if<Ping>(&*event)) return std::move(*ping);
  }
  return {};
}

int main() {
  const Ping ping = ping_of_the_pile();
  std::printf("%d beams of %d bins, to %.0f m\n", ping.fan->beams(), ping.window.bins, ping.window.end_m());

  EchoDetector detector({.false_alarm = 1e-4});  // of a bin without a target
  EchoDecisions decisions;
  detector.detect(ping, decisions);  // for each bin: echo, no echo, or no information

  int beams_on_the_pile = 0, others = 0;
  for (int beam = 0; beam < decisions.beams(); ++beam) {
    int bin = 0;  // the nearest echo of the beam
    while (bin < decisions.bins() && !(decisions.tells(beam, bin) && decisions.hit(beam, bin))) ++bin;
    if (bin == decisions.bins()) continue;
    const Angle azimuth = ping.fan->azimuth[static_cast<std::size_t>(beam)];  // clockwise from ahead
    const double range = ping.window.centre(bin);
    std::printf("beam %d, %5.1f deg: echo at %5.2f m, %.0f counts\n", beam, azimuth.degrees(), range,
                static_cast<double>(ping.intensity(beam, bin)));
    const Eigen::Vector2d echo(range * cos(azimuth), range * sin(azimuth));
    ++((echo - kPile).norm() < 1 ? beams_on_the_pile : others);
  }
  std::printf("the pile in %d beams, other echoes in %d\n", beams_on_the_pile, others);
  if (beams_on_the_pile == 0) return std::printf("the pile was not detected\n"), 1;
  return 0;
}
