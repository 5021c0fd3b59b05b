#include <algorithm>
#include <array>
#include <cmath>
#include <fmt/format.h>
#include <isobath/base/error.hpp>
#include <isobath/io/bytes/framing.hpp>
#include <isobath/io/bytes/log_source.hpp>
#include <isobath/io/formats/xtf.hpp>
#include <isobath/io/input/survey_track.hpp>

namespace isobath {
namespace {

constexpr std::uint8_t kFileMark = 123;
constexpr std::uint16_t kPacketMark = 0xFACE;
constexpr std::size_t kFileHeader = 1024;  // a multiple of this with more than six channels
constexpr std::size_t kMaxFileHeader = 1 << 16;
constexpr std::size_t kPacketHeader = 14;
constexpr std::uint32_t kMaxPacket = std::uint32_t{1} << 24;
constexpr std::uint8_t kAttitude = 3, kR2Sonic = 65, kPosition = 107;

Framing packet_at(Bytes bytes) {
  const RecordView view(bytes);
  if (!view.holds(0, kPacketHeader)) return {Framing::Kind::kIncomplete, kPacketHeader};
  const std::size_t length = view.at<std::uint32_t>(10);
  if (view.at<std::uint16_t>(0) == kPacketMark && length >= kPacketHeader && length <= kMaxPacket) {
    return {view.holds(0, length) ? Framing::Kind::kFrame : Framing::Kind::kIncomplete, length};
  }
  return noise_until(bytes, static_cast<char>(0xCE));
}

/// Offset of the first packet; 0: none found.
std::size_t header_size(Bytes head) {
  for (std::size_t at = kFileHeader; at <= kMaxFileHeader && at + kPacketHeader <= head.size(); at += kFileHeader) {
    if (packet_at(head.subspan(at)).kind != Framing::Kind::kNoise) return at;
  }
  return 0;
}

/// A date and time: year u16, then month, day, hour, minute and second as u8.
std::optional<Time> date_at(const RecordView& fields, std::size_t at) {
  using namespace std::chrono;
  const int y = fields.at<std::uint16_t>(at);
  const auto byte = [&](std::size_t i) { return unsigned{fields.at<std::uint8_t>(at + 2 + i)}; };
  const year_month_day date(year(y), month(byte(0)), day(byte(1)));
  if (!date.ok() || y < 1970 || y > 2200 || byte(2) > 23 || byte(3) > 59 || byte(4) > 60) return std::nullopt;
  return Time{sys_days(date).time_since_epoch() + hours(byte(2)) + minutes(byte(3)) + std::chrono::seconds(byte(4))};
}

/// The block of an R2Sonic head: big-endian sections, each with a two-letter name and a size.
struct R2SonicBlock {
  RecordView header{{}}, ranges{{}}, angles{{}}, flags{{}};
  bool even_angles = false;  ///< `angles` holds the first and last angle; else steps
};

std::optional<R2SonicBlock> block_of(Bytes bytes) {
  constexpr std::endian kOrder = std::endian::big;
  if (bytes.size() < 12 || text_of(bytes.first(4)) != "BTH0") return std::nullopt;
  const std::size_t size = RecordView(bytes, kOrder).at<std::uint32_t>(4);
  Bytes rest = bytes.first(std::min(size, bytes.size()));
  R2SonicBlock block;
  rest = rest.subspan(std::min<std::size_t>(12, rest.size()));
  while (rest.size() >= 4) {
    const std::string_view name = text_of(rest.first(2));
    const std::size_t length = RecordView(rest, kOrder).at<std::uint16_t>(2);
    if (length < 4 || length > rest.size()) break;
    const RecordView section(rest.first(length), kOrder);
    if (name == "H0") block.header = section;
    if (name == "R0") block.ranges = section;
    if (name == "A0" || name == "A2") block.angles = section;
    if (name == "A0") block.even_angles = true;
    if (name == "Q0") block.flags = section;
    rest = rest.subspan(length);
  }
  return block;
}

class Xtf final : public LogSource {
 public:
  Xtf(ByteWindow input, const InputConfig& config) : LogSource(std::move(input), "XTF"), track_(report_) {
    X_BS_.rotation = Rotation::from_heading_pitch_roll(config.mount_heading, config.mount_pitch, config.mount_roll);
    X_BS_.translation = Eigen::Vector3d(config.mount_m[0], config.mount_m[1], config.mount_m[2]);
    skip_header();
    describe();
  }

 private:
  std::optional<Event> read() override;
  void skip_header();
  void describe();
  void take(Bytes packet);
  void take_attitude(const RecordView& packet);
  void take_position(const RecordView& packet);
  void take_bathymetry(const RecordView& packet);
  bool add_soundings(const R2SonicBlock& block, Swath& swath);
  void add_sounding(Swath& swath, std::size_t point, double range, double angle);

  SurveyTrack track_;
  Pose X_BS_;
  bool projected_ = false;  ///< positions in metres of an unknown projection
  bool ended_ = false;
};

void Xtf::skip_header() {
  const Bytes head = input_.want(kMaxFileHeader + kPacketHeader);
  const std::size_t size = header_size(head) > 0 ? header_size(head) : kFileHeader;
  if (head.size() <= size) {
    throw Error("nothing follows the file header", {input_.name(), head.size()}, {}, "the log was cut off");
  }
  constexpr std::uint16_t kDegrees = 3;
  projected_ = RecordView(head).at<std::uint16_t>(164) != kDegrees;
  input_.advance(size);
}

void Xtf::describe() {
  const Eigen::Vector3d& p = X_BS_.translation;
  report_.details["time"] = "clock of the recorder";
  report_.details["lever arms"] = fmt::format(
      "not in the log: head at {:g}, {:g}, {:g} m forward, starboard, down of the position and motion sensors, as "
      "configured",
      p.x(), p.y(), p.z());
  report_.details["ray bending"] = "not corrected: the log has no sound speed profile";
}

std::optional<Event> Xtf::read() {
  for (;;) {
    if (auto event = track_.next()) return event;
    if (ended_) return {};
    if (const auto packet = next_frame(input_, packet_at, report_)) {
      take(*packet);
    } else {
      ended_ = true;
      track_.finish();
    }
  }
}

void Xtf::take(Bytes bytes) {
  const RecordView packet(bytes);
  switch (const auto type = packet.at<std::uint8_t>(2)) {
    case kAttitude: return take_attitude(packet);
    case kPosition: return take_position(packet);
    case kR2Sonic: return take_bathymetry(packet);
    default: ++report_.rejected[fmt::format("packet of type {}, which is not read", type)];
  }
}

void Xtf::take_attitude(const RecordView& packet) {
  if (!packet.holds(0, 63)) return reject("attitude packet too short");
  const auto date = date_at(packet, 54);
  const auto milliseconds = packet.at<std::uint16_t>(61);
  if (!date || milliseconds > 999) return reject("attitude packet whose date is impossible");
  const auto value = [&](std::size_t at) { return static_cast<double>(packet.at<float>(at)); };
  MotionSample sample;
  sample.time = *date + std::chrono::milliseconds(milliseconds);
  sample.pitch = Angle::degrees(value(30));
  sample.roll = Angle::degrees(value(34));
  sample.heave_m = -value(38);
  sample.heading = Angle::degrees(value(50));
  const bool plausible = std::abs(value(30)) <= 90 && std::abs(value(34)) <= 180 && std::abs(value(38)) < 1000 &&
                         std::abs(value(50)) <= 360;
  if (!plausible) return reject("attitude sample that is impossible");
  track_.add(sample);
}

void Xtf::take_position(const RecordView& packet) {
  if (!packet.holds(0, 39)) return reject("position packet too short");
  const auto date = date_at(packet, 14);
  const auto tenths = packet.at<std::uint16_t>(21);  // tenths of a millisecond
  if (!date || tenths > 9999) return reject("position packet whose date is impossible");
  const GeoPoint point{packet.at<double>(23), packet.at<double>(31)};
  if (projected_) return reject("position in metres of an unknown projection");
  PositionFix fix;
  fix.time = *date + std::chrono::microseconds(100 * tenths);
  fix.point = point;
  track_.add(fix);
}

void Xtf::take_bathymetry(const RecordView& packet) {
  constexpr std::size_t kPingHeader = 256;
  const auto block = block_of(packet.part(kPingHeader, packet.size()));
  if (!block || block->header.size() < 116) return reject("bathymetry without the block of an R2Sonic head");
  const auto date = date_at(packet, 14);
  const auto hundredths = packet.at<std::uint8_t>(21);
  if (!date || hundredths > 99) return reject("bathymetry whose date is impossible");
  const Time recorded = *date + std::chrono::milliseconds(10 * hundredths);
  const auto nanoseconds = block->header.at<std::uint32_t>(32);
  const Time stated{std::chrono::seconds(block->header.at<std::uint32_t>(28)) + Duration(nanoseconds)};
  const bool agree = nanoseconds < 1'000'000'000 && std::chrono::abs(stated - recorded) < std::chrono::seconds(1);
  report_.note_setting("clock of the head",
                       agree ? "agrees with the recorder" : "disagrees with the recorder, not used");
  const double sound_speed = static_cast<double>(block->header.at<float>(44));
  if (!(sound_speed > 1000 && sound_speed < 2000)) return reject("bathymetry whose sound speed is impossible");
  Swath swath;
  swath.time = agree ? stated : recorded;
  swath.frame = Swath::Frame::kBody;
  swath.sound_speed = sound_speed;
  const double width = static_cast<double>(std::max(block->header.at<float>(60), block->header.at<float>(64)));
  if (width > 0 && width < 3) swath.beam_width = Angle::radians(width);
  if (!add_soundings(*block, swath)) return reject("bathymetry whose sizes contradict each other");
  const double tilt = static_cast<double>(block->header.at<float>(104));
  std::string model(text_of(block->header.part(4, 12)));
  model.resize(std::min(model.find('\0'), model.size()));
  if (std::any_of(model.begin(), model.end(), [](char c) { return c < ' ' || c > '~'; })) model = "of unknown model";
  report_.note_setting(
      "sonar", fmt::format("R2Sonic {}, {:.4g} kHz", model, static_cast<double>(block->header.at<float>(48)) / 1000));
  if (std::isfinite(tilt) && tilt != 0) {
    report_.note_setting("tilt of the head", fmt::format("{:.2f} degrees stated, not applied: configure mount_roll_deg",
                                                         Angle::radians(tilt).degrees()));
  }
  track_.add({std::move(swath), std::nullopt, std::nullopt});
}

bool Xtf::add_soundings(const R2SonicBlock& block, Swath& swath) {
  constexpr std::size_t kRanges = 8, kSteps = 36;
  const std::size_t points = block.header.at<std::uint16_t>(114);
  const bool angles = block.even_angles ? block.angles.holds(4, 8) : block.angles.holds(kSteps, 2 * points);
  const bool flagged = block.flags.size() > 0;
  if (!block.ranges.holds(kRanges, 2 * points) || !angles || (flagged && !block.flags.holds(4, (points + 1) / 2)))
    return false;
  const double unit = 0.5 * swath.sound_speed * static_cast<double>(block.ranges.at<float>(4));
  const double first = static_cast<double>(block.angles.at<float>(4));
  const double second = static_cast<double>(block.angles.at<float>(8));  // last angle, or angle per step count
  std::uint32_t steps = 0;
  swath.soundings.reserve(points);
  for (std::size_t i = 0; i < points; ++i) {
    if (!block.even_angles) steps += block.angles.at<std::uint16_t>(kSteps + 2 * i);
    const double share = points > 1 ? static_cast<double>(i) / static_cast<double>(points - 1) : 0;
    const double angle = block.even_angles ? first + share * (second - first) : first + second * steps;
    // Four flags per point, the first point in the upper half of a byte: phase, magnitude, two reserved.
    const auto flags = block.flags.at<std::uint8_t>(4 + i / 2) >> (i % 2 == 0 ? 4 : 0);
    const bool detected = !flagged || (flags & 0xC) != 0;
    const double range = detected ? unit * block.ranges.at<std::uint16_t>(kRanges + 2 * i) : 0;
    add_sounding(swath, i, range, angle);
  }
  return true;
}

void Xtf::add_sounding(Swath& swath, std::size_t point, double range, double angle) {
  if (range == 0) return reject("sounding without a detection");
  if (!(range > 0 && range < 1e5) || !(std::abs(angle) <= 3.2)) return reject("sounding that is not finite");
  const Eigen::Vector3d p_SQ(0, range * std::sin(angle), range * std::cos(angle));
  Sounding sounding;
  sounding.point = (X_BS_ * p_SQ).cast<float>();
  sounding.range_m = static_cast<float>(range);
  sounding.beam = static_cast<std::uint16_t>(point);
  swath.soundings.push_back(sounding);
}

}  // namespace

bool looks_like_xtf(Bytes head) {
  if (head.empty() || static_cast<std::uint8_t>(head[0]) != kFileMark || head.size() < kFileHeader) return false;
  if (head.size() == kFileHeader) return text_of(head).find('\0') != std::string_view::npos;
  return header_size(head) > 0 || holds_frame(head.subspan(kFileHeader), packet_at);
}

std::unique_ptr<Source> open_xtf(ByteWindow input, const InputConfig& config) {
  return std::make_unique<Xtf>(std::move(input), config);
}

}  // namespace isobath
