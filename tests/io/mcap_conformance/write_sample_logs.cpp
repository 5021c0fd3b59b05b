// Writes <folder>/{none,lz4,zstd}.mcap of made-up events and <folder>/expected.json, what a reader must count in them.
#include <cstdio>
#include <fmt/format.h>
#include <isobath/base/pending_file.hpp>
#include <isobath/io/mcap/native_log.hpp>
#include <tests/io/sample_events.hpp>

namespace isobath {
namespace {

std::string expected_of(const std::vector<Event>& events) {
  int pings = 0, fixes = 0, ranges = 0, health = 0, swaths = 0;
  std::uint64_t samples = 0;
  double sum = 0;
  for (const Event& event : events) {
    fixes += std::holds_alternative<Navigation>(event);
    ranges += std::holds_alternative<RangeReading>(event);
    health += std::holds_alternative<Health>(event);
    swaths += std::holds_alternative<Swath>(event);
    const auto* ping = std::get_if<Ping>(&event);
    if (!ping) continue;
    ++pings;
    for (int b = 0; b < ping->intensity.beams(); ++b) {
      for (int k = 0; k < ping->intensity.bins(); ++k, ++samples) sum += ping->intensity(b, k);
    }
  }
  return fmt::format(
      R"({{"counts": {{"/ping": {}, "/navigation": {}, "/range": {}, "/health": {}, "/swath": {}}}, "samples": {}, "sum": {:.17g}}})",
      pings, fixes, ranges, health, swaths, samples, sum);
}

void write_logs(const std::filesystem::path& folder) {
  std::filesystem::create_directories(folder);
  const std::vector<Event> events = test::sample_events(500, 21);
  for (const auto& [name, compression] : {std::pair("none.mcap", McapCompression::kNone),
                                          {"lz4.mcap", McapCompression::kLz4},
                                          {"zstd.mcap", McapCompression::kZstd}}) {
    NativeLogWriter writer(folder / name, {compression, 16});
    writer.set_details({{"sonar", "made up"}});
    writer.set_configuration("[io]\n");
    for (const Event& event : events) writer.write(event);
    writer.set_origin({60, 10});
    writer.close();
  }
  write_whole_file(folder / "expected.json", expected_of(events));
}

}  // namespace
}  // namespace isobath

int main(int count, char** arguments) {
  if (count != 2) return 2;
  try {
    isobath::write_logs(arguments[1]);
  } catch (const std::exception& e) {
    std::fprintf(stderr, "%s\n", e.what());
    return 1;
  }
}
