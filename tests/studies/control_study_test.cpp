// The study of three kinds of control.
#include <fstream>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <isobath/base/error.hpp>
#include <isobath/studies/control_study.hpp>
#include <tests/support/data.hpp>

namespace isobath::control_study {
namespace {

ControlRequest small(const std::string& vehicle, ControlTask task, std::vector<ControlChange> changes) {
  ControlRequest request;
  request.vehicles = {vehicle};
  request.tasks = {task};
  request.changes = std::move(changes);
  request.runs = 3;
  return request;
}

// With mass or drag changed in mid-run the error of the adaptive control rises, then returns; the fixed model keeps it.
// ledger: S7-08 S7-11 S7-12 S7-16 S7-D01
TEST(ControlStudy, TheAdaptiveControlReturnsToItsFormerError) {
  for (const std::string vehicle : {"bluerov2", "hovering_rov"}) {
    const ControlStudy study =
        study_control(small(vehicle, ControlTask::kHelix, {ControlChange::kMass, ControlChange::kDrag}));
    for (const ControlChange change : {ControlChange::kMass, ControlChange::kDrag}) {
      const ControlRow& learnt = *study.row(vehicle, ControlTask::kHelix, change, ControlKind::kAdaptive);
      EXPECT_GT(learnt.at_max_m.median, 1.5 * learnt.before_rms_m.median);
      EXPECT_LT(learnt.after_rms_m.median, 1.25 * learnt.before_rms_m.median + 0.005);
      const ControlRow& fixed = *study.row(vehicle, ControlTask::kHelix, change, ControlKind::kModel);
      EXPECT_GT(fixed.after_rms_m.median, 1.25 * fixed.before_rms_m.median);
      EXPECT_GT(fixed.after_rms_m.median, 3 * learnt.after_rms_m.median);
    }
    EXPECT_EQ(study.bars.size(), 2u);
    for (const ControlBar& bar : study.bars) EXPECT_TRUE(bar.met) << bar.vehicle << ": " << bar.what;
  }
}

// Buoyancy, density and current. ledger: S7-09 S7-11 S7-D02
TEST(ControlStudy, TheAdaptiveControlHoldsItsStationInAnotherEnvironment) {
  const ControlStudy study = study_control(
      small("bluerov2", ControlTask::kStation,
            {ControlChange::kNone, ControlChange::kHeavy, ControlChange::kDensity, ControlChange::kStrongCurrent}));
  for (const ControlBar& bar : study.bars) EXPECT_TRUE(bar.met) << bar.what << ": " << bar.value;
  EXPECT_EQ(study.bars.size(), 3u);
  const auto row = [&](ControlChange change, ControlKind control) {
    return *study.row("bluerov2", ControlTask::kStation, change, control);
  };
  for (const ControlChange change : {ControlChange::kHeavy, ControlChange::kDensity, ControlChange::kStrongCurrent}) {
    EXPECT_LT(row(change, ControlKind::kAdaptive).at_max_m.median,
              0.5 * row(change, ControlKind::kPid).at_max_m.median);
  }
  // Where nothing changes, all three are as good within a factor of 1.5.
  const double pid = row(ControlChange::kNone, ControlKind::kPid).after_rms_m.median;
  for (const ControlKind control : {ControlKind::kModel, ControlKind::kAdaptive}) {
    EXPECT_LT(row(ControlChange::kNone, control).after_rms_m.median, 1.5 * pid);
  }
}

TEST(ControlStudy, SaysWhatAVehicleCannotHold) {
  const ControlStudy study =
      study_control(small("hovering_rov", ControlTask::kStation, {ControlChange::kStrongCurrent}));
  ASSERT_EQ(study.bars.size(), 1u);
  EXPECT_FALSE(study.bars[0].met);
  EXPECT_THAT(study.bars[0].why, testing::HasSubstr("thrusters do not hold it"));
}

// Late and noisy place and speeds leave all three stable. ledger: S7-10
TEST(ControlStudy, StaysStableWithLateAndNoisyNavigation) {
  for (const std::string vehicle : {"bluerov2", "hovering_rov", "remus100"}) {
    const ControlStudy study = study_control(small(vehicle, ControlTask::kLine, {ControlChange::kNavigation}));
    for (const ControlRow& row : study.rows) EXPECT_LT(row.after_max_m.most, 0.2) << vehicle << to_text(row.control);
  }
}

// ledger: S7-06 S7-16
TEST(ControlStudy, ATorpedoDoesAllTasks) {
  ControlRequest request = small("remus100", ControlTask::kLine, {ControlChange::kMass, ControlChange::kTether});
  request.tasks.assign(std::begin(kControlTasks), std::end(kControlTasks));
  request.runs = 1;
  const ControlStudy study = study_control(request);
  EXPECT_EQ(study.rows.size(), 4u * 3u) << "no runs with a tether";
  EXPECT_TRUE(study.bars.empty()) << "bars are those of vehicles that hover";
  for (const ControlTask task : kControlTasks) {
    EXPECT_LT(study.row("remus100", task, ControlChange::kMass, ControlKind::kAdaptive)->after_rms_m.median, 2.5);
  }
}

// ledger: S7-12
TEST(ControlStudy, IsTheSameOnAnyNumberOfThreads) {
  ControlRequest request = small("bluerov2", ControlTask::kSquare, {ControlChange::kActuator});
  const ControlStudy one = study_control(request);
  request.threads = 2;
  const ControlStudy two = study_control(request);
  ASSERT_EQ(one.rows.size(), two.rows.size());
  for (std::size_t i = 0; i < one.rows.size(); ++i) EXPECT_EQ(one.rows[i].error_m, two.rows[i].error_m);
}

TEST(ControlStudy, WritesItsTableAndPictures) {
  const ControlRequest request = small("bluerov2", ControlTask::kStation, {ControlChange::kCurrent});
  const ControlStudy study = study_control(request);
  const auto folder = test::scratch_folder();
  const auto files = write_control_report(request, study, folder);
  EXPECT_THAT(files, testing::ElementsAre("report.html", "control.csv", "bluerov2-station-current.png"));
  std::ifstream csv(folder / "control.csv");
  std::string line;
  std::getline(csv, line);
  EXPECT_THAT(line, testing::StartsWith("vehicle,task,change,control,runs"));
  for (const char* control : {"pid", "model", "adaptive"}) {
    std::getline(csv, line);
    EXPECT_THAT(line, testing::StartsWith(std::string("bluerov2,station,current,") + control));
  }
  const auto table = control_table(study);
  EXPECT_THAT(table.at(0), testing::ElementsAre("vehicle", "task", "change", "pid", "model", "adaptive"));
  EXPECT_EQ(table.size(), 2u);
}

TEST(ControlStudy, RefusesAVehicleThatIsNotThere) {
  try {
    study_control(small("bluerov", ControlTask::kLine, {ControlChange::kNone}));
    FAIL();
  } catch (const Error& e) {
    EXPECT_THAT(e.what(), testing::HasSubstr("no such vehicle: bluerov"));
    EXPECT_THAT(e.what(), testing::HasSubstr("did you mean bluerov2?"));
  }
}

}  // namespace
}  // namespace isobath::control_study
