// An approach by helix beside a straight one, with the whole vehicle.
#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <isobath/base/error.hpp>
#include <isobath/studies/helix_pictures.hpp>
#include <tests/support/data.hpp>

namespace isobath {
namespace {

HelixRequest request_for(double width, double height) {
  HelixRequest request;
  request.width_m = width;
  request.height_m = height;
  request.course = Angle::degrees(35);
  request.images_per_s = 2.5;
  return request;
}

VehicleModel torpedo() { return load_vehicle((test::source_folder() / "vehicles" / "remus100.toml").string()); }

double last_share(const ApproachLog& log) { return log.samples.back().known_share; }

// ledger: S5-40 S5-45 S5-53 S5-58 S5-D09 S5-F01
TEST(HelixStudy, TheHelixShowsNineTenthsOfTheOpeningBeforeTheDecision) {
  const HelixStudy study = study_helix(request_for(25, 8));
  EXPECT_GE(last_share(study.helix), 0.9);
  EXPECT_LT(last_share(study.straight), 0.7);
  EXPECT_GT(study.helix.leave_m, 20);
  EXPECT_LT(study.helix.leave_m, 30);
  EXPECT_EQ(study.helix.samples.back().phase, ApproachPhase::kPass);
  EXPECT_EQ(study.helix.nearest_m, 0) << "went through";
  EXPECT_LT(study.helix.vertical_rms_m, 0.5);
  EXPECT_LT(study.helix.lateral_rms_m, 0.3);
  // Known before the decision, not after it.
  double at_decision = 0;
  for (const ApproachSample& s : study.helix.samples) {
    if (s.distance_m >= study.helix.leave_m) at_decision = s.known_share;
  }
  EXPECT_GE(at_decision, 0.9);
  // What is not known yet falls along both ways, and faster along the helix.
  const auto bits_at = [](const ApproachLog& log, double distance) {
    double bits = 1;
    for (const ApproachSample& s : log.samples) {
      if (s.distance_m >= distance) bits = s.bits_a_voxel;
    }
    return bits;
  };
  for (const double distance : {50.0, 45.0, 40.0, 35.0, 30.0, 25.0}) {
    EXPECT_LT(bits_at(study.helix, distance), bits_at(study.straight, distance)) << distance;
  }
  for (const ApproachLog* log : {&study.helix, &study.straight}) {
    for (std::size_t i = 1; i < log->samples.size(); ++i) {
      EXPECT_LE(log->samples[i].bits_a_voxel, log->samples[i - 1].bits_a_voxel + 1e-12);
      EXPECT_GE(log->samples[i].known_share, log->samples[i - 1].known_share);
    }
  }
}

// Nothing that the plan asks for is more than the vehicle can do, and it does no more. ledger: S5-47
TEST(HelixStudy, TheVehicleStaysWithinItsLimits) {
  HelixRequest request = request_for(25, 14);
  request.plant = PlantKind::kKinematic;
  const VehicleModel model = torpedo();
  const ApproachLog log = fly_approach(request, model, {}, 1);
  const double min_s = 1 / request.images_per_s;
  const auto& samples = log.samples;
  for (std::size_t i = 1; i < samples.size() && samples[i].phase != ApproachPhase::kTurnAway; ++i) {
    const double turned = abs((samples[i].heading - samples[i - 1].heading).wrapped()).degrees() / min_s;
    EXPECT_LE(turned, model.limits.max_yaw_rate.degrees() + 1e-6);
    const double climbed = std::abs(samples[i].p_O.z() - samples[i - 1].p_O.z()) / min_s;
    EXPECT_LE(climbed, model.limits.max_climb_rate + 1e-6);
    EXPECT_LE(abs(samples[i].heading).degrees(), 22) << samples[i].distance_m;
  }
  EXPECT_GE(last_share(log), 0.9);
}

// A rock stands where the helix leads, two metres off the middle line. Its echoes come in time: the helix is smaller
// from there on, or the vehicle turns away, and its hull keeps clear of the rock. ledger: S5-47
TEST(HelixStudy, ARockOnTheHelixIsKeptClearOf) {
  HelixRequest request = request_for(25, 14);
  const VehicleModel model = torpedo();
  const ApproachLog plain = fly_approach(request, model, {6, 12}, 1);
  const auto most = std::max_element(plain.samples.begin(), plain.samples.end(), [](const auto& a, const auto& b) {
    const auto off = [](const ApproachSample& s) { return s.p_O.x() < -25 ? std::abs(s.p_O.y()) : 0; };
    return off(a) < off(b);
  });
  ASSERT_GT(std::abs(most->p_O.y()), 1.5);
  request.rock_radius_m = 0.5;
  request.rock_before_m = -most->p_O.x();
  request.rock_aside_m = most->p_O.y();
  request.rock_down_m = most->p_O.z();
  const ApproachLog log = fly_approach(request, model, {6, 12}, 1);
  double nearest = INFINITY, before = INFINITY;
  for (const ApproachSample& s : log.samples) nearest = std::min(nearest, (s.p_O - most->p_O).norm());
  for (const ApproachSample& s : plain.samples) before = std::min(before, (s.p_O - most->p_O).norm());
  EXPECT_EQ(before, 0) << "without the map it would have met the rock";
  EXPECT_GT(nearest, request.rock_radius_m + parameters_of(model).half_width_m);
}

// ledger: S5-45
TEST(HelixStudy, TurnsAwayFromAnOpeningThatIsTooNarrow) {
  const ApproachLog log = fly_approach(request_for(1.8, 8), torpedo(), {6, 12}, 1);
  EXPECT_EQ(log.samples.back().phase, ApproachPhase::kTurnAway);
  EXPECT_GT(log.nearest_m, HelixConfig().clearance_m);
}

// ledger: S5-56 S5-D07 S5-D08
TEST(HelixStudy, DrawsItsPicturesAndAReport) {
  const HelixStudy study = study_helix(request_for(25, 8));
  for (const Convergence& c : study.convergence) {
    EXPECT_LT(c.off_m.back(), 1e-6);
    EXPECT_LT(c.greatest_rise, 1e-14);
  }
  const auto folder = test::scratch_folder();
  const auto files = write_helix_report(study, folder);
  EXPECT_EQ(files.size(), 10u);
  for (const auto& file : files) EXPECT_GT(std::filesystem::file_size(folder / file), 1500u) << file;
  EXPECT_EQ(helix_frames_picture(study.reference, study.convergence.back()),
            helix_frames_picture(study.reference, study.convergence.back()));
}

TEST(HelixStudy, RefusesWhatNoVehicleCanDo) {
  HelixRequest fast = request_for(25, 8);
  fast.speed = 9;
  EXPECT_THROW(study_helix(fast), Error);
  HelixRequest still = request_for(25, 8);
  still.speed = 0;
  EXPECT_THROW(study_helix(still), Error);
}

TEST(HelixStudy, SettingsReadBack) {
  HelixRequest request = request_for(31, 9);
  const std::string text = write_toml(sections(request), true);
  HelixRequest again;
  std::vector<Section> all = sections(again);
  read_toml(text, "settings.toml", all);
  EXPECT_EQ(again.width_m, 31);
  EXPECT_EQ(write_toml(sections(again), true), text);
}

}  // namespace
}  // namespace isobath
