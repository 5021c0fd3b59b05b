// Isobath's native log: every Event, exactly, in an MCAP container (mcap.hpp).
//
// Channels /ping, /navigation, /range, /health, /swath and, if there are operator frames or passive bearings, /operator
// and /bearing carry CDR (little-endian). The file contains the ros2msg definitions isobath/msg/Ping, Navigation,
// RangeReading, Health, Swath, OperatorFrame and PassiveBearing, so that other viewers decode every field by name.
// Reading returns the same events in the same order: times, poses, beams and samples bit for bit. Pings of the same fan
// share one BeamFan. Samples are stored beam by beam, whatever the strides of the source were. The metadata hold the
// origin on the globe, the details of the source, and the configuration. Errors: as McapWriter. open_native_log throws
// Error if the file is not MCAP or has no Isobath channel. The report counts damage, messages of other channels and
// messages that cannot be decoded.
#pragma once

#include <filesystem>
#include <isobath/event/event.hpp>
#include <isobath/io/input/input_config.hpp>
#include <isobath/io/mcap/mcap.hpp>
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

namespace native {
struct RecordKind;
}

class NativeLogWriter {
 public:
  explicit NativeLogWriter(const std::filesystem::path& file, const McapWriterConfig& config = {});

  /// Details ("sonar" -> "Ping360 ..."), the configuration as TOML, and the origin can be set at any time before close;
  /// readers know them from the start if they are set before the first event.
  void set_details(const std::map<std::string, std::string>& details);
  void set_configuration(const std::string& toml);
  void set_origin(const GeoOrigin& origin);

  /// Writes an event. False, and nothing is written, for an unusable ping: one without beams, or whose samples are not
  /// beams x bins.
  bool write(const Event& event);
  /// Ground truth of a simulator, in separate channels (/truth/motion, /truth/echoes) that sources skip.
  void write(const TrueMotion& motion);
  void write(const EchoTruth& echoes);
  /// The set-point of the vehicle from this time on, in /setpoint; sources skip it.
  void write(Time time, const Setpoint& setpoint);
  /// A decision and its reason, as one JSON object of the caller, in /decisions; sources skip it.
  void write_decision(Time time, const std::string& json);
  /// Adds a channel for derived data, with a schema; a schema of the same name is reused. Sources skip the channel if
  /// the name of its schema begins with "isobath." or "foxglove.". `group` as in McapWriter: not 0, or reading events
  /// becomes slower.
  std::uint16_t add_channel(const std::string& topic, const std::string& message_encoding, McapSchema schema,
                            int group);
  void write(std::uint16_t channel, Time time, std::string_view message);
  /// Attaches a file to the log, such as the simulated scene.
  void attach(const std::string& name, const std::string& media_type, const std::string& data);
  /// Makes the written events safe from a crash.
  void flush() { mcap_.flush(); }
  void close() { mcap_.close(); }

 private:
  std::uint16_t add_kind(const native::RecordKind& kind);
  std::uint16_t late_channel(std::uint16_t& id, const native::RecordKind& kind);
  void send(std::uint16_t channel, Time time, std::span<const std::uint8_t> message);

  McapWriter mcap_;
  std::uint16_t ping_ = 0, navigation_ = 0, range_ = 0, health_ = 0, swath_ = 0;
  std::uint16_t operator_ = 0, bearing_ = 0;      ///< added with the first operator frame, passive bearing
  std::uint16_t motion_ = 0, echoes_ = 0;         ///< added with the first truth; a vehicle's log has none
  std::uint16_t setpoint_ = 0, decisions_ = 0;    ///< added with the first; a log without a mission has none
  std::map<std::string, std::uint16_t> schemas_;  ///< schemas of the caller's channels, by name
  std::map<std::uint16_t, std::uint32_t> sequence_;
  std::vector<std::uint8_t> message_;
};

/// Reads the ground truth of a simulated log, in order; a vehicle's log has none. Messages that cannot be decoded are
/// skipped.
class TruthReader {
 public:
  explicit TruthReader(const std::filesystem::path& file);
  ~TruthReader();
  std::optional<std::variant<TrueMotion, EchoTruth>> next();

 private:
  std::unique_ptr<McapReader> reader_;
};

/// The decisions of a recorded run, in order, as written; a log without a mission has none. Throws Error if the file is
/// not MCAP.
std::vector<std::string> decisions_in(const std::filesystem::path& file);
/// The attachment of this name; empty if there is none. Throws Error likewise.
std::optional<std::string> attachment_in(const std::filesystem::path& file, const std::string& name);

std::unique_ptr<Source> open_native_log(const std::filesystem::path& file, const InputConfig& config);
std::unique_ptr<Source> open_native_log(std::unique_ptr<std::istream> input, const std::string& name);

}  // namespace isobath
