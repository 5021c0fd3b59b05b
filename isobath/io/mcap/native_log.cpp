#include <algorithm>
#include <charconv>
#include <fmt/format.h>
#include <fstream>
#include <isobath/base/error.hpp>
#include <isobath/io/bytes/cdr.hpp>
#include <isobath/io/mcap/native_log.hpp>
#include <limits>

namespace isobath {
namespace {

using Eigen::Quaterniond;
using Eigen::Vector3d;

constexpr const char* kPing = "isobath/msg/Ping";
constexpr const char* kNavigation = "isobath/msg/Navigation";
constexpr const char* kRange = "isobath/msg/RangeReading";
constexpr const char* kHealth = "isobath/msg/Health";
constexpr const char* kSwath = "isobath/msg/Swath";
constexpr const char* kOperatorFrame = "isobath/msg/OperatorFrame";
constexpr const char* kTrueMotion = "isobath/msg/TrueMotion";
constexpr const char* kEchoTruth = "isobath/msg/EchoTruth";
constexpr const char* kSetpoint = "isobath/msg/Setpoint";
constexpr const char* kDecision = "isobath/msg/Decision";
constexpr const char* kOrigin = "isobath/origin";
constexpr const char* kDetails = "isobath/source";
constexpr const char* kConfiguration = "isobath/configuration";

const std::string kPoseDefinition = std::string(80, '=') +
                                    "\nMSG: isobath/Pose\n"
                                    "# North-east-down or forward-starboard-down axes; unit quaternion.\n"
                                    "float64 x\nfloat64 y\nfloat64 z\nfloat64 qx\nfloat64 qy\nfloat64 qz\nfloat64 qw\n";

const std::string kPingDefinition =
    "# One transmission of an imaging sonar: a fan of beams by range bins. SI units.\n"
    "int64 time_ns             # since 1970 (UTC), or since the start of a log without a date\n"
    "isobath/Pose sensor       # sensor in body\n"
    "float64 sound_speed       # that the ranges were computed with\n"
    "float64 range_start       # near edge of the first bin\n"
    "float64 bin_length\n"
    "uint32 bins\n"
    "float32 full_scale        # value of a saturated sample\n"
    "float64 blind_m           # nearer samples hold the sonar's own transmission; 0: not stated\n"
    "uint8 sweep               # of a scanning head: 0 unknown, 1 inside a sweep, 2 its end\n"
    "float64 beam_height       # full -3 dB width in elevation, rad\n"
    "float64[] azimuth         # of each beam, clockwise seen from above, rad\n"
    "float64[] beam_width      # full -3 dB width of each beam, rad\n"
    "uint8[] samples_u8        # beam by beam, nearest bin first; one of the three lists is filled\n"
    "uint16[] samples_u16\n"
    "float32[] samples_f32\n"
    "uint32[] sampled          # of each beam the first bin that was sampled and the one behind the last; empty: "
    "all\n" +
    kPoseDefinition;

const std::string kNavigationDefinition =
    "# One fix of the vehicle's own estimate of where it is. SI units, world north-east-down.\n"
    "int64 time_ns\n"
    "isobath/Pose body         # body in world\n"
    "float64[] velocity        # of the body in the world: north, east, down; empty: unknown\n"
    "float64[] covariance      # 6 x 6 by rows, of position (world) and rotation vector (body); empty: unknown\n"
    "float64[] velocity_sigma  # standard deviation of the velocity in the plane; empty: not stated\n" +
    kPoseDefinition;

const std::string kRangeDefinition =
    "# A single range with the cone it was measured in. SI units.\n"
    "int64 time_ns\n"
    "isobath/Pose sensor       # sensor in body; x is the axis of the cone\n"
    "float64 max_range\n"
    "float64 width             # full width of the cone, rad\n"
    "float32 confidence        # 0 to 1\n"
    "float64[] range           # empty: no echo within max_range\n" +
    kPoseDefinition;

const std::string kHealthDefinition =
    "# How the vehicle, or one of its sensors, is.\n"
    "int64 time_ns\n"
    "string source             # vehicle, or the name of a sensor\n"
    "uint8 state               # 0 sound, 1 degraded, 2 lost\n"
    "float32 battery           # share of a full charge\n"
    "bool leak\n"
    "string note\n";

const std::string kSwathDefinition =
    "# The soundings of one transmission of a multibeam echo sounder. SI units.\n"
    "int64 time_ns\n"
    "uint8 frame               # of the points: 0 body, 1 level: x forward, y starboard, z below the water surface\n"
    "float64[] heading         # of the ping, rad; empty: that of the pose\n"
    "float64 beam_width        # full, rad; 0: not known\n"
    "float64 sound_speed       # at the transducer; 0: not stated\n"
    "float32[] x               # one element a sounding in each of the lists: forward\n"
    "float32[] y               # starboard\n"
    "float32[] z               # down\n"
    "float32[] range           # slant range from the transducer\n"
    "float32[] sigma           # standard deviation of the depth; 0: not stated\n"
    "uint16[] beam\n"
    "uint8[] kind              # 0 bottom, 1 something in the water\n";

const std::string kOperatorFrameDefinition =
    "# One frame of the operator's link, as it arrived at the vehicle.\n"
    "int64 time_ns\n"
    "uint8[] bytes\n";

const std::string kTrueMotionDefinition =
    "# Where a simulated vehicle really is. SI units, world north-east-down.\n"
    "int64 time_ns\n"
    "isobath/Pose body         # body in world\n"
    "float64[] velocity        # over ground, components in the body\n"
    "float64[] rates           # roll, pitch, yaw rate\n"
    "float64[] current         # of the water: north, east, down\n"
    "float64[] altitude        # above the bottom; empty: no bottom below\n" +
    kPoseDefinition;

const std::string kEchoTruthDefinition =
    "# What each sample of a simulated ping really is.\n"
    "int64 time_ns             # of the ping\n"
    "string sonar\n"
    "uint32 beams\n"
    "uint32 bins\n"
    "uint16[] labels           # beam by beam. Upper 12 bits: 0 nothing, 1 surface, 2 bottom, 3.. bodies of the "
    "scene;\n"
    "                          # lower 4: 0 noise, 1 direct, 2 side lobe, 3 surface bounce, 4 bottom bounce,\n"
    "                          # 5 body bounce, 6 multiple, 7 volume, 8 ringing, 9 spurious, 10 disturbance\n";

const std::string kSetpointDefinition =
    "# What the vehicle is told to do from this time on. SI units.\n"
    "int64 time_ns\n"
    "float64 heading           # clockwise from north, rad\n"
    "float64 depth\n"
    "float64 speed             # ahead\n"
    "float64 sway_speed        # to starboard\n";

const std::string kDecisionDefinition =
    R"({"type": "object", "properties": {"time_ns": {"type": "integer"}, "agent": {"type": "string"},
"what": {"type": "string"}, "reason": {"type": "string"}}, "required": ["time_ns", "agent", "what", "reason"]})";

void put_pose(CdrWriter& w, const Pose& pose) {
  for (int i = 0; i < 3; ++i) w.number(pose.translation[i]);
  for (int i = 0; i < 4; ++i) w.number(pose.rotation.quaternion().coeffs()[i]);  // x y z w
}

template <class Values>
void put_doubles(CdrWriter& w, const Values& values, std::size_t count) {
  std::uint8_t* at = w.sequence<double>(count);
  for (std::size_t i = 0; i < count; ++i) {
    const double value = values(i);
    std::memcpy(at + 8 * i, &value, 8);
  }
}

bool writable(const Ping& p) {
  return p.fan && p.fan->beams() > 0 && p.fan->width.size() == p.fan->azimuth.size() && p.intensity.data() &&
         p.window.bins > 0 && p.intensity.beams() == p.fan->beams() && p.intensity.bins() == p.window.bins &&
         (!p.sampled || p.sampled->size() == p.fan->azimuth.size());
}

std::size_t size_of(SampleType type) {
  switch (type) {
    case SampleType::kU8: return 1;
    case SampleType::kU16: return 2;
    case SampleType::kF32: return 4;
  }
  return 0;
}

template <std::size_t kSize>
void copy_beam_by_beam(const Intensities& samples, std::uint8_t* out) {
  for (int b = 0; b < samples.beams(); ++b) {
    const std::byte* at = samples.data() + b * samples.beam_stride();
    for (int k = 0; k < samples.bins(); ++k, at += samples.bin_stride(), out += kSize) std::memcpy(out, at, kSize);
  }
}

void put_samples(CdrWriter& w, const Intensities& samples) {
  const std::size_t count = static_cast<std::size_t>(samples.beams()) * samples.bins();
  const SampleType type = samples.type();
  std::uint8_t* u8 = w.sequence<std::uint8_t>(type == SampleType::kU8 ? count : 0);
  if (type == SampleType::kU8) copy_beam_by_beam<1>(samples, u8);
  std::uint8_t* u16 = w.sequence<std::uint16_t>(type == SampleType::kU16 ? count : 0);
  if (type == SampleType::kU16) copy_beam_by_beam<2>(samples, u16);
  std::uint8_t* f32 = w.sequence<float>(type == SampleType::kF32 ? count : 0);
  if (type == SampleType::kF32) copy_beam_by_beam<4>(samples, f32);
}

void put(CdrWriter& w, const Ping& p) {
  w.number(std::int64_t{p.time.time_since_epoch().count()});
  put_pose(w, p.X_BS);
  w.number(p.sound_speed).number(p.window.start_m).number(p.window.bin_m);
  w.number(static_cast<std::uint32_t>(p.window.bins)).number(p.full_scale).number(p.blind_m);
  w.number(static_cast<std::uint8_t>(p.sweep));
  w.number(p.fan->height.radians());
  put_doubles(
      w, [&](std::size_t i) { return p.fan->azimuth[i].radians(); }, p.fan->azimuth.size());
  put_doubles(
      w, [&](std::size_t i) { return p.fan->width[i].radians(); }, p.fan->width.size());
  put_samples(w, p.intensity);
  std::uint8_t* at = w.sequence<std::uint32_t>(p.sampled ? 2 * p.sampled->size() : 0);
  for (int b = 0; p.sampled && b < p.fan->beams(); ++b, at += 8) {
    const BinSpan span = sampled_bins(p, b);
    const std::uint32_t ends[] = {static_cast<std::uint32_t>(span.first), static_cast<std::uint32_t>(span.end)};
    std::memcpy(at, ends, sizeof ends);
  }
}

void put(CdrWriter& w, const Navigation& n) {
  w.number(std::int64_t{n.time.time_since_epoch().count()});
  put_pose(w, n.X_WB);
  put_doubles(
      w, [&](std::size_t i) { return (*n.v_WB)[i]; }, n.v_WB ? 3 : 0);
  put_doubles(
      w, [&](std::size_t i) { return (*n.covariance)(i / 6, i % 6); }, n.covariance ? 36 : 0);
  put_doubles(
      w, [&](std::size_t) { return *n.v_sigma; }, n.v_sigma ? 1 : 0);
}

void put(CdrWriter& w, const RangeReading& r) {
  w.number(std::int64_t{r.time.time_since_epoch().count()});
  put_pose(w, r.X_BS);
  w.number(r.max_range_m).number(r.width.radians()).number(r.confidence);
  put_doubles(
      w, [&](std::size_t) { return *r.range_m; }, r.range_m ? 1 : 0);
}

void put(CdrWriter& w, const Health& h) {
  w.number(std::int64_t{h.time.time_since_epoch().count()}).text(h.source);
  w.number(static_cast<std::uint8_t>(h.state)).number(h.battery_share);
  w.number(static_cast<std::uint8_t>(h.leak)).text(h.note);
}

void put(CdrWriter& w, const OperatorFrame& f) {
  w.number(std::int64_t{f.time.time_since_epoch().count()});
  std::copy(f.bytes.begin(), f.bytes.end(), w.sequence<std::uint8_t>(f.bytes.size()));
}

/// Writes one member of every sounding as a list.
template <class Number, class Member>
void put_column(CdrWriter& w, const std::vector<Sounding>& soundings, Member member) {
  std::uint8_t* at = w.sequence<Number>(soundings.size());
  for (const Sounding& s : soundings) {
    const Number value = member(s);
    std::memcpy(at, &value, sizeof value);
    at += sizeof value;
  }
}

void put(CdrWriter& w, const Swath& s) {
  w.number(std::int64_t{s.time.time_since_epoch().count()}).number(static_cast<std::uint8_t>(s.frame));
  put_doubles(
      w, [&](std::size_t) { return s.heading->radians(); }, s.heading ? 1 : 0);
  w.number(s.beam_width.radians()).number(s.sound_speed);
  for (Eigen::Index i = 0; i < 3; ++i) {
    put_column<float>(w, s.soundings, [i](const Sounding& p) { return p.point[i]; });
  }
  put_column<float>(w, s.soundings, [](const Sounding& p) { return p.range_m; });
  put_column<float>(w, s.soundings, [](const Sounding& p) { return p.sigma_m; });
  put_column<std::uint16_t>(w, s.soundings, [](const Sounding& p) { return p.beam; });
  put_column<std::uint8_t>(w, s.soundings, [](const Sounding& p) { return static_cast<std::uint8_t>(p.kind); });
}

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
  }
  return swath;
}

std::optional<Vector3d> take_vector(CdrReader& r) {
  const auto bytes = r.sequence<double>();
  if (bytes.size() != 24) return std::nullopt;
  return Vector3d(double_at(bytes, 0), double_at(bytes, 1), double_at(bytes, 2));
}

std::optional<TrueMotion> take_motion(std::span<const std::uint8_t> data) {
  CdrReader r(data);
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

std::optional<EchoTruth> take_echoes(std::span<const std::uint8_t> data) {
  CdrReader r(data);
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

/// Stores fans by their bytes, so that pings of the same geometry share one.
class FanStore {
 public:
  std::shared_ptr<const BeamFan> fan(double height, std::span<const std::uint8_t> azimuths,
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
    if (bytes_ > kMaxBytes) fans_.clear();  // bounds the memory if every ping has other beams
    return result;
  }

  /// The sampled span of each beam, as pairs of first and end; null if a span does not fit into `bins`.
  static std::shared_ptr<const std::vector<BinSpan>> spans(std::span<const std::uint8_t> ends, std::uint32_t bins) {
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

 private:
  static constexpr std::size_t kMaxBytes = 64u << 20;
  std::map<std::string, std::shared_ptr<const BeamFan>> fans_;
  std::size_t bytes_ = 0;
};

struct Samples {
  std::span<const std::uint8_t> bytes;
  SampleType type = SampleType::kU8;
};

/// The one list that is filled; empty if none or several are filled.
std::optional<Samples> take_samples(CdrReader& r) {
  const Samples lists[] = {{r.sequence<std::uint8_t>(), SampleType::kU8},
                           {r.sequence<std::uint16_t>(), SampleType::kU16},
                           {r.sequence<float>(), SampleType::kF32}};
  const auto filled = [](const Samples& s) { return !s.bytes.empty(); };
  if (!r.ok() || std::count_if(std::begin(lists), std::end(lists), filled) != 1) return std::nullopt;
  return *std::find_if(std::begin(lists), std::end(lists), filled);
}

std::optional<Event> take_ping(const McapMessage& message, FanStore& fans) {
  CdrReader r(message.data);
  Ping p;
  bool bad = false;
  p.time = take_time(r);
  p.X_BS = take_pose(r, bad);
  p.sound_speed = r.number<double>();
  p.window.start_m = r.number<double>();
  p.window.bin_m = r.number<double>();
  const auto bins = r.number<std::uint32_t>();
  p.full_scale = r.number<float>();
  p.blind_m = r.number<double>();
  const auto sweep = r.number<std::uint8_t>();
  const auto height = r.number<double>();
  const auto azimuths = r.sequence<double>();
  const auto widths = r.sequence<double>();
  const auto samples = take_samples(r);
  if (bad || !samples || sweep > 2 || azimuths.empty() || azimuths.size() != widths.size()) return std::nullopt;
  const std::uint64_t beams = azimuths.size() / 8, sample = size_of(samples->type);
  if (bins > std::numeric_limits<int>::max() || beams > 1u << 20 || samples->bytes.size() != beams * bins * sample) {
    return std::nullopt;
  }
  p.sweep = static_cast<SweepMark>(sweep);
  p.window.bins = static_cast<int>(bins);
  p.fan = fans.fan(height, azimuths, widths);
  const auto step = static_cast<std::ptrdiff_t>(sample);
  p.intensity = Intensities(samples->bytes.data(), samples->type, static_cast<int>(beams), p.window.bins,
                            step * p.window.bins, step);
  p.storage = message.storage;
  const bool older = r.at_end();  // from before this field was added
  const auto sampled = older ? std::span<const std::uint8_t>() : r.sequence<std::uint32_t>();
  if (!r.ok() || (!sampled.empty() && sampled.size() != beams * 8)) return std::nullopt;
  if (!sampled.empty()) p.sampled = fans.spans(sampled, bins);
  if (!sampled.empty() && !p.sampled) return std::nullopt;
  return p;
}

class NativeLogSource final : public Source {
 public:
  NativeLogSource(std::unique_ptr<std::istream> input, const std::string& name) : reader_(std::move(input), name) {
    reader_.report().format = "Isobath log (MCAP)";
    learn_metadata();
    waiting_ = next_event();
    std::string topics;
    bool ours = false;
    for (const auto& [id, channel] : reader_.channels()) {
      topics += (topics.empty() ? "" : ", ") + channel.topic;
      ours = ours || is_ours(channel);
    }
    if (!ours) {
      throw Error("MCAP without Isobath channels", {name, {}, {}, {}, {}},
                  fmt::format("{}, {}, {}, {}", kPing, kNavigation, kRange, kSwath),
                  topics.empty() ? "" : "it holds " + topics.substr(0, 200));
    }
  }

  std::optional<Event> next() override { return waiting_ ? std::exchange(waiting_, std::nullopt) : next_event(); }
  [[nodiscard]] const SourceReport& report() const override { return std::as_const(reader_).report(); }

 private:
  std::optional<Event> next_event() {
    while (const auto message = reader_.next()) {
      const McapChannel& channel = *reader_.channel(message->channel_id);
      const McapSchema* schema = reader_.schema(channel.schema_id);
      if (schema && is_aside(schema->name)) continue;
      if (!is_ours(channel)) {
        ++reader_.report().rejected["message of a channel that is not from Isobath"];
        continue;
      }
      if (auto event = decoded(schema->name, *message)) return event;
      ++reader_.report().rejected["message that cannot be decoded"];
    }
    learn_metadata();
    return std::nullopt;
  }

  [[nodiscard]] bool is_ours(const McapChannel& channel) const {
    const McapSchema* schema = reader_.schema(channel.schema_id);
    return schema && channel.message_encoding == "cdr" && schema->name.starts_with("isobath/msg/");
  }

  /// Channels that are not inputs of a vehicle: ground truth, which only the scorer may read, and derived data, which
  /// is computed again.
  static bool is_aside(const std::string& kind) {
    return kind == kTrueMotion || kind == kEchoTruth || kind == kSetpoint || kind == kDecision ||
           kind.starts_with("isobath.") || kind.starts_with("foxglove.");
  }

  std::optional<Event> decoded(const std::string& kind, const McapMessage& message) {
    if (kind == kPing) return take_ping(message, fans_);
    if (kind == kNavigation) return take_navigation(message.data);
    if (kind == kRange) return take_range(message.data);
    if (kind == kHealth) return take_health(message.data);
    if (kind == kSwath) return take_swath(message.data);
    if (kind == kOperatorFrame) return take_operator_frame(message.data);
    return std::nullopt;
  }

  void learn_metadata() {
    SourceReport& report = reader_.report();
    for (; metadata_seen_ < reader_.metadata().size(); ++metadata_seen_) {
      const McapMetadata& item = reader_.metadata()[metadata_seen_];
      if (item.name == kDetails) report.details.insert(item.values.begin(), item.values.end());
      if (item.name == kOrigin) learn_origin(item, report);
    }
  }

  static void learn_origin(const McapMetadata& item, SourceReport& report) {
    GeoOrigin origin;
    const auto read = [&](const char* key, double& value) {
      const auto at = item.values.find(key);
      if (at == item.values.end()) return false;
      const std::string& text = at->second;
      return std::from_chars(text.data(), text.data() + text.size(), value).ec == std::errc();
    };
    const bool complete = read("latitude_deg", origin.latitude_deg) && read("longitude_deg", origin.longitude_deg);
    if (complete && valid(origin)) report.origin = origin;
  }

  McapReader reader_;
  FanStore fans_;
  std::optional<Event> waiting_;
  std::size_t metadata_seen_ = 0;
};

}  // namespace

NativeLogWriter::NativeLogWriter(const std::filesystem::path& file, const McapWriterConfig& config)
    : mcap_(file, config) {
  const auto add = [&](const char* topic, const char* name, const std::string& definition) {
    const std::uint16_t schema = mcap_.add_schema({0, name, "ros2msg", definition});
    return mcap_.add_channel({0, schema, topic, "cdr", {}});
  };
  ping_ = add("/ping", kPing, kPingDefinition);
  navigation_ = add("/navigation", kNavigation, kNavigationDefinition);
  range_ = add("/range", kRange, kRangeDefinition);
  health_ = add("/health", kHealth, kHealthDefinition);
  swath_ = add("/swath", kSwath, kSwathDefinition);
}

void NativeLogWriter::set_details(const std::map<std::string, std::string>& details) {
  mcap_.add_metadata({kDetails, details});
}
void NativeLogWriter::set_configuration(const std::string& toml) {
  mcap_.add_metadata({kConfiguration, {{"toml", toml}}});
}
void NativeLogWriter::set_origin(const GeoOrigin& origin) {
  mcap_.add_metadata({kOrigin,
                      {{"latitude_deg", fmt::format("{}", origin.latitude_deg)},
                       {"longitude_deg", fmt::format("{}", origin.longitude_deg)}}});
}

bool NativeLogWriter::write(const Event& event) {
  if (const Ping* ping = std::get_if<Ping>(&event); ping && !writable(*ping)) return false;
  CdrWriter w(message_);
  std::visit([&](const auto& e) { put(w, e); }, event);
  if (std::holds_alternative<OperatorFrame>(event)) {
    late_channel(operator_, "/operator", kOperatorFrame, kOperatorFrameDefinition);
  }
  const std::uint16_t channels[] = {ping_, range_, navigation_, health_, swath_, operator_};  // in variant order
  static_assert(std::variant_size_v<Event> == std::size(channels));
  send(channels[event.index()], time_of(event), message_);
  return true;
}

void NativeLogWriter::send(std::uint16_t channel, Time at, std::span<const std::uint8_t> message) {
  // MCAP has no times before 1970; the message holds the exact time
  const auto time = static_cast<std::uint64_t>(std::max<std::int64_t>(at.time_since_epoch().count(), 0));
  mcap_.write({channel, sequence_[channel]++, time, time, message, nullptr});
}

std::uint16_t NativeLogWriter::late_channel(std::uint16_t& id, const char* topic, const char* name,
                                            const std::string& definition) {
  if (id == 0) id = mcap_.add_channel({0, mcap_.add_schema({0, name, "ros2msg", definition}), topic, "cdr", {}});
  return id;
}

void NativeLogWriter::write(const TrueMotion& motion) {
  CdrWriter w(message_);
  w.number(std::int64_t{motion.time.time_since_epoch().count()});
  put_pose(w, motion.state.X_WB);
  for (const Vector3d& v : {motion.state.v_B, motion.state.w_B, motion.current_W}) {
    put_doubles(
        w, [&v](std::size_t i) { return v[static_cast<Eigen::Index>(i)]; }, 3);
  }
  put_doubles(
      w, [&](std::size_t) { return *motion.altitude_m; }, motion.altitude_m ? 1 : 0);
  send(late_channel(motion_, "/truth/motion", kTrueMotion, kTrueMotionDefinition), motion.time, message_);
}

void NativeLogWriter::write(const EchoTruth& echoes) {
  CdrWriter w(message_);
  w.number(std::int64_t{echoes.time.time_since_epoch().count()}).text(echoes.sonar);
  w.number(static_cast<std::uint32_t>(echoes.beams)).number(static_cast<std::uint32_t>(echoes.bins));
  std::uint8_t* out = w.sequence<std::uint16_t>(echoes.labels.size());
  for (const EchoLabel label : echoes.labels) {
    *out++ = static_cast<std::uint8_t>(label.code() & 0xff);
    *out++ = static_cast<std::uint8_t>(label.code() >> 8);
  }
  send(late_channel(echoes_, "/truth/echoes", kEchoTruth, kEchoTruthDefinition), echoes.time, message_);
}

void NativeLogWriter::write(Time time, const Setpoint& setpoint) {
  CdrWriter w(message_);
  w.number(std::int64_t{time.time_since_epoch().count()}).number(setpoint.heading.radians());
  w.number(setpoint.depth).number(setpoint.speed).number(setpoint.sway_speed);
  send(late_channel(setpoint_, "/setpoint", kSetpoint, kSetpointDefinition), time, message_);
}

void NativeLogWriter::write_decision(Time time, const std::string& json) {
  if (decisions_ == 0) {
    const std::uint16_t schema = mcap_.add_schema({0, kDecision, "jsonschema", kDecisionDefinition});
    decisions_ = mcap_.add_channel({0, schema, "/decisions", "json", {}});
  }
  write(decisions_, time, json);
}

std::uint16_t NativeLogWriter::add_channel(const std::string& topic, const std::string& message_encoding,
                                           McapSchema schema, int group) {
  const auto [known, is_new] = schemas_.try_emplace(schema.name);
  if (is_new) known->second = mcap_.add_schema(std::move(schema));
  return mcap_.add_channel({0, known->second, topic, message_encoding, {}}, group);
}

void NativeLogWriter::write(std::uint16_t channel, Time time, std::string_view message) {
  send(channel, time, {reinterpret_cast<const std::uint8_t*>(message.data()), message.size()});
}

void NativeLogWriter::attach(const std::string& name, const std::string& media_type, const std::string& data) {
  mcap_.add_attachment({0, 0, name, media_type, data});
}

namespace {

std::unique_ptr<std::istream> opened(const std::filesystem::path& file) {
  auto input = std::make_unique<std::ifstream>(file, std::ios::binary);
  if (!*input) throw Error("cannot be read", {file.string(), {}, {}, {}, {}});
  return input;
}

}  // namespace

TruthReader::TruthReader(const std::filesystem::path& file)
    : reader_(std::make_unique<McapReader>(opened(file), file.string())) {}
TruthReader::~TruthReader() = default;

std::optional<std::variant<TrueMotion, EchoTruth>> TruthReader::next() {
  while (const auto message = reader_->next()) {
    const McapSchema* schema = reader_->schema(reader_->channel(message->channel_id)->schema_id);
    if (!schema) continue;
    if (schema->name == kTrueMotion) {
      if (auto motion = take_motion(message->data)) return std::move(*motion);
    } else if (schema->name == kEchoTruth) {
      if (auto echoes = take_echoes(message->data)) return std::move(*echoes);
    }
  }
  return std::nullopt;
}

std::vector<std::string> decisions_in(const std::filesystem::path& file) {
  McapReader reader(opened(file), file.string());
  std::vector<std::string> decisions;
  while (const auto message = reader.next()) {
    const McapSchema* schema = reader.schema(reader.channel(message->channel_id)->schema_id);
    if (schema && schema->name == kDecision) decisions.emplace_back(message->data.begin(), message->data.end());
  }
  return decisions;
}

std::optional<std::string> attachment_in(const std::filesystem::path& file, const std::string& name) {
  McapReader reader(opened(file), file.string());
  const auto found = [&]() -> std::optional<std::string> {
    for (const McapAttachment& a : reader.attachments()) {
      if (a.name == name) return a.data;
    }
    return std::nullopt;
  };
  auto text = found();  // attachments at the head are known from the start
  while (!text && reader.next()) text = found();
  return text ? text : found();
}

std::unique_ptr<Source> open_native_log(std::unique_ptr<std::istream> input, const std::string& name) {
  return std::make_unique<NativeLogSource>(std::move(input), name);
}

std::unique_ptr<Source> open_native_log(const std::filesystem::path& file, const InputConfig&) {
  return open_native_log(opened(file), file.string());
}

}  // namespace isobath
