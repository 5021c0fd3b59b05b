// In one file, of some 400 lines: the datagrams of the format share the state of one source.
#include <algorithm>
#include <array>
#include <bit>
#include <charconv>
#include <cmath>
#include <fmt/format.h>
#include <isobath/io/bytes/framing.hpp>
#include <isobath/io/bytes/log_source.hpp>
#include <isobath/io/formats/kongsberg/kongsberg.hpp>
#include <isobath/io/formats/kongsberg/kongsberg_installation.hpp>
#include <isobath/io/formats/kongsberg/kongsberg_parts.hpp>
#include <isobath/io/input/scanning_head.hpp>
#include <isobath/io/input/survey_track.hpp>

namespace isobath {
namespace {

constexpr std::size_t kHeader = 20;                           // datagram header: length, STX, type ... serial number
constexpr std::size_t kTrailer = 3;                           // ETX, checksum
constexpr std::uint32_t kMaxLength = std::uint32_t{1} << 20;  // water column datagrams reach 64 KiB
constexpr char kStart = 2, kEnd = 3;
constexpr double kQualityScale = 2500;

// Framing
// --------------------------------------------------------------------------------------------------------------

template <std::endian order>
Framing datagram_at(Bytes bytes) {
  const RecordView view(bytes, order);
  if (!view.holds(0, 5)) return {Framing::Kind::kIncomplete, 5};
  const std::size_t length = view.at<std::uint32_t>(0);
  if (view.at<char>(4) == kStart && length >= kHeader + kTrailer - 4 && length <= kMaxLength) {
    const std::size_t end = 4 + length;
    if (!view.holds(0, end)) return {Framing::Kind::kIncomplete, end};
    if (view.at<char>(end - kTrailer) == kEnd) return {Framing::Kind::kFrame, end};
  }
  const Framing next = noise_until(bytes.subspan(4), kStart);  // the length precedes the start byte
  return {Framing::Kind::kNoise, next.bytes};
}

bool checksum_holds(Bytes datagram, std::endian order) {
  std::uint32_t sum = 0;
  for (const std::byte b : datagram.subspan(5, datagram.size() - 5 - kTrailer)) sum += static_cast<std::uint8_t>(b);
  return static_cast<std::uint16_t>(sum) == RecordView(datagram, order).at<std::uint16_t>(datagram.size() - 2);
}

/// Date as yyyymmdd and milliseconds of the day.
std::optional<Time> time_of_day(std::uint32_t date, std::uint32_t ms) {
  using namespace std::chrono;
  const year_month_day day(year(static_cast<int>(date / 10000)), month(date / 100 % 100), std::chrono::day(date % 100));
  if (!day.ok() || date < 19700101 || date > 22000101 || ms > 86'401'000) return std::nullopt;
  return Time{sys_days(day).time_since_epoch() + milliseconds(ms)};
}

template <std::endian order>
std::optional<Time> time_of_datagram(Bytes bytes) {
  const RecordView view(bytes, order);
  return time_of_day(view.at<std::uint32_t>(8), view.at<std::uint32_t>(12));
}

template <std::endian order>
bool begins_datagram(Bytes bytes) {
  const RecordView view(bytes, order);
  const bool model = view.at<std::uint16_t>(6) > 0;
  return datagram_at<order>(bytes).kind == Framing::Kind::kFrame && model &&
         time_of_day(view.at<std::uint32_t>(8), view.at<std::uint32_t>(12));
}

/// The byte order of the first datagram with a possible time and a right checksum. At the first byte of the file, the
/// checksum is not required.
std::optional<std::endian> order_of(Bytes head) {
  if (begins_datagram<std::endian::little>(head)) return std::endian::little;
  if (begins_datagram<std::endian::big>(head)) return std::endian::big;
  const auto found = [&]<std::endian order>(Bytes rest) {
    return begins_datagram<order>(rest) && checksum_holds(rest.first(datagram_at<order>(rest).bytes), order);
  };
  const std::string_view text = text_of(head);
  for (std::size_t at = text.find(kStart, 4); at != std::string_view::npos; at = text.find(kStart, at + 1)) {
    const Bytes rest = head.subspan(at - 4);
    if (found.template operator()<std::endian::little>(rest)) return std::endian::little;
    if (found.template operator()<std::endian::big>(rest)) return std::endian::big;
  }
  return std::nullopt;
}

// Reader
// ---------------------------------------------------------------------------------------------------------------

/// A datagram with its common fields.
struct Datagram {
  RecordView fields;
  char type;
  std::uint16_t model, counter, serial;
  Time time;
};

/// A heading in units of 0.01 degrees.
std::optional<Angle> heading_of(std::uint16_t hundredths) {
  return hundredths < 36000 ? std::optional(Angle::degrees(hundredths * 0.01)) : std::nullopt;
}

class KongsbergAll final : public LogSource {
 public:
  KongsbergAll(ByteWindow input, std::optional<ByteWindow> beside, const InputConfig& config)
      : LogSource(std::move(input), "Kongsberg .all", std::move(beside)),
        config_(config),
        track_(report_),
        water_parts_(report_) {
    order_ = order_of(input_.want(kHead)).value_or(std::endian::little);
    report_.details["time"] = "clock of the sonar, UTC";
    if (beside_) report_.details["beside"] = beside_name_ + ": water columns, attitude";
    if (order_ == std::endian::big) report_.details["byte order"] = "big-endian";
  }

 private:
  static constexpr std::size_t kHead = 1 << 18;

  std::optional<Event> read() override;
  void take(Bytes bytes);
  void take_xyz88(const Datagram& d);
  void take_depth(const Datagram& d);
  void take_position(const Datagram& d);
  void take_attitude(const Datagram& d);
  void take_network_attitude(const Datagram& d);
  void take_installation(const Datagram& d);
  void take_profile(const Datagram& d);
  void take_water(const Datagram& d);
  void add_attitude(Time time, const RecordView& fields, std::size_t at, std::uint8_t sensor);
  void add_sounding(Swath& swath, const Datagram& d, const Eigen::Vector3d& re_transducer, double transducer_m,
                    std::size_t beam, double quality);
  void add_swath(Swath swath, const Datagram& d);
  void tell_counts();

  InputConfig config_;
  std::endian order_ = std::endian::little;
  SurveyTrack track_;
  AllInstallation installation_;
  Angle beam_width_;
  Angle across_, along_;  ///< width of a beam; 0: not stated
  WaterParts water_parts_;
  WaterPings water_;
  std::array<std::uint64_t, 256> others_{};
  std::uint64_t bad_checksums_ = 0, passive_positions_ = 0, passive_attitudes_ = 0;
  bool ended_ = false;
};

std::optional<Event> KongsbergAll::read() {
  const FrameAt frame_at =
      order_ == std::endian::little ? datagram_at<std::endian::little> : datagram_at<std::endian::big>;
  for (;;) {
    if (auto event = track_.next()) return event;
    if (ended_) return {};
    const auto time_at =
        order_ == std::endian::little ? time_of_datagram<std::endian::little> : time_of_datagram<std::endian::big>;
    if (const auto datagram = next_in_time(frame_at, time_at)) {
      const char type = static_cast<char>(datagram->bytes[5]);
      if (!datagram->beside || type == 'k' || type == 'A' || type == 'n') take(datagram->bytes);
    } else {
      ended_ = true;
      water_parts_.finish();
      track_.finish();
      tell_counts();
    }
  }
}

void KongsbergAll::take(Bytes bytes) {
  const RecordView fields(bytes.first(bytes.size() - kTrailer), order_);
  const auto time = time_of_day(fields.at<std::uint32_t>(8), fields.at<std::uint32_t>(12));
  if (!checksum_holds(bytes, order_)) ++bad_checksums_;
  if (!time) return reject("datagram whose date is impossible");
  const Datagram d{fields,
                   fields.at<char>(5),
                   fields.at<std::uint16_t>(6),
                   fields.at<std::uint16_t>(16),
                   fields.at<std::uint16_t>(18),
                   *time};
  switch (d.type) {
    case 'X': return take_xyz88(d);
    case 'D': return take_depth(d);
    case 'P': return take_position(d);
    case 'A': return take_attitude(d);
    case 'n': return take_network_attitude(d);
    case 'I': return take_installation(d);
    case 'U': return take_profile(d);
    case 'k':
      if (config_.water_column) return take_water(d);
      ++others_[static_cast<std::uint8_t>(d.type)];
      return;
    case 'R':
      along_ = Angle::degrees(0.1 * fields.at<std::uint16_t>(34));
      across_ = Angle::degrees(0.1 * fields.at<std::uint8_t>(37));
      beam_width_ = Angle::degrees(0.1 * std::max<int>(fields.at<std::uint16_t>(34), fields.at<std::uint8_t>(37)));
      return;
    default: ++others_[static_cast<std::uint8_t>(d.type)];
  }
}

void KongsbergAll::take_xyz88(const Datagram& d) {
  constexpr std::size_t kBeams = 40, kBeam = 20;
  const std::size_t count = d.fields.at<std::uint16_t>(28);
  if (!d.fields.holds(kBeams, count * kBeam)) return reject("ping shorter than its beams");
  const double transducer_m = static_cast<double>(d.fields.at<float>(24));
  if (!(std::abs(transducer_m) < 1.2e4)) return reject("ping whose transducer depth is impossible");
  Swath swath;
  swath.soundings.reserve(count);
  for (std::size_t i = 0; i < count; ++i) {
    const RecordView beam(d.fields.part(kBeams + i * kBeam, kBeam), order_);
    const Eigen::Vector3f p(beam.at<float>(8), beam.at<float>(4), beam.at<float>(0));
    if ((beam.at<std::uint8_t>(16) & 0x80) != 0) {
      reject("sounding that the sonar calls invalid");
    } else if (beam.at<std::int8_t>(17) < 0) {
      reject("sounding that real-time cleaning has flagged");
    } else {
      add_sounding(swath, d, p.cast<double>(), transducer_m, i, beam.at<std::uint8_t>(14));
    }
  }
  add_swath(std::move(swath), d);
}

void KongsbergAll::take_depth(const Datagram& d) {
  constexpr std::size_t kBeams = 32, kBeam = 16;
  const std::size_t count = d.fields.at<std::uint8_t>(27);
  if (!d.fields.holds(kBeams, count * kBeam + 1)) return reject("ping shorter than its beams");
  const double z_unit = 0.01 * d.fields.at<std::uint8_t>(28), xy_unit = 0.01 * d.fields.at<std::uint8_t>(29);
  const double transducer_m =
      0.01 * d.fields.at<std::uint16_t>(24) + 655.36 * d.fields.at<std::int8_t>(kBeams + count * kBeam);
  const bool deep = d.model == 120 || d.model == 300;  // these models write unsigned depths
  Swath swath;
  swath.soundings.reserve(count);
  for (std::size_t i = 0; i < count; ++i) {
    const RecordView beam(d.fields.part(kBeams + i * kBeam, kBeam), order_);
    const int z = deep ? beam.at<std::uint16_t>(0) : beam.at<std::int16_t>(0);
    const Eigen::Vector3d p(xy_unit * beam.at<std::int16_t>(4), xy_unit * beam.at<std::int16_t>(2), z_unit * z);
    if (z == 0) {
      reject("sounding without a detection");
    } else {
      add_sounding(swath, d, p, transducer_m, beam.at<std::uint8_t>(15), 0);
    }
  }
  add_swath(std::move(swath), d);
}

/// Completes a swath and adds it. Heading and sound speed have the same offsets in both kinds of depth datagram.
void KongsbergAll::add_swath(Swath swath, const Datagram& d) {
  swath.time = d.time;
  swath.frame = Swath::Frame::kLevel;
  swath.heading = heading_of(d.fields.at<std::uint16_t>(20));
  swath.beam_width = beam_width_;
  swath.sound_speed = 0.1 * d.fields.at<std::uint16_t>(22);
  report_.note_setting("sonar", fmt::format("EM {}, serial {}", d.model, d.serial));
  track_.add({std::move(swath), std::nullopt, std::nullopt});
}

void KongsbergAll::add_sounding(Swath& swath, const Datagram& d, const Eigen::Vector3d& re_transducer,
                                double transducer_m, std::size_t beam, double quality) {
  const Eigen::Vector3d& p = re_transducer;
  if (!p.allFinite() || p.norm() > 1e5) return reject("sounding that is not finite");
  if (p.isZero(0)) return reject("sounding without a detection");
  const Eigen::Vector2d across = p.head<2>() - installation_.transmitter(d.serial).p_BS.head<2>();
  const double range = std::hypot(across.x(), across.y(), p.z());
  Sounding sounding;
  sounding.point = Eigen::Vector3d(p.x(), p.y(), p.z() + transducer_m).cast<float>();
  sounding.range_m = static_cast<float>(range);
  sounding.sigma_m = static_cast<float>(quality / kQualityScale * range);
  sounding.beam = static_cast<std::uint16_t>(beam);
  swath.soundings.push_back(sounding);
}

void KongsbergAll::take_position(const Datagram& d) {
  constexpr std::uint8_t kActive = 0x80;
  constexpr std::uint16_t kUnknown = 0xFFFF;
  if ((d.fields.at<std::uint8_t>(36) & kActive) == 0) {
    ++passive_positions_;
    return;
  }
  const auto latitude = d.fields.at<std::int32_t>(20), longitude = d.fields.at<std::int32_t>(24);
  if (!d.fields.holds(20, 17) || latitude == 0x7FFFFFFF || longitude == 0x7FFFFFFF) {
    return reject("invalid position");
  }
  PositionFix fix;
  fix.time = d.time;
  fix.point = {latitude / 2e7, longitude / 1e7};
  const auto quality = d.fields.at<std::uint16_t>(28), speed = d.fields.at<std::uint16_t>(30);
  if (quality != kUnknown) fix.sigma_m = 0.01 * quality;
  const auto course = heading_of(d.fields.at<std::uint16_t>(32));
  if (speed != kUnknown && course) fix.velocity = along(*course, 0.01 * speed);
  fix.heading = heading_of(d.fields.at<std::uint16_t>(34));
  track_.add(fix);
}

// Bits of the sensor descriptor: bit 0: heading is active; bits 1, 2, 3: roll, pitch, heave are inactive.
void KongsbergAll::take_attitude(const Datagram& d) {
  constexpr std::size_t kSamples = 22, kSample = 12;
  const std::size_t count = d.fields.at<std::uint16_t>(20);
  if (!d.fields.holds(kSamples, count * kSample + 1)) return reject("attitude shorter than its samples");
  const auto sensor = d.fields.at<std::uint8_t>(kSamples + count * kSample);
  if ((sensor & 0x02) != 0) {
    ++passive_attitudes_;
    return;
  }
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t at = kSamples + i * kSample;
    const auto status = d.fields.at<std::uint8_t>(at + 2);
    if (status >= 0x9A && status <= 0xAF) {  // invalid, as coded in the EM 3000 sensor format
      reject("attitude sample that its sensor calls invalid");
      continue;
    }
    add_attitude(d.time + std::chrono::milliseconds(d.fields.at<std::uint16_t>(at)), d.fields, at + 4, sensor);
  }
}

void KongsbergAll::take_network_attitude(const Datagram& d) {
  constexpr std::size_t kSample = 11;
  const std::size_t count = d.fields.at<std::uint16_t>(20);
  const auto sensor = d.fields.at<std::uint8_t>(22);
  if ((sensor & 0x02) != 0) {
    ++passive_attitudes_;
    return;
  }
  std::size_t at = 24;
  for (std::size_t i = 0; i < count; ++i) {
    if (!d.fields.holds(at, kSample)) return reject("attitude shorter than its samples");
    add_attitude(d.time + std::chrono::milliseconds(d.fields.at<std::uint16_t>(at)), d.fields, at + 2, sensor);
    at += kSample + d.fields.at<std::uint8_t>(at + 10);
  }
}

/// Reads roll, pitch, heave and heading at `at`.
void KongsbergAll::add_attitude(Time time, const RecordView& fields, std::size_t at, std::uint8_t sensor) {
  MotionSample sample;
  sample.time = time;
  sample.roll = Angle::degrees(0.01 * fields.at<std::int16_t>(at));
  if ((sensor & 0x04) == 0) sample.pitch = Angle::degrees(0.01 * fields.at<std::int16_t>(at + 2));
  if ((sensor & 0x08) == 0) sample.heave_m = 0.01 * fields.at<std::int16_t>(at + 4);
  if ((sensor & 0x01) != 0) sample.heading = heading_of(fields.at<std::uint16_t>(at + 6));
  track_.add(sample);
}

void KongsbergAll::take_installation(const Datagram& d) {
  const std::string_view text = text_of(d.fields.part(22, d.fields.size()));
  installation_ = AllInstallation::read(text);
  track_.set_water_line(installation_.water_line_m);
  report_.note_setting("water line", fmt::format("{:g} m below the reference point", installation_.water_line_m));
  const auto angle = [&](const char* key) { return AllInstallation::number(text, key).value_or(0); };
  report_.note_setting("motion sensor", fmt::format("mounted at roll {:g}, pitch {:g}, heading {:g} degrees",
                                                    angle("MSR"), angle("MSP"), angle("MSG")));
}

void KongsbergAll::take_profile(const Datagram& d) {
  report_.note_setting("sound speed profile", fmt::format("{} depths, taken {}", d.fields.at<std::uint16_t>(28),
                                                          d.fields.at<std::uint32_t>(20)));
}

void KongsbergAll::take_water(const Datagram& d) {
  WaterRecord* const water = water_parts_.add(d.fields, d.time);
  if (!water) return;
  const auto known = [](Angle width) { return width.radians() > 0 ? width : kWaterBeam; };
  const BeamSize size = beam_size(config_, {known(across_), known(along_)});
  water->width = size.width;
  water->height = size.height;
  water->mount = installation_.mount(d.serial);
  if (!(water->sound_speed > 0)) water->sound_speed = config_.sound_speed;
  auto ping = water_.ping(*water);
  if (!ping) return reject(to_text(ping.error()));
  report_.note_setting("sonar", fmt::format("EM {}, serial {}", d.model, d.serial));
  report_.note_setting("water column",
                       water_setting(d.fields.at<std::uint8_t>(38), d.fields.at<std::int8_t>(39), water->beams.size()));
  track_.add_ping(std::move(*ping));
}

void KongsbergAll::tell_counts() {
  std::string text;
  for (std::size_t type = 0; type < others_.size(); ++type) {
    if (others_[type] == 0) continue;
    const char letter = static_cast<char>(type);
    const bool readable = type > ' ' && type < 127;
    text += (text.empty() ? "" : ", ") + (readable ? std::string(1, letter) : fmt::format("0x{:02x}", type));
    text += fmt::format(" x {}", others_[type]);
  }
  if (!text.empty()) report_.details["other datagrams"] = text;
  if (bad_checksums_ > 0) {
    report_.details["checksums"] = fmt::format("{} datagrams with a wrong checksum, used nevertheless", bad_checksums_);
  }
  if (passive_positions_ + passive_attitudes_ > 0) {
    report_.details["other sensors"] = fmt::format("{} positions and {} attitude records of inactive sensors, not used",
                                                   passive_positions_, passive_attitudes_);
  }
}

}  // namespace

bool looks_like_kongsberg_all(Bytes head) { return order_of(head).has_value(); }

std::unique_ptr<Source> open_kongsberg_all(ByteWindow input, const InputConfig& config) {
  return std::make_unique<KongsbergAll>(std::move(input), std::nullopt, config);
}

std::unique_ptr<Source> open_kongsberg_all_with_water(ByteWindow input, ByteWindow beside, const InputConfig& config) {
  return std::make_unique<KongsbergAll>(std::move(input), std::move(beside), config);
}

}  // namespace isobath
