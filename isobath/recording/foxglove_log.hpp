// FoxgloveLog: writes a run to channels that Foxglove and other viewers show without a plug-in (io/foxglove.hpp): in a
// recording, beside Isobath's own channels, and to viewers that watch the run (viewer_feed.hpp):
//
//   /foxglove/tf, /pose        pose of the vehicle                      FrameTransform, PoseInFrame
//   /foxglove/location         its geographic position, if known        LocationFix
//   /foxglove/points           detected echoes                          PointCloud
//   /foxglove/sonar            the fan, or a turn of a scanning head    RawImage; each further sonar /sonar.2 ...
//   /foxglove/occupancy        the grid around the vehicle              Grid
//   /foxglove/obstacles        obstacles of the last scan, 10 s arrows  SceneUpdate
//   /foxglove/plan, /track     the route, and the track so far          SceneUpdate
//   /foxglove/voxels           occupied voxels                          PointCloud
//   /foxglove/log              decisions, faults, lost agents           Log
//
// The configuration bounds the rates. All voxels are written at once, less often the more there are: 20 kB a second of
// the run on average. An image has at most kMaxPixels a side; a pixel shows the loudest sample that it covers. Errors:
// those of the channels. One thread at a time.
#pragma once

#include <functional>
#include <isobath/configuration/recorder_config.hpp>
#include <isobath/io/mcap/foxglove.hpp>
#include <isobath/mission/command/bus.hpp>
#include <isobath/sonar/sensor_table.hpp>
#include <isobath/world/result_sinks.hpp>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace isobath {

class FoxgloveLog {
 public:
  static constexpr int kMaxPixels = 256;
  static constexpr std::size_t kMaxPoints = 20'000;  ///< echoes in a message
  static constexpr std::size_t kMaxTrack = 512;      ///< points of the track; beyond, every other one is dropped

  /// Where messages go. `open`: called once for each topic; returns the number of its channel.
  struct Channels {
    std::function<std::size_t(FoxgloveKind, const std::string& topic)> open;
    std::function<void(std::size_t channel, Time, const std::string& message)> write;
  };

  FoxgloveLog(Channels to, const FoxgloveConfig& config) : to_(std::move(to)), config_(config) {}

  /// The geographic origin of W.
  void locate(const GeoOrigin& origin) { plane_.emplace(origin); }
  void on_fix(const Navigation& fix);
  void on_ping(const PosedPing& ping);
  void on_scan(const ScanResult& scan);
  void on_message(const Envelope& envelope);
  /// Records of the display (display_state.hpp); only the voxels are used.
  void on_display(Time time, std::string_view records);

 private:
  /// Limits the rate of a channel.
  struct Turn {
    std::optional<Time> last;
    /// True if a message is due; then marks it as written.
    bool take(Time now, double interval_s);
  };
  struct Column {
    double bearing = 0;  ///< clockwise from forward
    std::vector<std::uint8_t> pixels;
  };
  struct Sonar {
    std::vector<Column> columns;  ///< of the current sweep of a scanning head
    Turn image;
  };
  void write(FoxgloveKind kind, const std::string& topic, Time time, const std::string& message);
  void write_track(Time time);
  void write_grid(const ScanResult& scan);
  void write_obstacles(const Detection& detection);
  void write_image(const std::string& topic, Time time, const std::vector<const Column*>& columns);
  void write_voxels(Time time);
  void add_echoes(const PosedPing& posed);
  void add_image(const PosedPing& posed);

  Channels to_;
  FoxgloveConfig config_;
  std::map<std::string, std::size_t> channels_;  ///< by topic
  std::optional<LocalPlane> plane_;
  Turn pose_, points_, grid_, track_turn_;
  std::vector<FoxglovePoint> echoes_;
  SensorTable mountings_;
  std::map<std::size_t, Sonar> sonars_;
  std::vector<Eigen::Vector3d> track_;
  std::uint64_t fixes_ = 0, track_step_ = 1;
  std::map<std::uint64_t, std::string> voxels_;  ///< payloads by block
  bool voxels_changed_ = false;
  std::optional<Time> voxels_due_;
};

}  // namespace isobath
