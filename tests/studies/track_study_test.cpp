// Tracks from a table of positions, and their score.
#include <cmath>
#include <fmt/format.h>
#include <fstream>
#include <gtest/gtest.h>
#include <isobath/base/error.hpp>
#include <isobath/base/random.hpp>
#include <isobath/studies/track_study.hpp>

namespace isobath {
namespace {

namespace fs = std::filesystem;

fs::path table_of(const char* name, const std::string& text) {
  const fs::path file = fs::path(testing::TempDir()) / fmt::format("track_study_{}.csv", name);
  std::ofstream(file) << text;
  return file;
}

// Three boats whose courses cross, one at its mooring; positions to 0.3 m every second or so.
std::string boats() {
  Random random(7);
  std::string text = "time,north,east,id,course_deg,speed_mps\n";
  for (int k = 0; k < 400; ++k) {
    const double t = 0.25 * k;
    const int boat = k % 4;
    const double since = t - 50 + 10 * (boat - 1);  // when it passes the point where the courses cross
    const double course = boat * 120.0 * 3.14159265 / 180, speed = boat < 3 ? 1 : 0;
    const double north = speed * since * std::cos(course) + (boat == 3 ? 30 : 0);
    const double east = speed * since * std::sin(course);
    text += fmt::format("{:.2f},{:.3f},{:.3f},boat {},{:.1f},{}\n", t, north + 0.3 * random.normal(),
                        east + 0.3 * random.normal(), boat, boat < 3 ? boat * 120.0 : 0.0, speed);
  }
  return text;
}

// ledger: S3-15
TEST(TrackStudy, HoldsBoatsThatCrossWithoutTheirNames) {
  TrackRequest request;
  request.file = table_of("boats", boats());
  const TrackStudy study = study_tracks(request);
  EXPECT_EQ(study.table.rows.size(), 400U);
  ASSERT_EQ(study.table.names.size(), 4U);
  EXPECT_GT(study.score.held, 0.95 * static_cast<double>(study.score.asked));
  EXPECT_LE(study.score.switches, 2U);
  EXPECT_LT(study.score.velocity_median, 0.15);
  EXPECT_LT(study.score.still_moving, study.score.still / 10 + 1);
  EXPECT_EQ(study.courses.size(), 4U);
}

TEST(TrackStudy, SeesNoNames) {
  TrackRequest request;
  request.file = table_of("named", boats());
  const TrackStudy named = study_tracks(request);
  std::string text = boats();
  text.replace(text.find(",id,"), 4, ",xx,");
  request.file = table_of("nameless", text);
  const TrackStudy nameless = study_tracks(request);
  EXPECT_TRUE(nameless.table.names.empty());
  EXPECT_EQ(nameless.score.asked, 0U);
  ASSERT_EQ(nameless.courses.size(), named.courses.size());
  for (std::size_t i = 0; i < named.courses.size(); ++i) EXPECT_EQ(nameless.courses[i].p_W, named.courses[i].p_W);
}

}  // namespace
}  // namespace isobath
