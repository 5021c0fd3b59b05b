// Readers: bytes of log a second, from a log in memory to events whose samples have been looked at once.
// Bar: 300 MB/s for Ping Viewer logs.
#include <benchmark/benchmark.h>
#include <bit>
#include <isobath/base/random.hpp>
#include <isobath/io/formats/oculus/oculus_logs.hpp>
#include <isobath/io/formats/ping/ping_logs.hpp>
#include <isobath/io/formats/scan_csv.hpp>
#include <tests/io/oculus_messages.hpp>
#include <tests/io/ping_frames.hpp>

namespace isobath {
namespace {

using Open = std::unique_ptr<Source> (*)(ByteWindow, const InputConfig&);

void read_all(benchmark::State& state, const std::string& log, Open open) {
  const auto owner = std::make_shared<const std::string>(log);
  std::int64_t pings = 0;
  for (auto _ : state) {
    const auto source = open({"log", bytes_of(*owner), owner}, {});
    while (const auto event = source->next()) {
      const auto& ping = std::get<Ping>(*event);
      benchmark::DoNotOptimize(ping.intensity(0, ping.window.bins - 1));
      ++pings;
    }
    if (source->report().bytes_skipped > 0) state.SkipWithError("the log was not read whole");
  }
  state.SetBytesProcessed(state.iterations() * static_cast<std::int64_t>(log.size()));
  state.counters["pings/s"] = benchmark::Counter(static_cast<double>(pings), benchmark::Counter::kIsRate);
}

std::string samples(int count, Random& random) {
  std::string result(static_cast<std::size_t>(count), '\0');
  for (char& c : result) c = static_cast<char>(random.index(256));
  return result;
}

void BM_PingViewerLog(benchmark::State& state) {
  test::PingViewerWriter writer;
  int at = 0;
  for (const auto& frame : test::ping360_frames(8000, 1200, 1)) writer.add(at += 30, frame);
  read_all(state, writer.log(), open_ping_viewer_log);
}
BENCHMARK(BM_PingViewerLog)->Unit(benchmark::kMillisecond);

void BM_ScanCsv(benchmark::State& state) {
  Random random(1);
  std::string log = "# t_s,head_deg,bin_m,nbins,i0,i1,...\n";
  for (int i = 0; i < 4000; ++i) {
    log += std::to_string(i * 0.04) + ',' + std::to_string(i % 200 * 1.8) + ",0.0125,399";
    for (int k = 0; k < 399; ++k) log += ',' + std::to_string(random.index(192));
    log += '\n';
  }
  read_all(state, log, open_scan_csv);
}
BENCHMARK(BM_ScanCsv)->Unit(benchmark::kMillisecond);

void BM_OculusStream(benchmark::State& state) {
  Random random(1);
  std::string log;
  for (int i = 0; i < 60; ++i) {
    test::OculusMessage message{.beams = 256, .ranges = 700, .ping_id = static_cast<std::uint32_t>(i)};
    message.bearings.clear();
    for (int b = 0; b < 256; ++b) message.bearings.push_back(-6500 + 51 * b);
    message.image = samples(256 * 700, random);
    log += message.bytes();
  }
  read_all(state, log, open_oculus_stream);
}
BENCHMARK(BM_OculusStream)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace isobath
