// Corners by what appears and what vanishes on the way round a body (the paper's figure 3).
#include <cmath>
#include <gmock/gmock.h>
#include <isobath/perception/corner_evidence.hpp>
#include <tests/support/plane_rays.hpp>
#include <tests/support/sanitized.hpp>

namespace isobath {
namespace {

using Eigen::Vector2d;
using test::PlanRoom, test::plan_scan;

/// Corners in a row along the path of the figure: south-west, south-east, north-east, north-west.
PlanRoom parallelogram() {
  PlanRoom room;
  room.segments = {{{0, 0}, {2, 8}}, {{2, 8}, {9, 10}}, {{9, 10}, {7, 2}}, {{7, 2}, {0, 0}}};
  return room;
}
void hear(CornerEvidence& evidence, const PlanRoom& room, const Vector2d& from, Random& random, double reach_m = 15) {
  const PlaneScan scan = plan_scan(room, from, random, 1, reach_m);
  evidence.add(scan, shapes_of(scan));
}
const SeenCorner* near(const CornerEvidence& evidence, const Vector2d& p) {
  for (const SeenCorner& corner : evidence.corners()) {
    if (corner.corner.convex && (corner.corner.at - p).norm() < 0.8) return &corner;
  }
  return nullptr;
}

// ledger: S4-42 S4-D02
TEST(CornerEvidence, IsHypothesisedWhereASecondEdgeAppearsAndConfirmedAsTheFirstVanishes) {
  int confirmed = 0;
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    Random random(seed);
    CornerEvidence evidence;
    const PlanRoom room = parallelogram();
    hear(evidence, room, {-4, 5}, random);  // the south face alone
    EXPECT_TRUE(evidence.corners().empty()) << "one edge is no corner";
    ASSERT_EQ(evidence.edges().size(), 1u);
    hear(evidence, room, {-3, 13}, random);  // south and east
    const SeenCorner* corner = near(evidence, {2, 8});
    ASSERT_TRUE(corner) << seed;
    EXPECT_EQ(corner->hypothesised, 2);
    EXPECT_EQ(corner->confirmed, 0) << "nothing has vanished yet";
    hear(evidence, room, {4.5, 17}, random);  // behind the south face's line
    hear(evidence, room, {9, 17}, random);
    corner = near(evidence, {2, 8});
    ASSERT_TRUE(corner);
    if (corner->confirmed == 3 || corner->confirmed == 4) ++confirmed;
    EXPECT_EQ(corner->scans_against, 0);
    EXPECT_LT((corner->corner.at - Vector2d(2, 8)).norm(), 4 * std::sqrt(corner->corner.covariance.trace()));
  }
  EXPECT_GE(confirmed, 9) << "within the next two positions";
}

// ledger: S4-42
TEST(CornerEvidence, GoesAgainstACornerThatBeamsPassThrough) {
  Random random(11);
  CornerEvidence evidence;
  const test::PlanSegment south{{0, 0}, {2, 8}}, east{{2, 8}, {9, 10}}, far_off{{-60, -20}, {60, -20}};
  hear(evidence, {{south, east, far_off}, {}}, {-3, 13}, random, 60);
  ASSERT_TRUE(near(evidence, {2, 8}));
  // the south face was none: it has left, and the wall behind it is heard
  for (int i = 0; i < 3; ++i) hear(evidence, {{east, far_off}, {}}, {-3, 13}, random, 60);
  EXPECT_EQ(near(evidence, {2, 8})->confirmed, 0);
  EXPECT_EQ(near(evidence, {2, 8})->scans_against, 3);
}

// ledger: S4-42
TEST(CornerEvidence, DoesNotConfirmTheCornersOfARoom) {
  ISOBATH_NOT_SANITIZED();
  Random random(12);
  CornerEvidence evidence;
  const PlanRoom room{{{{-10, -10}, {10, -10}}, {{10, -10}, {10, 10}}, {{10, 10}, {-10, 10}}, {{-10, 10}, {-10, -10}}},
                      {}};
  for (int i = 0; i < 6; ++i) hear(evidence, room, {-5 + 2.0 * i, 1}, random, 40);
  int hollow = 0;
  for (const SeenCorner& corner : evidence.corners()) {
    EXPECT_FALSE(corner.corner.convex);
    EXPECT_EQ(corner.confirmed, 0);
    const Vector2d at = corner.corner.at.cwiseAbs();
    EXPECT_LT((at - Vector2d(10, 10)).norm(), 0.5);
    ++hollow;
  }
  EXPECT_EQ(hollow, 4);
  EXPECT_EQ(evidence.edges().size(), 4u) << "each wall is one edge, however often it is heard";
  for (const SeenEdge& edge : evidence.edges()) EXPECT_EQ(edge.scans, 6);
}

// ledger: S4-47
TEST(CornerEvidence, FusesPlacesByTheirCovariances) {
  PlaneCorner a, b;
  a.at = {1, 0};
  a.covariance = Vector2d(1, 4).asDiagonal();
  b.at = {3, 5};
  b.covariance = Vector2d(3, 4).asDiagonal();
  const PlaneCorner both = fused(a, b);
  EXPECT_LT((both.at - Vector2d(1.5, 2.5)).norm(), 1e-12);
  EXPECT_LT((both.covariance.diagonal() - Vector2d(0.75, 2)).norm(), 1e-12);
}

}  // namespace
}  // namespace isobath
