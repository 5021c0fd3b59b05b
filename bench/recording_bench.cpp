// Recordings: what it costs to open one of an hour, to show any time of it, to go on from there, and to take a sample.
// Bar: a seek in an hour in less than 200 ms.
//
// The display holds 5 MB (80 tiles of depths, a thousand blocks of voxels); a sample, every quarter of a second,
// changes about 10 kB of it. Beside it events of 40 kB a second.
#include <benchmark/benchmark.h>
#include <filesystem>
#include <isobath/base/random.hpp>
#include <isobath/recording/recorded_display.hpp>
#include <isobath/recording/run_recorder.hpp>

namespace isobath {
namespace {

constexpr std::int64_t kSeconds = 3600;
constexpr int kSamples = 4;  // a second

Time time_at(double s) { return Time(seconds(1.6e9 + s)); }

std::string noise(std::size_t bytes, Random& random) {
  std::string text(bytes, '\0');
  for (char& c : text) c = static_cast<char>(random.index(16));
  return text;
}

class Display {
 public:
  Display() {
    for (std::uint64_t tile = 0; tile < 80; ++tile) change(DisplayKind::kDepth, tile, 64 << 10, 0);
    for (std::uint64_t block = 0; block < 1000; ++block) change(DisplayKind::kVoxels, block, 500, 0);
  }
  void step(double s) {
    change(DisplayKind::kVehicle, 0, 80, s);
    change(DisplayKind::kGrid, 0, 5000, s);
    for (int i = 0; i < 6; ++i) change(DisplayKind::kVoxels, random_.index(1000), 500, s);
    if (++steps_ % 40 == 0) change(DisplayKind::kDepth, random_.index(80), 64 << 10, s);
  }
  DisplayState items;

 private:
  void change(DisplayKind kind, std::uint64_t number, std::size_t bytes, double s) {
    items.set(kind, number, time_at(s), noise(bytes, random_));
  }
  Random random_{4};
  int steps_ = 0;
};

/// A file that is gone when the program ends.
struct TemporaryFile {
  explicit TemporaryFile(const char* name) : path(std::filesystem::temp_directory_path() / name) {}
  TemporaryFile(const TemporaryFile&) = delete;
  TemporaryFile& operator=(const TemporaryFile&) = delete;
  ~TemporaryFile() {
    std::error_code ignored;
    std::filesystem::remove(path, ignored);
  }
  std::filesystem::path path;
};

void record_an_hour(const std::filesystem::path& file) {
  RunRecorder recorder(file, {});
  Display display;
  Random random(8);
  for (std::int64_t i = 0; i < kSeconds * kSamples; ++i) {
    const double s = static_cast<double>(i) / kSamples;
    Health health;
    health.time = time_at(s);
    health.note = noise(10'000, random);
    recorder.on_event(Event(health));
    display.step(s);
    recorder.sample(time_at(s), display.items);
  }
  recorder.close();
}

/// Made once.
const std::filesystem::path& an_hour() {
  static const TemporaryFile kFile("isobath-hour.mcap");
  static const bool kMade = (record_an_hour(kFile.path), true);
  benchmark::DoNotOptimize(kMade);
  return kFile.path;
}

void BM_OpenAnHour(benchmark::State& state) {
  const auto& file = an_hour();
  for (auto _ : state) {
    RecordedDisplay recorded(file);
    benchmark::DoNotOptimize(recorded.span());
  }
  state.counters["file_MB"] = static_cast<double>(std::filesystem::file_size(file)) / 1e6;
}
BENCHMARK(BM_OpenAnHour)->Unit(benchmark::kMillisecond);

void BM_SeekInAnHour(benchmark::State& state) {
  RecordedDisplay recorded(an_hour());
  Random random(3);
  DisplayState items;
  for (auto _ : state) {
    recorded.seek(time_at(static_cast<double>(random.index(kSeconds * 1000)) / 1000), items);
  }
  const auto counts = recorded.counts();
  const auto seeks = static_cast<double>(state.iterations());
  state.counters["chunks"] = static_cast<double>(counts.unpacked) / seeks;
  state.counters["MB"] = static_cast<double>(counts.unpacked_bytes) / 1e6 / seeks;
}
BENCHMARK(BM_SeekInAnHour)->Unit(benchmark::kMillisecond);

void BM_PlayOneSecond(benchmark::State& state) {
  RecordedDisplay recorded(an_hour());
  DisplayState items;
  double s = 0;
  for (auto _ : state) {
    s = s + 1 < kSeconds ? s + 1 : 0;
    recorded.advance(time_at(s), items);
  }
}
BENCHMARK(BM_PlayOneSecond)->Unit(benchmark::kMillisecond);

void BM_SampleOfTheDisplay(benchmark::State& state) {
  const TemporaryFile file("isobath-samples.mcap");
  RunRecorder recorder(file.path, {});
  Display display;
  double s = 0;
  for (auto _ : state) {
    state.PauseTiming();
    s += 1.0 / kSamples;
    display.step(s);
    state.ResumeTiming();
    recorder.sample(time_at(s), display.items);
  }
}
BENCHMARK(BM_SampleOfTheDisplay)->Unit(benchmark::kMicrosecond);

}  // namespace
}  // namespace isobath
