#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <fmt/format.h>
#include <isobath/display/display_bytes.hpp>
#include <isobath/display/display_state.hpp>
#include <isobath/map/occupancy/whole_obstacle.hpp>
#include <isobath/map/voxel/voxel_blocks.hpp>
#include <isobath/recording/foxglove_log.hpp>

namespace isobath {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr int kFewBeams = 8;  // with fewer, one ping makes no image
constexpr std::size_t kMaxColumns = 1440;
constexpr double kVoxelBytesPerSecond = 20e3;
constexpr double kArrow_s = 10;                  // the arrow of a moving body ends where it is after this time
constexpr double kBarb_m = 1, kBarbAngle = 2.7;  // rad from the arrow's direction

constexpr FoxgloveColor kObstacleColor{1, 0.35, 0.2, 1}, kHiddenColor{1, 0.35, 0.2, 0.35}, kPlanColor{0.3, 0.7, 1, 1},
    kTrackColor{0.6, 0.9, 0.5, 1};

/// One beam as bytes of at most kMaxPixels, the loudest sample of each; nearest first.
std::vector<std::uint8_t> pixels_of_beam(const Ping& ping, int beam) {
  const int bins = ping.window.bins;
  const int height = std::min(bins, FoxgloveLog::kMaxPixels);
  std::vector<float> line(static_cast<std::size_t>(bins));
  ping.intensity.copy_beam(beam, line.data());
  std::vector<std::uint8_t> pixels(static_cast<std::size_t>(height), 0);
  const double scale = ping.full_scale > 0 ? 255.0 / static_cast<double>(ping.full_scale) : 0;
  for (int k = 0; k < bins; ++k) {
    const double value = static_cast<double>(line[static_cast<std::size_t>(k)]) * scale;
    const auto byte = static_cast<std::uint8_t>(std::isfinite(value) ? std::clamp(value, 0.0, 255.0) : 0.0);
    auto& pixel = pixels[static_cast<std::size_t>(static_cast<std::int64_t>(k) * height / bins)];
    pixel = std::max(pixel, byte);
  }
  return pixels;
}

double bearing_of(const Ping& ping, int beam) {
  const double azimuth = ping.fan->azimuth[static_cast<std::size_t>(beam)].radians();
  const Vector3d axis_B = ping.X_BS.rotation * Vector3d(std::cos(azimuth), std::sin(azimuth), 0);
  return std::atan2(axis_B.y(), axis_B.x());
}

std::vector<Vector3d> outline_in_world(const Pose& X_WL, const Polygon& outline) {
  std::vector<Vector3d> points;
  for (const Vector2d& p : outline) points.emplace_back(X_WL * Vector3d(p.x(), p.y(), 0));
  return points;
}

/// Along the velocity of a moving body, with two barbs at its end.
std::vector<Vector3d> arrow_in_world(const Vector3d& from_W, const Vector2d& velocity_W) {
  const Vector3d to_W = from_W + kArrow_s * Vector3d(velocity_W.x(), velocity_W.y(), 0);
  const double course = std::atan2(velocity_W.y(), velocity_W.x());
  const auto barb = [&](double side) {
    const double angle = course + side * kBarbAngle;
    return Vector3d(to_W + kBarb_m * Vector3d(std::cos(angle), std::sin(angle), 0));
  };
  return {from_W, to_W, barb(1), to_W, barb(-1)};
}

std::string topic_of(std::size_t sonar) {
  return sonar == 0 ? "/foxglove/sonar" : fmt::format("/foxglove/sonar.{}", sonar + 1);
}

}  // namespace

bool FoxgloveLog::Turn::take(Time now, double interval_s) {
  if (last && now >= *last && now - *last < seconds(interval_s)) return false;
  last = now;
  return true;
}

/// Does not write empty messages.
void FoxgloveLog::write(FoxgloveKind kind, const std::string& topic, Time time, const std::string& message) {
  if (message.empty()) return;
  const auto [channel, is_new] = channels_.try_emplace(topic);
  if (is_new) channel->second = to_.open(kind, topic);
  to_.write(channel->second, time, message);
}

void FoxgloveLog::on_fix(const Navigation& fix) {
  if (!fix.X_WB.is_finite() || !pose_.take(fix.time, config_.pose_s)) return;
  write(FoxgloveKind::kFrameTransform, "/foxglove/tf", fix.time, foxglove_transform(fix.time, fix.X_WB));
  write(FoxgloveKind::kPoseInFrame, "/foxglove/pose", fix.time, foxglove_pose(fix.time, fix.X_WB));
  if (plane_) {
    FoxglovePlace place{plane_->to_geo(fix.X_WB.translation.head<2>()), fix.X_WB.translation.z()};
    if (fix.covariance) place.covariance_W = fix.covariance->topLeftCorner<3, 3>();
    place.heading = fix.X_WB.rotation.heading();
    write(FoxgloveKind::kLocationFix, "/foxglove/location", fix.time, foxglove_location(fix.time, place));
  }
  if (fixes_++ % track_step_ == 0) track_.push_back(fix.X_WB.translation);
  if (track_.size() > kMaxTrack) {
    for (std::size_t i = 0; 2 * i < track_.size(); ++i) track_[i] = track_[2 * i];
    track_.resize((track_.size() + 1) / 2);
    track_step_ *= 2;
  }
  if (track_turn_.take(fix.time, config_.voxels_s)) write_track(fix.time);
}

void FoxgloveLog::write_track(Time time) {
  const FoxgloveEntity track{"track", {{track_, false, kTrackColor}}};
  write(FoxgloveKind::kSceneUpdate, "/foxglove/track", time, foxglove_scene(time, {&track, 1}));
}

void FoxgloveLog::on_ping(const PosedPing& posed) {
  add_echoes(posed);
  add_image(posed);
}

/// Echoes of a scanning head accumulate; of a fan, one ping is enough.
void FoxgloveLog::add_echoes(const PosedPing& posed) {
  const Ping& ping = posed.ping;
  const bool due = !points_.last || ping.time < *points_.last || ping.time - *points_.last >= seconds(config_.points_s);
  if (ping.fan->beams() >= kFewBeams && !due) return;
  const Pose X_WS = posed.X_WB * ping.X_BS;
  for (int beam = 0; beam < ping.fan->beams(); ++beam) {
    const double azimuth = ping.fan->azimuth[static_cast<std::size_t>(beam)].radians();
    const Vector3d axis(std::cos(azimuth), std::sin(azimuth), 0);
    for (int bin = 0; bin < ping.window.bins && echoes_.size() < kMaxPoints; ++bin) {
      if (!posed.decisions.hit(beam, bin) || !posed.decisions.tells(beam, bin)) continue;
      const Vector3d p_W = X_WS * Vector3d(ping.window.centre(bin) * axis);
      echoes_.push_back({p_W.cast<float>(), ping.intensity(beam, bin)});
    }
  }
  if (!due) return;
  points_.last = ping.time;
  write(FoxgloveKind::kPointCloud, "/foxglove/points", ping.time, foxglove_points(ping.time, echoes_, "intensity"));
  echoes_.clear();
}

void FoxgloveLog::add_image(const PosedPing& posed) {
  const Ping& ping = posed.ping;
  const std::size_t number = mountings_.index_of(ping.X_BS).value_or(0);
  Sonar& sonar = sonars_[number];
  if (ping.fan->beams() < kFewBeams) {
    for (int beam = 0; beam < ping.fan->beams() && sonar.columns.size() < kMaxColumns; ++beam) {
      sonar.columns.push_back({bearing_of(ping, beam), pixels_of_beam(ping, beam)});
    }
    return;
  }
  if (!sonar.image.take(ping.time, config_.image_s)) return;
  std::vector<Column> columns;
  for (int beam = 0; beam < ping.fan->beams(); ++beam) columns.push_back({0, pixels_of_beam(ping, beam)});
  std::vector<const Column*> in_order;
  for (const Column& column : columns) in_order.push_back(&column);
  write_image(topic_of(number), ping.time, in_order);
}

/// Columns from port to starboard, the far end at the top.
void FoxgloveLog::write_image(const std::string& topic, Time time, const std::vector<const Column*>& columns) {
  const auto count = static_cast<int>(columns.size());
  const int width = std::min(count, kMaxPixels);
  std::size_t height = 0;
  for (const Column* column : columns) height = std::max(height, column->pixels.size());
  if (width == 0 || height == 0) return;
  std::vector<std::uint8_t> pixels(static_cast<std::size_t>(width) * height, 0);
  for (int i = 0; i < count; ++i) {
    const std::vector<std::uint8_t>& column = columns[static_cast<std::size_t>(i)]->pixels;
    const auto x = static_cast<std::size_t>(static_cast<std::int64_t>(i) * width / count);
    for (std::size_t k = 0; k < column.size(); ++k) {
      auto& pixel = pixels[(height - 1 - k) * static_cast<std::size_t>(width) + x];
      pixel = std::max(pixel, column[k]);
    }
  }
  write(FoxgloveKind::kRawImage, topic, time, foxglove_image(time, width, static_cast<int>(height), pixels));
}

void FoxgloveLog::on_scan(const ScanResult& scan) {
  const Time time = scan.detection.time;
  for (auto& [number, sonar] : sonars_) {
    if (sonar.columns.empty()) continue;
    if (sonar.image.take(time, config_.image_s)) {
      std::vector<const Column*> in_order;
      for (const Column& column : sonar.columns) in_order.push_back(&column);
      std::stable_sort(in_order.begin(), in_order.end(),
                       [](const Column* a, const Column* b) { return a->bearing < b->bearing; });
      write_image(topic_of(number), time, in_order);
    }
    sonar.columns.clear();
  }
  if (!grid_.take(time, config_.grid_s)) return;
  write_grid(scan);
  write_obstacles(scan.detection);
}

void FoxgloveLog::write_grid(const ScanResult& scan) {
  const BodyGrid& grid = scan.grid;
  const CartesianGrid& cells = grid.cells();
  std::vector<std::uint8_t> values;
  values.reserve(cells.size());
  for (const double log_odds : grid.log_odds()) {
    values.push_back(static_cast<std::uint8_t>(std::lround(250 * probability_of(log_odds))));
  }
  const Pose X_WL = level(scan.detection.X_WB);
  const Vector2d corner_L = grid.to_level_body(Vector2d::Zero());
  const FoxgloveGrid message{X_WL * Vector3d(corner_L.x(), corner_L.y(), 0),
                             X_WL.rotation.heading() - grid.heading(),
                             cells.cells_x,
                             cells.cells_y,
                             cells.cell_m,
                             values};
  write(FoxgloveKind::kGrid, "/foxglove/occupancy", scan.detection.time,
        foxglove_grid(scan.detection.time, message, "occupancy_250"));
}

void FoxgloveLog::write_obstacles(const Detection& detection) {
  const Pose X_WL = level(detection.X_WB);
  FoxgloveEntity entity{"obstacles"};
  for (const Obstacle& o : detection.obstacles) {
    const FoxgloveColor color = o.behind ? kHiddenColor : kObstacleColor;
    entity.lines.push_back({outline_in_world(X_WL, o.outline), true, color});
    if (o.moves()) {
      const Vector3d centre_W = X_WL * Vector3d(o.centre.x(), o.centre.y(), 0);
      entity.lines.push_back({arrow_in_world(centre_W, o.motion.velocity_W), false, color});
    }
  }
  for (const WholeObstacle& whole : whole_obstacles(detection.obstacles)) {
    if (whole.behind) continue;
    const Obstacle& piece = *whole.nearest;
    entity.texts.push_back(
        {X_WL * Vector3d(piece.nearest.x(), piece.nearest.y(), 0),
         fmt::format("{}: {}, {:.1f} m, {:.2f}", whole.number, whole.kind(), piece.range_m, whole.existence),
         kObstacleColor});
  }
  write(FoxgloveKind::kSceneUpdate, "/foxglove/obstacles", detection.time,
        foxglove_scene(detection.time, {&entity, 1}));
}

void FoxgloveLog::on_message(const Envelope& envelope) {
  const auto log = [&](FoxgloveLevel level, std::string_view name, std::string_view message) {
    write(FoxgloveKind::kLog, "/foxglove/log", envelope.time, foxglove_log(envelope.time, level, name, message));
  };
  if (const auto* decision = std::get_if<Decision>(&envelope.message)) {
    log(FoxgloveLevel::kInfo, decision->agent,
        fmt::format("{}. {}: {}", decision->number, decision->what, decision->reason));
  } else if (const auto* fault = std::get_if<SafetyReport>(&envelope.message)) {
    const std::string state = fault->active ? fault->why : "over";
    log(fault->abort ? FoxgloveLevel::kError : FoxgloveLevel::kWarning, envelope.sender, fault->fault + ": " + state);
  } else if (const auto* lost = std::get_if<AgentLost>(&envelope.message)) {
    log(FoxgloveLevel::kError, lost->agent, (lost->hung ? "hangs: " : "died: ") + lost->why);
  } else if (const auto* order = std::get_if<FollowOrder>(&envelope.message)) {
    FoxgloveEntity plan{"plan", {{{}, false, kPlanColor}}};
    for (const Waypoint& w : order->waypoints) {
      const Vector3d at(w.north, w.east, w.depth);
      plan.lines[0].points_W.push_back(at);
      plan.balls.push_back({at, 0.5, kPlanColor});
    }
    write(FoxgloveKind::kSceneUpdate, "/foxglove/plan", envelope.time, foxglove_scene(envelope.time, {&plan, 1}));
  }
}

void FoxgloveLog::on_display(Time time, std::string_view records) {
  for_each_record(records, [&](const DisplayRecord& record) {
    if (record.forget && !voxels_.empty()) {
      voxels_.clear();
      voxels_changed_ = true;
    }
    if (record.kind != DisplayKind::kVoxels) return;
    if (record.gone) {
      voxels_.erase(record.number);
    } else {
      voxels_[record.number] = record.payload;
    }
    voxels_changed_ = true;
  });
  if (!voxels_changed_ || (voxels_due_ && time < *voxels_due_)) return;
  voxels_changed_ = false;
  write_voxels(time);
}

void FoxgloveLog::write_voxels(Time time) {
  constexpr std::size_t kHead = 20;  // f32 voxel; i32 x, y, z; u32 n
  std::vector<FoxglovePoint> points;
  std::array<std::uint8_t, VoxelBlocks::kVolume> shades;
  for (const auto& [number, payload] : voxels_) {
    if (payload.size() < kHead || !unpack_bits(std::string_view(payload).substr(kHead), shades)) continue;
    float voxel_m = 0;
    std::int32_t corner[3] = {};
    std::memcpy(&voxel_m, payload.data(), 4);
    std::memcpy(corner, payload.data() + 4, 12);
    for (int i = 0; i < VoxelBlocks::kVolume; ++i) {
      const std::uint8_t shade = shades[static_cast<std::size_t>(i)];
      if (shade == 0) continue;
      const VoxelIndex at = VoxelIndex(corner[0], corner[1], corner[2]) + VoxelBlocks::place_of(i);
      points.push_back({(at.cast<float>().array() + 0.5f).matrix() * voxel_m, static_cast<float>(shade) / 250.0f});
    }
  }
  const std::string message = foxglove_points(time, points, "probability");
  voxels_due_ = time + seconds(std::max(config_.voxels_s, static_cast<double>(message.size()) / kVoxelBytesPerSecond));
  write(FoxgloveKind::kPointCloud, "/foxglove/voxels", time, message);
}

}  // namespace isobath
