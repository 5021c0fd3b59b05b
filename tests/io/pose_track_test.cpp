// Tables of poses beside a log.
#include <deque>
#include <gmock/gmock.h>
#include <isobath/base/error.hpp>
#include <isobath/base/random.hpp>
#include <isobath/io/input/pose_track.hpp>
#include <sstream>

namespace isobath {
namespace {

using Eigen::Vector3d;
using testing::HasSubstr;

std::unique_ptr<Source> track(const std::string& text) {
  return open_pose_track(std::make_unique<std::istringstream>(text), "poses.csv");
}

std::vector<Navigation> fixes(Source& source) {
  std::vector<Navigation> all;
  while (const auto event = source.next()) all.push_back(std::get<Navigation>(*event));
  return all;
}

std::string error_of(const std::string& text) {
  try {
    track(text);
  } catch (const Error& e) {
    return e.what();
  }
  return "no error";
}

TEST(PoseTrack, FindsColumnsByName) {
  const auto source = track(
      "\xEF\xBB\xBF# a comment\r\n\"heading_deg\", depth_m,other,east_m,north_m,t_s,roll_deg,vd,ve,vn\r\n"
      "90,3,text,2,1,0.25,10,0.3,0.2,0.1\r\n\r\n180,3,,2,1,1,0,,0.2,0.1\n");
  const auto all = fixes(*source);
  ASSERT_EQ(all.size(), 2u);
  EXPECT_EQ(all[0].time, Time{std::chrono::milliseconds(250)});
  EXPECT_EQ(all[0].X_WB.translation, Vector3d(1, 2, 3));
  EXPECT_NEAR(all[0].X_WB.rotation.heading().degrees(), 90, 1e-9);
  EXPECT_NEAR(all[0].X_WB.rotation.roll().degrees(), 10, 1e-9);
  EXPECT_EQ(*all[0].v_WB, Vector3d(0.1, 0.2, 0.3));
  EXPECT_FALSE(all[1].v_WB);
  EXPECT_FALSE(source->report().origin);
}

TEST(PoseTrack, TakesQuaternionsAndIsoTimes) {
  const auto source = track("time,x,y,z,qw,qx,qy,qz\n2024-03-13T15:50:16.250Z,1,2,3,0.70710678,0,0,0.70710678\n");
  const auto all = fixes(*source);
  ASSERT_EQ(all.size(), 1u);
  EXPECT_EQ(to_text(all[0].time), "2024-03-13T15:50:16.250Z");
  EXPECT_NEAR(all[0].X_WB.rotation.heading().degrees(), 90, 1e-6);
}

TEST(PoseTrack, MakesMetresOfLatitudeAndLongitude) {
  const auto source = track("time_us,lat_deg,lon_deg,depth_m,heading_deg\n1000,60,10,5,0\n2000,60.001,10,6,0\n");
  const auto all = fixes(*source);
  ASSERT_EQ(all.size(), 2u);
  EXPECT_EQ(*source->report().origin, (GeoOrigin{60, 10}));
  EXPECT_EQ(all[0].X_WB.translation, Vector3d(0, 0, 5));
  EXPECT_NEAR(all[1].X_WB.translation.x(), 111.412, 0.002);
  EXPECT_EQ(all[1].X_WB.translation.z(), 6);
  EXPECT_EQ(all[1].time, Time{std::chrono::milliseconds(2)});
}

TEST(PoseTrack, TiesMetresToTheGlobe) {
  const auto source = track("t_s,x,y,z,lat_deg,lon_deg,heading_deg\n0,111.412,0,5,60.001,10,0\n");
  const auto all = fixes(*source);
  EXPECT_EQ(all.at(0).X_WB.translation, Vector3d(111.412, 0, 5));
  EXPECT_NEAR(source->report().origin->latitude_deg, 60, 1e-7);
  EXPECT_NEAR(source->report().origin->longitude_deg, 10, 1e-7);
}

TEST(PoseTrack, RejectsAndCountsBadRows) {
  const auto source = track(
      "t_s,x,y,z,heading_deg\n1,0,0,0,0\n2,nan,0,0,0\n3,0,0\n0.5,0,0,0,0\nabc,0,0,0,0\n4,0,0,inf,0\n5,1e300,0,0,0\n"
      "1e300,0,0,0,0\n6,0,0,0,0,extra\n7,0,0,0,0");
  EXPECT_EQ(fixes(*source).size(), 3u);
  EXPECT_EQ(source->report().rejected.at(kPoseBackwards), 1u);
  EXPECT_EQ(source->report().rejected.at(kBadPose), 6u);
}

TEST(PoseTrack, SaysWhatTheLineOfNamesLacks) {
  EXPECT_THAT(error_of(""), HasSubstr("no line of column names"));
  EXPECT_THAT(error_of("\n# x\nx,y,z,heading_deg\n"),
              HasSubstr("poses.csv:3: no column of time; allowed: t_s, time_us or time"));
  EXPECT_THAT(error_of("t_s,time_us,x,y,z,heading_deg\n"), HasSubstr("more than one column of time"));
  EXPECT_THAT(error_of("t_s,heading_deg\n"), HasSubstr("no columns of position"));
  EXPECT_THAT(error_of("t_s,north_m,heading_deg\n"), HasSubstr("no column \"east_m\""));
  EXPECT_THAT(error_of("t_s,x,y,z\n"), HasSubstr("no columns of attitude"));
  EXPECT_THAT(error_of("t_s,x,y,z,qw,qx,qy\n"), HasSubstr("no column \"qz\""));
  EXPECT_THAT(error_of("t_s,x,x,y,z,heading_deg\n"), HasSubstr("twice"));
}

TEST(PoseTrack, SurvivesRandomBytesAndOverlongLines) {
  const std::string head = "t_s,x,y,z,heading_deg\n";
  Random random(5);
  for (int i = 0; i < 200; ++i) {
    std::string text = head;
    for (int k = 0; k < 300; ++k) text += ",.-+0123456789einfa\n\r\0\xff"[random.index(22)];
    for (const Navigation& fix : fixes(*track(text))) EXPECT_TRUE(fix.X_WB.is_finite());
  }
  EXPECT_EQ(fixes(*track(head + "1,0,0,0,0\n" + std::string(100000, '1') + "\n2,0,0,0,0\n")).size(), 1u);
}

TEST(TimeFromIso, TakesDatesAndRefusesOthers) {
  EXPECT_EQ(time_from_iso("1970-01-01T00:00:01"), Time{std::chrono::seconds(1)});
  EXPECT_EQ(time_from_iso("2016-07-19 22:13:17.006010Z"), Time{std::chrono::microseconds(1468966397006010)});
  for (const char* bad :
       {"", "2024", "2024-02-30T00:00:00", "2024-01-01T24:00:00", "2024-01-01T00:00:00.", "2024-01-01T0-:00:00",
        "2024-01-01T00:00:00.1234567890", "2024-01-01T00:00:00+01", "99999-1-1T00:00:00"}) {
    EXPECT_FALSE(time_from_iso(bad)) << bad;
  }
}

class Events final : public Source {
 public:
  explicit Events(std::deque<Event> events) : events_(std::move(events)) {}
  std::optional<Event> next() override {
    if (events_.empty()) return std::nullopt;
    const Event first = events_.front();
    events_.pop_front();
    return first;
  }
  const SourceReport& report() const override { return report_; }

 private:
  std::deque<Event> events_;
  SourceReport report_;
};

TEST(MergeByTime, PutsFixesBeforeWhatTheyBelongTo) {
  const auto range = [](int t) {
    RangeReading r;
    r.time = Time{std::chrono::seconds(t)};
    return r;
  };
  const auto own = [](int t) { return Navigation{Time{std::chrono::seconds(t)}, {}, {}, {}}; };
  auto log = std::make_unique<Events>(std::deque<Event>{range(1), own(2), range(3), range(2), range(5)});
  auto merged =
      merge_by_time(std::move(log), track("t_s,x,y,z,heading_deg\n0,0,0,0,0\n3,0,0,0,0\nx\n4,0,0,0,0\n9,0,0,0,0\n"));
  std::string order;
  while (const auto event = merged->next()) {
    order += std::holds_alternative<Navigation>(*event) ? 'n' : 'r';
    order += std::to_string(time_of(*event).time_since_epoch() / std::chrono::seconds(1));
  }
  EXPECT_EQ(order, "n0r1n3r3r2n4r5n9");
  EXPECT_EQ(merged->report().rejected.at("fix of the log, replaced by the pose track"), 1u);
  EXPECT_EQ(merged->report().rejected.at(kBadPose), 1u);
}

}  // namespace
}  // namespace isobath
