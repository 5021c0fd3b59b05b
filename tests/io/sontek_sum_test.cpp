#include <algorithm>
#include <gmock/gmock.h>
#include <isobath/io/formats/sontek_sum.hpp>
#include <isobath/io/open_source.hpp>
#include <map>
#include <numbers>
#include <tests/io/bytes_by_hand.hpp>
#include <tests/io/survey_events.hpp>
#include <tests/support/data.hpp>

namespace isobath {
namespace {

using test::drain;
using test::in_memory;
using test::only;
using test::soundings;
using testing::HasSubstr;
using testing::Pair;
using testing::UnorderedElementsAre;

const std::string kHeading =
    "Sample #,Date/Time,Frequency (MHz),Profile Type,Depth (m),Latitude (deg),Longitude (deg),Heading (deg),Pitch "
    "(deg),Roll (deg),BT Depth (m),VB Depth (m),BT Beam1 Depth (m),BT Beam2 Depth (m),BT Beam3 Depth (m),BT Beam4 "
    "Depth (m),Track (m),DMG (m),Mean Speed (m/s),Boat Speed (m/s),Direction (deg),Boat Direction (deg)";

/// Date and time, latitude, longitude, attitude, five depths: the vertical one first.
struct Sample {
  std::string time = "1/17/2025 4:03:47 PM";
  std::string latitude = " 52\xb0 20' 32.37\"";
  std::string longitude = " 12\xb0 59' 54.16\"";
  std::string attitude = "273.4,-0.2,2.0";
  std::string vertical = "6.27";
  std::string slant = "6.59,6.29,5.97,6.22";

  [[nodiscard]] std::string line(const std::string& end = "\r") const {
    return "1," + time + ",1MHz,IC,6.27," + latitude + "," + longitude + "," + attitude + ",6.23," + vertical + "," +
           slant + ",0.08,0.08,0.072,0.077,70.1,6.8" + end;
  }
};

std::unique_ptr<Source> sum(const std::string& lines, InputConfig config = {}, const std::string& end = "\r") {
  return open_sontek_sum(in_memory(kHeading + end + lines), config);
}

std::string iso(const std::vector<Event>& events) { return to_text(time_of(events.at(0))); }

TEST(SontekSum, ASampleIsAFixAndFiveReadings) {
  const auto events = drain(*sum(Sample{}.line()));
  ASSERT_EQ(events.size(), 6u);
  const Navigation& fix = std::get<Navigation>(events[0]);
  EXPECT_EQ(to_text(fix.time), "2025-01-17T16:03:47.000Z");
  EXPECT_EQ(fix.X_WB.translation, Eigen::Vector3d::Zero());
  EXPECT_NEAR(fix.X_WB.rotation.heading().wrapped_positive().degrees(), 273.4, 1e-9);
  EXPECT_NEAR(fix.X_WB.rotation.pitch().degrees(), -0.2, 1e-9);
  EXPECT_NEAR(fix.X_WB.rotation.roll().degrees(), 2, 1e-9);
  ASSERT_TRUE(fix.covariance);
  EXPECT_DOUBLE_EQ((*fix.covariance)(0, 0), 1);
  for (std::size_t i = 1; i < 6; ++i) EXPECT_EQ(time_of(events[i]), fix.time);
}

TEST(SontekSum, ReadingsEndAtTheRecordedDepthsWhateverTheAttitude) {
  for (const char* attitude : {"0,0,0", "273.4,-0.2,2.0", "45,20,-15", "181.5,-8,30"}) {
    for (const double draught : {0.0, 0.07, 0.5}) {
      InputConfig config;
      config.survey.transducer_depth_m = draught;
      Sample sample;
      sample.attitude = attitude;
      const auto found = soundings(drain(*sum(sample.line(), config)));
      ASSERT_EQ(found.size(), 5u);
      const double depth[] = {6.27, 6.59, 6.29, 5.97, 6.22};
      for (std::size_t i = 0; i < 5; ++i) EXPECT_NEAR(found[i].bottom.z(), depth[i], 1e-12);
    }
  }
}

TEST(SontekSum, SlantBeamsLean25DegreesCounterClockwiseFromPortBow) {
  Sample sample;
  sample.attitude = "90,0,0";  // bow to the east
  sample.vertical = "10";
  sample.slant = "10,10,10,10";
  const auto found = soundings(drain(*sum(sample.line())));
  ASSERT_EQ(found.size(), 5u);
  const double lean = 10 * std::tan(25 * std::numbers::pi / 180) * std::sqrt(0.5);
  EXPECT_TRUE(found[0].bottom.isApprox(Eigen::Vector3d(0, 0, 10), 1e-12));
  EXPECT_TRUE(found[1].bottom.isApprox(Eigen::Vector3d(lean, lean, 10), 1e-12)) << "port bow";
  EXPECT_TRUE(found[2].bottom.isApprox(Eigen::Vector3d(lean, -lean, 10), 1e-12)) << "port quarter";
  EXPECT_TRUE(found[3].bottom.isApprox(Eigen::Vector3d(-lean, -lean, 10), 1e-12)) << "starboard quarter";
  EXPECT_TRUE(found[4].bottom.isApprox(Eigen::Vector3d(-lean, lean, 10), 1e-12)) << "starboard bow";
}

TEST(SontekSum, LinesEndInAnyWay) {
  for (const std::string end : {"\r", "\n", "\r\n"}) {
    const auto source = sum(Sample{}.line(end) + Sample{}.line(end), {}, end);
    EXPECT_EQ(drain(*source).size(), 12u);
    EXPECT_EQ(source->report().bytes_skipped, 0u);
    EXPECT_EQ(source->report().bytes_read, source->report().bytes_total);
    EXPECT_TRUE(looks_like_sontek_sum(bytes_of(kHeading + end + Sample{}.line(end))));
  }
}

TEST(SontekSum, TwelveHourClockAndOffset) {
  const std::vector<std::pair<std::string, std::string>> times{{"1/2/2025 12:00:00 AM", "2025-01-02T00:00:00.000Z"},
                                                               {"1/2/2025 12:30:00 PM", "2025-01-02T12:30:00.000Z"},
                                                               {"12/31/2024 11:59:59 PM", "2024-12-31T23:59:59.000Z"},
                                                               {"1/2/2025 16:03:47", "2025-01-02T16:03:47.000Z"}};
  for (const auto& [text, expected] : times) {
    Sample sample;
    sample.time = text;
    EXPECT_EQ(iso(drain(*sum(sample.line()))), expected);
  }
  InputConfig config;
  config.survey.utc_offset_h = 1;
  EXPECT_EQ(iso(drain(*sum(Sample{}.line(), config))), "2025-01-17T15:03:47.000Z");
}

// ledger: S1-64
TEST(SontekSum, DepthZeroIsNoLockAndNoReading) {
  Sample sample;
  sample.vertical = "0.00";
  sample.slant = "6.59,0.00,5.97,0.00";
  const auto source = sum(sample.line());
  EXPECT_EQ(soundings(drain(*source)).size(), 2u);
  EXPECT_THAT(source->report().rejected,
              UnorderedElementsAre(Pair("no lock of the vertical beam", 1), Pair("no lock of a slant beam", 2)));
}

TEST(SontekSum, SamplesWithoutTimeOrPositionAreCounted) {
  std::string lines = Sample{}.line();
  for (const char* bad : {"", "17.1.2025 16:03:47", "13/1/2025 4:03:47 PM", "1/17/2025 13:03:47 PM",
                          "2/30/2025 4:03:47 PM", "1/17/2025 4:61:47 PM", "-1/17/2025 4:03:47 PM"}) {
    Sample sample;
    sample.time = bad;
    lines += sample.line();
  }
  for (const char* bad : {"", "52\xb0 61' 0\"", "91\xb0 0' 0\"", "1 2 3 4", "1..2\xb0 0' 0\"", "-\xb0"}) {
    Sample sample;
    sample.latitude = bad;
    lines += sample.line();
  }
  Sample no_fix;
  no_fix.latitude = no_fix.longitude = " 0\xb0  0'  0.00\"";
  Sample tumbling;
  tumbling.attitude = "1,2,170";
  const auto source = sum(lines + no_fix.line() + tumbling.line());
  EXPECT_EQ(drain(*source).size(), 6u);
  EXPECT_THAT(source->report().rejected, UnorderedElementsAre(Pair("sample without a readable time", 7),
                                                              Pair("sample without a valid position", 7),
                                                              Pair("sample with an impossible attitude", 1)));
  EXPECT_EQ(source->report().bytes_skipped, 0u);
}

TEST(SontekSum, DamagedLinesCostThemselves) {
  for (const std::string bad : {"x\r", "1,2,3\r", "1,1/17/2025 4:03:47 PM,1MHz,IC,6\r"}) {
    const auto source = sum(Sample{}.line() + bad + Sample{}.line());
    EXPECT_EQ(drain(*source).size(), 12u) << bad;
    ASSERT_EQ(source->report().damages.size(), 1u);
    EXPECT_EQ(source->report().damages[0].bytes, bad.size());
  }
  Sample wrong;
  wrong.slant = "6.59,nan,5.97,6,22";
  const auto source = sum(wrong.line());
  EXPECT_TRUE(drain(*source).empty());
  EXPECT_EQ(source->report().damages.size(), 1u);
}

TEST(SontekSum, HemispheresAndRoundedSeconds) {
  Sample north, south;
  north.latitude = "52\xb0 20' 60.00\"";  // 59.996 as it is written
  south.latitude = "-52\xb0 20' 30\"";
  south.longitude = "12\xb0 59' 54.16\" W";
  const auto a = sum(north.line()), b = sum(south.line());
  drain(*a);
  drain(*b);
  EXPECT_NEAR(a->report().origin->latitude_deg, 52.35, 1e-12);
  EXPECT_NEAR(b->report().origin->latitude_deg, -(52 + 20.5 / 60), 1e-12);
  EXPECT_NEAR(b->report().origin->longitude_deg, -(12 + 59 / 60.0 + 54.16 / 3600), 1e-12);
}

TEST(SontekSum, FeetAndMissingColumnsAreErrors) {
  const auto error = [](std::string text) {
    try {
      open_sontek_sum(in_memory(std::move(text)), {});
    } catch (const Error& e) {
      return std::string(e.what());
    }
    return std::string("opened");
  };
  std::string feet = kHeading;
  for (std::size_t at = 0; (at = feet.find("(m)", at)) != std::string::npos;) feet.replace(at, 3, "(ft)");
  EXPECT_THAT(error(feet + "\r"), HasSubstr("depths in feet; export it"));
  EXPECT_THAT(error("Sample #,Date/Time,VB Depth (m)\r"), HasSubstr("heading without the column \"Latitude (deg)\""));
}

// Real: sixteen runs on a lake. 30983 samples, of which two have no vertical and two no slant depth.
TEST(SontekSum, RealRunHasItsFirstRecordExactly) {
  ISOBATH_NEEDS_DATA(folder, "lake-caputh-m9");
  const auto source = open_source(folder / "20250117160335.sum", {});
  EXPECT_EQ(source->report().format, "SonTek .sum");
  const auto events = drain(*source);
  EXPECT_EQ(only<Navigation>(events).size(), 408u);
  const auto found = soundings(events);
  ASSERT_EQ(found.size(), 5u * 408);
  const double depth[] = {6.27, 6.59, 6.29, 5.97, 6.22};
  for (std::size_t i = 0; i < 5; ++i) EXPECT_NEAR(found[i].bottom.z(), depth[i], 1e-12);
  EXPECT_NEAR(source->report().origin->latitude_deg, 52 + 20 / 60.0 + 32.37 / 3600, 1e-12);
  EXPECT_NEAR(source->report().origin->longitude_deg, 12 + 59 / 60.0 + 54.16 / 3600, 1e-12);
  EXPECT_EQ(source->report().bytes_skipped, 0u);
}

/// What one sample with all five beams says about the slope of the bottom.
struct Slopes {
  Eigen::Vector2d place;
  Time time;
  Angle heading;
  double depth = 0;      ///< by the vertical beam
  double ahead = 0;      ///< down to the bow by the slant beams, metres a metre
  double starboard = 0;  ///< down to starboard by the slant beams
  double on_track = 0;   ///< down to the bow by the vertical beam, over six seconds
};

std::vector<Slopes> slopes_of(const std::vector<test::Sounding>& all) {
  std::vector<Slopes> samples;
  for (std::size_t i = 0; i + 4 < all.size(); ++i) {
    if (all[i].reading.X_BS.rotation.pitch().degrees() > -80 || all[i + 4].fix.time != all[i].fix.time) continue;
    const Navigation& fix = all[i].fix;
    const Pose X_LW = level(fix.X_WB).inverse();
    double ahead = 0, starboard = 0, arms_x = 0, arms_y = 0;
    for (std::size_t beam = 1; beam <= 4; ++beam) {
      const Eigen::Vector3d p = X_LW * all[i + beam].bottom;
      ahead += p.x() > 0 ? p.z() : -p.z();
      starboard += p.y() > 0 ? p.z() : -p.z();
      arms_x += std::abs(p.x());
      arms_y += std::abs(p.y());
    }
    samples.push_back({fix.X_WB.translation.head<2>(), fix.time, fix.X_WB.rotation.heading(), all[i].bottom.z(),
                       ahead / arms_x, starboard / arms_y, 0});
  }
  std::vector<Slopes> whole;
  for (std::size_t i = 3; i + 3 < samples.size(); ++i) {
    const Slopes &before = samples[i - 3], &after = samples[i + 3];
    const Eigen::Vector2d bow(cos(samples[i].heading), sin(samples[i].heading));
    const double way = (after.place - before.place).dot(bow);
    if (after.time - before.time != std::chrono::seconds(6) || way < 2 || samples[i].depth < 1.2) continue;
    whole.push_back(samples[i]);
    whole.back().on_track = (after.depth - before.depth) / way;
  }
  return whole;
}

/// Of pairs, each clipped to 0.4: far ones are fish and weed.
double correlation(const std::vector<std::pair<double, double>>& pairs) {
  double ab = 0, aa = 0, bb = 0;
  for (const auto& [x, y] : pairs) {
    const double a = std::clamp(x, -0.4, 0.4), b = std::clamp(y, -0.4, 0.4);
    ab += a * b;
    aa += a * a;
    bb += b * b;
  }
  return ab / std::sqrt(aa * bb);
}

// The mapping of beams to directions is right if bow and stern beams show the slope that the boat then goes down, and
// if port and starboard beams show the slope that it goes down where its tracks cross at right angles. A beam on the
// wrong side would turn the sign.
TEST(SontekSum, SlantBeamsOfARealSurveyShowTheSlopesThatTheVerticalBeamFindsAlongTheTracks) {
  ISOBATH_NEEDS_DATA(folder, "lake-caputh-m9");
  InputConfig config;
  config.survey.only = "20250117*, 20250130*";
  const auto samples = slopes_of(soundings(drain(*open_source(folder, config))));
  std::vector<std::pair<double, double>> along, across;
  std::multimap<std::pair<int, int>, const Slopes*> cells;  // of 4 m
  const auto cell = [](double x) { return static_cast<int>(std::floor(x / 4)); };
  for (const Slopes& s : samples) {
    along.emplace_back(s.on_track, s.ahead);
    cells.emplace(std::pair(cell(s.place.x()), cell(s.place.y())), &s);
  }
  for (const Slopes& s : samples) {
    const auto [first, last] = cells.equal_range({cell(s.place.x()), cell(s.place.y())});
    for (auto at = first; at != last; ++at) {
      const double turn = (s.heading - at->second->heading).wrapped().degrees();
      if (std::abs(std::abs(turn) - 90) > 25) continue;
      across.emplace_back(turn > 0 ? s.on_track : -s.on_track, at->second->starboard);
    }
  }
  ASSERT_GT(along.size(), 5000u);
  ASSERT_GT(across.size(), 500u);
  EXPECT_GT(correlation(along), 0.6);
  EXPECT_GT(correlation(across), 0.5);
}

}  // namespace
}  // namespace isobath
