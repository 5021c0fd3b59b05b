// Plans of QGroundControl: any bytes.
#include <isobath/mission/plan/mission_import.hpp>
#include <tests/fuzz/mission.hpp>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace isobath;
  return fuzz::read_mission(data, size, [](std::string_view bytes) { return import_qground_plan(bytes, "fuzz.plan"); });
}
