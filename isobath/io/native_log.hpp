// Isobath's own log: every Event, exactly, in an MCAP container (mcap.hpp).
//
// Channels /ping, /navigation, /range, /health, /swath and, where an operator was heard, /operator carry CDR
// (little-endian) with ros2msg definitions isobath/msg/Ping, Navigation, RangeReading, Health, Swath and OperatorFrame
// inside the file, so that other viewers decode every field by name. Reading gives back the same events in the same
// order: times, poses, beams and samples bit for bit. Pings of the same fan share one BeamFan. Samples are stored beam
// by beam, whatever the strides of the source were. A log's metadata holds the origin on the globe, what the source
// said about itself, and the configuration. Errors: see McapWriter; open_native_log throws Error for a file that is no
// MCAP or holds no channel of ours. Damage, other channels' messages and messages that cannot be decoded are counted in
// the report.
#pragma once

#include <filesystem>
#include <isobath/io/event.hpp>
#include <isobath/io/input_config.hpp>
#include <isobath/io/mcap.hpp>
#include <isobath/sonar/echo_truth.hpp>
#include <isobath/vehicle/autopilot.hpp>
#include <isobath/vehicle/vehicle_state.hpp>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <variant>
#include <vector>

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
  /// What only a simulator knows, in channels of its own (/truth/motion, /truth/echoes), which sources pass over.
  void write(const TrueMotion& motion);
  void write(const EchoTruth& echoes);
  /// What the vehicle is told to do from this time on, in /setpoint; sources pass over it.
  void write(Time time, const Setpoint& setpoint);
  /// What was decided and why, as one JSON object of the caller's, in /decisions; sources pass over it.
  void write_decision(Time time, const std::string& json);
  /// A channel of the caller's with a schema (one of the same name stands for it), for what is made of the events.
  /// Sources pass over it where the name of its schema begins with "isobath." or "foxglove."; group as McapWriter's:
  /// not 0, or events are read more slowly.
  std::uint16_t add_channel(const std::string& topic, const std::string& message_encoding, McapSchema schema,
                            int group);
  void write(std::uint16_t channel, Time time, std::string_view message);
  /// A file beside the messages, such as the scene that was simulated.
  void attach(const std::string& name, const std::string& media_type, const std::string& data);
  /// Makes what was written safe from a crash.
  void flush() { mcap_.flush(); }
  void close() { mcap_.close(); }

 private:
  std::uint16_t late_channel(std::uint16_t& id, const char* topic, const char* name, const std::string& definition);
  void send(std::uint16_t channel, Time time, std::span<const std::uint8_t> message);

  McapWriter mcap_;
  std::uint16_t ping_ = 0, navigation_ = 0, range_ = 0, health_ = 0, swath_ = 0;
  std::uint16_t operator_ = 0;                    ///< made with the first frame
  std::uint16_t motion_ = 0, echoes_ = 0;         ///< made with the first truth: a vehicle's log has none
  std::uint16_t setpoint_ = 0, decisions_ = 0;    ///< made with the first: without a mission there are none
  std::map<std::string, std::uint16_t> schemas_;  ///< of the caller's channels, by name
  std::map<std::uint16_t, std::uint32_t> sequence_;
  std::vector<std::uint8_t> message_;
};

/// The truths of a simulated log, in order; none in a log from a vehicle. Messages that cannot be decoded are passed
/// over.
class TruthReader {
 public:
  explicit TruthReader(const std::filesystem::path& file);
  ~TruthReader();
  std::optional<std::variant<TrueMotion, EchoTruth>> next();

 private:
  std::unique_ptr<McapReader> reader_;
};

/// The decisions of a recorded run, in order, as they were written; none in a log without a mission. Throws Error where
/// the file is no MCAP.
std::vector<std::string> decisions_in(const std::filesystem::path& file);
/// What stands beside the messages under this name; empty where nothing does. Throws Error likewise.
std::optional<std::string> attachment_in(const std::filesystem::path& file, const std::string& name);

std::unique_ptr<Source> open_native_log(const std::filesystem::path& file, const InputConfig& config);
std::unique_ptr<Source> open_native_log(std::unique_ptr<std::istream> input, const std::string& name);

}  // namespace isobath
