#include <isobath/io/bytes/line_stream.hpp>
#include <isobath/io/formats/nmea_decoder.hpp>
#include <isobath/links/device_link.hpp>

namespace isobath {
namespace {

constexpr std::size_t kLongestSentence = 512;  // with noise in front of it

/// The sentences of a GPS, a compass and an echo sounder. It is told nothing.
class NmeaLink final : public DeviceLink {
 public:
  NmeaLink(const DeviceConfig& config, LinkSource& events)
      : DeviceLink(config, events), decoder_(input_of(config), report_, NmeaDecoder::Times::kHost) {}

  void on_bytes(Bytes bytes, Time time) override {
    const std::uint64_t dropped = lines_.push(bytes, [&](std::string_view line) { on_line(line, time); });
    if (dropped > 0) report_.rejected["line too long"] += dropped;
    tell(report_);
  }

 private:
  static InputConfig input_of(const DeviceConfig& config) {
    InputConfig input = config.input();
    input.survey.transducer_depth_m = config.position_m[2];
    return input;
  }
  void begin() override { lines_.clear(); }
  void on_line(std::string_view line, Time time) {
    const NmeaSentence sentence = sentence_of(line);
    if (sentence.state == NmeaSentence::State::kNone) ++report_.rejected["text that is no sentence"];
    if (const auto origin = events_.origin()) report_.origin = origin;
    auto event = decoder_.event(sentence, time);
    if (!event) return;
    if (auto* reading = std::get_if<RangeReading>(&*event)) {
      reading->X_BS.translation.x() = config_.position_m[0];
      reading->X_BS.translation.y() = config_.position_m[1];
    } else if (!config_.navigation) {
      heard_ = true;
      return;
    }
    if (config_.navigation && report_.origin) events_.locate(*report_.origin);
    give(std::move(*event), time);
  }

  SourceReport report_;
  NmeaDecoder decoder_;
  LineStream lines_{kLongestSentence};
};

}  // namespace

std::unique_ptr<DeviceLink> make_nmea_link(const DeviceConfig& config, LinkSource& events) {
  return std::make_unique<NmeaLink>(config, events);
}

}  // namespace isobath
