#include <array>
#include <fmt/format.h>
#include <isobath/io/bytes/framing.hpp>
#include <isobath/io/bytes/log_source.hpp>
#include <isobath/io/formats/aris.hpp>
#include <isobath/io/input/scanning_head.hpp>

namespace isobath {
namespace {

constexpr std::size_t kHeaderBytes = 1024;  // header of the file and of each frame
constexpr std::string_view kSignature("DDF\x05");
constexpr std::size_t kSignatureAt = 12;  // offset in a frame
constexpr std::uint32_t kMaxSamples = 16384;
constexpr Angle kArisHeight = Angle::degrees(14), kArisTelephotoHeight = Angle::degrees(3);

/// Beams of each ping mode, 1 to 12.
constexpr std::array<int, 13> kBeams{0, 48, 48, 96, 96, 96, 64, 64, 64, 128, 128, 128, 128};

enum class ArisSystem : std::uint32_t { k1800 = 0, k3000 = 1, k1200 = 2 };

/// Azimuth of a beam, degrees: linear u + cubic u^3, with u from -1 at the first beam to 1 at the last.
struct ArisLens {
  int beams;
  bool telephoto;
  double linear, cubic;
};
constexpr std::array<ArisLens, 6> kLenses{{{48, false, 15.8494, -2.3245},
                                           {96, false, 16.1014, -2.3249},
                                           {64, false, 15.049, -0.336},
                                           {128, false, 15.0933, -0.38},
                                           {48, true, 7.063, -0.328},
                                           {96, true, 7.6048, -0.184}}};

struct ArisHeader {
  std::uint64_t time_us = 0;
  std::uint32_t mode = 0, high_frequency = 0, cycle_us = 0, period_us = 0, transmits = 0, samples = 0, delay_us = 0;
  std::uint32_t telephoto = 0, system = 0, ordered = 0;
  float sound_speed = 0;

  [[nodiscard]] int beams() const { return mode < kBeams.size() ? kBeams[mode] : 0; }
  [[nodiscard]] std::size_t bytes() const { return kHeaderBytes + static_cast<std::size_t>(beams()) * samples; }
};

/// Reads a header of kHeaderBytes; empty if it contradicts itself.
std::optional<ArisHeader> aris_header_of(Bytes header) {
  const RecordView fields(header);
  ArisHeader f;
  f.time_us = fields.at<std::uint64_t>(4);
  f.mode = fields.at<std::uint32_t>(436);
  f.high_frequency = fields.at<std::uint32_t>(440);
  f.cycle_us = fields.at<std::uint32_t>(448);
  f.period_us = fields.at<std::uint32_t>(452);
  f.transmits = fields.at<std::uint32_t>(456);
  f.sound_speed = fields.at<float>(464);
  f.samples = fields.at<std::uint32_t>(468);
  f.delay_us = fields.at<std::uint32_t>(476);
  f.telephoto = fields.at<std::uint32_t>(480);
  f.system = fields.at<std::uint32_t>(484);
  f.ordered = fields.at<std::uint32_t>(516);
  const bool sized = f.beams() > 0 && f.samples > 0 && f.samples <= kMaxSamples;
  const bool timed = f.period_us > 0 && f.period_us <= 10'000 && f.delay_us <= 10'000'000;
  // All samples must lie within the cycle, since a wrong number of samples would swallow the next frame.
  const bool fits = f.cycle_us == 0 || f.delay_us + std::uint64_t{f.period_us} * f.samples <= f.cycle_us;
  return sized && timed && fits ? std::optional(f) : std::nullopt;
}

/// Whether another frame begins within the samples of this one, so that part of this frame was lost.
bool holds_next(Bytes frame) {
  const std::string_view text = text_of(frame);
  for (std::size_t at = kSignatureAt;;) {
    at = text.find(kSignature, at + 1);
    if (at == std::string_view::npos) return false;
    const std::size_t begin = at - kSignatureAt;
    const bool cut = frame.size() - begin < kHeaderBytes;
    if (cut || aris_header_of(frame.subspan(begin, kHeaderBytes))) return true;
  }
}

Framing aris_frame_at(Bytes bytes) {
  const std::string_view text = text_of(bytes);
  if (text.size() < kSignatureAt + kSignature.size()) return {Framing::Kind::kIncomplete, kHeaderBytes};
  if (text.substr(kSignatureAt, kSignature.size()) == kSignature) {
    if (bytes.size() < kHeaderBytes) return {Framing::Kind::kIncomplete, kHeaderBytes};
    if (const auto frame = aris_header_of(bytes.first(kHeaderBytes))) {
      if (bytes.size() < frame->bytes()) return {Framing::Kind::kIncomplete, frame->bytes()};
      if (!holds_next(bytes.first(frame->bytes()))) return {Framing::Kind::kFrame, frame->bytes()};
    }
  }
  const std::size_t next = text.find(kSignature, kSignatureAt + 1);
  if (next != std::string_view::npos) return {Framing::Kind::kNoise, next - kSignatureAt};
  return {Framing::Kind::kNoise, text.size() - kSignatureAt - kSignature.size() + 1};
}

const char* aris_name(std::uint32_t system) {
  switch (static_cast<ArisSystem>(system)) {
    case ArisSystem::k1800: return "ARIS 1800";
    case ArisSystem::k3000: return "ARIS 3000";
    case ArisSystem::k1200: return "ARIS 1200";
  }
  return "ARIS of unknown type";
}

const char* aris_frequency(const ArisHeader& frame) {
  const bool high = frame.high_frequency != 0;
  switch (static_cast<ArisSystem>(frame.system)) {
    case ArisSystem::k1800: return high ? "1.8 MHz" : "1.1 MHz";
    case ArisSystem::k3000: return high ? "3 MHz" : "1.8 MHz";
    case ArisSystem::k1200: return high ? "1.2 MHz" : "0.7 MHz";
  }
  return high ? "high" : "low";
}

class Aris final : public LogSource {
 public:
  Aris(ByteWindow input, const InputConfig& config) : LogSource(std::move(input), "ARIS recording"), config_(config) {
    const Bytes head = input_.want(kHeaderBytes + 1);
    if (head.size() <= kHeaderBytes) {
      throw Error("ends within its header or right after it: nothing was recorded", {input_.name(), head.size()});
    }
    input_.advance(kHeaderBytes);
    report_.details["time"] = "clock of the recorder";
    report_.details["samples"] = "8 bits, 80 dB over 255 counts";
  }

 private:
  std::optional<Event> read() override {
    while (const auto bytes = next_frame(input_, aris_frame_at, report_)) {
      if (auto event = take(*bytes)) return event;
    }
    return {};
  }
  std::optional<Event> take(Bytes bytes);
  const std::shared_ptr<const BeamFan>& fan_of(const ArisHeader& frame);
  void describe(const ArisHeader& frame, const Ping& ping);

  InputConfig config_;
  std::shared_ptr<const BeamFan> fans_[2][kBeams.size()];  ///< by lens and ping mode
  std::shared_ptr<const BeamFan> described_fan_;
  RangeWindow described_window_;
};

std::optional<Event> Aris::take(Bytes bytes) {
  const ArisHeader frame = *aris_header_of(bytes.first(kHeaderBytes));
  const auto refuse = [&](const char* reason) -> std::optional<Event> {
    reject(reason);
    return {};
  };
  constexpr std::uint64_t kLatest = 9'000'000'000'000'000;
  if (frame.time_us > kLatest) return refuse("frame whose time is impossible");
  if (frame.ordered == 0) return refuse("frame whose samples are not in the order of its beams");
  if (frame.transmits == 0) return refuse("frame without a transmission");
  Ping ping;
  const double stated = static_cast<double>(frame.sound_speed);
  ping.sound_speed = stated > 1300 && stated < 1700 ? stated : config_.sound_speed;
  const double metres_a_us = 0.5e-6 * ping.sound_speed;
  ping.time = Time{std::chrono::microseconds(static_cast<std::int64_t>(frame.time_us))};
  ping.fan = fan_of(frame);
  ping.window = {metres_a_us * frame.delay_us, metres_a_us * frame.period_us, static_cast<int>(frame.samples)};
  const int beams = frame.beams();
  ping.intensity = Intensities(bytes.data() + kHeaderBytes + beams - 1, SampleType::kU8, beams, ping.window.bins, -1,
                               beams);  // from port to starboard
  ping.storage = input_.owner();
  ping.X_BS = mounted(config_);
  if (ping.fan != described_fan_ || ping.window != described_window_) describe(frame, ping);
  return ping;
}

const std::shared_ptr<const BeamFan>& Aris::fan_of(const ArisHeader& frame) {
  const bool telephoto = frame.telephoto != 0;
  auto& fan = fans_[telephoto ? 1 : 0][frame.mode];
  if (fan) return fan;
  const int beams = frame.beams();
  const ArisLens* lens = nullptr;
  for (const ArisLens& l : kLenses) {
    if (l.beams == beams && (!lens || l.telephoto == telephoto)) lens = &l;
  }
  const auto azimuth = [&](double beam) {
    const double u = 2 * beam / (beams - 1) - 1;
    return Angle::degrees(u * (lens->linear + lens->cubic * u * u));
  };
  BeamFan made;
  for (int b = 0; b < beams; ++b) {
    made.azimuth.push_back(azimuth(b));
    made.width.push_back(beam_size(config_, {azimuth(b + 0.5) - azimuth(b - 0.5), kArisHeight}).width);
  }
  made.height = beam_size(config_, {kArisHeight, lens->telephoto ? kArisTelephotoHeight : kArisHeight}).height;
  fan = std::make_shared<const BeamFan>(std::move(made));
  return fan;
}

void Aris::describe(const ArisHeader& frame, const Ping& ping) {
  described_fan_ = ping.fan;
  described_window_ = ping.window;
  report_.note_setting("sonar", fmt::format("{}, {} beams{}", aris_name(frame.system), frame.beams(),
                                            frame.telephoto != 0 ? ", telephoto lens" : ""));
  report_.note_setting("frequency", aris_frequency(frame));
  report_.note_setting("range", fmt::format("{:.4g} to {:.4g} m in {} bins of {:.4g} mm", ping.window.start_m,
                                            ping.window.end_m(), ping.window.bins, ping.window.bin_m * 1e3));
}

}  // namespace

bool looks_like_aris(Bytes head) { return text_of(head).starts_with(kSignature); }

std::unique_ptr<Source> open_aris(ByteWindow input, const InputConfig& config) {
  return std::make_unique<Aris>(std::move(input), config);
}

}  // namespace isobath
