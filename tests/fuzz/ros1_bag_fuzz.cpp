// Bags of ROS 1 with their definitions and messages.
#include <isobath/io/ros/ros1_bag.hpp>
#include <sstream>
#include <tests/fuzz/drain.hpp>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  try {
    auto input = std::make_unique<std::istringstream>(std::string(reinterpret_cast<const char*>(data), size));
    const auto source = isobath::ros_events(isobath::open_ros1_recording(std::move(input), "input"), {});
    isobath::fuzz::drain(*source, size);
  } catch (const isobath::Error&) {  // a bag that cannot be read at all
  }
  return 0;
}
