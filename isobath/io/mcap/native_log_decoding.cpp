#include <algorithm>
#include <cmath>
#include <cstring>
#include <isobath/io/bytes/cdr.hpp>
#include <isobath/io/mcap/native_log_decoding.hpp>
#include <isobath/io/mcap/native_log_kinds.hpp>
#include <limits>
#include <vector>

namespace isobath::native {
namespace {

using Eigen::Quaterniond;
using Eigen::Vector3d;

constexpr std::size_t kMaxFanBytes = 64u << 20;

double double_at(std::span<const std::uint8_t> bytes, std::size_t i) {
  double value = 0;
  std::memcpy(&value, bytes.data() + 8 * i, 8);
  return value;
}

/// Sets `bad` if the quaternion is finite but not a rotation.
Pose take_pose(CdrReader& r, bool& bad) {
  Pose pose;
  for (int i = 0; i < 3; ++i) pose.translation[i] = r.number<double>();
  Quaterniond q;
  for (int i = 0; i < 4; ++i) q.coeffs()[i] = r.number<double>();
  bad = bad || std::abs(q.norm() - 1) > 1e-6;  // false for nan: a pose that is not finite is refused later
  pose.rotation = Rotation::from_unit_quaternion(q);
  return pose;
}

Time take_time(CdrReader& r) { return Time{Duration(r.number<std::int64_t>())}; }

std::optional<Event> take_navigation(std::span<const std::uint8_t> data) {
  CdrReader r(data);
  Navigation n;
  bool bad = false;
  n.time = take_time(r);
  n.X_WB = take_pose(r, bad);
  const auto velocity = r.sequence<double>();
  const auto covariance = r.sequence<double>();
  const auto v_sigma = r.sequence<double>();
  if (bad || !r.ok() || (!velocity.empty() && velocity.size() != 24)) return std::nullopt;
  if ((!covariance.empty() && covariance.size() != 288) || v_sigma.size() > 8) return std::nullopt;
  if (!v_sigma.empty()) n.v_sigma = double_at(v_sigma, 0);
  if (!velocity.empty()) n.v_WB = Vector3d(double_at(velocity, 0), double_at(velocity, 1), double_at(velocity, 2));
  if (!covariance.empty()) {
    n.covariance.emplace();
    for (int i = 0; i < 36; ++i) (*n.covariance)(i / 6, i % 6) = double_at(covariance, i);
  }
  return n;
}

std::optional<Event> take_range(std::span<const std::uint8_t> data) {
  CdrReader r(data);
  RangeReading reading;
  bool bad = false;
  reading.time = take_time(r);
  reading.X_BS = take_pose(r, bad);
  reading.max_range_m = r.number<double>();
  reading.width = Angle::radians(r.number<double>());
  reading.confidence = r.number<float>();
  const auto range = r.sequence<double>();
  if (bad || !r.ok() || range.size() > 8) return std::nullopt;
  if (!range.empty()) reading.range_m = double_at(range, 0);
  return reading;
}

std::optional<Event> take_health(std::span<const std::uint8_t> data) {
  CdrReader r(data);
  Health health;
  health.time = take_time(r);
  health.source = r.text();
  const auto state = r.number<std::uint8_t>();
  health.battery_share = r.number<float>();
  health.leak = r.number<std::uint8_t>() != 0;
  health.note = r.text();
  if (!r.ok() || state > 2) return std::nullopt;
  health.state = static_cast<HealthState>(state);
  return health;
}

std::optional<Event> take_operator_frame(std::span<const std::uint8_t> data) {
  CdrReader r(data);
  OperatorFrame frame;
  frame.time = take_time(r);
  const auto bytes = r.sequence<std::uint8_t>();
  if (!r.ok()) return std::nullopt;
  frame.bytes.assign(bytes.begin(), bytes.end());
  return frame;
}

std::optional<Event> take_bearing(std::span<const std::uint8_t> data) {
  CdrReader r(data);
  PassiveBearing heard;
  bool bad = false;
  heard.time = take_time(r);
  heard.X_BS = take_pose(r, bad);
  heard.bearing = Angle::radians(r.number<double>());
  heard.sigma = Angle::radians(r.number<double>());
  heard.frequency_hz = r.number<double>();
  heard.resolution_hz = r.number<double>();
  heard.snr_db = r.number<double>();
  const auto elevation = r.sequence<double>();
  if (bad || !r.ok() || elevation.size() > 8) return std::nullopt;
  if (!elevation.empty()) heard.elevation = Angle::radians(double_at(elevation, 0));
  return heard;
}

template <class Number>
Number number_at(std::span<const std::uint8_t> bytes, std::size_t i) {
  Number value{};
  std::memcpy(&value, bytes.data() + sizeof value * i, sizeof value);
  return value;
}

std::optional<Event> take_swath(std::span<const std::uint8_t> data) {
  CdrReader r(data);
  Swath swath;
  swath.time = take_time(r);
  const auto frame = r.number<std::uint8_t>();
  const auto heading = r.sequence<double>();
  swath.beam_width = Angle::radians(r.number<double>());
  swath.sound_speed = r.number<double>();
  const auto x = r.sequence<float>(), y = r.sequence<float>(), z = r.sequence<float>();
  const auto range = r.sequence<float>(), sigma = r.sequence<float>();
  const auto beam = r.sequence<std::uint16_t>();
  const auto kind = r.sequence<std::uint8_t>();
  const std::size_t count = kind.size();
  const bool older = r.at_end();  // from before the height of the beams was added
  if (!older) swath.beam_height = Angle::radians(r.number<double>());
  const bool without_range_sigma = r.at_end();  // from before the standard deviation of ranges was added
  const auto sigma_range = without_range_sigma ? std::span<const std::uint8_t>() : r.sequence<float>();
  if (!without_range_sigma && sigma_range.size() != 4 * count) return std::nullopt;
  if (!r.ok() || frame > 1 || heading.size() > 8 || beam.size() != 2 * count) return std::nullopt;
  for (const auto& column : {x, y, z, range, sigma}) {
    if (column.size() != 4 * count) return std::nullopt;
  }
  if (std::any_of(kind.begin(), kind.end(), [](std::uint8_t k) { return k > 1; })) return std::nullopt;
  swath.frame = static_cast<Swath::Frame>(frame);
  if (!heading.empty()) swath.heading = Angle::radians(double_at(heading, 0));
  swath.soundings.resize(count);
  for (std::size_t i = 0; i < count; ++i) {
    Sounding& s = swath.soundings[i];
    s.point = {number_at<float>(x, i), number_at<float>(y, i), number_at<float>(z, i)};
    s.range_m = number_at<float>(range, i);
    s.sigma_m = number_at<float>(sigma, i);
    s.beam = number_at<std::uint16_t>(beam, i);
    s.kind = static_cast<Sounding::Kind>(kind[i]);
    if (!without_range_sigma) s.sigma_range_m = number_at<float>(sigma_range, i);
  }
  return swath;
}

std::optional<Vector3d> take_vector(CdrReader& r) {
  const auto bytes = r.sequence<double>();
  if (bytes.size() != 24) return std::nullopt;
  return Vector3d(double_at(bytes, 0), double_at(bytes, 1), double_at(bytes, 2));
}

struct Samples {
  std::span<const std::uint8_t> bytes;
  SampleType type = SampleType::kU8;
};

/// The one list that is filled, or one without bytes; empty if several are filled.
std::optional<Samples> take_samples(CdrReader& r) {
  const Samples lists[] = {{r.sequence<std::uint8_t>(), SampleType::kU8},
                           {r.sequence<std::uint16_t>(), SampleType::kU16},
                           {r.sequence<float>(), SampleType::kF32}};
  const auto filled = [](const Samples& s) { return !s.bytes.empty(); };
  if (!r.ok() || std::count_if(std::begin(lists), std::end(lists), filled) > 1) return std::nullopt;
  const auto* const found = std::find_if(std::begin(lists), std::end(lists), filled);
  return found == std::end(lists) ? Samples() : *found;
}

std::size_t size_of(SampleType type) {
  switch (type) {
    case SampleType::kU8: return 1;
    case SampleType::kU16: return 2;
    case SampleType::kF32: return 4;
  }
  return 0;
}

/// The sampled span of each beam, as pairs of first and end; null if a span does not fit into `bins`.
std::shared_ptr<const std::vector<BinSpan>> take_spans(std::span<const std::uint8_t> ends, std::uint32_t bins) {
  auto made = std::make_shared<std::vector<BinSpan>>();
  for (std::size_t i = 0; i + 8 <= ends.size(); i += 8) {
    std::uint32_t first = 0, end = 0;
    std::memcpy(&first, ends.data() + i, 4);
    std::memcpy(&end, ends.data() + i + 4, 4);
    if (first > end || end > bins) return nullptr;
    made->push_back({static_cast<int>(first), static_cast<int>(end)});
  }
  return made;
}

/// Everything but the intensities; `samples` gets their bytes, which may be none.
std::optional<Ping> take_ping(std::span<const std::uint8_t> data, FanStore& fans, Samples& samples) {
  CdrReader r(data);
  Ping p;
  bool bad = false;
  p.time = take_time(r);
  p.X_BS = take_pose(r, bad);
  p.sound_speed = r.number<double>();
  p.window.start_m = r.number<double>();
  p.window.bin_m = r.number<double>();
  const auto bins = r.number<std::uint32_t>();
  p.full_scale = r.number<float>();
  p.blanking_m = r.number<double>();
  const auto sweep = r.number<std::uint8_t>();
  const auto height = r.number<double>();
  const auto azimuths = r.sequence<double>();
  const auto widths = r.sequence<double>();
  const auto taken = take_samples(r);
  if (bad || !taken || sweep > 2 || azimuths.empty() || azimuths.size() != widths.size()) return std::nullopt;
  samples = *taken;
  const std::uint64_t beams = azimuths.size() / 8;
  if (bins > std::numeric_limits<int>::max() || beams > 1u << 20) return std::nullopt;
  p.sweep = static_cast<SweepMark>(sweep);
  p.window.bins = static_cast<int>(bins);
  p.fan = fans.fan(height, azimuths, widths);
  const bool older = r.at_end();  // from before this field was added
  const auto sampled = older ? std::span<const std::uint8_t>() : r.sequence<std::uint32_t>();
  if (!r.ok() || (!sampled.empty() && sampled.size() != beams * 8)) return std::nullopt;
  if (!sampled.empty()) p.sampled = take_spans(sampled, bins);
  if (!sampled.empty() && !p.sampled) return std::nullopt;
  return p;
}

std::optional<Event> take_whole_ping(const McapMessage& message, FanStore& fans) {
  Samples samples;
  auto p = take_ping(message.data, fans, samples);
  if (!p || samples.bytes.empty()) return std::nullopt;
  const int beams = p->fan->beams();
  const std::size_t size = size_of(samples.type);
  if (samples.bytes.size() != size * static_cast<std::size_t>(beams) * static_cast<std::size_t>(p->window.bins)) {
    return std::nullopt;
  }
  const auto step = static_cast<std::ptrdiff_t>(size);
  p->intensity = Intensities(samples.bytes.data(), samples.type, beams, p->window.bins, step * p->window.bins, step);
  p->storage = message.storage;
  return *std::move(p);
}

}  // namespace

std::shared_ptr<const BeamFan> FanStore::fan(double height, std::span<const std::uint8_t> azimuths,
                                             std::span<const std::uint8_t> widths) {
  std::string key(reinterpret_cast<const char*>(&height), sizeof height);
  key.append(azimuths.begin(), azimuths.end()).append(widths.begin(), widths.end());
  auto& known = fans_[key];
  if (!known) {
    auto made = std::make_shared<BeamFan>();
    made->height = Angle::radians(height);
    for (std::size_t i = 0; i < azimuths.size() / 8; ++i) {
      made->azimuth.push_back(Angle::radians(double_at(azimuths, i)));
      made->width.push_back(Angle::radians(double_at(widths, i)));
    }
    known = std::move(made);
    bytes_ = fans_.size() == 1 ? key.size() : bytes_ + key.size();
  }
  auto result = known;
  if (bytes_ > kMaxFanBytes) fans_.clear();  // bounds the memory if every ping has other beams
  return result;
}

std::optional<Event> decode_event(std::string_view kind, const McapMessage& message, FanStore& fans) {
  if (kind == kPing.name) return take_whole_ping(message, fans);
  if (kind == kNavigation.name) return take_navigation(message.data);
  if (kind == kRange.name) return take_range(message.data);
  if (kind == kHealth.name) return take_health(message.data);
  if (kind == kSwath.name) return take_swath(message.data);
  if (kind == kOperatorFrame.name) return take_operator_frame(message.data);
  if (kind == kBearing.name) return take_bearing(message.data);
  return std::nullopt;
}

std::optional<Ping> decode_geometry(std::span<const std::uint8_t> record, FanStore& fans) {
  Samples samples;
  auto ping = take_ping(record, fans, samples);
  if (ping && !samples.bytes.empty()) return std::nullopt;
  return ping;
}

std::optional<TrueMotion> decode_motion(std::span<const std::uint8_t> record) {
  CdrReader r(record);
  TrueMotion motion;
  bool bad = false;
  motion.time = take_time(r);
  motion.state.X_WB = take_pose(r, bad);
  const auto velocity = take_vector(r), rates = take_vector(r), current = take_vector(r);
  const auto altitude = r.sequence<double>();
  if (bad || !r.ok() || !velocity || !rates || !current || altitude.size() > 8) return std::nullopt;
  motion.state.v_B = *velocity;
  motion.state.w_B = *rates;
  motion.current_W = *current;
  if (!altitude.empty()) motion.altitude_m = double_at(altitude, 0);
  return motion;
}

std::optional<EchoTruth> decode_echoes(std::span<const std::uint8_t> record) {
  CdrReader r(record);
  EchoTruth truth;
  truth.time = take_time(r);
  truth.sonar = r.text();
  const std::uint64_t beams = r.number<std::uint32_t>(), bins = r.number<std::uint32_t>();
  const auto labels = r.sequence<std::uint16_t>();
  if (!r.ok() || beams > 1u << 20 || bins > 1u << 20 || labels.size() != beams * bins * 2) return std::nullopt;
  truth.beams = static_cast<int>(beams);
  truth.bins = static_cast<int>(bins);
  truth.labels.reserve(labels.size() / 2);
  for (std::size_t i = 0; i < labels.size(); i += 2) {
    const int code = labels[i] | labels[i + 1] << 8;
    truth.labels.emplace_back(code >> 4, static_cast<EchoPath>(code & 0xf));
  }
  return truth;
}

}  // namespace isobath::native
