// Bags of ROS 2 in SQLite.
#include <filesystem>
#include <fstream>
#include <isobath/io/ros/ros2_database.hpp>
#include <tests/fuzz/drain.hpp>
#include <unistd.h>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const std::filesystem::path file =
      std::filesystem::temp_directory_path() / ("isobath_ros_database_fuzz_" + std::to_string(getpid()) + ".db3");
  std::ofstream(file, std::ios::binary).write(reinterpret_cast<const char*>(data), static_cast<std::streamsize>(size));
  try {
    const auto source = isobath::open_ros2_database(file, {});
    isobath::fuzz::drain(*source, size);
  } catch (const isobath::Error&) {  // no bag that SQLite can read
  }
  std::filesystem::remove(file);
  return 0;
}
