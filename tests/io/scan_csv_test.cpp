#include <gmock/gmock.h>
#include <isobath/io/formats/scan_csv.hpp>
#include <isobath/io/open_source.hpp>
#include <set>
#include <tests/io/bytes_by_hand.hpp>
#include <tests/support/data.hpp>

namespace isobath {
namespace {

using test::drain;
using test::in_memory;

const std::string kHeading = "# t_s,head_deg,bin_m,nbins,i0,i1,...\n";

std::unique_ptr<Source> scans(const std::string& lines) { return open_scan_csv(in_memory(kHeading + lines), {}); }

TEST(ScanCsv, ALineIsAPing) {
  const auto source = scans("10.5,90,0.0125,3,0,7,255\r\n10.54,91.8,0.0125,3,1,2,3");
  const auto events = drain(*source);
  ASSERT_EQ(events.size(), 2u);
  const Ping& ping = std::get<Ping>(events[0]);
  EXPECT_EQ(check(ping), PingFault::kNone);
  EXPECT_EQ(ping.time, Time{seconds(10.5)});
  EXPECT_NEAR(ping.fan->azimuth[0].degrees(), 90, 1e-12);
  EXPECT_EQ(ping.window, (RangeWindow{0, 0.0125, 3}));
  EXPECT_THAT(test::beam(ping), testing::ElementsAre(0, 7, 255));
  EXPECT_THAT(test::beam(std::get<Ping>(events[1])), testing::ElementsAre(1, 2, 3));
}

TEST(ScanCsv, DamagedLinesCostThemselves) {
  const std::string good = "1,90,0.0125,3,0,7,255\n";
  for (const std::string bad :
       {"x\n", "1,90,0.0125\n", "1,90,0.0125,3,0,7\n", "1,90,0.0125,3,0,7,8,9\n", "1,90,0.0125,3,0,7,256\n",
        "1,90,0.0125,3,0,,7\n", "1,90,0.0125,3,0,7,-1\n", "nan,90,0.0125,3,0,7,1\n", "1,inf,0.0125,3,0,7,1\n",
        "1,90,0,3,0,7,1\n", "1,90,-0.1,3,0,7,1\n", "1,90,0.1,0\n", "1,90,0.1,2147483648,1\n",
        "1e300,90,0.1,3,1,2,3\n"}) {
    const auto source = scans(good + bad + good);
    EXPECT_EQ(drain(*source).size(), 2u) << bad;
    ASSERT_EQ(source->report().damages.size(), 1u) << bad;
    EXPECT_EQ(source->report().damages[0].offset, kHeading.size() + good.size());
    EXPECT_EQ(source->report().damages[0].bytes, bad.size());
  }
}

TEST(ScanCsv, FirstLineThatPromises2To31BinsIsAnError) {
  try {
    scans("1,90,0.0125,2147483648,0,7,255\n");
    FAIL();
  } catch (const Error& e) {
    EXPECT_THAT(e.what(), testing::HasSubstr("nbins: the first line states 2147483648 bins; allowed: 1 .. 65536"));
  }
  EXPECT_THROW(scans(""), Error);
}

// Real: 4100 pings of a head that turns in a tank, 200 bearings a turn.
TEST(ScanCsv, RealTankHasAllItsPings) {
  ISOBATH_NEEDS_DATA(folder, "msis-tank");
  const auto source = open_source(folder / "msis-tank-rev00-20.csv", {});
  int pings = 0;
  Time last{};
  std::set<const BeamFan*> fans;
  std::vector<std::shared_ptr<const BeamFan>> keep;
  while (const auto event = source->next()) {
    const Ping& ping = std::get<Ping>(*event);
    ASSERT_EQ(check(ping), PingFault::kNone);
    ASSERT_EQ(ping.window.bins, 399);
    ASSERT_DOUBLE_EQ(ping.window.bin_m, 0.01253133);
    ASSERT_GT(ping.time, last);
    last = ping.time;
    if (fans.insert(ping.fan.get()).second) keep.push_back(ping.fan);
    ++pings;
  }
  EXPECT_EQ(pings, 4100);
  EXPECT_EQ(fans.size(), 200u);
  EXPECT_EQ(source->report().bytes_skipped, 0u);
  EXPECT_EQ(source->report().bytes_read, source->report().bytes_total);
}

}  // namespace
}  // namespace isobath
