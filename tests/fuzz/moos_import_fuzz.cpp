// Behaviour files of MOOS: any bytes.
#include <isobath/mission/plan/mission_import.hpp>
#include <tests/fuzz/mission.hpp>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace isobath;
  return fuzz::read_mission(data, size, [](std::string_view bytes) {
    (void)looks_like_moos(bytes);
    return import_moos(bytes, "fuzz.bhv", moos_origin(bytes));
  });
}
