// A run as its report carries it: bounded, nothing lost that must not be, and shown again as it was.
#include <cmath>
#include <gtest/gtest.h>
#include <isobath/display/live_page.hpp>
#include <isobath/report/embedded_replay.hpp>
#include <isobath/report/html_report.hpp>
#include <random>
#include <stdexcept>
#include <tests/support/embedded_run.hpp>

namespace isobath {
namespace {

using Kind = DisplayKind;
using test::as_map;
using test::Block;
using test::blocks_of;
using test::from_base64;
using test::number_at;
using test::Record;
using test::records_of;
using Items = std::map<std::pair<DisplayKind, std::uint64_t>, std::string>;

/// What a page knows that was shown all blocks up to a moment, or that begins at the last whole one before it.
Items shown_at(const std::vector<Block>& blocks, Time time, bool from_whole) {
  std::size_t end = 0, begin = 0;
  while (end < blocks.size() && blocks[end].time <= time) ++end;
  for (std::size_t i = 0; from_whole && i < end; ++i) begin = blocks[i].whole ? i : begin;
  Items items;
  for (std::size_t i = begin; i < end; ++i) {
    for (const Record& r : blocks[i].records) {
      if (r.forget) items.clear();
      if (r.gone) {
        items.erase({r.kind, r.number});
      } else {
        items[{r.kind, r.number}] = r.payload;
      }
    }
  }
  return items;
}

/// Of a film: all but what real clocks measured.
Items film_of(const DisplayState& items) {
  Items all = as_map(items.changes_after(0).records);
  std::erase_if(all, [](const auto& item) { return item.first.first == Kind::kTimes; });
  return all;
}

std::string noise(std::mt19937& random, std::size_t bytes) {
  std::string out(bytes, '\0');
  for (char& c : out) c = static_cast<char>(random());
  return out;
}

/// A run that shows a bit of everything, ten times a second.
struct Voyage {
  ReportConfig config;
  std::size_t echo_bytes = 2000;
  double lasts_s = 120;

  DisplayState items;
  std::map<Time, Items> was;  ///< at each moment
  std::string film;
  std::size_t max_replaced = 0;  ///< ever

  static Time at(double t) { return Time(seconds(1000 + t)); }

  EmbeddedReplay& play(EmbeddedReplay& run_film) {
    std::mt19937 random(3);
    std::string chunk;
    int decisions = 0;
    const int steps = static_cast<int>(std::lround(10 * lasts_s));
    for (int i = 0; i <= steps; ++i) {
      const Time time = at(0.1 * i);
      if (i == 0) items.set(Kind::kScene, 0, time, "a lake </script>\"");
      items.set(Kind::kVehicle, 0, time, noise(random, 72));
      items.set(Kind::kEchoes, 7, time, noise(random, echo_bytes));
      items.set(Kind::kTimes, 0, time, noise(random, 40));
      if (i % 10 == 0) {
        const int place = i / 10;
        if (place % 64 == 0) chunk.clear();
        chunk += noise(random, 16);
        items.set(Kind::kTrack, static_cast<std::uint64_t>(place / 64), time, chunk);
      }
      if (i % 37 == 0) items.set(Kind::kDecision, static_cast<std::uint64_t>(decisions++), time, noise(random, 90));
      if (i % 23 == 0) items.set(Kind::kVoxels, random() % 8, time, noise(random, 50));
      if (i % 23 == 0) items.set(Kind::kCubes, 0, time, noise(random, 20));
      if (i % 41 == 0) items.remove(Kind::kVoxels, random() % 8, time);
      run_film.sample(time, items);
      max_replaced = std::max(max_replaced, run_film.replaced());
      was[time] = film_of(items);
    }
    film = run_film.finish(at(lasts_s), items);
    return run_film;
  }
};

TEST(EmbeddedReplay, EndsWithAllThatTheDisplayHolds) {
  Voyage voyage;
  EmbeddedReplay film(voyage.config);
  voyage.play(film);
  const auto blocks = blocks_of(voyage.film);
  ASSERT_FALSE(blocks.empty());
  EXPECT_EQ(blocks.front().time, Voyage::at(0));
  EXPECT_EQ(blocks.back().time, Voyage::at(120));
  EXPECT_TRUE(blocks.front().whole);
  EXPECT_EQ(shown_at(blocks, Voyage::at(120), false), film_of(voyage.items));
}

TEST(EmbeddedReplay, ShowsEachMomentThatItTookAsItWas) {
  Voyage voyage;
  EmbeddedReplay film(voyage.config);
  voyage.play(film);
  EXPECT_EQ(film.interval_s(Kind::kEchoes), 0.5) << "nothing of this run had to be left out";
  const auto blocks = blocks_of(voyage.film);
  EXPECT_EQ(blocks.size(), 241U);
  for (const Block& block : blocks) {
    EXPECT_EQ(shown_at(blocks, block.time, false), voyage.was.at(block.time));
  }
}

TEST(EmbeddedReplay, GoingBackToAWholeBlockShowsTheSameAsPlayingToIt) {
  Voyage voyage;
  EmbeddedReplay film(voyage.config);
  voyage.play(film);
  const auto blocks = blocks_of(voyage.film);
  std::size_t whole = 0, bytes_since = 0, bytes_whole = 0;
  for (const Block& block : blocks) {
    EXPECT_EQ(shown_at(blocks, block.time, true), shown_at(blocks, block.time, false));
    std::size_t bytes = 0;
    for (const Record& r : block.records) bytes += 24 + r.payload.size();
    whole += block.whole ? 1 : 0;
    bytes_since = block.whole ? 0 : bytes_since + bytes;
    bytes_whole = block.whole ? bytes : bytes_whole;
    EXPECT_LT(bytes_since, 2 * EmbeddedReplay::kWholeAfter * bytes_whole) << "who jumps must not read all before";
  }
  EXPECT_GT(whole, 10U);
  EXPECT_LT(whole, blocks.size() / 2);
}

TEST(EmbeddedReplay, BeyondItsBoundEchoesBecomeRareAndThePlacesOfTheVehicleStay) {
  Voyage voyage;
  voyage.config.replay_mb = 0.1;
  EmbeddedReplay film(voyage.config);
  voyage.play(film);
  EXPECT_LE(voyage.max_replaced, film.max_replaced());
  EXPECT_LE(voyage.film.size(), 100'000U);
  EXPECT_GE(film.interval_s(Kind::kEchoes), 2);
  EXPECT_EQ(film.interval_s(Kind::kVehicle), 0.5);
  const auto blocks = blocks_of(voyage.film);
  EXPECT_EQ(shown_at(blocks, Voyage::at(120), false), film_of(voyage.items)) << "the end is whole";
}

// Each item as it was then, or as it was before the stretch of its kind began.
TEST(EmbeddedReplay, OfWhatWasLeftOutAMomentShowsWhatWasAStretchBefore) {
  Voyage voyage;
  voyage.config.replay_mb = 0.03;
  EmbeddedReplay film(voyage.config);
  voyage.play(film);
  ASSERT_GT(film.interval_s(Kind::kVehicle), 0.5) << "this one thins more than echoes";
  const auto blocks = blocks_of(voyage.film);
  std::size_t as_before = 0;
  for (double t = 0; t <= 120; t += 0.5) {
    const Items shown = shown_at(blocks, Voyage::at(t), false);
    const Items& was = voyage.was.at(Voyage::at(t));
    std::set<std::pair<DisplayKind, std::uint64_t>> keys;
    for (const auto& [key, payload] : shown) keys.insert(key);
    for (const auto& [key, payload] : was) keys.insert(key);
    const auto in = [](const Items& items, const auto& key) {
      const auto found = items.find(key);
      return found == items.end() ? std::string("not there") : found->second;
    };
    for (const auto& key : keys) {
      if (in(shown, key) == in(was, key)) continue;
      const double interval_s = film.interval_s(key.first);
      const double stretch_s = interval_s * std::floor(t / interval_s);
      const Items& before = voyage.was.at(Voyage::at(std::max(0.0, stretch_s - voyage.config.replay_s)));
      EXPECT_EQ(in(shown, key), in(before, key)) << "kind " << static_cast<int>(key.first) << " at " << t;
      ++as_before;
    }
  }
  EXPECT_GT(as_before, 100U);
}

TEST(EmbeddedReplay, LosesNoDecisionAndNoPlaceOfTheTrackHoweverSmall) {
  Voyage voyage;
  voyage.config.replay_mb = 0.03;
  EmbeddedReplay film(voyage.config);
  voyage.play(film);
  const auto blocks = blocks_of(voyage.film);
  const Items end = shown_at(blocks, Voyage::at(120), false);
  std::size_t decisions = 0, places = 0;
  for (const auto& [key, payload] : end) {
    decisions += key.first == Kind::kDecision ? 1 : 0;
    places += key.first == Kind::kTrack ? payload.size() / 16 : 0;
  }
  EXPECT_EQ(decisions, 33U);
  EXPECT_EQ(places, 121U);
  // each decision at the moment that first could show it
  for (const Block& block : blocks) {
    for (const Record& r : block.records) {
      if (r.kind != Kind::kDecision || block.whole) continue;
      EXPECT_LT(block.time - r.time, seconds(0.5));
    }
  }
}

TEST(EmbeddedReplay, IsNoneWhereItsEndAloneIsTooMuch) {
  Voyage voyage;
  voyage.config.replay_mb = 0.03;
  voyage.echo_bytes = 40'000;
  voyage.lasts_s = 20;
  EmbeddedReplay film(voyage.config);
  voyage.play(film);
  EXPECT_EQ(voyage.film, "");
  EXPECT_LE(voyage.max_replaced, film.max_replaced());
}

TEST(EmbeddedReplay, TheSameRunGivesTheSameBytesWhateverRealClocksMeasured) {
  Voyage one, other;
  EmbeddedReplay first(one.config), second(other.config);
  one.play(first);
  other.items.set(Kind::kTimes, 1, Voyage::at(0), "3.1 ms");
  other.items.set(Kind::kClock, 0, Voyage::at(0), "live");
  other.play(second);
  EXPECT_EQ(one.film, other.film);
  EXPECT_EQ(from_base64(one.film).substr(0, 10), std::string("\x1f\x8b\x08\0\0\0\0\0\0\xff", 10))
      << "no time, no system";
}

TEST(EmbeddedReplay, WhatWasForgottenIsGoneFromThere) {
  DisplayState items;
  EmbeddedReplay film(ReportConfig{});
  items.set(Kind::kScene, 0, Voyage::at(0), "a lake");
  items.set(Kind::kWay, 0, Voyage::at(0), "north");
  film.sample(Voyage::at(0), items);
  items.clear();
  items.set(Kind::kScene, 0, Voyage::at(3), "a river");
  film.sample(Voyage::at(3), items);
  const auto blocks = blocks_of(film.finish(Voyage::at(4), items));
  EXPECT_EQ(shown_at(blocks, Voyage::at(2), false).size(), 2U);
  const Items end{{{Kind::kScene, 0}, "a river"}};
  EXPECT_EQ(shown_at(blocks, Voyage::at(4), false), end);
  EXPECT_EQ(shown_at(blocks, Voyage::at(4), true), end);
}

TEST(EmbeddedReplay, WhatComesAfterTheLastEventIsOfItsTime) {
  DisplayState items;
  EmbeddedReplay film(ReportConfig{});
  items.set(Kind::kScene, 0, Voyage::at(0), "a lake");
  film.sample(Voyage::at(0), items);
  items.set(Kind::kWay, 0, Voyage::at(1), "north");
  film.sample(Voyage::at(1), items);
  items.set(Kind::kObstacles, 0, Voyage::at(1), "a rock");
  const auto blocks = blocks_of(film.finish(Voyage::at(1), items));
  ASSERT_EQ(blocks.size(), 2U) << "two blocks of one time would stop who steps back";
  EXPECT_EQ(shown_at(blocks, Voyage::at(1), false), film_of(items));
}

/// What is told again at the time of the last sample replaces what that sample had, however much must be left out.
TEST(EmbeddedReplay, OfAnItemToldTwiceAtTheEndTheLaterStays) {
  std::mt19937 random(5);
  DisplayState items;
  ReportConfig config;
  config.replay_mb = 0.01;
  EmbeddedReplay film(config);
  for (int i = 0; i <= 100; ++i) {
    items.set(Kind::kWay, 0, Voyage::at(i), noise(random, 2000));
    film.sample(Voyage::at(i), items);
  }
  items.set(Kind::kWay, 0, Voyage::at(100), noise(random, 1000));
  const auto blocks = blocks_of(film.finish(Voyage::at(100), items));
  EXPECT_EQ(shown_at(blocks, Voyage::at(100), false), film_of(items));
}

TEST(EmbeddedReplay, OfNothingThereIsNone) {
  DisplayState items;
  EmbeddedReplay film(ReportConfig{});
  film.sample(Voyage::at(0), items);
  EXPECT_EQ(film.finish(Voyage::at(1), items), "");
}

TEST(PageWithRecording, HoldsItWhereThePageHasThePlace) {
  EXPECT_EQ(page_with_recording("<body><!-- recording: here --><p>", "AAAA"),
            "<body><script type=\"application/octet-stream+base64\" id=\"isobath-recording\">AAAA</script><p>");
  EXPECT_THROW(static_cast<void>(page_with_recording("<body><p>", "AAAA")), std::logic_error);
  if (live_page().empty()) GTEST_SKIP() << "built without its page";
  EXPECT_NO_THROW(static_cast<void>(page_with_recording(live_page(), "AAAA")));
}

// ledger: S5-59
TEST(HtmlReport, APageInsideStaysInItsAttribute) {
  const std::string nasty = "<p title=\"a\">&quot;</iframe></script><script>alert('1')</script>";
  HtmlReport report("t", "l");
  const std::size_t plain = report.html().size();
  report.page_inside("\"><b>", nasty, "<i>words</i>");
  const std::string html = report.html();
  const std::size_t begin = html.find("srcdoc=\"") + 8, end = html.find('"', begin);
  std::string inside = html.substr(begin, end - begin);
  const std::pair<const char*, const char*> kEscapes[] = {
      {"&lt;", "<"}, {"&gt;", ">"}, {"&quot;", "\""}, {"&amp;", "&"}};
  for (const auto& [escape, plainly] : kEscapes) {
    for (std::size_t at = 0; (at = inside.find(escape, at)) != std::string::npos; ++at)
      inside.replace(at, std::string(escape).size(), plainly);
  }
  EXPECT_EQ(inside, nasty);
  EXPECT_EQ(html.find("<script"), std::string::npos);
  EXPECT_EQ(html.find("<b>"), std::string::npos);
  EXPECT_EQ(html.find("<i>"), std::string::npos);
  EXPECT_NE(html.find("<iframe title=\"&quot;&gt;&lt;b&gt;\" sandbox=\"allow-scripts\""), std::string::npos);
  EXPECT_GT(html.size(), plain);
}

}  // namespace
}  // namespace isobath
