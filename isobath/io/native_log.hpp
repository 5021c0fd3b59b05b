// Isobath's own log: every Event, exactly, in an MCAP container (mcap.hpp).
//
// Channels /ping, /navigation and /range carry CDR (little-endian) with ros2msg definitions isobath/msg/Ping,
// Navigation and RangeReading inside the file, so that other viewers decode every field by name. Reading gives back the
// same events in the same order: times, poses, beams and samples bit for bit. Pings of the same fan share one BeamFan.
// Samples are stored beam by beam, whatever the strides of the source were. A log's metadata holds the origin on the
// globe, what the source said about itself, and the configuration. Errors: see McapWriter; open_native_log throws Error
// for a file that is no MCAP or holds no channel of ours. Damage, other channels' messages and messages that cannot be
// decoded are counted in the report.
#pragma once

#include <filesystem>
#include <isobath/io/event.hpp>
#include <isobath/io/mcap.hpp>
#include <isobath/io/open.hpp>
#include <map>
#include <memory>
#include <string>

namespace isobath {

class NativeLogWriter {
 public:
  explicit NativeLogWriter(const std::filesystem::path& file, const McapWriterConfig& config = {});

  /// Any time before close, most useful before the first event: "sonar" -> "Ping360 ...", configuration as TOML,
  /// origin.
  void set_details(const std::map<std::string, std::string>& details);
  void set_configuration(const std::string& toml);
  void set_origin(const GeoOrigin& origin);

  /// False, and nothing is written, for a ping without beams or whose samples are not beams x bins: no reader could use
  /// it.
  bool write(const Event& event);
  /// Makes what was written safe from a crash.
  void flush() { mcap_.flush(); }
  void close() { mcap_.close(); }

 private:
  McapWriter mcap_;
  std::uint16_t ping_ = 0;
  std::uint16_t navigation_ = 0;
  std::uint16_t range_ = 0;
  std::map<std::uint16_t, std::uint32_t> sequence_;
  std::vector<std::uint8_t> message_;
};

std::unique_ptr<Source> open_native_log(const std::filesystem::path& file, const InputConfig& config);
std::unique_ptr<Source> open_native_log(std::unique_ptr<std::istream> input, const std::string& name);

}  // namespace isobath
