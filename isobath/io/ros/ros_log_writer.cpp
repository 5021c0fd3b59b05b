#include <algorithm>
#include <cmath>
#include <cstring>
#include <fmt/format.h>
#include <isobath/base/error.hpp>
#include <isobath/io/mcap/foxglove.hpp>
#include <isobath/io/mcap/native_log_encoding.hpp>
#include <isobath/io/mcap/native_log_kinds.hpp>
#include <isobath/io/ros/ros_log_writer.hpp>
#include <limits>

namespace isobath {
namespace {

constexpr std::size_t kMaxStaticFrames = 1000, kMaxRepeatedFrames = 16;
constexpr const char* kVehicleFrame = "base_link";

/// "isobath/msg/Ping" -> "isobath_msgs/Ping".
std::string record_type(const native::RecordKind& kind) {
  const std::string_view name = kind.name;
  return std::string(kRecordPackage).append(name.substr(name.rfind('/') + 1));
}

bool same_pose(const Pose& a, const Pose& b) {
  return a.translation == b.translation && a.rotation.quaternion().coeffs() == b.rotation.quaternion().coeffs();
}

/// The samples of a ping with the beams of one range together, as the images of marine_acoustic_msgs have them.
std::vector<std::uint8_t> samples_by_range(const Intensities& samples, std::size_t size) {
  std::vector<std::uint8_t> out(size * static_cast<std::size_t>(samples.beams()) *
                                static_cast<std::size_t>(samples.bins()));
  std::uint8_t* to = out.data();
  for (int k = 0; k < samples.bins(); ++k) {
    const std::byte* at = samples.data() + k * samples.bin_stride();
    for (int b = 0; b < samples.beams(); ++b, at += samples.beam_stride(), to += size) std::memcpy(to, at, size);
  }
  return out;
}

}  // namespace

RosLogWriter::RosLogWriter(RosRecorder& recorder, const RosLogOptions& options)
    : recorder_(recorder), options_(options) {}

void RosLogWriter::set_origin(const GeoOrigin& origin) {
  origin_ = origin;
  origin_written_ = false;
}

bool RosLogWriter::write(const Event& event) {
  time_ = time_of(event);
  const auto refuse = [&](const char* reason) {
    ++left_out_[reason];
    return false;
  };
  if (!ros_can_hold(time_, recorder_.encoding())) return refuse("time that the headers of ROS cannot state");
  if (const Ping* ping = std::get_if<Ping>(&event); ping && !native::writable(*ping)) {
    return refuse("ping without samples");
  }
  write_origin();
  if (options_.records) write_record(event);
  const char* const without = std::visit([&](const auto& e) { return put(e); }, event);
  if (!without) return true;
  if (!options_.records) return refuse(without);
  ++records_only_[without];
  return true;
}

RosWriter& RosLogWriter::message(std::string_view topic, std::string_view type, bool latched) {
  auto known = topics_.find(topic);
  if (known == topics_.end()) {
    auto definition = RosDefinition::parse(type, known_ros_definition(type, recorder_.encoding()));
    ISOBATH_ASSERT(definition.has_value());
    const std::size_t index = recorder_.add_topic({std::string(topic), std::string(type), latched, 0});
    known = topics_.emplace(topic, Topic{index, RosWriter(*std::move(definition), recorder_.encoding())}).first;
  }
  return known->second.writer.begin();
}

void RosLogWriter::send(std::string_view topic) {
  Topic& t = topics_.find(topic)->second;
  recorder_.write(t.index, time_of_recording(), t.writer.done());
}

/// The time of the event, but later than that of the message before, so that tools which sort messages by their time
/// keep the order; and not 0, which readers of ROS take for "not set".
Time RosLogWriter::time_of_recording() {
  constexpr Duration kMaxDisorder = std::chrono::seconds(60);  // after a wrong time far ahead the clock goes back
  const bool goes_on = time_ >= recorded_ - kMaxDisorder;
  recorded_ = std::max(time_, (goes_on ? recorded_ : Time{}) + std::chrono::nanoseconds(1));
  return recorded_;
}

void RosLogWriter::write_record(const Event& event) {
  const native::RecordKind& kind = *native::kEventKinds[event.index()];
  const std::string topic = std::string("/isobath") + kind.topic;
  (void)message(topic, record_type(kind));
  const Topic& t = topics_.find(topic)->second;
  if (const Ping* ping = std::get_if<Ping>(&event)) {
    native::encode_geometry(*ping, record_);
  } else {
    native::encode(event, record_);
  }
  if (recorder_.encoding() == RosEncoding::kRos1) {
    auto packed = recoded(t.writer.definition(), std::as_bytes(std::span(record_)), RosEncoding::kCdr);
    ISOBATH_ASSERT(packed.has_value());
    record_ = *std::move(packed);
  }
  recorder_.write(t.index, time_of_recording(), record_);
}

void RosLogWriter::write_origin() {
  if (origin_written_) return;
  origin_written_ = true;
  message("/origin", "geographic_msgs/GeoPointStamped", true)
      .header(time_, "earth")
      .numbers({origin_->latitude_deg, origin_->longitude_deg, std::numeric_limits<double>::quiet_NaN()});
  send("/origin");
}

std::string RosLogWriter::frame_of(const std::string& sensor, const Pose& X_BS, RosAxes axes) {
  const Pose body{from_starboard_down(RosAxes::kForwardPortUp), Eigen::Vector3d::Zero()};
  const Pose X = body * X_BS * Pose{from_starboard_down(axes).inverse(), Eigen::Vector3d::Zero()};
  std::size_t of_sensor = 1;
  for (const Mounting& m : mountings_) {
    const bool mine = m.child == sensor || m.child.starts_with(sensor + "_");
    if (mine && same_pose(m.X, X)) return m.child;
    of_sensor += mine ? 1 : 0;
  }
  if (mountings_.size() >= kMaxStaticFrames) {  // a sensor that moves on the vehicle
    const std::string child = sensor + "_moving";
    put_transform("/tf", {{kVehicleFrame, child, X}}, false);
    return child;
  }
  mountings_.push_back({kVehicleFrame, of_sensor == 1 ? sensor : fmt::format("{}_{}", sensor, of_sensor), X});
  // All of them, since only the last message reaches late subscribers of ROS 1; with many, such as one for each beam of
  // an echo sounder, only the new one.
  const bool repeats = mountings_.size() <= kMaxRepeatedFrames;
  put_transform("/tf_static", repeats ? mountings_ : std::vector<Mounting>{mountings_.back()}, true);
  return mountings_.back().child;
}

void RosLogWriter::put_transform(std::string_view topic, const std::vector<Mounting>& transforms, bool latched) {
  RosWriter& w = message(topic, "tf2_msgs/TFMessage", latched).count(transforms.size());
  for (const Mounting& m : transforms) {
    const Eigen::Vector3d& p = m.X.translation;
    const Eigen::Quaterniond& q = m.X.rotation.quaternion();
    w.header(time_, m.parent).text(m.child).numbers({p.x(), p.y(), p.z(), q.x(), q.y(), q.z(), q.w()});
  }
  send(topic);
}

const char* RosLogWriter::put(const Ping& ping) {
  if (!ping.X_BS.is_finite()) return "pings whose mounting is not finite";
  const SampleType type = ping.intensity.type();
  const std::size_t size = type == SampleType::kU8 ? 1 : type == SampleType::kU16 ? 2 : 4;
  const double kind = type == SampleType::kU8 ? 0 : type == SampleType::kU16 ? 2 : 8;  // DTYPE_*
  const std::string frame = frame_of("sonar", ping.X_BS, RosAxes::kUpStarboardForward);
  const BeamFan& fan = *ping.fan;
  RosWriter& w = message("/sonar/image", "marine_acoustic_msgs/ProjectedSonarImage").header(time_, frame);
  std::vector<double> values(fan.azimuth.size(), fan.height.radians());
  w.numbers({0, ping.sound_speed}).array(values);  // frequency: not known
  std::ranges::transform(fan.width, values.begin(), [](Angle width) { return width.radians(); });
  w.array(values).count(fan.azimuth.size());
  for (const Angle azimuth : fan.azimuth) w.numbers({0, std::sin(azimuth.radians()), std::cos(azimuth.radians())});
  values.resize(static_cast<std::size_t>(ping.window.bins));
  for (int k = 0; k < ping.window.bins; ++k) values[static_cast<std::size_t>(k)] = ping.window.centre(k);
  w.array(values)
      .numbers({0, kind, static_cast<double>(fan.beams())})
      .raw_array(samples_by_range(ping.intensity, size));
  send("/sonar/image");
  return nullptr;
}

const char* RosLogWriter::put(const RangeReading& reading) {
  if (!reading.X_BS.is_finite()) return "ranges whose mounting is not finite";
  const std::string frame = frame_of("range", reading.X_BS, RosAxes::kForwardPortUp);
  const double none = std::numeric_limits<double>::infinity();
  message("/range", "sensor_msgs/Range")
      .header(time_, frame)
      .numbers({0, reading.width.radians(), 0, reading.max_range_m, reading.range_m.value_or(none)});
  send("/range");
  return nullptr;
}

const char* RosLogWriter::put(const Health& health) {
  const double level = health.state == HealthState::kOk ? 0 : health.state == HealthState::kDegraded ? 1 : 2;
  message("/diagnostics", "diagnostic_msgs/DiagnosticArray")
      .header(time_, "")
      .count(1)
      .number(level)
      .text(health.source)
      .text(health.note.empty() ? to_text(health.state) : health.note)
      .text("")
      .count(2)
      .text("battery_share")
      .text(fmt::format("{}", health.battery_share))
      .text("leak")
      .text(health.leak ? "true" : "false");
  send("/diagnostics");
  return nullptr;
}

const char* RosLogWriter::put(const Swath& swath) {
  std::string frame = kVehicleFrame;
  if (swath.frame == Swath::Frame::kLevel) {
    if (!X_WB_) return "level soundings before the first fix";
    const Pose X_WF = frame_in_world(swath, *X_WB_);
    if (!X_WF.is_finite()) return "level soundings whose heading is not finite";
    frame = "level";
    put_transform("/tf", {{"map", frame, to_east_north_up(X_WF)}}, false);
  }
  struct Column {
    const char* name;
    int offset, type;
  };
  constexpr int kU8 = 2, kU16 = 4, kF32 = 7, kPointBytes = 20;
  constexpr Column kColumns[] = {{"x", 0, kF32},      {"y", 4, kF32},     {"z", 8, kF32},
                                 {"range", 12, kF32}, {"beam", 16, kU16}, {"kind", 18, kU8}};
  const auto count = static_cast<double>(swath.soundings.size());
  RosWriter& w = message("/soundings", "sensor_msgs/PointCloud2").header(time_, frame).numbers({1, count});
  w.count(std::size(kColumns));
  for (const Column& c : kColumns) w.text(c.name).numbers({double(c.offset), double(c.type), 1});
  std::vector<std::uint8_t> points(swath.soundings.size() * kPointBytes);
  for (std::size_t i = 0; i < swath.soundings.size(); ++i) {
    const Sounding& s = swath.soundings[i];
    const float numbers[] = {s.point.x(), -s.point.y(), -s.point.z(), s.range_m};
    std::uint8_t* const to = points.data() + i * kPointBytes;
    std::memcpy(to, numbers, sizeof numbers);
    std::memcpy(to + 16, &s.beam, sizeof s.beam);
    to[18] = static_cast<std::uint8_t>(s.kind);
  }
  w.numbers({0, kPointBytes, kPointBytes * count}).raw_array(points).number(1);
  send("/soundings");
  return nullptr;
}

}  // namespace isobath
