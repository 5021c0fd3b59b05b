#include <chrono>
#include <fmt/format.h>
#include <isobath/app/commands.hpp>
#include <isobath/app/json_output.hpp>
#include <isobath/app/option_facts.hpp>
#include <isobath/app/progress.hpp>
#include <isobath/app/settings_json.hpp>
#include <isobath/app/speed.hpp>
#include <isobath/app/values.hpp>
#include <isobath/base/error.hpp>
#include <isobath/base/file_access.hpp>
#include <isobath/base/pending_file.hpp>
#include <isobath/base/printable_text.hpp>
#include <isobath/io/frames/pair_writer.hpp>
#include <isobath/io/mcap/native_log.hpp>
#include <isobath/report/scene_picture.hpp>
#include <isobath/scenario/scenario.hpp>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <thread>

namespace isobath::app {
namespace {

struct SimOptions {
  std::filesystem::path scene, out, picture, pairs;
  SimulationConfig simulation;
  int threads = 2;
  std::string speed = "max";
  bool format = false, json = false;
};

struct Counts {
  std::uint64_t pings = 0, ranges = 0, navigation = 0, health = 0, bearings = 0, pairs = 0;
};

using Clock = std::chrono::steady_clock;  // for pace and timings only; no result depends on it

void write(const SimulatedEvent& event, NativeLogWriter* log, PairFolderWriter* pairs, Counts& n,
           std::vector<Eigen::Vector2d>& track) {
  if (const auto* motion = std::get_if<TrueMotion>(&event)) {
    track.emplace_back(motion->state.X_WB.translation.head<2>());
    if (log) log->write(*motion);
  } else if (const auto* echoes = std::get_if<EchoTruth>(&event)) {
    if (log) log->write(*echoes);
  } else if (const auto* ping = std::get_if<Ping>(&event)) {
    ++n.pings;
    if (log) log->write(*ping);
  } else if (const auto* reading = std::get_if<RangeReading>(&event)) {
    ++n.ranges;
    if (log) log->write(*reading);
  } else if (const auto* fix = std::get_if<Navigation>(&event)) {
    ++n.navigation;
    if (log) log->write(*fix);
    if (pairs) pairs->write(*fix);
  } else if (const auto* health = std::get_if<Health>(&event)) {
    ++n.health;
    if (log) log->write(*health);
  } else if (const auto* heard = std::get_if<PassiveBearing>(&event)) {
    ++n.bearings;
    if (log) log->write(*heard);
  } else if (const auto* pair = std::get_if<CameraPair>(&event)) {
    ++n.pairs;
    if (pairs && pair->rig == 0) pairs->write(*pair);
  }
}

/// The folder for the pairs of the first cameras of the scene.
std::unique_ptr<PairFolderWriter> open_pairs(const SimOptions& options, const Scene& scene) {
  if (options.pairs.empty()) return nullptr;
  if (scene.cameras.empty() || !scene.cameras.front().on)
    throw Error("the scene has no cameras", {.file = scene.file}, "a [[camera]]", "--pairs writes what they see");
  check_output_folder(options.pairs, "--pairs");
  const CameraPairConfig& camera = scene.cameras.front();
  PairRig rig;
  rig.position = camera.position;
  rig.heading = camera.heading;
  rig.pitch = camera.pitch;
  rig.roll = camera.roll;
  return std::make_unique<PairFolderWriter>(options.pairs, std::move(rig), text_of_file(camera.calibration));
}

/// Opens the log and attaches the scene file to it.
std::unique_ptr<NativeLogWriter> open_log(const SimOptions& options, const Simulator& simulator,
                                          std::optional<PendingFile>& pending) {
  if (options.out.empty()) return nullptr;
  if (options.out.extension() != ".mcap") {
    throw Error("cannot write this kind of file", {options.out.string()}, "a name that ends in .mcap");
  }
  make_parent(options.out);
  auto log = std::make_unique<NativeLogWriter>(pending.emplace(options.out).beside());
  log->set_details({{"scene", simulator.scene().about.title}, {"seed", fmt::format("{}", simulator.seed())}});
  if (const auto origin = simulator.scene().origin()) log->set_origin(*origin);
  log->attach("scene.toml", "application/toml",
              options.scene.empty() ? std::string(embedded_scene()) : text_of_file(options.scene.string()));
  return log;
}

int act(const SimOptions& options) {
  if (options.format) {
    Scene scene;
    if (options.json) {
      print_json(settings_json(schema(scene), false));
    } else {
      fmt::print("{}", write_template(schema(scene)));
    }
    return kSuccess;
  }
  const double pace = speed_of(options.speed);
  Simulator simulator(open_scene(options.scene), options.simulation, options.threads);
  std::optional<PendingFile> pending;  // of the log
  const auto log = open_log(options, simulator, pending);
  const auto pairs = open_pairs(options, simulator.scene());
  Counts n;
  std::vector<Eigen::Vector2d> track;
  ProgressLine progress;
  const auto start = Clock::now();
  while (const auto event = simulator.next()) {
    if (pace > 0) std::this_thread::sleep_until(start + std::chrono::duration<double>(simulator.now_s() / pace));
    write(*event, log.get(), pairs.get(), n, track);
    progress.show(static_cast<std::uint64_t>(simulator.now_s() * 1000),
                  static_cast<std::uint64_t>(simulator.duration_s() * 1000), n.pings);
  }
  if (log) {
    log->close();
    pending->complete();
  }
  if (pairs) pairs->close();
  progress.clear();
  if (!options.picture.empty()) {
    make_parent(options.picture);
    write_whole_file(options.picture, scene_picture(simulator, track));
  }
  const double wall = std::chrono::duration<double>(Clock::now() - start).count();
  const double times = wall > 0 ? simulator.duration_s() / wall : 0;
  if (options.json) {
    nlohmann::ordered_json json{{"scene", simulator.scene().about.title},
                                {"seed", simulator.seed()},
                                {"duration_s", simulator.duration_s()},
                                {"counts",
                                 {{"pings", n.pings},
                                  {"ranges", n.ranges},
                                  {"navigation", n.navigation},
                                  {"health", n.health},
                                  {"bearings", n.bearings},
                                  {"pairs", n.pairs}}},
                                {"rates", {{"wall_s", wall}, {"times_real_time", times}}}};
    std::vector<std::filesystem::path> files;
    if (log) files.push_back(options.out);
    if (pairs) files.push_back(options.pairs);
    if (!options.picture.empty()) files.push_back(options.picture);
    add_files(json, "", files);
    print_json(json);
    return kSuccess;
  }
  fmt::print("{}, seed {}: {} pings, {} ranges, {} fixes in {:g} s; {:.1f} s of work ({:.1f} x real time)\n",
             printable_text(simulator.scene().about.title), simulator.seed(), n.pings, n.ranges, n.navigation,
             simulator.duration_s(), wall, times);
  if (log) fmt::print("written to {}; isobath run {} replays it\n", options.out.string(), options.out.string());
  if (pairs) {
    fmt::print("{} pairs of pictures written to {}; isobath run {} maps what they show\n", pairs->pairs(),
               options.pairs.string(), options.pairs.string());
  }
  return kSuccess;
}

}  // namespace

Action add_sim(CLI::App& program) {
  auto options = std::make_shared<SimOptions>();
  CLI::App* command =
      program.add_subcommand("sim", "Simulate a scene; write the log of the vehicle in it, with the ground truth");
  command->add_option("SCENARIO", options->scene, "Scene (.toml)")->check(reads())->default_str("the embedded scene");
  command->add_option("--out", options->out, "Log to write (.mcap)")
      ->type_name("FILE")
      ->check(writes_file())
      ->default_str("none")
      ->group("Output");
  command->add_option("--pairs", options->pairs, "Folder for the pictures of the scene's cameras, as an input of run")
      ->type_name("FOLDER")
      ->default_str("none")
      ->group("Output");
  command->add_option("--picture", options->picture, "Picture of the scene from above with the vehicle's track (.png)")
      ->type_name("FILE")
      ->check(writes_file())
      ->default_str("none")
      ->group("Output");
  add_json_flag(*command, options->json);
  command->add_flag("--format", options->format, "Print every key of a scene with its default, range and unit")
      ->group("Output");
  command->add_option("--seed", options->simulation.seed, "Seed of every random number")
      ->check(whole(0, 2147483647))
      ->default_str("the scene's")
      ->group("Simulation");
  command->add_option("--duration", options->simulation.duration_s, "Time to simulate, s")
      ->check(number(0.1, 1e6))
      ->default_str("the scene's")
      ->group("Simulation");
  command->add_option("--speed", options->speed, "A multiple of real time, or max")
      ->type_name("FACTOR")
      ->check(speed())
      ->capture_default_str()
      ->group("Simulation");
  command->add_option("--threads", options->threads, "Number of threads; the results are the same")
      ->check(whole(1, 64))
      ->capture_default_str()
      ->group("Simulation");
  add_example(*command, "sim scenarios/bridge.toml --out bridge.mcap --seed 2");
  add_example(*command, "sim --duration 60 --picture scene.png");
  add_example(*command, "sim scenarios/cameras/survey_by_cameras.toml --pairs out/pairs");
  add_example(*command, "sim --format > keys.toml");
  return [options] { return act(*options); };
}

}  // namespace isobath::app
