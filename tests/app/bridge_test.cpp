// The two fans before the bridge as a user sets them up: their images, their disturbances, their models, their places.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <Eigen/Core>
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <isobath/sonar/histogram_model.hpp>
#include <numbers>
#include <tests/app/program.hpp>
#include <tests/support/data.hpp>

namespace isobath {
namespace {

using nlohmann::json;
using test::isobath_run;
using testing::HasSubstr;
namespace fs = std::filesystem;

/// Puts `what` after each `mark`.
std::string put_after(std::string text, const std::string& mark, const std::string& what) {
  std::size_t places = 0;
  for (std::size_t at = text.find(mark); at != std::string::npos; at = text.find(mark, at + mark.size())) {
    at += mark.size();
    text.insert(at, what);
    ++places;
  }
  EXPECT_GT(places, 0u) << mark;
  return text;
}

std::string without(std::string text, const std::string& what) {
  const std::size_t at = text.find(what);
  EXPECT_NE(at, std::string::npos) << what;
  return at == std::string::npos ? text : text.erase(at, what.size());
}

class BridgeRuns : public testing::Test {
 protected:
  BridgeRuns() {
    for (const char* name : {"vehicles", "scenarios"}) fs::create_directories(folder_ / name);
    fs::copy_file(test::source_folder() / "vehicles/remus100.toml", folder_ / "vehicles/remus100.toml",
                  fs::copy_options::overwrite_existing);
  }
  fs::path scene(const std::string& name, const std::string& text) {
    return test::write(folder_ / "scenarios" / (name + ".toml"), text);
  }
  /// What a run of so many seconds prints.
  json run(const fs::path& scene, int seconds, std::vector<std::string> more = {}) {
    more.insert(more.end(), {"--set", "simulation.duration_s=" + std::to_string(seconds)});
    const test::ProgramResult result = isobath_run(scene, folder_ / scene.stem(), more);
    EXPECT_EQ(result.exit_code, 0) << result.err;
    return json::parse(result.out, nullptr, false);
  }

  fs::path folder_ = test::scratch_folder();
  std::string bridge_ = test::scene_text("bridge");
};

// Five images a second of each plane, in voxels of half a metre: none is left out, and the run states what each stage
// of the work cost. That it keeps up on one core is the benchmark's to say (bench/voxel_bench.cpp). ledger: S5-60
TEST_F(BridgeRuns, MapFiveImagesASecondOfEachPlaneInHalfMetres) {
  const json run_of = run(scene("five", put_after(bridge_, "sound_speed = 1467.6\n", "interval_s = 0.2\n")), 4);
  EXPECT_EQ(run_of["voxels"]["voxel_m"], 0.5);
  ASSERT_EQ(run_of["voxels"]["layers"].size(), 2u);
  for (const json& layer : run_of["voxels"]["layers"]) EXPECT_EQ(layer["pings"], 4 * 5 + 1) << layer;
  EXPECT_TRUE(run_of["rejected"].empty());
  for (const char* stage : {"echoes", "plan view", "voxels", "obstacles", "planning and agents", "input"}) {
    ASSERT_TRUE(run_of["rates"]["stages_s"].contains(stage)) << stage;
    EXPECT_GT(run_of["rates"]["stages_s"][stage], 0) << stage;
  }
}

// Balls at 40 m in open water, round the horizontal fan and above and below it: the run hears those within 45 degrees
// to either side and 7.5 degrees of the plane, and no other. ledger: S5-03 S5-05
TEST_F(BridgeRuns, HearBallsWithinTheSectorOfTheFanOnly) {
  std::string text =
      "[scene]\ntitle = \"Balls\"\n[water]\nsound_speed = [[0, 1500]]\n[vehicle]\nstart = [0, 0, 50]\nspeed = 0\n"
      "[[waypoint]]\nnorth = 0\ndepth = 50\n[[sonar]]\npreset = \"p450_horizontal\"\nspurious_share = 0\n";
  const auto add = [&](const char* name, double azimuth_deg, double elevation_deg) {
    const double a = azimuth_deg * std::numbers::pi / 180, e = elevation_deg * std::numbers::pi / 180;
    text += fmt::format("[[sphere]]\nname = \"{}\"\ncentre = [{}, {}, {}]\nradius = 0.1\n", name,
                        40 * std::cos(a) * std::cos(e), 40 * std::sin(a) * std::cos(e), 50 - 40 * std::sin(e));
  };
  for (const double side : {-1.0, 1.0}) {
    add(side < 0 ? "outside, port" : "outside, starboard", side * 46.5, 0);
    add(side < 0 ? "inside, port" : "inside, starboard", side * 44, 0);
    add(side < 0 ? "outside, below" : "outside, above", 0, side * 8.2);
    add(side < 0 ? "inside, below" : "inside, above", side * 20, side * 7);
  }
  const json run_of = run(scene("balls", text), 2);
  std::vector<std::string> heard;
  for (const json& body : run_of["truth"]["bodies"]) heard.push_back(body["name"]);
  EXPECT_THAT(heard,
              testing::UnorderedElementsAre("inside, port", "inside, starboard", "inside, below", "inside, above"));
}

/// An occupied voxel of voxels.ply.
struct MappedVoxel {
  double north, east, depth, probability;
};
std::vector<MappedVoxel> mapped_voxels(const fs::path& folder) {
  const std::string bytes = test::content_of(folder / "voxels.ply");
  const std::string end = "end_header\n";
  std::vector<MappedVoxel> voxels;
  for (std::size_t at = bytes.find(end) + end.size(); at + 16 <= bytes.size(); at += 16) {
    std::array<float, 4> v{};  // x east, y north, z up, probability
    std::memcpy(v.data(), bytes.data() + at, 16);
    voxels.push_back({v[1], v[0], -v[2], v[3]});
  }
  return voxels;
}

// A ball 20 m ahead, where both fans look, in voxels of 0.1 m by the rule of the paper: the voxels of the highest
// pooled probability lie about the ball's near side, within 0.1 m and a degree. The horizontal fan alone gives an arc
// of 15 degrees. ledger: S5-09 S5-27
TEST_F(BridgeRuns, TwoFansPlaceABallWithinADegreeAndATenthOfAMetre) {
  const std::string text =
      "[scene]\ntitle = \"A ball\"\n[water]\nsound_speed = [[0, 1500]]\nvolume_scattering_db = -110\n[vehicle]\n"
      "start = [0, 0, 50]\nspeed = 0.5\n[[waypoint]]\nnorth = 20\ndepth = 50\n"
      "[[sphere]]\ncentre = [20, 1.1, 50.9]\nradius = 0.3\n"
      "[[sonar]]\npreset = \"p450_horizontal\"\nrange_m = 25\nbins = 250\n"
      "[[sonar]]\npreset = \"p450_vertical\"\nname = \"vertical\"\nrange_m = 25\nbins = 250\n";
  const auto highest = [&](std::vector<std::string> more) {
    more.insert(more.end(), {"--set", "voxels.fit=false", "--set", "voxels.voxel_m=0.1", "--set", "fans.rule=stamp"});
    run(scene("ball", text), 4, more);
    std::vector<MappedVoxel> voxels = mapped_voxels(folder_ / "ball");
    double most = 0;
    for (const MappedVoxel& v : voxels) most = std::max(most, v.probability);
    std::erase_if(voxels, [&](const MappedVoxel& v) { return v.probability < most; });
    return voxels;
  };
  const Eigen::Vector3d ball(20, 1.1, 0.9);  // from the start, at which the vehicle is at first
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  const std::vector<MappedVoxel> both = highest({});
  ASSERT_FALSE(both.empty());
  for (const MappedVoxel& v : both) sum += Eigen::Vector3d(v.north, v.east, v.depth - 50);
  const Eigen::Vector3d place = sum / static_cast<double>(both.size());
  EXPECT_NEAR(place.norm(), ball.norm() - 0.3, 0.1);
  EXPECT_GT(place.normalized().dot(ball.normalized()), std::cos(std::numbers::pi / 180));
  double above = 0, below = 0;
  for (const MappedVoxel& v : highest({"--set", "simulation.without=vertical"})) {
    if (std::hypot(v.north - 20, v.east - 1.1) > 1) continue;
    above = std::max(above, 50 - v.depth);
    below = std::max(below, v.depth - 50);
  }
  EXPECT_NEAR(above, 19 * std::sin(7.5 * std::numbers::pi / 180), 0.4);
  EXPECT_NEAR(below, 19 * std::sin(7.5 * std::numbers::pi / 180), 0.4);
}

// The vertical fan alone, over a flat bed and over one that rises by 1 in 5 ahead: in each metre from 20 to 37 m ahead
// the occupied voxels below the vehicle lie on the bed, to a voxel on average and to a voxel's diagonal each.
// ledger: S5-07
TEST_F(BridgeRuns, TheVerticalFanRecoversTheProfileOfAFlatAndOfASlopedBed) {
  constexpr double kVoxel = 0.5, kDepth = 12;
  for (const double rise : {0.0, 0.2}) {
    const std::string text = fmt::format(
        "[scene]\ntitle = \"A bed\"\n[water]\nsound_speed = [[0, 1500]]\n[bottom]\nkind = \"terrain\"\n"
        "material = \"sand\"\ndepth = {}\nrelief_m = 0\ncell_m = 1\nextent_m = 60\nslope = [{}, 0]\n[vehicle]\n"
        "start = [0, 0, 3]\nspeed = 0.5\n[[waypoint]]\nnorth = 20\ndepth = 3\n[[sonar]]\npreset = \"p450_vertical\"\n",
        kDepth, -rise);
    run(scene("bed", text), 4, {"--set", fmt::format("voxels.voxel_m={}", kVoxel)});
    std::array<std::vector<double>, 17> errors;  // by metre: depth of a voxel less that of the bed below it
    for (const MappedVoxel& v : mapped_voxels(folder_ / "bed")) {
      if (v.north < 20 || v.north >= 37 || v.depth < 3) continue;
      errors[static_cast<std::size_t>(v.north - 20)].push_back(v.depth - (kDepth - rise * v.north));
    }
    for (std::size_t metre = 0; metre < errors.size(); ++metre) {
      ASSERT_FALSE(errors[metre].empty()) << "rise " << rise << ", " << 20 + metre << " m ahead";
      double sum = 0;
      for (const double error : errors[metre]) {
        EXPECT_LE(std::abs(error), kVoxel * std::numbers::sqrt3) << "rise " << rise << ", " << 20 + metre << " m ahead";
        sum += error;
      }
      EXPECT_LE(std::abs(sum / static_cast<double>(errors[metre].size())), kVoxel) << rise << ", metre " << metre;
    }
  }
}

// The first six seconds of the mission. By the rule of the paper, which marks the whole arc of an echo, no way is left
// and the navigator refuses the point; the rule that knows of the arc finds the passage at 3 s. It loses none of the
// four pylons beside the passage, nor the berm, and is the likelier map by the truth. ledger: S5-31 S5-35 S5-E14
TEST_F(BridgeRuns, TheRuleThatKnowsOfTheArcFindsThePassageAndLosesNoPylon) {
  const fs::path mission = scene("mission", test::content_of(test::source_folder() / "scenarios/bridge.toml"));
  const auto sailed = [&](const std::string& rule) {
    const test::ProgramResult result =
        isobath_run(mission, folder_ / rule, {"--set", "simulation.duration_s=6", "--set", "fans.rule=" + rule});
    return json::parse(result.out, nullptr, false);
  };
  const json stamp = sailed("stamp"), aspects = sailed("aspects");
  const std::string passes = "the obstacle that the route went round can be passed";
  EXPECT_THAT(test::content_of(folder_ / "aspects/decisions.json"), HasSubstr(passes));
  EXPECT_THAT(test::content_of(folder_ / "stamp/decisions.json"), testing::Not(HasSubstr(passes)));
  EXPECT_THAT(test::content_of(folder_ / "stamp/decisions.json"), HasSubstr("there is no path"));
  EXPECT_LT(aspects["voxels"]["truth"]["log_loss"], stamp["voxels"]["truth"]["log_loss"]);
  EXPECT_GT(aspects["voxels"]["truth"]["precision"], stamp["voxels"]["truth"]["precision"]);
  const std::vector<MappedVoxel> voxels = mapped_voxels(folder_ / "aspects");
  for (const double east : {-13.5, -4.5, 4.5, 13.5}) {
    const auto at_pylon = [&](const MappedVoxel& v) { return std::hypot(v.north - 45, v.east - east) < 1.1; };
    EXPECT_GT(std::count_if(voxels.begin(), voxels.end(), at_pylon), 20) << east;
  }
  const auto at_berm = [](const MappedVoxel& v) { return std::abs(v.east) < 10 && std::abs(v.north - 30.5) < 2; };
  EXPECT_GT(std::count_if(voxels.begin(), voxels.end(), at_berm), 100);
}

/// Share of the voxels in the water that the map calls occupied without a surface within a voxel.
double false_share(const json& voxels) {
  return (1 - voxels["truth"]["precision"].get<double>()) * voxels["occupied"].get<double>() /
         voxels["seen"].get<double>();
}

// Streaks, rings and bursts in a tenth of the images each, false echoes in three tenths, a tenth of the images lost: at
// most 3 % of the voxels are falsely occupied, and the map is not much worse than that of a quiet sonar. ledger: S5-22
TEST_F(BridgeRuns, DisturbancesCostTheMapLessThanThreePercent) {
  const std::string own = "streak_share = 0.02\nring_share = 0.01\n", quiet = without(bridge_, own);
  const std::string all =
      "streak_share = 0.1\nring_share = 0.1\nburst_share = 0.1\ndropout_share = 0.1\n"
      "spurious_share = 0.3\n";
  const json calm = run(scene("quiet", quiet), 5);
  const json rough = run(scene("rough", put_after(quiet, "sound_speed = 1467.6\n", all)), 5);
  EXPECT_LT(rough["voxels"]["layers"][0]["pings"].get<int>() + rough["voxels"]["layers"][1]["pings"].get<int>(), 22)
      << "images are lost";
  EXPECT_GT(rough["voxels"]["occupied"], 1000) << "and the rest is mapped";
  EXPECT_LT(false_share(rough["voxels"]), 0.03);
  EXPECT_LT(false_share(rough["voxels"]), false_share(calm["voxels"]) + 0.005);
  EXPECT_GT(rough["voxels"]["truth"]["precision"], calm["voxels"]["truth"]["precision"].get<double>() - 0.1);
}

/// The sonars of a scene with coarser images, of which a test can make hundreds.
std::string coarser(const std::string& text) {
  const std::string flat = put_after(text, "name = \"horizontal\"\n", "beams = 31\nbins = 90\nresolution_m = 1\n");
  return put_after(flat, "name = \"vertical\"\n", "beams = 16\nbins = 90\nresolution_m = 1\n");
}

// From 300 images of open water and 200 with marks of each plane: a model of each, of 25 levels, in which the noise of
// a pixel is its own, 88 m and 5 degrees to port among them. A run takes both. ledger: S5-18 S5-23 S5-D02 S5-D03
TEST_F(BridgeRuns, EachPlaneHasItsHistogramModel) {
  const fs::path images = scene("images", coarser(test::scene_text("bridge_images")));
  const fs::path log = folder_ / "images.mcap";
  ASSERT_EQ(test::isobath({"sim", images, "--seed", "101", "--out", log}).exit_code, 0);
  for (const char* plane : {"horizontal", "vertical"}) {
    const auto made =
        test::isobath({"calibrate", log, "--truth", "--sonar", plane, "--out", folder_ / plane, "--json"});
    ASSERT_EQ(made.exit_code, 0) << made.err;
    const json of = json::parse(made.out);
    EXPECT_GE(of["background_pings"], 300);
    EXPECT_GE(of["marked_pings"], 200);
    for (std::size_t i = 0; i < of["histograms"].size(); ++i) {
      EXPECT_GE(of["histograms"][i]["p"]["value"], of["cross_validation"][i]["p_global_threshold"]["value"]) << plane;
    }
    const HistogramModel model = load_histogram_model(folder_ / plane / "histogram_model.bin");
    EXPECT_EQ(model.config.levels, 25);
    double objects = 0;
    for (const double share : model.object_shares()) objects += share;
    EXPECT_NEAR(objects, 1, 1e-12);
    // 88 m far, 5 degrees to port or, of the vertical fan, above its middle.
    int beam = 0;
    while (model.azimuth[static_cast<std::size_t>(beam)].degrees() < -5) ++beam;
    const int bin = static_cast<int>((88 - model.window.start_m) / model.window.bin_m);
    const std::vector<double> there = model.noise_shares(beam, bin), edge = model.noise_shares(0, bin);
    double apart = 0, sum = 0;
    for (std::size_t b = 0; b < there.size(); ++b) {
      apart += std::abs(there[b] - edge[b]);
      sum += there[b];
    }
    EXPECT_NEAR(sum, 1, 1e-12);
    EXPECT_GT(apart, 0.2) << "the outermost stave is noisier";
  }
  const std::string flat = "sensor.histogram=" + (folder_ / "horizontal/histogram_model.bin").string();
  const std::string upright = "sensor.histogram_vertical=" + (folder_ / "vertical/histogram_model.bin").string();
  const fs::path bridge = scene("coarse", coarser(bridge_));
  const json both = run(bridge, 4, {"--set", flat, "--set", upright}), one = run(bridge, 4, {"--set", flat});
  EXPECT_EQ(both["undecided"], "");
  EXPECT_EQ(one["undecided"], "vertical fans: the histogram model is of another sonar or other settings");
  EXPECT_GT(both["voxels"]["seen"], one["voxels"]["seen"]);
  EXPECT_EQ(both["counts"]["hits"], one["counts"]["hits"]) << "of the horizontal images";
}

// The navigation near the bridge has fixes of 5 m and no log of the speed: what each scan shows of a pylon then lies
// beside the others by a good part of a metre, at least twice as much as with a drift of 0.5 %. ledger: S5-38 S5-D04
TEST_F(BridgeRuns, PoorFixesScatterThePylons) {
  const std::string drift = "kind = \"drift\"\n";
  const std::string poor = put_after(without(bridge_, drift), "[navigation]\n", "kind = \"sensors\"\n") +
                           "\n[gps]\nmax_depth_m = 10\nnoise = 5\n[dvl]\non = false\n";
  const std::vector<std::string> plane{"--set", "voxels.sonars=none", "--set", "simulation.without=vertical"};
  const auto spreads = [](const json& run_of) {
    std::vector<double> spread;
    for (const json& body : run_of["truth"]["bodies"]) {
      if (body["name"].get<std::string>().rfind("pylon", 0) != 0) continue;
      EXPECT_GE(body["scans_found"], 15) << body;
      spread.push_back(body["fix_spread_m"]);
    }
    return spread;
  };
  const auto good = spreads(run(scene("drift", bridge_), 18, plane)),
             bad = spreads(run(scene("poor", poor), 18, plane));
  ASSERT_EQ(good.size(), 8u);
  ASSERT_EQ(bad.size(), 8u);
  double sum_good = 0, sum_bad = 0;
  for (std::size_t i = 0; i < 8; ++i) {
    EXPECT_GT(bad[i], good[i]) << i;
    sum_good += good[i];
    sum_bad += bad[i];
  }
  EXPECT_GT(sum_bad, 2 * sum_good);
}

/// Two piers 12 m apart at 40 m, in place of the bridge and its berm, with a span between them down to 1 m; the
/// vehicle is to pass at 6 m, over a bottom of 14 m.
std::string arch_scene(std::string bridge) {
  const auto box = [](const char* name, double east, double width, double bottom) {
    return fmt::format("[[box]]\nname = \"{}\"\ncentre = [40, {}, {}]\nsize = [3, {}, {}]\nmaterial = \"concrete\"\n\n",
                       name, east, (bottom - 2) / 2, width, bottom + 2);
  };
  const auto put = [&](const std::string& old, const std::string& now) {
    const std::size_t at = bridge.find(old);
    ASSERT_NE(at, std::string::npos) << old;
    bridge.replace(at, old.size(), now);
  };
  put("depth = 8\n", "depth = 14\n");
  put("start = [0, 0, 3]", "start = [0, 0, 6]");
  put("depth = 3\n", "depth = 6\n");
  put("depth_m = 3", "depth_m = 6");
  for (const std::string name : {"name = \"horizontal\"\n", "name = \"vertical\"\n"})
    put(name, name + "interval_s = 1\n");
  const std::size_t berm = bridge.find("# The berm"), banks = bridge.find("[[box]]"),
                    mission = bridge.find("[mission]");
  EXPECT_TRUE(berm < banks && banks < mission && mission != std::string::npos);
  return bridge.substr(0, berm) + box("port pier", -9, 6, 16) + box("starboard pier", 9, 6, 16) +
         box("span", 0, 24, 1) + bridge.substr(mission);
}

// The voxels hold the span with water below it, and the vehicle passes beneath, on a shorter way than round the piers.
// ledger: S1-74 S1-75
TEST_F(BridgeRuns, AnArchIsPassedBelowItsSpan) {
  const std::string bridge = test::content_of(test::source_folder() / "scenarios/bridge.toml");
  const double round_m = 2 * std::hypot(40, 12);  // by the outer side of a pier
  const json under = run(scene("arch", arch_scene(bridge)), 90)["mission"];
  EXPECT_EQ(under["reached"], 1);
  EXPECT_FALSE(under["truth"]["contact"].get<bool>());
  EXPECT_EQ(under["truth"]["nearest_body"], "span") << under["truth"];
  EXPECT_LT(under["truth"]["path_m"], round_m);
  int span = 0, opening = 0;
  for (const MappedVoxel& v : mapped_voxels(folder_ / "arch")) {
    if (std::abs(v.north - 40) > 2.5 || std::abs(v.east) > 4) continue;
    span += v.depth < 2;
    opening += v.depth > 3 && v.depth < 10;
  }
  EXPECT_GT(span, 20);
  EXPECT_EQ(opening, 0);
}

// Pylons 25 m apart: from straight ahead the upright fan sees less than half of the way between them. On the helix that
// the Navigator flies, the voxels soon hold nine tenths of it for free; on a straight way they do not.
// ledger: S5-40 S5-41 S5-44 S5-45 S5-46
TEST_F(BridgeRuns, OnAHelixAWideOpeningIsKnownFromFarther) {
  std::string wide = test::content_of(test::source_folder() / "scenarios/bridge_wide.toml");
  wide.replace(wide.find("start = [0, 0, 3]"), 17, "start = [26, 0, 3]");
  for (const std::string mode : {"watch", "helix"}) {
    const fs::path out = folder_ / mode;
    isobath_run(scene(mode, wide), out,
                {"--set", "opening.mode=" + mode, "--set", "simulation.duration_s=13", "--set", "sphere.keep=false"});
    std::vector<json> said;
    const json all = json::parse(test::content_of(out / "decisions.json"));
    for (const json& d : all["decisions"]) {
      if (d.contains("opening")) said.push_back(d);
    }
    ASSERT_FALSE(said.empty()) << mode;
    EXPECT_NEAR(said.back()["opening"]["width_m"], 22, 2.5)
        << "24 m between the pylons, less the width of their echoes";
    EXPECT_EQ(said.back()["what"], mode == "helix" ? "opening known" : "opening");
    if (mode == "watch") continue;
    EXPECT_GE(said.back()["opening"]["free_share"], 0.9);
    EXPECT_GT(said.back()["opening"]["distance_m"], 30);
  }
}

}  // namespace
}  // namespace isobath
