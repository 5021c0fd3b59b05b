#include <gtest/gtest.h>
#include <isobath/report/html_report.hpp>
#include <isobath/report/plot/picture.hpp>
#include <isobath/run/prefetch.hpp>
#include <isobath/studies/inspection.hpp>
#include <tests/support/events.hpp>

namespace isobath {
namespace {

using test::ListSource;
using test::ping_at;

std::vector<Event> many(int count) {
  std::vector<Event> events;
  for (int i = 0; i < count; ++i) events.emplace_back(ping_at(0.1 * i));
  return events;
}

TEST(PrefetchSource, GivesTheSameEventsInTheSameOrder) {
  PrefetchSource source(std::make_unique<ListSource>(many(1000)));
  for (int i = 0; i < 1000; ++i) {
    const auto event = source.next();
    ASSERT_TRUE(event);
    EXPECT_EQ(time_of(*event), Time(seconds(0.1 * i)));
  }
  EXPECT_FALSE(source.next());
  EXPECT_EQ(source.report().bytes_read, 1000u);
}

TEST(PrefetchSource, StopsWhenItIsLeftEarly) {
  PrefetchSource source(std::make_unique<ListSource>(many(5000)));
  EXPECT_TRUE(source.next());
}

TEST(Inspection, CountsRatesGapsAndStepsBack) {
  auto events = many(100);
  events.emplace_back(ping_at(30));
  events.emplace_back(ping_at(29));
  ListSource source(events);
  const Inspection facts = inspect(source);
  ASSERT_EQ(facts.streams.size(), 1u);
  const StreamFacts& pings = facts.streams[0];
  EXPECT_EQ(pings.events, 102u);
  EXPECT_NEAR(pings.median_interval_s, 0.1, 1e-6);
  EXPECT_EQ(pings.gaps, 1u);
  EXPECT_NEAR(pings.longest_gap_s, 20.1, 1e-6);
  EXPECT_EQ(pings.backwards, 1u);
  ASSERT_EQ(facts.geometries.size(), 1u);
  EXPECT_EQ(facts.geometries[0].bins, 4);
  EXPECT_EQ(facts.intensity_max, 4);
}

TEST(HtmlReport, IsSelfContainedAndEscapesUntrustedText) {
  HtmlReport report("a <b>", "c & d");
  report.table({"k"}, {{"<script>"}});
  report.figure(
      "\x89PN"
      "G",
      "picture");
  const std::string html = report.html();
  EXPECT_EQ(html.find("<script>"), std::string::npos);
  EXPECT_NE(html.find("&lt;script&gt;"), std::string::npos);
  EXPECT_NE(html.find("data:image/png;base64,iVBO"), std::string::npos);
  EXPECT_EQ(html.find("http"), std::string::npos) << "nothing is fetched";
}

TEST(Picture, TicksAreRoundAndCoverTheRange) {
  EXPECT_EQ(ticks(0, 10, 5), (std::vector<double>{0, 2, 4, 6, 8, 10}));
  EXPECT_TRUE(ticks(1, 1, 5).empty());
}

TEST(Picture, SameDrawingSameBytes) {
  const auto draw = [] {
    PlanPicture p({-1, 1, -1, 1}, 100, {"t", "u", "r"});
    p.raster([](double x, double y) { return intensity_colour(x * y); });
    p.vehicle({0, 0}, 1);
    p.finish({{palette::kObstacle, "obstacle"}});
    return p.png();
  };
  EXPECT_EQ(draw(), draw());
}

}  // namespace
}  // namespace isobath
