// A run says of its obstacles which of them stand in the water: by the fan alone the near one, with a fan that stands
// upright the far one too.
#include <fstream>
#include <gtest/gtest.h>
#include <isobath/perception/water_label.hpp>
#include <isobath/run/run.hpp>
#include <nlohmann/json.hpp>
#include <tests/support/data.hpp>

namespace isobath {
namespace {

constexpr const char* kTwoPoles = R"(
[scene]
title = "one pole near to starboard, one far ahead"
duration_s = 10
seed = 3
[bottom]
kind = "flat"
depth = 8
material = "sand"
[vehicle]
start = [0, 0, 3]
speed = 0.2
[[waypoint]]
north = 10
depth = 3
[[cylinder]]
name = "near"
centre = [8, 5, 4]
radius = 0.4
length = 10
[[cylinder]]
name = "far"
centre = [24, 0, 4]
radius = 0.6
length = 10
[[sonar]]
preset = "altimeter"
name = "altimeter"
[[sonar]]
preset = "p450_horizontal"
name = "horizontal"
[[sonar]]
preset = "p450_vertical"
name = "vertical"
)";

nlohmann::json json_of(const std::filesystem::path& file) { return nlohmann::json::parse(std::ifstream(file)); }

/// The label of the obstacle whose outline comes nearest to a place, from the vehicle's place at the end.
std::string label_at(const nlohmann::json& found, double ahead, double starboard) {
  std::string label = "none";
  double nearest = 1.5;
  for (const auto& o : found["obstacles"]) {
    const double away = std::hypot(o["centre_m"][0].get<double>() - ahead, o["centre_m"][1].get<double>() - starboard);
    if (away > nearest) continue;
    nearest = away;
    label = o["label"];
  }
  return label;
}

nlohmann::json run_without(const std::string& sonar) {
  const auto folder = test::scratch_folder();
  std::ofstream(folder / "poles.toml") << kTwoPoles;
  RunRequest request;
  request.input = folder / "poles.toml";
  request.out = folder / "out";
  request.configuration.simulation.without = sonar;
  run(request);
  return json_of(request.out / "obstacles.json");
}

// ledger: S6-69 S5-35
TEST(LabelsOfARun, SayWhatStandsInTheWater) {
  const auto both = run_without("");
  const double north = both["north_m"];
  EXPECT_EQ(label_at(both, 8 - north, 5), "standing");
  EXPECT_EQ(label_at(both, 24 - north, 0), "standing");
  const auto flat = run_without("vertical");
  EXPECT_EQ(label_at(flat, 8 - north, 5), "standing") << "nearer than the beam can meet the bottom";
  EXPECT_EQ(label_at(flat, 24 - north, 0), "unknown") << "a fan that lies flat cannot tell it from the bottom there";
  const auto blind = run_without("altimeter");
  EXPECT_EQ(label_at(blind, 24 - north, 0), "standing") << "it reaches up to the sonar's depth";
}

}  // namespace
}  // namespace isobath
