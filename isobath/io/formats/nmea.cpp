#include <algorithm>
#include <fmt/format.h>
#include <isobath/io/bytes/log_source.hpp>
#include <isobath/io/bytes/text_lines.hpp>
#include <isobath/io/formats/nmea.hpp>
#include <isobath/io/formats/nmea_decoder.hpp>

namespace isobath {
namespace {

constexpr std::size_t kHead = 1 << 16;

/// Whether any sentence of the text states a date.
bool has_date(std::string_view text) {
  while (!text.empty()) {
    const std::size_t end = text.find_first_of("\r\n");
    if (states_date(sentence_of(text.substr(0, end)))) return true;
    text.remove_prefix(end == std::string_view::npos ? text.size() : end + 1);
  }
  return false;
}

class Nmea final : public LogSource {
 public:
  Nmea(ByteWindow input, const InputConfig& config)
      : LogSource(std::move(input), "NMEA 0183"),
        decoder_(config, report_,
                 has_date(text_of(input_.want(kHead))) ? NmeaDecoder::Times::kDated : NmeaDecoder::Times::kUndated) {}

 private:
  std::optional<Event> read() override {
    while (const auto line = next_line(input_, report_, LineEnd::kAny)) {
      if (trimmed(line->text).empty()) continue;
      const NmeaSentence sentence = sentence_of(line->text);
      if (sentence.state == NmeaSentence::State::kNone) line->add_damage(report_, "text that is not a sentence");
      if (auto event = decoder_.event(sentence)) return event;
    }
    decoder_.count_unused();
    return std::nullopt;
  }

  NmeaDecoder decoder_;
};

}  // namespace

bool looks_like_nmea(Bytes head) {
  if (!looks_like_text(head)) return false;
  std::string_view text = text_of(head.first(std::min(head.size(), kHead)));
  int lines = 0, good = 0;
  bool used = false;
  while (!text.empty() && lines < 100) {
    const std::size_t end = text.find_first_of("\r\n");
    if (end == std::string_view::npos && good > 0) break;  // cut by the end of the head
    const std::string_view line = text.substr(0, end);
    text.remove_prefix(end == std::string_view::npos ? text.size() : end + 1);
    if (trimmed(line).empty()) continue;
    ++lines;
    const NmeaSentence sentence = sentence_of(line);
    if (sentence.state != NmeaSentence::State::kGood && sentence.state != NmeaSentence::State::kOther) continue;
    ++good;
    used = used || sentence.state == NmeaSentence::State::kGood;
  }
  return used && good * 2 > lines;
}

std::unique_ptr<Source> open_nmea(ByteWindow input, const InputConfig& config) {
  return std::make_unique<Nmea>(std::move(input), config);
}

}  // namespace isobath
