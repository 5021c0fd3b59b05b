// Ranges, scans and point clouds as soundings. The points of a cloud are on the bottom where the cloud lies below the
// sensor (its mean direction is over 30 degrees down), else in the water, where obstacles are.
#include <algorithm>
#include <cmath>
#include <isobath/io/ros/ros_decoding.hpp>
#include <numbers>

namespace isobath {
namespace {

constexpr Angle kScanHeight = Angle::degrees(20);  // of a scan whose beams are not stated
constexpr double kFarthestSounding = 1e4;          // m
constexpr double kBottomSlope = 0.5;               // sine of the mean direction below the horizontal

bool usable(double range) { return range > 0 && range <= kFarthestSounding; }

void add_point(Swath& swath, const Pose& X_BS, const Eigen::Vector3d& p_S, std::size_t beam) {
  Sounding& s = swath.soundings.emplace_back();
  s.point = (X_BS * p_S).cast<float>();
  s.range_m = static_cast<float>(p_S.norm());
  s.beam = static_cast<std::uint16_t>(beam % Swath::kMaxSoundings);
  s.kind = Sounding::Kind::kWater;
}

/// Whether the points, seen from the sensor, lie below it.
void mark_bottom(Swath& swath, const Pose& X_BS) {
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (const Sounding& s : swath.soundings) {
    mean += (s.point.cast<double>() - X_BS.translation).normalized();
  }
  if (!(mean.z() > kBottomSlope * mean.norm())) return;
  for (Sounding& s : swath.soundings) s.kind = Sounding::Kind::kBottom;
}

Swath swath_of(const RosInput& input, const RosContext& context) {
  Swath swath;
  swath.time = input.time;
  swath.frame = Swath::Frame::kBody;
  swath.beam_width = context.config.beam_width;
  return swath;
}

/// Positions of x, y and z in a point, all of one type.
struct CloudLayout {
  std::size_t at[3] = {};
  bool wide = false;  ///< 64-bit
};
std::optional<CloudLayout> layout_of(const RosMessage& message, std::uint64_t point_bytes) {
  CloudLayout layout;
  int found = 0;
  for (const RosValue& field : message["fields"].elements()) {
    const std::string_view name = field["name"].text();
    if (name != "x" && name != "y" && name != "z") continue;
    const std::uint64_t type = field["datatype"].whole(), offset = field["offset"].whole();
    if ((type != 7 && type != 8) || offset + (type == 8 ? 8 : 4) > point_bytes) return {};
    layout.at[name[0] - 'x'] = offset;
    layout.wide = type == 8;
    ++found;
  }
  return found == 3 ? std::optional(layout) : std::nullopt;
}

/// Directions and ranges of beams as one swath in the water or on the bottom.
const char* add_beams(const RosInput& input, RosContext& context, const std::vector<Eigen::Vector3d>& p_F,
                      std::vector<Event>& events) {
  if (!input.message.ok()) return nullptr;
  Swath swath = swath_of(input, context);
  // The axes of marine_acoustic_msgs: x up, y starboard, z forward.
  const Pose X_BS = context.mount(input.frame, RosAxes::kUpStarboardForward);
  for (std::size_t i = 0; i < p_F.size() && i < Swath::kMaxSoundings; ++i) {
    const Eigen::Vector3d& p = p_F[i];
    if (p.allFinite() && usable(p.norm())) add_point(swath, X_BS, {p.z(), p.y(), -p.x()}, i);
  }
  if (swath.soundings.empty()) return "swath without a sounding";
  mark_bottom(swath, X_BS);
  events.emplace_back(std::move(swath));
  return nullptr;
}

std::vector<bool> good_beams(const RosMessage& message, std::size_t beams) {
  std::vector<bool> good(beams, true);
  const auto flags = message["flags"].elements();
  for (std::size_t i = 0; i < flags.size() && i < beams; ++i) good[i] = flags[i]["flag"].number() == 0;
  return good;
}

}  // namespace

const char* decode_laser_scan(const RosInput& input, RosContext& context, std::vector<Event>& events) {
  const RosMessage& message = input.message;
  const double first = message["angle_min"].number(), step = message["angle_increment"].number();
  const double nearest = message["range_min"].number(), farthest = message["range_max"].number();
  const std::vector<double> ranges = message["ranges"].numbers();
  if (!message.ok()) return nullptr;
  if (!std::isfinite(first) || !std::isfinite(step)) return "scan with an impossible bearing";
  Swath swath = swath_of(input, context);
  swath.beam_height = context.config.beam_height.radians() > 0 ? context.config.beam_height : kScanHeight;
  if (swath.beam_width.radians() <= 0 && std::abs(step) < std::numbers::pi) {
    swath.beam_width = Angle::radians(std::abs(step));
  }
  const Pose X_BS = context.mount(input.frame, RosAxes::kForwardPortUp);
  for (std::size_t i = 0; i < ranges.size() && i < Swath::kMaxSoundings; ++i) {
    const double r = ranges[i];  // NaN: no data, infinite: no echo
    if (!usable(r) || r < nearest || (farthest > 0 && r > farthest)) continue;
    const double azimuth = -(first + step * static_cast<double>(i));  // ROS counts to port
    add_point(swath, X_BS, {r * std::cos(azimuth), r * std::sin(azimuth), 0}, i);
  }
  if (swath.soundings.empty()) return "scan without an echo";
  events.emplace_back(std::move(swath));
  return nullptr;
}

const char* decode_point_cloud(const RosInput& input, RosContext& context, std::vector<Event>& events) {
  const RosMessage& message = input.message;
  const std::uint64_t width = message["width"].whole(), height = message["height"].whole();
  const std::uint64_t step = message["point_step"].whole(), row = message["row_step"].whole();
  const RecordView view(message["data"].bytes(),
                        message["is_bigendian"].number() != 0 ? std::endian::big : std::endian::little);
  const auto layout = layout_of(message, step);
  if (!message.ok()) return nullptr;
  if (!layout) return "point cloud without x, y, z as real numbers";
  if (width > view.size() || height > view.size() || width * step > row || height * row > view.size()) {
    return "point cloud whose size disagrees with its points";
  }
  const Pose X_BS = context.mount(input.frame, RosAxes::kForwardPortUp);
  Swath swath = swath_of(input, context);
  const auto finish = [&] {
    if (swath.soundings.empty()) return;
    mark_bottom(swath, X_BS);
    events.emplace_back(std::move(swath));
    swath = swath_of(input, context);
  };
  for (std::uint64_t i = 0; i < width * height; ++i) {
    const std::size_t at = i / width * row + i % width * step;
    Eigen::Vector3d p;
    for (int k = 0; k < 3; ++k) {
      p[k] =
          layout->wide ? view.at<double>(at + layout->at[k]) : static_cast<double>(view.at<float>(at + layout->at[k]));
    }
    if (!p.allFinite() || !usable(p.norm())) continue;
    add_point(swath, X_BS, {p.x(), -p.y(), -p.z()}, swath.soundings.size());
    if (swath.soundings.size() == Swath::kMaxSoundings) finish();
  }
  finish();
  return events.empty() ? "point cloud without a point" : nullptr;
}

const char* decode_sonar_ranges(const RosInput& input, RosContext& context, std::vector<Event>& events) {
  const std::vector<double> ranges = input.message["ranges"].numbers();
  const auto directions = input.message["beam_unit_vec"].elements();
  if (ranges.size() != directions.size()) return "swath whose beams and ranges differ in number";
  const std::vector<bool> good = good_beams(input.message, ranges.size());
  std::vector<Eigen::Vector3d> points;
  for (std::size_t i = 0; i < ranges.size(); ++i) {
    const RosValue& d = directions[i];
    if (good[i]) points.push_back(ranges[i] * Eigen::Vector3d(d["x"].number(), d["y"].number(), d["z"].number()));
  }
  return add_beams(input, context, points, events);
}

const char* decode_sonar_detections(const RosInput& input, RosContext& context, std::vector<Event>& events) {
  const RosMessage& message = input.message;
  const std::vector<double> times = message["two_way_travel_times"].numbers();
  const std::vector<double> tx = message["tx_angles"].numbers(), rx = message["rx_angles"].numbers();
  const double stated = message["ping_info"]["sound_speed"].number();
  const double sound = stated > 0 ? stated : context.config.sound_speed;
  if (rx.size() != times.size() || (!tx.empty() && tx.size() != times.size())) {
    return "swath whose beams and travel times differ in number";
  }
  const std::vector<bool> good = good_beams(message, times.size());
  std::vector<Eigen::Vector3d> points;
  for (std::size_t i = 0; i < times.size(); ++i) {
    const double along = tx.empty() ? 0 : std::sin(tx[i]), across = std::sin(rx[i]);
    const double ahead = 1 - along * along - across * across;
    if (good[i] && ahead >= 0)
      points.push_back(times[i] * sound / 2 * Eigen::Vector3d(along, across, std::sqrt(ahead)));
  }
  return add_beams(input, context, points, events);
}

const char* decode_range(const RosInput& input, RosContext& context, std::vector<Event>& events) {
  const RosMessage& message = input.message;
  const double range = message["range"].number(), field = message["field_of_view"].number();
  const double nearest = message["min_range"].number(), farthest = message["max_range"].number();
  if (!message.ok()) return nullptr;
  if (std::isnan(range) || !usable(farthest)) return "range that is not a number or has no limit";
  RangeReading reading;
  reading.time = input.time;
  reading.max_range_m = farthest;
  reading.width = context.config.beam_width;
  if (reading.width.radians() <= 0 && field > 0 && field < std::numbers::pi) reading.width = Angle::radians(field);
  reading.X_BS = context.mount(input.frame, RosAxes::kForwardPortUp);
  if (range <= farthest) reading.range_m = std::max({range, nearest, 0.0});  // minus infinity: it touches
  events.emplace_back(reading);
  return nullptr;
}

}  // namespace isobath
