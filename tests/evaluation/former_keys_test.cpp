// Settings that have a new key: each kind of file that has one says so for the old key. Goes with the last .was().
#include <fstream>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <isobath/configuration/configuration.hpp>
#include <isobath/evaluation/evaluation_report.hpp>
#include <isobath/scenario/scenario.hpp>
#include <isobath/vehicle/vehicle_model.hpp>
#include <tests/support/data.hpp>
#include <tests/support/pole_scene.hpp>

namespace isobath {
namespace {

struct Renamed {
  const char *section, *old_key, *new_key;
};
constexpr Renamed kRenamed[] = {
    {"input", "most_bins", "max_bins"},
    {"gate", "most_speed", "max_speed"},
    {"gate", "leap_m", "max_jump_m"},
    {"gate", "believe_leap_after", "accept_jump_after"},
    {"echoes", "blind_m", "blanking_m"},
    {"echoes", "boundary_loudest", "boundary_max_level"},
    {"echoes", "spread", "max_background_ratio"},
    {"voxels", "most_log_odds", "max_log_odds"},
    {"fans", "answers", "visibility"},
    {"fans", "most_looks", "max_looks"},
    {"fans", "aspect_answers", "aspect_visibility"},
    {"fans", "aspect_silence", "aspect_no_echo_weight"},
    {"fans", "aspect_limit", "aspect_max_log_odds"},
    {"prior", "least_depth_m", "min_depth_m"},
    {"prior", "greatest_depth_m", "max_depth_m"},
    {"prior", "farthest_m", "max_distance_m"},
    {"prior", "most_cells", "max_cells"},
    {"depth", "honest", "range_weighting"},
    {"depth", "explain", "affirm_predicted"},
    {"evidence", "least_confidence", "min_confidence"},
    {"prefilter", "most", "max_readings"},
    {"quarantine", "steepest", "max_slope"},
    {"quarantine", "believe_after", "accept_after"},
    {"quarantine", "highest_m", "min_depth_m"},
    {"quarantine", "deepest_m", "max_depth_m"},
    {"executive", "patience_s", "route_timeout_s"},
    {"route", "most_expanded", "max_expanded"},
    {"space_route", "most_expanded", "max_expanded"},
    {"fls_detector", "least_existence", "min_existence"},
    {"memory", "least_seen", "min_initial_existence"},
    {"memory", "least_existence", "min_existence"},
    {"memory", "most", "max_obstacles"},
    {"chart_room", "again_share", "recheck_share"},
    {"chart_room", "most_outlines", "max_outlines"},
    {"signaling", "beat_limit_s", "heartbeat_limit_s"},
    {"survey", "most_m", "max_total_m"},
    {"circle", "most_turns", "max_turns"},
    {"safety", "leave_s", "clear_after_s"},
    {"safety", "leave_share", "clear_share"},
    {"safety", "off_way_s", "off_route_s"},
    {"safety", "way_abort_s", "route_abort_s"},
    {"safety", "low_abort_s", "low_altitude_abort_s"},
    {"executor", "most_said", "max_messages"},
    {"executor", "most_ticks", "max_ticks"},
    {"executor", "order_patience", "order_timeout_s"},
    {"calibration", "blind_m", "blanking_m"},
    {"calibration", "least_targets", "min_targets"},
    {"histogram", "most_evidence", "max_log_odds"},
    {"recorder", "whole_s", "keyframe_s"},
    {"report", "film", "replay"},
    {"report", "film_s", "replay_s"},
    {"report", "film_mb", "replay_mb"},
};

template <class Action>
std::string refusal_by(const Action& act) {
  try {
    act();
  } catch (const Error& e) {
    return e.what();
  }
  return "accepted";
}

TEST(FormerKeys, OfConfigurationFilesAndSettingsGiveTheNewKey) {
  for (const Renamed& key : kRenamed) {
    const std::string old_key = key.old_key, name = std::string(key.section) + "." + old_key;
    const std::string now = name + ": unknown key; it is called " + key.new_key + " now";
    Configuration c;
    Schema all = schema(c);
    EXPECT_EQ(
        refusal_by([&] { read_toml("[" + std::string(key.section) + "]\n" + old_key + " = 1\n", "c.toml", all); }),
        "c.toml:2:1: " + now);
    EXPECT_THAT(refusal_by([&] { set_from_text(name + "=1", all.sections); }), testing::EndsWith(now));
  }
}

TEST(FormerKeys, OfSectionsGiveTheNewSection) {
  Configuration c;
  Schema all = schema(c);
  EXPECT_THAT(refusal_by([&] { read_toml("[crew]\nmissed_ticks = 5\n", "c.toml", all); }),
              testing::EndsWith("it is called executor now"));
}

TEST(FormerKeys, OfScenesAndSuitesGiveTheNewKey) {
  const std::string sonar = "[[sonar]]\npreset = \"micron\"\nblind_m = 0.5\n";
  const std::string now = ": sonar.blind_m: unknown key; it is called blanking_m now";
  EXPECT_EQ(refusal_by([&] { (void)parse_scenario(sonar, "scene.toml"); }), "scene.toml:3:1" + now);

  const auto folder = test::scratch_folder();
  std::ofstream(folder / "pole.toml") << test::kPoleScene;
  std::ofstream(folder / "suite.toml") << "[suite]\nscene = \"pole.toml\"\n" << sonar;
  EXPECT_THAT(refusal_by([&] { (void)load_suite(folder / "suite.toml"); }), testing::EndsWith("suite.toml:5:1" + now));
}

// Vehicle files have no key with a new name: an unknown key there is still compared with the known ones.
TEST(FormerKeys, AreNotAssumedWhereNoneWasRenamed) {
  EXPECT_THAT(refusal_by([] { (void)parse_vehicle("[vehicle]\nlenght = 1\n", "v.toml"); }),
              testing::HasSubstr("did you mean length?"));
}

}  // namespace
}  // namespace isobath
