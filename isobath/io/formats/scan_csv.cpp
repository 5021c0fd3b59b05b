#include <fmt/format.h>
#include <isobath/io/bytes/log_source.hpp>
#include <isobath/io/bytes/sample_arena.hpp>
#include <isobath/io/bytes/text_lines.hpp>
#include <isobath/io/formats/scan_csv.hpp>
#include <isobath/io/input/scanning_head.hpp>

namespace isobath {
namespace {

constexpr BeamSize kBeam{Angle::degrees(3), Angle::degrees(35)};
constexpr std::int64_t kMaxBins = 65536;

struct Heading {
  double t_s = 0;
  double head_deg = 0;
  double bin_m = 0;
  std::int64_t bins = 0;

  bool read(TextRow& row) { return row.number(t_s) && row.number(head_deg) && row.number(bin_m) && row.number(bins); }
};

class ScanCsv final : public LogSource {
 public:
  ScanCsv(ByteWindow input, const InputConfig& config) : LogSource(std::move(input), "scan CSV"), head_(config, kBeam) {
    next_line(input_, report_);  // the heading
    check_first_line();
  }

 private:
  std::optional<Event> read() override {
    while (const auto line = next_line(input_, report_)) {
      if (trimmed(line->text).empty() || line->text.front() == '#') continue;
      if (auto ping = parse(*line)) return ping;
    }
    return {};
  }
  void check_first_line();
  std::optional<Event> parse(const TextLine& line);
  void describe(const Heading& heading);

  ScanningHead head_;
  SampleArena arena_;
  RangeWindow described_;
};

void ScanCsv::check_first_line() {
  const Bytes view = input_.want(4096);
  if (trimmed(first_line(view)).empty()) {
    throw Error("nothing follows the heading", {input_.name(), input_.position()}, {}, "the file was cut off");
  }
  Heading heading;
  TextRow row(first_line(view), ',');
  if (heading.read(row) && (heading.bins < 1 || heading.bins > kMaxBins)) {
    throw Error(fmt::format("the first line states {} bins", heading.bins),
                {input_.name(), input_.position(), {}, {}, "nbins"}, fmt::format("1 .. {}", kMaxBins));
  }
}

std::optional<Event> ScanCsv::parse(const TextLine& line) {
  const auto damaged = [&](const char* reason) {
    line.add_damage(report_, reason);
    return std::nullopt;
  };
  TextRow row(line.text, ',');
  Heading heading;
  if (!heading.read(row)) return damaged("line without time, bearing, bin length and number of bins");
  if (!representable_seconds(heading.t_s)) return damaged("time out of range");
  if (!(heading.bin_m > 0 && heading.bin_m < 1000)) return damaged("bin length out of range");
  if (heading.bins < 1 || heading.bins > kMaxBins) return damaged("number of bins out of range");
  const auto bins = static_cast<int>(heading.bins);
  std::byte* samples = arena_.take(static_cast<std::size_t>(bins));
  if (row.samples(samples, bins) != bins) {
    arena_.give_back(static_cast<std::size_t>(bins));
    return damaged("line without its stated number of samples, each 0..255");
  }
  const RangeWindow window{0, heading.bin_m, bins};
  if (window != described_) describe(heading);
  described_ = window;
  Ping ping = head_.ping(Angle::degrees(heading.head_deg), window, samples, arena_.owner());
  ping.time = Time{seconds(heading.t_s)};
  return ping;
}

void ScanCsv::describe(const Heading& heading) {
  report_.details["sonar"] = fmt::format("scanning head, beam {:g} x {:g} degrees", head_.beam().width.degrees(),
                                         head_.beam().height.degrees());
  report_.note_setting("range", fmt::format("{:.4g} m in {} bins of {:.5g} mm", heading.bin_m * double(heading.bins),
                                            heading.bins, heading.bin_m * 1e3));
  report_.details["sound speed"] =
      fmt::format("{:g} m/s, as configured: the log does not state it", head_.sound_speed());
  report_.details["time"] = "seconds since an unknown start";
}

}  // namespace

bool looks_like_scan_csv(Bytes head) {
  const std::string_view line = first_line(head);
  return line.starts_with('#') && line.find("t_s,head_deg,bin_m,nbins") != std::string_view::npos;
}

std::unique_ptr<Source> open_scan_csv(ByteWindow input, const InputConfig& config) {
  return std::make_unique<ScanCsv>(std::move(input), config);
}

}  // namespace isobath
