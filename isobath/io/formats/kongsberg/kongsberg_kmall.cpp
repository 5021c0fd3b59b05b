// In one file, of some 400 lines: the datagrams of the format share the state of one source.
#include <algorithm>
#include <charconv>
#include <cmath>
#include <fmt/format.h>
#include <isobath/io/bytes/framing.hpp>
#include <isobath/io/bytes/log_source.hpp>
#include <isobath/io/formats/kongsberg/kongsberg.hpp>
#include <isobath/io/formats/kongsberg/kongsberg_water.hpp>
#include <isobath/io/input/scanning_head.hpp>
#include <isobath/io/input/survey_track.hpp>
#include <map>

namespace isobath {
namespace {

constexpr std::size_t kHeader = 20;
constexpr std::size_t kShortest = kHeader + 4;
constexpr std::size_t kShortestBeam = 12;                     // beam entry of a water column, before its samples
constexpr std::uint32_t kMaxLength = std::uint32_t{1} << 24;  // the water column of a deep ping has a few megabytes

bool is_type(Bytes name) {
  const std::string_view text = text_of(name);
  return text.size() == 4 && text[0] == '#' &&
         std::all_of(text.begin() + 1, text.end(), [](char c) { return c >= 'A' && c <= 'Z'; });
}

Framing datagram_at(Bytes bytes) {
  const RecordView view(bytes);
  if (!view.holds(0, 8)) return {Framing::Kind::kIncomplete, 8};
  const std::size_t length = view.at<std::uint32_t>(0);
  if (is_type(bytes.subspan(4, 4)) && length >= kShortest && length <= kMaxLength) {
    if (!view.holds(0, length)) return {Framing::Kind::kIncomplete, length};
    if (view.at<std::uint32_t>(length - 4) == length) return {Framing::Kind::kFrame, length};
  }
  return {Framing::Kind::kNoise, noise_until(bytes.subspan(4), '#').bytes};  // the length precedes the name
}

/// The value of "key=..." in a group that begins with `group:`, up to the next of ",;".
std::optional<double> number_value(std::string_view text, std::string_view group, std::string_view key) {
  const std::string start = std::string(group) + ":", name = std::string(key) + "=";
  std::size_t at = text.find(start);
  if (at == std::string_view::npos) return std::nullopt;
  std::string_view fields = text.substr(at + start.size());
  fields = fields.substr(0, fields.find(','));
  while (!fields.empty()) {
    const std::size_t end = std::min(fields.find(';'), fields.size());
    const std::string_view field = fields.substr(0, end);
    double number = 0;
    if (field.starts_with(name)) {
      const char* const from = field.data() + name.size();
      const bool read = std::from_chars(from, field.data() + field.size(), number).ec == std::errc();
      return read && std::abs(number) < 1e4 ? std::optional(number) : std::nullopt;
    }
    fields.remove_prefix(std::min(end + 1, fields.size()));
  }
  return std::nullopt;
}

std::optional<Time> time_at(const RecordView& fields, std::size_t at) {
  const auto nanoseconds = fields.at<std::uint32_t>(at + 4);
  if (nanoseconds >= 1'000'000'000) return std::nullopt;
  return Time{std::chrono::seconds(fields.at<std::uint32_t>(at)) + Duration(nanoseconds)};
}

std::optional<Time> time_of_datagram(Bytes bytes) { return time_at(RecordView(bytes), 12); }

/// The parts of an #MRZ datagram. Each states its own size.
struct SoundingRecord {
  RecordView ping, receiver, soundings;
  std::size_t count = 0, stride = 0;
};

/// A structure that begins with its own size as u16; empty if it does not fit.
Bytes sized(const RecordView& fields, std::size_t at) {
  const std::size_t size = fields.at<std::uint16_t>(at);
  return size >= 2 && fields.holds(at, size) ? fields.part(at, size) : Bytes();
}

std::optional<SoundingRecord> parts_of(const RecordView& d) {
  constexpr std::size_t kCommon = kHeader + 4;
  const Bytes common = sized(d, kCommon);
  const std::size_t ping_at = kCommon + common.size();
  const Bytes ping_bytes = sized(d, ping_at);
  if (common.empty() || ping_bytes.empty()) return std::nullopt;
  const RecordView ping(ping_bytes);
  const std::size_t sectors = std::size_t{ping.at<std::uint16_t>(92)} * ping.at<std::uint16_t>(94);
  const std::size_t receiver_at = ping_at + ping.size() + sectors;
  const Bytes receiver_bytes = sized(d, receiver_at);
  if (receiver_bytes.empty()) return std::nullopt;
  const RecordView receiver(receiver_bytes);
  const std::size_t count = std::size_t{receiver.at<std::uint16_t>(2)} + receiver.at<std::uint16_t>(26);
  const std::size_t stride = receiver.at<std::uint16_t>(6);
  const std::size_t classes = std::size_t{receiver.at<std::uint16_t>(28)} * receiver.at<std::uint16_t>(30);
  const std::size_t soundings_at = receiver_at + receiver.size() + classes;
  constexpr std::size_t kUpToPoint = 108;  // bytes of a sounding up to the end of x
  const bool fits = count == 0 || (stride >= kUpToPoint && d.holds(soundings_at, count * stride));
  if (!fits || count > Swath::kMaxSoundings) return std::nullopt;
  return SoundingRecord{ping, receiver, RecordView(d.part(soundings_at, count * stride)), count, stride};
}

/// The beams of an #MWC datagram from `at` on; empty if they do not fit.
std::vector<WaterBeam> beams_of(const RecordView& d, std::size_t at, const RecordView& receiver,
                                const std::vector<double>& tilts_deg) {
  const std::size_t count = receiver.at<std::uint16_t>(2), entry = receiver.at<std::uint8_t>(4);
  const std::size_t phase = receiver.at<std::uint8_t>(5);  // phase bytes per sample
  if (entry < kShortestBeam || phase > 2) return {};
  std::vector<WaterBeam> beams;
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t samples = d.at<std::uint16_t>(at + 10), sector = d.at<std::uint16_t>(at + 8);
    if (!d.holds(at, entry + samples * (1 + phase)) || sector >= tilts_deg.size()) return {};
    beams.push_back({static_cast<double>(d.at<float>(at)), d.at<std::uint16_t>(at + 4), d.part(at + entry, samples),
                     tilts_deg[sector]});
    at += entry + samples * (1 + phase);
  }
  return beams;
}

class Kmall final : public LogSource {
 public:
  Kmall(ByteWindow input, std::optional<ByteWindow> beside, const InputConfig& config)
      : LogSource(std::move(input), "Kongsberg .kmall", std::move(beside)),
        track_(report_),
        config_(config),
        sound_speed_(config.sound_speed) {
    report_.details["time"] = "clock of the sonar, UTC";
    if (beside_) report_.details["beside"] = beside_name_ + ": water columns";
  }

 private:
  std::optional<Event> read() override;
  void take(Bytes bytes);
  void take_soundings(const RecordView& d, Time time);
  void take_water(const RecordView& d, Time time);
  [[nodiscard]] WaterMount mount_of(const RecordView& common) const;
  void take_position(const RecordView& d);
  void take_motion(const RecordView& d);
  void take_installation(const RecordView& d);
  void add_sounding(Swath& swath, const RecordView& s, double water_m);
  void tell_counts();

  SurveyTrack track_;
  InputConfig config_;
  double sound_speed_;  ///< for pings that state none
  WaterPings water_;
  std::string installation_;
  double receiver_share_ = 1;  ///< beam width across the track over beam width along it
  std::map<std::string, std::uint64_t> others_;
  std::uint64_t passive_ = 0;
  bool ended_ = false;
};

std::optional<Event> Kmall::read() {
  for (;;) {
    if (auto event = track_.next()) return event;
    if (ended_) return {};
    if (const auto datagram = next_in_time(datagram_at, time_of_datagram)) {
      if (!datagram->beside || text_of(datagram->bytes.subspan(4, 4)) == "#MWC") take(datagram->bytes);
    } else {
      ended_ = true;
      track_.finish();
      tell_counts();
    }
  }
}

void Kmall::take(Bytes bytes) {
  const RecordView d(bytes.first(bytes.size() - 4));
  const std::string_view type = text_of(bytes.subspan(4, 4));
  const auto time = time_at(d, 12);
  if (!time) return reject("datagram whose time is impossible");
  if (type == "#MRZ") return take_soundings(d, *time);
  if (type == "#MWC" && config_.water_column) return take_water(d, *time);
  if (type == "#SPO") return take_position(d);
  if (type == "#SKM") return take_motion(d);
  if (type == "#IIP") return take_installation(d);
  if (type == "#SVP") {
    report_.note_setting("sound speed profile",
                         fmt::format("{} depths, taken {}", d.at<std::uint16_t>(22),
                                     to_text(Time{std::chrono::seconds(d.at<std::uint32_t>(28))})));
    return;
  }
  if (others_.size() < 64 || others_.contains(std::string(type))) ++others_[std::string(type)];
}

void Kmall::take_soundings(const RecordView& d, Time time) {
  if (d.at<std::uint16_t>(kHeader) != 1) return reject("part of a divided datagram");
  const auto parts = parts_of(d);
  if (!parts) return reject("ping whose sizes contradict each other");
  const RecordView& ping = parts->ping;
  const double water_m = static_cast<double>(ping.at<float>(108));
  if (!ping.holds(108, 4) || !(std::abs(water_m) < 1e4)) return reject("ping whose water level is impossible");
  SwathRecord record;
  Swath& swath = record.swath;
  swath.time = time;
  swath.frame = Swath::Frame::kLevel;
  const double heading = static_cast<double>(ping.at<float>(96)), speed = static_cast<double>(ping.at<float>(100));
  if (std::abs(heading) <= 360) swath.heading = Angle::degrees(heading);
  if (speed > 0 && speed < 1e4) swath.sound_speed = speed;
  const double width = static_cast<double>(std::max(ping.at<float>(72), ping.at<float>(76)));
  if (width > 0 && width < 180) swath.beam_width = Angle::degrees(width);
  const double transmit = static_cast<double>(ping.at<float>(72)), receive = static_cast<double>(ping.at<float>(76));
  if (transmit > 0.1 && transmit < 90 && receive > 0.1 && receive < 90) receiver_share_ = receive / transmit;
  swath.soundings.reserve(parts->count);
  for (std::size_t i = 0; i < parts->count; ++i) {
    add_sounding(swath, RecordView(parts->soundings.part(i * parts->stride, parts->stride)), water_m);
  }
  constexpr std::uint8_t kInvalid = 1;
  const GeoPoint point{ping.at<double>(124), ping.at<double>(132)};
  if (ping.holds(124, 16) && ping.at<std::uint8_t>(121) != kInvalid && valid(point)) record.position = point;
  record.depth_m = -water_m;
  report_.note_setting("sonar", fmt::format("EM {}", d.at<std::uint16_t>(10)));
  track_.add(std::move(record));
}

// The transmit sectors state their tilt and the width of the beams along the track.
void Kmall::take_water(const RecordView& d, Time time) {
  if (d.at<std::uint16_t>(kHeader) != 1) return reject("part of a divided datagram");
  constexpr std::size_t kCommon = kHeader + 4;
  const RecordView common(sized(d, kCommon));
  const std::size_t transmit_at = kCommon + common.size();
  const RecordView transmit(sized(d, transmit_at));
  const std::size_t sectors = transmit.at<std::uint16_t>(2), stride = transmit.at<std::uint16_t>(4);
  const std::size_t sectors_at = transmit_at + transmit.size(), receiver_at = sectors_at + sectors * stride;
  const RecordView receiver(sized(d, receiver_at));
  const bool whole = common.size() > 0 && transmit.size() >= 6 && receiver.size() >= 16 && stride >= 12;
  if (!whole) return reject(to_text(WaterFault::kBadSizes));
  std::vector<double> tilts_deg;
  double width_deg = 0;
  for (std::size_t i = 0; i < sectors; ++i) {
    const RecordView sector(d.part(sectors_at + i * stride, stride));
    tilts_deg.push_back(static_cast<double>(sector.at<float>(0)));
    const double width = static_cast<double>(sector.at<float>(8));
    if (width > 0 && width < 45) width_deg = std::max(width_deg, width);
  }
  WaterRecord record;
  record.time = time;
  record.beams = beams_of(d, receiver_at + receiver.size(), receiver, tilts_deg);
  record.sample_hz = static_cast<double>(receiver.at<float>(8));
  record.sound_speed = static_cast<double>(receiver.at<float>(12));
  if (!(record.sound_speed > 0)) record.sound_speed = sound_speed_;
  record.mount = mount_of(common);
  const Angle along = width_deg > 0 ? Angle::degrees(width_deg) : kWaterBeam;
  const BeamSize size = beam_size(config_, {along * receiver_share_, along});
  record.width = size.width;
  record.height = size.height;
  auto ping = water_.ping(record);
  if (!ping) return reject(to_text(ping.error()));
  report_.note_setting("sonar", fmt::format("EM {}", d.at<std::uint16_t>(10)));
  report_.note_setting("water column",
                       water_setting(receiver.at<std::uint8_t>(6), receiver.at<std::int8_t>(7), ping->sampled->size()));
  track_.add_ping(std::move(*ping));
}

/// The point half way between transmitter and receiver; a combined head has only one position.
WaterMount Kmall::mount_of(const RecordView& common) const {
  const auto place = [&](const std::string& group) -> std::optional<Eigen::Vector3d> {
    const auto z = number_value(installation_, group, "Z");
    if (!z) return std::nullopt;
    return Eigen::Vector3d(number_value(installation_, group, "X").value_or(0),
                           number_value(installation_, group, "Y").value_or(0), *z);
  };
  const int transmitter = common.at<std::uint8_t>(8) + 1, receiver = common.at<std::uint8_t>(9) + 1;
  std::string array = fmt::format("TRAI_TX{}", transmitter);
  if (!place(array)) array = fmt::format("TRAI_HD{}", receiver);
  const auto from = place(array), to = place(fmt::format("TRAI_RX{}", receiver));
  WaterMount mount;
  if (from) mount.p_BS = to ? 0.5 * (*from + *to) : *from;
  mount.heading_deg = number_value(installation_, array, "H").value_or(0);
  mount.pitch_deg = number_value(installation_, array, "P").value_or(0);
  return mount;
}

void Kmall::add_sounding(Swath& swath, const RecordView& s, double water_m) {
  constexpr std::uint8_t kExtra = 1, kRejected = 2;
  const auto type = s.at<std::uint8_t>(3);
  if (type == kRejected) return reject("sounding that the sonar has rejected");
  if (type > kRejected) return reject("sounding of an unknown kind");
  Sounding sounding;
  sounding.point = {s.at<float>(104), s.at<float>(100), s.at<float>(96) - static_cast<float>(water_m)};
  const double seconds = static_cast<double>(s.at<float>(80)) + static_cast<double>(s.at<float>(84));
  const double speed = swath.sound_speed > 0 ? swath.sound_speed : sound_speed_;
  const double range = 0.5 * seconds * speed;
  if (!sounding.point.allFinite() || sounding.point.norm() > 1e5F || !std::isfinite(range)) {
    return reject("sounding that is not finite");
  }
  if (!(range > 0 && range < 1e5)) return reject("sounding without a detection");
  const float sigma = s.at<float>(20);
  sounding.range_m = static_cast<float>(range);
  if (sigma > 0 && sigma < 1e4F) sounding.sigma_m = sigma;
  sounding.beam = s.at<std::uint16_t>(0);
  sounding.kind = type == kExtra ? Sounding::Kind::kWater : Sounding::Kind::kBottom;
  swath.soundings.push_back(sounding);
}

void Kmall::take_position(const RecordView& d) {
  constexpr std::uint16_t kActive = 1, kInvalid = 1 << 4;
  const Bytes common = sized(d, kHeader);
  const std::size_t at = kHeader + common.size();
  if (common.size() < 6 || !d.holds(at, 28)) return reject("position datagram too short");
  const auto status = RecordView(common).at<std::uint16_t>(4);
  if ((status & kActive) == 0) {
    ++passive_;
    return;
  }
  const auto time = time_at(d, at);
  const GeoPoint point{d.at<double>(at + 12), d.at<double>(at + 20)};
  if ((status & kInvalid) != 0 || !valid(point) || !time) return reject("invalid position");
  PositionFix fix;
  fix.time = *time;
  fix.point = point;
  const double quality = static_cast<double>(d.at<float>(at + 8));
  if (quality > 0 && quality < 1e6) fix.sigma_m = quality;
  const double speed = static_cast<double>(d.at<float>(at + 28)), course = static_cast<double>(d.at<float>(at + 32));
  const bool moves = d.holds(at + 28, 8) && speed >= 0 && speed < 1000 && course >= 0 && course <= 360;
  if (moves) fix.velocity = along(Angle::degrees(course), speed);
  track_.add(fix);
}

// Samples in the sensor's own binary format, each with its own time.
void Kmall::take_motion(const RecordView& d) {
  constexpr std::uint8_t kActive = 1;
  constexpr std::uint32_t kNoTilt = 1 << 1, kNoHeading = 1 << 2, kNoHeave = 1 << 3;
  const Bytes info = sized(d, kHeader);
  const RecordView head(info);
  const std::size_t count = head.at<std::uint16_t>(6), stride = head.at<std::uint16_t>(8);
  const std::size_t first = kHeader + info.size();
  if (info.size() < 10 || stride < 56 || !d.holds(first, count * stride)) {
    return reject("attitude shorter than its samples");
  }
  if ((head.at<std::uint8_t>(3) & kActive) == 0) {
    ++passive_;
    return;
  }
  const auto degrees = [](const RecordView& s, std::size_t at) { return Angle::degrees(double(s.at<float>(at))); };
  for (std::size_t i = 0; i < count; ++i) {
    const RecordView s(d.part(first + i * stride, stride));
    const auto status = s.at<std::uint32_t>(16);
    const auto time = time_at(s, 8);
    if (!time || (status & kNoTilt) != 0) {
      reject("attitude sample that its sensor calls invalid");
      continue;
    }
    MotionSample sample;
    sample.time = *time;
    sample.roll = degrees(s, 40);
    sample.pitch = degrees(s, 44);
    if ((status & kNoHeading) == 0) sample.heading = degrees(s, 48);
    if ((status & kNoHeave) == 0) sample.heave_m = static_cast<double>(s.at<float>(52));
    const bool plausible = std::abs(sample.roll.degrees()) <= 180 && std::abs(sample.pitch.degrees()) <= 90 &&
                           (!sample.heading || std::abs(sample.heading->degrees()) <= 360) &&
                           std::abs(sample.heave_m) < 1000;
    if (!plausible) {
      reject("attitude sample that is impossible");
      continue;
    }
    const auto stated = [&](std::size_t at, double most) {
      const double value = static_cast<double>(s.at<float>(at));
      return value > 0 && value < most ? value : 0;
    };
    sample.sigma_tilt = Angle::degrees(std::max(stated(92, 90), stated(96, 90))).radians();
    sample.sigma_heading = Angle::degrees(stated(100, 180)).radians();
    sample.sigma_heave_m = stated(104, 1000);
    track_.add(sample);
  }
}

void Kmall::take_installation(const RecordView& d) {
  const std::string_view text = text_of(d.part(26, d.size()));
  installation_ = text;
  const double water_m = number_value(text, "EMXI", "SWLZ").value_or(0);
  track_.set_water_line(water_m);
  report_.note_setting("water line", fmt::format("{:g} m below the reference point at rest", water_m));
  const auto angle = [&](const char* key) { return number_value(text, "ATTI_1", key).value_or(0); };
  report_.note_setting("motion sensor", fmt::format("mounted at roll {:g}, pitch {:g}, heading {:g} degrees",
                                                    angle("R"), angle("P"), angle("H")));
}

void Kmall::tell_counts() {
  std::string text;
  for (const auto& [type, count] : others_) text += fmt::format("{}{} x {}", text.empty() ? "" : ", ", type, count);
  if (!text.empty()) report_.details["other datagrams"] = text;
  if (passive_ > 0)
    report_.details["other sensors"] = fmt::format("{} records of inactive sensors, not used", passive_);
}

}  // namespace

bool looks_like_kmall(Bytes head) {
  const RecordView view(head);
  const std::size_t length = view.at<std::uint32_t>(0);
  if (view.holds(0, kHeader) && is_type(head.subspan(4, 4)) && length >= kShortest && length <= kMaxLength) return true;
  return holds_frame(head, datagram_at);
}

std::unique_ptr<Source> open_kmall(ByteWindow input, const InputConfig& config) {
  return std::make_unique<Kmall>(std::move(input), std::nullopt, config);
}

std::unique_ptr<Source> open_kmall_with_water(ByteWindow input, ByteWindow beside, const InputConfig& config) {
  return std::make_unique<Kmall>(std::move(input), std::move(beside), config);
}

}  // namespace isobath
