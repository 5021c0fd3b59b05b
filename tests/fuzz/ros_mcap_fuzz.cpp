// Messages of ROS, in either encoding, with their definitions in MCAP.
#include <isobath/io/ros/ros_mcap.hpp>
#include <sstream>
#include <tests/fuzz/drain.hpp>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string bytes(reinterpret_cast<const char*>(data), size);
  try {
    const auto open = [&] { return std::make_unique<std::istringstream>(bytes); };
    const auto source = isobath::ros_events(isobath::open_ros_mcap_recording(open, "input"), {});
    isobath::fuzz::drain(*source, size);
  } catch (const isobath::Error&) {  // not MCAP
  }
  return 0;
}
