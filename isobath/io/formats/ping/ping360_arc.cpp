#include <fmt/format.h>
#include <isobath/io/bytes/framing.hpp>
#include <isobath/io/bytes/log_source.hpp>
#include <isobath/io/bytes/sample_arena.hpp>
#include <isobath/io/bytes/text_lines.hpp>
#include <isobath/io/formats/ping/ping_logs.hpp>
#include <isobath/io/input/scanning_head.hpp>

namespace isobath {
namespace {

constexpr BeamSize kBeam{Angle::degrees(2), Angle::degrees(25)};
constexpr double kDefaultRange = 2;  // m: setting of a Ping360 after its start
constexpr double kStepTime = 0.020;  // s
constexpr std::string_view kHeading = "Angle (gradian)";

class Ping360Arc final : public LogSource {
 public:
  Ping360Arc(ByteWindow input, const InputConfig& config)
      : LogSource(std::move(input), "Ping360 arc table"),
        head_(config, kBeam),
        range_m_(config.range_m > 0 ? config.range_m : kDefaultRange) {
    const auto heading = next_line(input_, report_);
    separator_ = heading && heading->text.size() > kHeading.size() ? heading->text[kHeading.size()] : ',';
    if (input_.want(1).empty()) throw Error("nothing follows the heading", {input_.name(), input_.position()});
    report_.details["sonar"] =
        fmt::format("Ping360, beam {:g} x {:g} degrees", head_.beam().width.degrees(), head_.beam().height.degrees());
    report_.details["range"] =
        fmt::format("{:g} m, {}", range_m_,
                    config.range_m > 0 ? "as configured" : "assumed: the table does not state it, set input.range_m");
    report_.details["sound speed"] =
        fmt::format("{:g} m/s, as configured: the table does not state it", head_.sound_speed());
    report_.details["time"] = "estimated from the range: the table has no times";
  }

 private:
  std::optional<Event> read() override {
    while (const auto line = next_line(input_, report_)) {
      if (trimmed(line->text).empty()) continue;
      if (auto ping = parse(*line)) {
        return clock_.stamped(std::move(*ping), seconds(2 * range_m_ / head_.sound_speed() + kStepTime));
      }
    }
    return {};
  }

  std::optional<Event> parse(const TextLine& line) {
    TextRow row(line.text, separator_);
    int angle_grad = 0;
    const bool angle = row.number(angle_grad);
    const std::size_t capacity = row.fields_left();
    std::byte* samples = arena_.take(capacity);
    const int bins = angle ? row.samples(samples, static_cast<int>(capacity)) : -1;
    if (bins > 0 && angle_grad >= 0 && angle_grad < 400) {
      return head_.ping(Angle::gradians(angle_grad), {0, range_m_ / bins, bins}, samples, arena_.owner());
    }
    arena_.give_back(capacity);
    if (bins > 0) {
      reject(to_text(MessageFault::kBadBearing));
    } else {
      line.add_damage(report_, "line that is not an angle and intensities 0..255");
    }
    return {};
  }

  ScanningHead head_;
  SampleArena arena_;
  SyntheticClock clock_;
  double range_m_;
  char separator_;
};

}  // namespace

bool looks_like_ping360_arc(Bytes head) {
  const std::string_view line = first_line(head);
  return line.size() > kHeading.size() && line.starts_with(kHeading) &&
         (line[kHeading.size()] == ';' || line[kHeading.size()] == ',');
}

std::unique_ptr<Source> open_ping360_arc(ByteWindow input, const InputConfig& config) {
  return std::make_unique<Ping360Arc>(std::move(input), config);
}

}  // namespace isobath
