#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <isobath/base/file_access.hpp>
#include <isobath/base/nearest_name.hpp>
#include <isobath/base/pending_file.hpp>
#include <isobath/base/random.hpp>
#include <isobath/evaluation/evaluation_suite.hpp>
#include <isobath/report/html_report.hpp>
#include <isobath/scenario/embedded_files.hpp>
#include <numbers>

namespace isobath {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kFolder = "suites/", kEnding = ".toml";

std::vector<Field> about_fields(SuiteConfig& c, AltimeterChoice& altimeter) {
  return {
      Field::text("title", &c.title, "Title of the suite."),
      Field::text("text", &c.text, "What the suite shows."),
      Field::file("scene", &c.scene, "The scene, with its mission, of all runs."),
      Field::file("faults", &c.faults,
                  "Instead of a scene: a folder with one scene for each row of the fault table, named like it."),
      Field::choice("altimeter", &altimeter,
                    {{"scene", AltimeterChoice::kAsScene},
                     {"with", AltimeterChoice::kWith},
                     {"without", AltimeterChoice::kWithout},
                     {"both", AltimeterChoice::kBoth}},
                    "Whether the vehicle has an altimeter; scene: as in the scene, both: in turn."),
      Field::text("without", &c.without, "Name of a sonar of the scene that is switched off; empty: none."),
      Field::integer("runs", &c.runs, {1, 1'000'000}, "", "Number of runs; the command line can override it."),
      Field::integer("seed", &c.seed, {0, 1'000'000'000}, "",
                     "Seed of the first run; each further run has the next number."),
      Field::real("duration_s", &c.duration_s, {0, 1e5}, "s",
                  "Maximum duration of a run; 0: the duration of its scene."),
      Field::real("goal_m", &c.goal_m, {0.1, 1000}, "m",
                  "True distance at which the last mission point counts as reached."),
      Field::real("near_body_m", &c.near_body_m, {0, 1000}, "m",
                  "A replan for an obstacle farther than this from every body counts as false."),
      Field::real("clearance_m", &c.clearance_m, {0, 100}, "m", "Clearance of the planner with full truth."),
      Field::real("planner_cell_m", &c.planner_cell_m, {0.1, 10}, "m", "Cell size of the planner with full truth.")};
}

std::vector<Field> vary_fields(VariationConfig& c) {
  std::vector<Field> all = {
      Field::numbers("start", c.start.data(), 2, {0, 1000}, "m", "Half width of the start, north and east."),
      Field::degrees("heading_deg", &c.heading, {0, 180}, "Half width of the heading at the start."),
      Field::real("current", &c.current, {0, 2}, "m/s",
                  "Maximum speed of the current, in any direction. In suites of faults it is added to the current "
                  "of the scene, else it replaces it."),
      Field::numbers("drift", c.drift.data(), 2, {0, 0.5}, "1",
                     "Minimum and maximum drift of the navigation, as a share of the distance travelled; needs "
                     "navigation.kind drift."),
      Field::numbers("noise", c.noise.data(), 2, {0, 10}, "1",
                     "Minimum and maximum factor on the noise of the sonars."),
      Field::numbers("density", c.density.data(), 2, {0, 10}, "1",
                     "Minimum and maximum factor on the density of the clutter."),
      Field::numbers("lost_s", c.lost_s.data(), 2, {0, 1e5}, "s",
                     "Minimum and maximum time at which a group with loses_vehicle loses one.")};
  const auto add = [&all](const std::string& name, PlantVariation& v, const std::string& of) {
    all.push_back(Field::numbers(name + "_mass", v.mass.data(), 2, {0.1, 10}, "1",
                                 "Minimum and maximum factor on the mass of " + of));
    all.push_back(Field::numbers(name + "_drag", v.drag.data(), 2, {0, 10}, "1",
                                 "Minimum and maximum factor on the drag of " + of));
    all.push_back(Field::real(name + "_buoyancy", &v.buoyancy, {0, 1e5}, "N", "Half width of the buoyancy of " + of));
  };
  add("plant", c.plant, "a dynamic vehicle, which its control does not know.");
  add("control", c.control_model, "a dynamic vehicle as its control takes it.");
  return all;
}

std::vector<Field> bar_fields(BarsConfig& c) {
  return {
      Field::integer("collisions", &c.collisions, {-1, 1'000'000}, "", "Maximum number of collisions; -1: no bar."),
      Field::real("goals_share", &c.goals_share, {-1, 1}, "1",
                  "Minimum share of the runs that reach the goal; -1: no bar."),
      Field::real("refused_share", &c.refused_share, {-1, 1}, "1",
                  "Maximum share of the runs that are refused; -1: no bar."),
      Field::real("path_ratio_median", &c.path_ratio_median, {-1, 100}, "1",
                  "Maximum median ratio of the path length to that of the planner with full truth; -1: no bar."),
      Field::real("false_obstacles_20m", &c.false_obstacles_20m, {-1, 1000}, "",
                  "Maximum mean number of false obstacles within 20 m of the vehicle, per scan; -1: no bar."),
      Field::real("shown_share", &c.shown_share, {-1, 1}, "1",
                  "Minimum share of the fault runs that show what the fault table states; -1: no bar."),
      Field::real("story_share", &c.story_share, {-1, 1}, "1",
                  "Minimum share of the runs that show the whole story; -1: no bar."),
      Field::real("searched_share", &c.searched_share, {-1, 1}, "1",
                  "Minimum share of the area that a group searches, in every run; -1: no bar."),
      Field::real(
          "overlap_share", &c.overlap_share, {-1, 1}, "1",
          "Maximum share of the area that two or more vehicles search, in every run that loses none; -1: no bar."),
      Field::real("separation_m", &c.separation_m, {-1, 1000}, "m",
                  "Minimum distance between the hulls of two vehicles, in every run; -1: no bar."),
      Field::real("passage_shared_s", &c.passage_shared_s, {-1, 1e6}, "s",
                  "Maximum time that two vehicles are within one passage, in every run; -1: no bar."),
      Field::real("bit_rate", &c.bit_rate, {-1, 1e6}, "bit/s",
                  "Maximum rate that one vehicle of a group sends, in every run; -1: no bar."),
  };
}

std::vector<std::pair<std::string, Baseline>> baseline_names() {
  std::vector<std::pair<std::string, Baseline>> names;
  for (const Baseline b :
       {Baseline::kNoAvoidance, Baseline::kPotentialField, Baseline::kImageThreshold, Baseline::kHistogramThreshold,
        Baseline::kVelocityObstacles, Baseline::kStopAndWait, Baseline::kAsPrinted, Baseline::kWorldFixedGrid}) {
    names.emplace_back(to_text(b), b);
  }
  return names;
}

void check_suite(Suite& s, const std::string& file) {
  const auto refuse = [&file](const std::string& key, const std::string& problem, const std::string& allowed) {
    throw Error(problem, {.file = file, .key = key}, allowed);
  };
  const auto ordered = [&](const std::string& key, const Eigen::Vector2d& range) {
    if (range[0] > range[1]) refuse(key, "the first number is above the second", "minimum, maximum");
  };
  if (s.about.scene.empty() == s.about.faults.empty()) {
    refuse("suite.scene", s.about.scene.empty() ? "is missing" : "cannot be combined with faults",
           "a scene file, or faults");
  }
  if (!s.about.faults.empty() && !s.axes.empty()) {
    refuse("suite.faults", "cannot be combined with vehicles, sonars or an altimeter", "a scene instead of faults");
  }
  for (const StoryStage& stage : s.stages) {
    const bool names_point = stage.what == StageKind::kPlanned || stage.what == StageKind::kDropped;
    if (names_point && stage.point.empty())
      refuse("stage.point", "is missing in stage " + stage.name, "a mission point");
  }
  s.variants = variants_of(s.axes);
  ordered("vary.lost_s", s.vary.lost_s);
  ordered("vary.plant_mass", s.vary.plant.mass);
  ordered("vary.plant_drag", s.vary.plant.drag);
  ordered("vary.control_mass", s.vary.control_model.mass);
  ordered("vary.control_drag", s.vary.control_model.drag);
  ordered("vary.drift", s.vary.drift);
  ordered("vary.noise", s.vary.noise);
  ordered("vary.density", s.vary.density);
  ordered("encounters.meeting_s", s.encounters.meeting_s);
  ordered("replay.meeting_s", s.replay.meeting_s);
  for (std::size_t i = 0; i < s.baselines.size(); ++i) {
    if (std::count(s.baselines.begin(), s.baselines.end(), s.baselines[i]) > 1) {
      refuse("baseline.helm", fmt::format("{} is listed twice", to_text(s.baselines[i])), "each once");
    }
  }
}

/// What a suite of groups has not.
void check_group(const Suite& suite, const Scenario& scenario, const std::string& file) {
  const auto refuse = [&file](const char* key, const char* problem, const char* allowed) {
    throw Error(problem, {.file = file, .key = key}, allowed);
  };
  if (scenario.scene.group.empty()) {
    if (!suite.axes.groups.empty()) refuse("group", "the scene has one vehicle", "a scene with [[group_vehicle]]");
    return;
  }
  if (!suite.baselines.empty()) refuse("baseline.helm", "no baseline steers a group", "a [[group]] of one vehicle");
  if (!suite.stages.empty()) refuse("stage", "a group has no story", "a scene with one vehicle");
  if (suite.encounters.on) refuse("encounters.on", "a group meets no encounters", "a scene with one vehicle");
  if (suite.replay.on) refuse("replay.on", "a group meets no replayed traffic", "a scene with one vehicle");
}

/// FNV-1a, 64 bits.
std::uint64_t digest_of(std::uint64_t before, std::string_view text) {
  for (const char c : text) before = (before ^ static_cast<unsigned char>(c)) * 0x100000001b3u;
  return before;
}

std::vector<std::string> scenes_of(const SuiteConfig& about) {
  if (about.faults.empty()) return {about.scene};
  std::vector<std::string> files;
  for (const FaultRow& row : fault_table()) {
    files.push_back((fs::path(about.faults) / (file_name_of(row) + std::string(kEnding))).string());
  }
  return files;
}

MissionPlan mission_along(const Scene& scene) {
  MissionPlan plan;
  plan.title = scene.about.title;
  plan.speed = scene.vehicle.speed;
  for (const WaypointConfig& w : scene.waypoints) {
    MissionPoint& point = plan.points.emplace_back();
    point.name = fmt::format("point {}", plan.points.size());
    point.north_east = {w.north, w.east};
    point.depth_m = w.depth;
    point.speed = w.speed;
  }
  plan.origin = scene.origin();
  return plan;
}

void draw_current(Random random, const VariationConfig& vary, SuiteRun& run) {
  if (vary.current <= 0) return;
  std::vector<double>& current = run.scenario.scene.water.current;  // rows of depth, north, east
  const double speed = random.uniform(0, vary.current);
  const double towards = random.uniform(0, 2 * std::numbers::pi);
  if (!run.row || current.empty()) current = {0, 0, 0};
  for (std::size_t i = 0; i + 2 < current.size(); i += 3) {
    current[i + 1] += speed * std::cos(towards);
    current[i + 2] += speed * std::sin(towards);
  }
  run.conditions += fmt::format("; current {:.2f} m/s towards {:.0f} deg", speed, towards * 180 / std::numbers::pi);
}

void draw_start(Random random, const VariationConfig& vary, SuiteRun& run) {
  const auto move = [&](Eigen::Vector3d& start, Angle& heading) {
    const double north = random.uniform(-1, 1);
    const double east = random.uniform(-1, 1);
    const double turn = random.uniform(-1, 1);
    start += Eigen::Vector3d(north * vary.start.x(), east * vary.start.y(), 0);
    heading = (heading + vary.heading * turn).wrapped();
  };
  VehicleConfig& vehicle = run.scenario.scene.vehicle;
  move(vehicle.start, vehicle.heading);
  for (GroupVehicle& other : run.scenario.scene.group) move(other.start, other.heading);
  run.conditions += fmt::format("start at north {:.1f} m, east {:.1f} m, heading {:.0f} deg", vehicle.start.x(),
                                vehicle.start.y(), vehicle.heading.wrapped_positive().degrees());
}

void draw_loss_of_vehicle(Random random, const VariationConfig& vary, SuiteRun& run) {
  Scene& scene = run.scenario.scene;
  const auto which = std::min(
      static_cast<std::size_t>(random.uniform(0, 1) * static_cast<double>(scene.group.size() + 1)), scene.group.size());
  const double at_s = random.uniform(vary.lost_s[0], vary.lost_s[1]);
  (which == 0 ? scene.vehicle.lost_s : scene.group[which - 1].lost_s) = at_s;
  run.conditions +=
      fmt::format("; {} is lost after {:.0f} s", which == 0 ? scene.vehicle.name : scene.group[which - 1].name, at_s);
}

void draw_difference(Random random, const PlantVariation& vary, const char* of, PlantDifference& difference,
                     SuiteRun& run) {
  if (vary == PlantVariation{}) return;
  difference.mass *= random.uniform(vary.mass[0], vary.mass[1]);
  difference.drag *= random.uniform(vary.drag[0], vary.drag[1]);
  difference.buoyancy += vary.buoyancy * random.uniform(-1, 1);
  run.conditions += fmt::format("; {}: mass x {:.2f}, drag x {:.2f}, buoyancy {:+.1f} N", of, difference.mass,
                                difference.drag, difference.buoyancy);
}

/// From its start straight to the first mission point.
EncounteredVehicle straight_vehicle(const Scenario& scenario) {
  const MissionPoint& point = scenario.mission.points.front();
  EncounteredVehicle vehicle;
  vehicle.start_W = scenario.scene.vehicle.start.head<2>();
  const Eigen::Vector2d to_point = point.north_east - vehicle.start_W;
  vehicle.course = Angle::radians(std::atan2(to_point.y(), to_point.x()));
  vehicle.speed = point.speed > 0 ? point.speed : scenario.mission.speed;
  return vehicle;
}

void add_traffic(const Suite& suite, std::uint64_t seed, SuiteRun& run) {
  Scene& scene = run.scenario.scene;
  if (!suite.recording) throw Error("the suite replays traffic, and no recording was read", {.key = "replay.file"});
  ReplayedTraffic traffic =
      replayed_traffic(suite.replay, *suite.recording, straight_vehicle(run.scenario), seed, scene.about.duration_s);
  run.conditions += fmt::format("; {} ships; meets {} after {:.0f} s", traffic.bodies.size(),
                                traffic.bodies.front().name, traffic.meeting_s);
  std::move(traffic.bodies.begin(), traffic.bodies.end(), std::back_inserter(scene.bodies));
}

void add_encounters(const EncounterConfig& config, std::uint64_t seed, SuiteRun& run) {
  Scene& scene = run.scenario.scene;
  const std::vector<EncounterSituation>& all = encounter_situations();
  const EncounterSituation& situation = all[run.seed % all.size()];
  run.conditions += "; encounters: " + to_text(situation);
  std::vector<Body> bodies =
      encounter_bodies(config, situation, straight_vehicle(run.scenario), seed, scene.about.duration_s);
  std::move(bodies.begin(), bodies.end(), std::back_inserter(scene.bodies));
  run.encounters = situation;
}

}  // namespace

const char* to_text(Baseline baseline) {
  switch (baseline) {
    case Baseline::kNoAvoidance: return "no avoidance";
    case Baseline::kPotentialField: return "potential field";
    case Baseline::kImageThreshold: return "image threshold";
    case Baseline::kHistogramThreshold: return "histogram threshold";
    case Baseline::kVelocityObstacles: return "velocity obstacles";
    case Baseline::kStopAndWait: return "stop and wait";
    case Baseline::kAsPrinted: return "as printed";
    case Baseline::kWorldFixedGrid: return "world-fixed grid";
  }
  return "";
}

Schema schema(Suite& s) {
  Schema all;
  all.sections = {{"suite", "The runs of the suite.", about_fields(s.about, s.axes.altimeter)},
                  {"vary", "What varies from run to run.", vary_fields(s.vary)},
                  {"clutter", "A random field of obstacles, added to the scene.", fields(s.clutter)},
                  {"encounters", "Bodies that meet the vehicle, added to the scene.", fields(s.encounters)},
                  {"replay", "Recorded ships that meet the vehicle, added to the scene.", fields(s.replay)},
                  {"bars", "The bars that the runs must meet.", bar_fields(s.bars)}};
  all.lists = {
      {"baseline", "A method to compare with, on the same runs.",
       [&s](const Place&) {
         Baseline& helm = s.baselines.emplace_back(Baseline::kNoAvoidance);
         return std::vector<Field>{Field::choice("helm", &helm, baseline_names(), "Name of the method.")};
       }},
      {"stage", "A stage of the story that each run must show; stages follow each other.",
       [&s](const Place& place) {
         StoryStage& stage = s.stages.emplace_back();
         stage.place = place;
         return fields(stage);
       }},
      {"vehicle", "A vehicle that replaces that of the scene; the runs take the vehicles in turn.",
       [&s](const Place& place) {
         SuiteVehicle& vehicle = s.axes.vehicles.emplace_back();
         vehicle.place = place;
         return fields(vehicle);
       }},
      {"group", "Vehicles of a scene with a group; the runs take the groups in turn.",
       [&s](const Place& place) {
         SuiteGroup& group = s.axes.groups.emplace_back();
         group.place = place;
         return fields(group);
       }},
      {"sonar", "An imaging sonar instead of those of the scene; runs take them in turn.", [&s](const Place& place) {
         SonarConfig& sonar = s.axes.sonars.emplace_back();
         sonar.place = place;
         return fields(sonar);
       }}};
  return all;
}

Suite load_suite(const fs::path& file) {
  Suite suite;
  suite.name = file.stem().string();
  Schema all = schema(suite);
  const std::string text = text_of_file(file.string());
  read_toml(text, file.string(), all);
  check_suite(suite, file.string());
  suite.scenes = scenes_of(suite.about);
  suite.digest = digest_of(0xcbf29ce484222325u, text);
  for (const std::string& scene : suite.scenes) {
    suite.digest = digest_of(suite.digest, text_of_file(scene));
    const Scenario scenario = load_scenario(scene);
    check_group(suite, scenario, file.string());
    const std::string& vehicle = scenario.scene.vehicle.file;
    if (!vehicle.empty()) suite.digest = digest_of(suite.digest, text_of_file(vehicle));
  }
  for (const SuiteVehicle& vehicle : suite.axes.vehicles) {
    suite.digest = digest_of(suite.digest, text_of_file(vehicle.file));
  }
  return suite;
}

void load_recording(Suite& suite, const fs::path& file) {
  if (!suite.replay.on) {
    if (!file.empty()) throw Error(fmt::format("the suite {} replays no recording of ships", suite.name));
    return;
  }
  const fs::path from = file.empty() ? fs::path(suite.replay.file) : file;
  if (from.empty()) {
    throw Error(fmt::format("the suite {} replays a recording of ships, and none is given", suite.name), {}, {},
                "give a table of AIS reports: --replay FILE");
  }
  suite.recording = read_recording(from);
  suite.replay.file = from.string();
  suite.digest = digest_of(suite.digest, fmt::format("{:016x}", suite.recording->digest()));
}

void select_variants(Suite& suite, const std::string& name) {
  suite.variants = matching(suite.variants, name);
  for (const SuiteVariant& variant : suite.variants) suite.digest = digest_of(suite.digest, variant.name);
}

std::vector<Scenario> load_scenes(const Suite& suite) {
  std::vector<Scenario> scenes;
  for (const std::string& file : suite.scenes) scenes.push_back(load_scenario(file));
  return scenes;
}

std::vector<std::string> embedded_suites() {
  std::vector<std::string> names;
  for (const EmbeddedFile& file : embedded_files()) {
    if (!file.name.starts_with(kFolder)) continue;
    names.emplace_back(file.name.substr(kFolder.size(), file.name.size() - kFolder.size() - kEnding.size()));
  }
  std::sort(names.begin(), names.end());
  return names;
}

fs::path find_suite(const std::string& name_or_file, const fs::path& folder) {
  const std::vector<std::string> names = embedded_suites();
  if (std::find(names.begin(), names.end(), name_or_file) == names.end()) {
    if (fs::is_regular_file(name_or_file)) return name_or_file;
    const std::string near = did_you_mean(name_or_file, names);
    throw Error("no such suite: " + name_or_file, {}, fmt::format("a file, or one of {}", fmt::join(names, ", ")),
                near.empty() ? nearest_file(name_or_file) : near);
  }
  for (const EmbeddedFile& file : embedded_files()) {
    const fs::path to = folder / file.name;
    make_folder(to.parent_path());
    write_whole_file(to, file.text);
  }
  return folder / (std::string(kFolder) + name_or_file + std::string(kEnding));
}

SuiteRun make_run(const Suite& suite, std::span<const Scenario> scenes, std::uint64_t seed) {
  const std::size_t which = seed % scenes.size();
  SuiteRun run;
  run.seed = seed;
  run.scenario = scenes[which];
  if (!suite.about.faults.empty()) {
    run.row = &fault_table()[which];
    run.conditions = std::string(run.row->name) + "; ";
  }
  bool loses_vehicle = false;
  if (!suite.variants.empty()) {
    const SuiteVariant& variant = suite.variants[seed % suite.variants.size()];
    apply(variant, run.scenario);
    run.variant = variant.name;
    loses_vehicle = variant.group && variant.group->loses_vehicle;
  }
  Scene& scene = run.scenario.scene;
  scene.about.seed = static_cast<int>(seed);
  if (suite.about.duration_s > 0) scene.about.duration_s = suite.about.duration_s;
  Random random(seed);
  draw_start(random.fork(), suite.vary, run);
  draw_current(random.fork(), suite.vary, run);
  Random drift = random.fork();
  Random noise = random.fork();
  Random density = random.fork();
  const std::uint64_t field_seed = random.bits(), encounter_seed = random.bits(), replay_seed = random.bits();
  if (suite.vary.drift[1] > 0) {
    scene.navigator.drift_share = drift.uniform(suite.vary.drift[0], suite.vary.drift[1]);
    run.conditions += fmt::format("; drift {:.2f} %", 100 * scene.navigator.drift_share);
  }
  if (!suite.about.without.empty()) switch_off(scene, suite.about.without);
  const double factor = noise.uniform(suite.vary.noise[0], suite.vary.noise[1]);
  for (SonarConfig& sonar : scene.sonars) {
    sonar.noise_level *= factor;
    sonar.noise_sigma *= factor;
  }
  run.conditions += fmt::format("; noise x {:.2f}", factor);
  if (suite.clutter.density > 0 || suite.clutter.moving > 0) {
    ClutterConfig clutter = suite.clutter;
    clutter.density *= density.uniform(suite.vary.density[0], suite.vary.density[1]);
    ClutterField field = clutter_field(clutter, field_seed, scene.about.duration_s);
    run.conditions += fmt::format("; {} bodies", field.bodies.size());
    std::move(field.bodies.begin(), field.bodies.end(), std::back_inserter(scene.bodies));
  }
  if (run.scenario.mission.points.empty()) run.scenario.mission = mission_along(scene);
  if (run.scenario.mission.points.empty()) {
    throw Error("the scene has neither mission points nor way-points", {.file = scene.file}, "at least one");
  }
  if (suite.replay.on) add_traffic(suite, replay_seed, run);
  if (suite.encounters.on) add_encounters(suite.encounters, encounter_seed, run);
  if (loses_vehicle) draw_loss_of_vehicle(random.fork(), suite.vary, run);
  draw_difference(random.fork(), suite.vary.plant, "plant", run.scenario.scene.plant, run);
  draw_difference(random.fork(), suite.vary.control_model, "model of the control", run.scenario.scene.control_model,
                  run);
  return run;
}

}  // namespace isobath
