// Tables of poses: any text.
#include <cstdint>
#include <isobath/base/error.hpp>
#include <isobath/io/input/pose_track.hpp>
#include <sstream>
#include <string>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace isobath;
  try {
    const auto source = open_pose_track(
        std::make_unique<std::istringstream>(std::string(reinterpret_cast<const char*>(data), size)), "fuzz");
    while (const auto event = source->next()) {
      if (!std::get<Navigation>(*event).X_WB.is_finite()) __builtin_trap();
    }
  } catch (const Error&) {
  }
  return 0;
}
