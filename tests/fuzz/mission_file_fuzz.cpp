// Mission files: any bytes, recognised by content.
#include <tests/fuzz/mission.hpp>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace isobath;
  return fuzz::read_mission(data, size, [](std::string_view bytes) {
    (void)looks_like_mission(bytes);
    return parse_mission(bytes, "fuzz.toml");
  });
}
