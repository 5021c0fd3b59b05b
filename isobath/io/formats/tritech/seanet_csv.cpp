#include <fmt/format.h>
#include <isobath/io/bytes/log_source.hpp>
#include <isobath/io/bytes/sample_arena.hpp>
#include <isobath/io/bytes/text_lines.hpp>
#include <isobath/io/formats/tritech/tritech_logs.hpp>
#include <isobath/io/formats/tritech/tritech_protocol.hpp>
#include <isobath/io/input/scanning_head.hpp>

namespace isobath {
namespace {

constexpr BeamSize kBeam{Angle::degrees(3), Angle::degrees(35)};
constexpr int kMaxBins = 65536;

/// The time of day from "HH:MM:SS.fff".
std::optional<Duration> time_of_day(std::string_view text) {
  TextRow row(text, ':');
  int hours = 0, minutes = 0;
  double rest = 0;
  if (!row.number(hours) || !row.number(minutes) || !row.number(rest)) return {};
  if (hours < 0 || hours > 23 || minutes < 0 || minutes > 59 || !(rest >= 0 && rest < 61)) return {};
  return std::chrono::hours(hours) + std::chrono::minutes(minutes) + seconds(rest);
}

/// The columns before the bins.
struct Columns {
  Duration time{};
  int node = 0;
  int head_control = 0;
  int range_scale = 0;
  int gain = 0;
  int bearing = 0;
  int bins = 0;

  bool read(TextRow& row) {
    std::string_view clock;
    if (!row.skip(1) || !row.next(clock)) return false;
    const auto parsed = time_of_day(trimmed(clock));
    if (!parsed) return false;
    time = *parsed;
    return row.number(node) && row.skip(1) && row.number(head_control) && row.number(range_scale) && row.number(gain) &&
           row.skip(6) && row.number(bearing) && row.number(bins);
  }
  [[nodiscard]] bool plausible() const {
    return head_control >= 0 && head_control <= 0xffff && range_scale >= 0 && range_scale <= 0xffff && bins >= 1 &&
           bins <= kMaxBins;
  }
};

class SeanetCsv final : public LogSource {
 public:
  SeanetCsv(ByteWindow input, const InputConfig& config)
      : LogSource(std::move(input), "Seanet CSV"), head_(config, kBeam) {
    next_line(input_, report_);  // the heading
    if (input_.want(1).empty()) throw Error("nothing follows the heading", {input_.name(), input_.position()});
    report_.details["time"] = "time of day: the log has no date";
  }

 private:
  std::optional<Event> read() override {
    while (const auto line = next_line(input_, report_)) {
      if (trimmed(line->text).empty()) continue;
      if (auto ping = parse(*line)) return ping;
    }
    return {};
  }
  std::optional<Event> parse(const TextLine& line);
  void describe(const Columns& columns);

  ScanningHead head_;
  SampleArena arena_;
  DayClock clock_;
  std::array<int, 4> described_{};
};

std::optional<Event> SeanetCsv::parse(const TextLine& line) {
  TextRow row(line.text, ',');
  Columns c;
  if (!c.read(row) || !c.plausible()) {
    line.add_damage(report_, "line without time, settings, bearing and number of bins");
    return {};
  }
  std::byte* samples = arena_.take(static_cast<std::size_t>(c.bins));
  if (row.samples(samples, c.bins) != c.bins) {
    arena_.give_back(static_cast<std::size_t>(c.bins));
    line.add_damage(report_, "line without its stated number of samples, each 0..255");
    return {};
  }
  const double range_m = tritech::range_scale_m(static_cast<std::uint16_t>(c.range_scale));
  if (c.bearing < 0 || c.bearing > 6399 || !(range_m > 0)) {
    reject(to_text(range_m > 0 ? MessageFault::kBadBearing : MessageFault::kBadRange));
    return {};
  }
  const std::array<int, 4> setting{c.head_control, c.range_scale, c.gain, c.bins};
  if (described_ != setting) describe(c);
  described_ = setting;
  Ping ping = head_.ping(tritech::bearing(c.bearing), {0, range_m / c.bins, c.bins}, samples, arena_.owner());
  ping.time = clock_.at(c.time);
  ping.full_scale = c.head_control & tritech::kEightBit ? 255 : 15;
  return ping;
}

void SeanetCsv::describe(const Columns& c) {
  const double range_m = tritech::range_scale_m(static_cast<std::uint16_t>(c.range_scale));
  report_.details["sonar"] = fmt::format("Tritech imaging head, beam {:g} x {:g} degrees", head_.beam().width.degrees(),
                                         head_.beam().height.degrees());
  report_.note_setting("gain", fmt::format("{:.0f} %", c.gain / 2.1));
  report_.note_setting("range", fmt::format("{:.4g} m by its label, in {} bins", range_m, c.bins));
  report_.details["sound speed"] = "as set in Seanet Pro during recording: the range label is used unchanged";
}

}  // namespace

bool looks_like_seanet_csv(Bytes head) {
  std::string_view text = text_of(head);
  const std::size_t heading = text.find('\n');
  if (heading == std::string_view::npos) return false;
  text.remove_prefix(heading + 1);
  TextRow row(text.substr(0, text.find('\n')), ',');
  Columns columns;
  return columns.read(row) && columns.plausible();
}

std::unique_ptr<Source> open_seanet_csv(ByteWindow input, const InputConfig& config) {
  return std::make_unique<SeanetCsv>(std::move(input), config);
}

}  // namespace isobath
