// What pages cost the run that they look at. A vehicle's log (512 x 500 pings at 10 Hz, scenarios/wide_fan.toml) goes
// through detection, maps, mission and display in real time, once with nobody looking and once with four pages on this
// machine, of which three read all and one reads nothing; in turns, so that the machine's moods do not decide.
//
//   live_run_bench [--rounds N] [--seconds S] [RECORDING]
//
// The log is recorded first, by a run of the scenario, and held in memory: no simulator runs beside what is measured. A
// ping's latency is from when its event is taken until set-point and display are done, by the real clock; that of
// mapping is without the agents, which have threads of their own aboard. The pings of the first kWarm_s fill tables and
// count for nothing. Pages read and count bytes, as a browser's network process does; they draw nothing.
#include <algorithm>
#include <chrono>
#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <isobath/base/error.hpp>
#include <isobath/display/display.hpp>
#include <isobath/onboard/mission_setup.hpp>
#include <isobath/onboard/onboard.hpp>
#include <isobath/run/mission_input.hpp>
#include <isobath/run/run.hpp>
#include <isobath/run/run_source.hpp>
#include <isobath/server/page_session.hpp>
#include <isobath/server/page_site.hpp>
#include <isobath/server/web_server.hpp>
#include <optional>
#include <tests/server/wire.hpp>
#include <thread>
#include <unistd.h>
#include <vector>

namespace isobath {
namespace {

using Clock = std::chrono::steady_clock;
constexpr double kWarm_s = 5;
constexpr int kReaders = 3;

double ms_since(Clock::time_point start) {
  return std::chrono::duration<double, std::milli>(Clock::now() - start).count();
}

/// A folder that is gone when it is over.
struct Scratch {
  Scratch() : path(std::filesystem::temp_directory_path() / fmt::format("isobath_live_run_{}", ::getpid())) {
    std::filesystem::create_directories(path);
  }
  Scratch(const Scratch&) = delete;
  Scratch& operator=(const Scratch&) = delete;
  ~Scratch() {
    std::error_code ignored;
    std::filesystem::remove_all(path, ignored);
  }
  std::filesystem::path path;
};

/// What a vehicle heard on its way.
struct Log {
  std::vector<Event> events;
  MissionSetup setup;
  std::optional<GeoOrigin> origin;
};

void record(const std::filesystem::path& recording, double seconds) {
  DisplayState items;
  RunRequest request;
  request.input = ISOBATH_SCENARIOS "/wide_fan.toml";
  request.out = recording.parent_path() / "run";
  request.record = recording;
  request.watch.emplace();
  request.watch->display = &items;
  request.watch->stopped = [&items, seconds] {
    const auto [first, last] = items.times();
    return to_seconds(last - first) > seconds;
  };
  run(request);
}

Log log_of(const std::filesystem::path& recording, const Configuration& configuration, double seconds) {
  Log log;
  const auto source = open_run_source(recording, configuration);
  while (auto event = source->next()) {
    if (!log.events.empty() && to_seconds(time_of(*event) - time_of(log.events.front())) > seconds) break;
    log.events.push_back(std::move(*event));
  }
  log.origin = source->report().origin;
  const auto setup = mission_setup(ISOBATH_SCENARIOS "/wide_fan.toml", nullptr, recording, nullptr);
  if (!setup || log.events.empty()) throw Error("holds nothing", {recording.string(), {}, {}, {}, {}});
  log.setup = *setup;
  return log;
}

/// One ping, ms.
struct Took {
  double all;
  double mapping;  ///< without agents: detection, grid, voxels, depths, display
  double display;
  double processor;  ///< of this thread, for all of it: what neighbours on the machine cannot lengthen by much
};

/// A helm, and how long it takes.
class TimedHelm : public Helm {
 public:
  explicit TimedHelm(std::unique_ptr<Helm> helm) : helm_(std::move(helm)) {}
  void on_event(const Event& event) override {
    timed([&] { helm_->on_event(event); });
  }
  void on_ping(const PosedPing& ping) override {
    timed([&] { helm_->on_ping(ping); });
  }
  void on_scan(const ScanResult& scan) override {
    timed([&] { helm_->on_scan(scan); });
  }
  void on_world(const WorldSnapshot& world) override {
    timed([&] { helm_->on_world(world); });
  }
  [[nodiscard]] Setpoint steer() override {
    Setpoint setpoint;
    timed([&] { setpoint = helm_->steer(); });
    return setpoint;
  }
  [[nodiscard]] MissionReport progress() const override { return helm_->progress(); }
  [[nodiscard]] const std::vector<Decision>& decisions() const override { return helm_->decisions(); }
  void show_messages_to(const Recorder& recorder) override { helm_->show_messages_to(recorder); }
  [[nodiscard]] double take_ms() { return std::exchange(ms_, 0); }

 private:
  template <class Work>
  void timed(const Work& work) {
    const auto begun = Clock::now();
    work();
    ms_ += ms_since(begun);
  }
  std::unique_ptr<Helm> helm_;
  double ms_ = 0;
};

/// All that is on board, as in a run; the display apart by its own clock.
class Vehicle : public OnboardObserver {
 public:
  Vehicle(const Log& log, const Configuration& configuration, DisplayState& items)
      : depths_(configuration, {}),
        times_(std::make_shared<StageTimes>()),
        helm_(make_serial_helm(log.setup, configuration, times_)),
        display_(items),
        onboard_(configuration, depths_, {.helm = &helm_, .times = times_}) {
    depths_.locate(log.origin);
    helm_.show_messages_to([this](const Envelope& envelope) { display_.on_message(envelope); });
    onboard_.show_to(*this);
    scene_.title = log.setup.plan.title;
    scene_.plan = log.setup.plan;
  }

  /// Says how long it took where a ping got into the map.
  std::optional<Took> take(const Event& heard) {
    Event event = heard;  // copied by whoever senses
    const Time time = time_of(event);
    const std::uint64_t mapped = onboard_.pipeline().counts().pings;
    display_ms_ = 0;
    const std::int64_t worked = thread_nanoseconds();
    const auto taken = Clock::now();
    onboard_.on_event(std::move(event));
    onboard_.steer();
    shown([&] {
      if (display_.wants_counts(time)) {
        display_.show(time, scene_);
        display_.show(time, onboard_.timings());
      }
      display_.look(time, onboard_.pipeline(), depths_, onboard_.voxels());
    });
    const double all_ms = ms_since(taken), agents_ms = helm_.take_ms();
    if (onboard_.pipeline().counts().pings == mapped) return std::nullopt;
    return Took{all_ms, all_ms - agents_ms, display_ms_, 1e-6 * static_cast<double>(thread_nanoseconds() - worked)};
  }

  void on_event(const Event& event) override {
    shown([&] { display_.on_event(event); });
  }
  void on_ping(const PosedPing& ping) override {
    shown([&] { display_.on_ping(ping); });
  }
  void on_scan(const ScanResult& scan) override {
    shown([&] { display_.on_scan(scan); });
  }
  void on_vertical_ping(const PosedPing& ping) override {
    shown([&] { display_.on_vertical_ping(ping); });
  }
  void on_jump(const Eigen::Vector3d& by_W) override {
    shown([&] { display_.on_jump(by_W); });
  }
  void on_setpoint(Time, const Setpoint& setpoint) override { display_.want(setpoint); }

 private:
  template <class Work>
  void shown(const Work& work) {
    const auto begun = Clock::now();
    work();
    display_ms_ += ms_since(begun);
  }

  DepthModel depths_;
  std::shared_ptr<StageTimes> times_;
  TimedHelm helm_;
  Display display_;
  Onboard onboard_;
  double display_ms_ = 0;
  DisplayScene scene_;
};

constexpr const char* kWantsVoxels = R"({"ask": "detail", "voxels": "all"})";

/// Shows the view in space: asks for all voxels, reads all that comes, and counts it.
class Reader {
 public:
  explicit Reader(int port)
      : page_(port), thread_([this] {
          page_.say(kWantsVoxels);
          while (const auto message = page_.next()) bytes_ += message->size();
        }) {}
  std::uint64_t bytes() {
    thread_.join();
    return bytes_;
  }

 private:
  test::SocketPage page_;
  std::uint64_t bytes_ = 0;
  std::thread thread_;
};

struct Round {
  std::vector<Took> pings;
  std::vector<double> bytes_a_second;  ///< of each reader
  double late_s = 0;                   ///< at the end: the machine does not keep up
};

Round sail(const Log& log, const Configuration& configuration, bool with_pages) {
  DisplayState items;
  PageSources sources;
  sources.live = std::make_shared<SharedChanges>(items);
  sources.live_span = [&items] {
    const auto [first, last] = items.times();
    return TimeSpan{first, last};
  };
  check_page_sources(sources);
  WebServerConfig server_config;
  server_config.port = 0;
  server_config.stalled_s = server_config.silent_s = 3600;  // who reads nothing stays to the end
  WebServer server(server_config, page_site(sources));
  std::optional<test::SocketPage> stalled;
  std::vector<std::unique_ptr<Reader>> readers;
  if (with_pages) {
    stalled.emplace(server.port(), "", 4096);
    stalled->say(kWantsVoxels);
    for (int i = 0; i < kReaders; ++i) readers.push_back(std::make_unique<Reader>(server.port()));
  }

  Vehicle vehicle(log, configuration, items);
  Round round;
  const Time first = time_of(log.events.front());
  const auto start = Clock::now();
  for (const Event& event : log.events) {
    const double since_s = to_seconds(time_of(event) - first);
    std::this_thread::sleep_until(start + std::chrono::duration<double>(since_s));
    const auto took = vehicle.take(event);
    if (took && since_s >= kWarm_s) round.pings.push_back(*took);
  }
  const double lasted_s = ms_since(start) / 1e3;
  if (with_pages && (!stalled->open() || server.counts().clients != 1 + kReaders)) throw Error("a page has hung up");
  round.late_s = lasted_s - to_seconds(time_of(log.events.back()) - first);
  server.stop();
  for (const auto& reader : readers) round.bytes_a_second.push_back(static_cast<double>(reader->bytes()) / lasted_s);
  return round;
}

struct Shares {
  double median, p99, worst;
};
Shares shares_of(const std::vector<Took>& pings, double Took::*part) {
  std::vector<double> ms;
  for (const Took& took : pings) ms.push_back(took.*part);
  if (ms.empty()) throw Error("no ping was mapped after the first seconds");
  std::ranges::sort(ms);
  const auto share = [&](std::size_t hundredths) { return ms[(ms.size() - 1) * hundredths / 100]; };
  return {share(50), share(99), ms.back()};
}

void print_row(const std::string& name, const Round& round) {
  std::string line = fmt::format("{:<24}{:>6}", name, round.pings.size());
  for (double Took::*part : {&Took::all, &Took::mapping, &Took::display, &Took::processor}) {
    const Shares s = shares_of(round.pings, part);
    line += fmt::format(" |{:>7.2f}{:>7.2f}{:>7.2f}", s.median, s.p99, s.worst);
  }
  line += " |";
  for (const double bytes : round.bytes_a_second) line += fmt::format("{:>6.2f}", bytes / 1e6);
  if (round.late_s > 0.5) line += fmt::format("  {:.1f} s late", round.late_s);
  fmt::print("{}\n", line);
  std::fflush(stdout);
}

void append(Round& all, const Round& round) {
  all.pings.insert(all.pings.end(), round.pings.begin(), round.pings.end());
  all.bytes_a_second.resize(round.bytes_a_second.size());
  for (std::size_t i = 0; i < all.bytes_a_second.size(); ++i) all.bytes_a_second[i] += round.bytes_a_second[i];
}

void measure(std::filesystem::path recording, double seconds, int rounds) {
  const Scratch scratch;
  if (recording.empty()) {
    recording = scratch.path / "wide_fan.mcap";
    fmt::print("recording {:.0f} s of wide_fan.toml ...\n", seconds + kWarm_s);
    std::fflush(stdout);
    record(recording, seconds + kWarm_s);
  }
  const Configuration configuration;
  const Log log = log_of(recording, configuration, seconds + kWarm_s);
  fmt::print("{:<24}{:>6} | {:<20} | {:<20} | {:<20} | {:<20} | MB/s of each page\n", "ms: median, 99 %, worst",
             "pings", "a ping in all", "of it mapping", "of that display", "processor time");
  Round alone, looked_at;
  const auto p99 = [](const Round& round, double Took::*part) { return shares_of(round.pings, part).p99; };
  std::vector<double> ratios;
  for (int i = 0; i < rounds; ++i) {
    Round of_round[2];
    for (const bool with_pages : {i % 2 != 0, i % 2 == 0}) {  // each goes first in turn
      Round& round = of_round[with_pages ? 1 : 0];
      round = sail(log, configuration, with_pages);
      print_row(with_pages ? "four pages, one stalled" : "nobody looks", round);
      append(with_pages ? looked_at : alone, round);
    }
    ratios.push_back(p99(of_round[1], &Took::mapping) / p99(of_round[0], &Took::mapping));
  }
  for (double& bytes : looked_at.bytes_a_second) bytes /= rounds;
  fmt::print("all rounds together\n");
  print_row("nobody looks", alone);
  print_row("four pages, one stalled", looked_at);
  const auto [least, most] = std::ranges::minmax(ratios);
  fmt::print(
      "99 % with pages to 99 % without: mapping {:.3f}, round by round {:.3f} to {:.3f}; a ping in all {:.3f}, "
      "processor time {:.3f}\n",
      p99(looked_at, &Took::mapping) / p99(alone, &Took::mapping), least, most,
      p99(looked_at, &Took::all) / p99(alone, &Took::all),
      p99(looked_at, &Took::processor) / p99(alone, &Took::processor));
}

}  // namespace
}  // namespace isobath

int main(int argc, char** argv) {
  try {
    CLI::App program{"What pages cost the run that they look at"};
    std::string recording;
    double seconds = 40;
    int rounds = 3;
    program.add_option("RECORDING", recording, "Default: one is made of wide_fan.toml");
    program.add_option("--seconds", seconds, "Of each round, with pages and without")->capture_default_str();
    program.add_option("--rounds", rounds, "In turns")->capture_default_str();
    CLI11_PARSE(program, argc, argv);
    isobath::measure(recording, seconds, rounds);
  } catch (const std::exception& error) {
    fmt::print(stderr, "{}\n", error.what());
    return 1;
  }
  return 0;
}
