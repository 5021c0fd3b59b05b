// What a group searched, by tracks whose shares can be told by hand.
#include <gtest/gtest.h>
#include <isobath/scenario/group_record.hpp>

namespace isobath {
namespace {

/// Along north from 0 to 100 m at this east, a sample each half metre.
std::vector<TrueMotion> straight(double east) {
  std::vector<TrueMotion> track;
  for (int i = 0; i <= 200; ++i) {
    TrueMotion& motion = track.emplace_back();
    motion.time = Time(seconds(i / 3.0));
    motion.state.X_WB.translation = {0.5 * i, east, 5};
  }
  return track;
}

Decision decision(double s, const std::string& what, const std::string& reason = "") {
  Decision d;
  d.time = Time(seconds(s));
  d.agent = "commodore";
  d.what = what;
  d.reason = reason;
  return d;
}

/// An area of 100 x 40 m with four lanes of 10 m: a track covers 5.5 m to both sides.
GroupRecord record_of(std::initializer_list<double> easts) {
  GroupRecord record;
  record.plan.search.length_m = 100;
  record.plan.search.breadth_m = 40;
  for (const double east : easts) {
    GroupVehicleRecord& vehicle = record.vehicles.emplace_back();
    vehicle.name = record.vehicles.size() == 1 ? "alpha" : "bravo";
    vehicle.track = straight(east);
  }
  return record;
}

// ledger: S2-48 S2-50
TEST(GroupRecord, CountsTheAreaThatTheTracksPass) {
  GroupScore score = score_of(record_of({5}));
  EXPECT_DOUBLE_EQ(score.searched, 11.0 / 40) << "squares whose middle lies within 5.5 m";
  EXPECT_EQ(score.overlap, 0);
  score = score_of(record_of({5, 25}));
  EXPECT_DOUBLE_EQ(score.searched, 23.0 / 40);
  EXPECT_EQ(score.overlap, 0);
  EXPECT_DOUBLE_EQ(score.searched_by[1], 12.0 / 40);
  score = score_of(record_of({5, 8}));
  EXPECT_DOUBLE_EQ(score.overlap, 9.0 / 40);
  score = score_of(record_of({500}));
  EXPECT_EQ(score.searched, 0);
}

// ledger: S2-50
TEST(GroupRecord, TellsWhenTheLanesOfALostVehicleWereSharedAnew) {
  GroupRecord record = record_of({5, 25});
  record.vehicles[1].lost_s = 30;
  record.vehicles[0].decisions = {decision(1, "share lanes"), decision(40, "share lanes", "for another reason"),
                                  decision(92, "vehicle lost", "bravo was not heard for 60 s"),
                                  decision(92.1, "share lanes")};
  EXPECT_FALSE(score_of(record).all_searched_s);
  EXPECT_NEAR(score_of(record).reassigned_s.value(), 62.1, 1e-9);
  record.vehicles[0].decisions.pop_back();
  EXPECT_FALSE(score_of(record).reassigned_s) << "nothing was left to share";
  record.vehicles[0].decisions.push_back(decision(300, "area searched"));
  record.vehicles[1].decisions.push_back(decision(290, "area searched"));
  EXPECT_EQ(score_of(record).all_searched_s, 290);
}

// ledger: S2-51
TEST(GroupRecord, StatesTheRateOfAVehicleForItsTimeUnderWay) {
  GroupRecord record = record_of({5, 25});
  record.duration_s = 100;
  record.vehicles[0].link.bytes = record.vehicles[1].link.bytes = 100;
  record.vehicles[1].lost_s = 50;
  EXPECT_DOUBLE_EQ(record.bit_rate(0), 8);
  EXPECT_DOUBLE_EQ(record.bit_rate(1), 16);
  record.plan.search.run_out_m = 6;
  record.vehicles[0].report.reached = 2 * (record.plan.search.stations() - 1);
  EXPECT_EQ(record.lanes(0), 2u) << "of the run-outs of a lane, one is visited";
}

}  // namespace
}  // namespace isobath
