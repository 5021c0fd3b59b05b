// Scenes: any bytes. They end in a checked scene or in an Error of one line; whatever they name, no file is opened.
#include <cstddef>
#include <cstdint>
#include <isobath/base/error.hpp>
#include <isobath/sim/scene.hpp>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace isobath;
  const std::string_view bytes(reinterpret_cast<const char*>(data), size);
  (void)looks_like_scene(bytes);
  try {
    // Relative files are looked for in a folder that does not exist; a world, which would open them, is not made.
    const Scene scene = parse_scene(bytes, "/nonexistent/fuzz.toml");
    for (const Body& body : scene.bodies) {
      ISOBATH_ASSERT(scene.material(body.material) != nullptr);
      for (const double t : {-1.0, 0.0, 7.5, 1e9}) ISOBATH_ASSERT(displacement(body, t).allFinite());
    }
    for (const SonarConfig& sonar : scene.sonars)
      ISOBATH_ASSERT(sonar.bins > 0 && sonar.range_m > 0 && sonar.beams > 0);
    const Water water(scene.water);
    for (const double depth : {0.0, 10.0, 5000.0}) {
      ISOBATH_ASSERT(water.sound_speed(depth) > 0 && water.mean_sound_speed(0, depth) > 0);
      ISOBATH_ASSERT(water.absorption_db(700e3, depth) >= 0);
      ISOBATH_ASSERT(water.current(depth).allFinite());
    }
  } catch (const Error& error) {
    ISOBATH_ASSERT(std::string_view(error.what()).find('\n') == std::string_view::npos);
  }
  return 0;
}
