// The live page beside the run: how long the run's set() takes with nobody looking, and with four pages of which one
// takes nothing. A fan of 128 KB of echoes, a vehicle and 30 tiles of the map ten times a second, for ten seconds; the
// pages read in threads of their own, on the same machine.
#include <algorithm>
#include <atomic>
#include <benchmark/benchmark.h>
#include <chrono>
#include <isobath/base/random.hpp>
#include <isobath/server/page_session.hpp>
#include <isobath/server/web_server.hpp>
#include <optional>
#include <tests/server/wire.hpp>
#include <thread>
#include <vector>

namespace isobath {
namespace {

using Clock = std::chrono::steady_clock;
constexpr int kSteps = 100, kTiles = 30, kTilesInAll = 2000;
constexpr std::size_t kEchoBytes = 128 * 1024, kTileBytes = 64 * 64 * 4;
constexpr auto kStep = std::chrono::milliseconds(100);

/// Writes as a run does; returns how long each set() took, in us, sorted.
std::vector<double> write_run(DisplayState& items, std::atomic<std::int64_t>& now) {
  std::vector<double> took;
  Random random(3);
  const auto set = [&](DisplayKind kind, std::uint64_t number, Time time, std::string payload) {
    const auto begun = Clock::now();
    items.set(kind, number, time, std::move(payload));
    took.push_back(std::chrono::duration<double, std::micro>(Clock::now() - begun).count());
  };
  auto due = Clock::now();
  for (int step = 0; step < kSteps; ++step) {
    const Time time{Duration(step * 100'000'000LL)};
    set(DisplayKind::kEchoes, 0, time, std::string(kEchoBytes, static_cast<char>(step)));
    set(DisplayKind::kVehicle, 0, time, std::string(80, static_cast<char>(step)));
    for (int tile = 0; tile < kTiles; ++tile) {
      const auto number = static_cast<std::uint64_t>(random.uniform(0, kTilesInAll));
      set(DisplayKind::kDepth, number, time, std::string(kTileBytes, static_cast<char>(step + tile)));
    }
    now = time.time_since_epoch().count();
    std::this_thread::sleep_until(due += kStep);
  }
  std::ranges::sort(took);
  return took;
}

void LivePages(benchmark::State& state) {
  for (auto _ : state) {
    DisplayState items;
    for (std::uint64_t i = 0; i < kTilesInAll; ++i) {
      items.set(DisplayKind::kDepth, i, Time{}, std::string(kTileBytes, static_cast<char>(i)));
    }
    std::atomic<std::int64_t> now = 0;
    PageSources sources;
    sources.live = std::make_shared<SharedChanges>(items);
    sources.live_span = [&] { return TimeSpan{Time{}, Time{Duration(now.load())}}; };
    WebServerConfig config;
    config.port = 0;
    WebSite site;
    site.sockets["/socket"].open = [&] { return std::make_unique<PageSession>(sources); };
    WebServer server(config, std::move(site));

    std::optional<test::SocketPage> stalled;
    std::vector<std::thread> readers;
    std::atomic<std::uint64_t> bytes = 0, frames = 0;
    if (state.range(0) > 0) stalled.emplace(server.port(), "", 4096);
    for (int i = 1; i < state.range(0); ++i) {
      readers.emplace_back([&] {
        test::SocketPage page(server.port());
        while (const auto message = page.next()) bytes += message->size(), ++frames;
      });
    }
    const std::vector<double> took = write_run(items, now);
    server.stop();
    for (std::thread& reader : readers) reader.join();

    const auto share = [&](double of) {
      return took[static_cast<std::size_t>(of * static_cast<double>(took.size() - 1))];
    };
    const double seconds = std::chrono::duration<double>(kSteps * kStep).count();
    state.counters["median_us"] = share(0.5);
    state.counters["p99_us"] = share(0.99);
    state.counters["worst_us"] = share(1);
    if (!readers.empty()) {
      const auto pages = static_cast<double>(readers.size());
      state.counters["MB_a_s_page"] = static_cast<double>(bytes) / 1e6 / seconds / pages;
      state.counters["frames_a_s_page"] = static_cast<double>(frames) / seconds / pages;
    }
    state.counters["encoded"] = static_cast<double>(sources.live->encoded());
    state.counters["longest_call_us"] = static_cast<double>(server.counts().longest_call_us);
  }
}
BENCHMARK(LivePages)->Arg(0)->Arg(4)->Unit(benchmark::kMillisecond)->Iterations(1)->Repetitions(3)->UseRealTime();

}  // namespace
}  // namespace isobath
