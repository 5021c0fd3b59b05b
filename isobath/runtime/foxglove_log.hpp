// FoxgloveLog: what a run does in channels that Foxglove and other viewers show without a plug-in (io/foxglove.hpp),
// beside those of Isobath's own in the same log:
//
//   /foxglove/tf, /pose        where the vehicle is                     FrameTransform, PoseInFrame
//   /foxglove/location         the same on the globe, where known       LocationFix
//   /foxglove/points           echoes that were decided                 PointCloud
//   /foxglove/sonar            the fan, or a turn of a scanning head    RawImage; each further sonar /sonar.2 ...
//   /foxglove/occupancy        the grid around the vehicle              Grid
//   /foxglove/obstacles        of the last scan                         SceneUpdate
//   /foxglove/plan, /track     the way it follows, and where it was     SceneUpdate
//   /foxglove/voxels           the occupied ones                        PointCloud
//   /foxglove/log              decisions, faults, lost agents           Log
//
// Rates are bounded by the configuration; all voxels at once are written the more rarely the more there are: 20 kB a
// second of the run on average. An image has at most kMostPixels a side, a pixel the loudest sample that it covers.
// Errors: those of the log's writer. One thread at a time.
#pragma once

#include <isobath/io/foxglove.hpp>
#include <isobath/io/native_log.hpp>
#include <isobath/mission/bus.hpp>
#include <isobath/runtime/pipeline.hpp>
#include <isobath/runtime/recorder_config.hpp>
#include <isobath/sonar/sensor_table.hpp>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace isobath {

class FoxgloveLog {
 public:
  static constexpr int kMostPixels = 256;
  static constexpr std::size_t kMostPoints = 20'000;  ///< of echoes, at a time
  static constexpr std::size_t kMostTrack = 512;      ///< places of the track: beyond, every other is let go

  /// `log` must outlive it; `group` of its channels.
  FoxgloveLog(NativeLogWriter& log, const FoxgloveConfig& config, int group);

  /// Where on the globe the origin of W is.
  void locate(const GeoOrigin& origin) { plane_.emplace(origin); }
  void take(const Navigation& fix);
  void on_ping(const PosedPing& ping);
  void on_scan(const ScanResult& scan);
  void heard(const Envelope& envelope);
  /// Records of the display (display_items.hpp): of these it takes the voxels.
  void take_display(Time time, std::string_view records);

 private:
  /// When something was written last.
  struct Turn {
    std::optional<Time> last;
    /// Whether it is due; then it counts as done.
    bool take(Time now, double interval_s);
  };
  struct Column {
    double bearing = 0;  ///< clockwise from forward
    std::vector<std::uint8_t> pixels;
  };
  struct Sonar {
    std::vector<Column> columns;  ///< of the sweep under way, of a scanning head
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

  NativeLogWriter& log_;
  FoxgloveConfig config_;
  int group_;
  std::map<std::string, std::uint16_t> channels_;
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
