// What a paced page gets: it answers the frames, or not, and unpacks what comes by docs/live-page.md, with zlib.
#include <cstring>
#include <gmock/gmock.h>
#include <isobath/server/page_session.hpp>
#include <map>
#include <nlohmann/json.hpp>
#include <random>
#include <tests/server/records.hpp>
#include <zlib.h>

namespace isobath::paced_page {
namespace {

using nlohmann::json;
using test::of_kind;
using test::Record;
using test::records_of;
using testing::IsEmpty;
using testing::SizeIs;

Time at_s(double s) { return Time{Duration(1'600'000'000'000'000'000)} + seconds(s); }

std::string unpacked(const std::string& bytes) {
  std::string out(std::size_t{1} << 22, '\0');
  uLongf size = out.size();
  EXPECT_EQ(uncompress(reinterpret_cast<Bytef*>(out.data()), &size, reinterpret_cast<const Bytef*>(bytes.data()),
                       bytes.size()),
            Z_OK);
  out.resize(size);
  return out;
}

/// Bytes that no packing makes smaller.
std::string noise(std::size_t bytes, unsigned seed) {
  std::mt19937 random(seed);
  std::string out(bytes, '\0');
  for (char& c : out) c = static_cast<char>(random());
  return out;
}

/// A page of a run, its clock, and the slices that it has got.
struct PacedPage {
  PacedPage() {
    sources.live = std::make_shared<SharedChanges>(items);
    sources.live_span = [this] { return TimeSpan{at_s(0), at_s(run_s)}; };
    sources.clock = [this] { return now; };
    sources.version = "v";
    session = std::make_unique<PageSession>(sources, true);
  }
  /// The records of the next frame, unpacked; `bytes` of it is what the link carries.
  std::vector<Record> frame() {
    const WebFrame sent = session->next();
    bytes = sent.bytes();
    more = sent.more;
    std::vector<Record> records;
    for (const Record& r : records_of(sent)) {
      if (r.kind != DisplayKind::kPacked) {
        records.push_back(r);
        continue;
      }
      std::uint32_t head[2];
      std::memcpy(head, r.payload.data(), sizeof head);
      std::string& got = slices[r.number];
      if (head[0] == 0) got.clear();
      EXPECT_EQ(got.size(), head[0]) << "slices follow on one another";
      got += r.payload.substr(sizeof head);
      if (got.size() < head[1]) continue;
      for (const Record& inner : records_of(WebFrame{nullptr, unpacked(got)})) records.push_back(inner);
    }
    const auto clocks = of_kind(records, DisplayKind::kClock);
    if (!clocks.empty()) clock = json::parse(clocks.back().payload);
    return records;
  }
  Hearing see() { return session->on_message(json{{"ask", "seen"}, {"frame", clock.at("frame")}}.dump()); }
  void pass(double s) {
    now += std::chrono::duration_cast<std::chrono::steady_clock::duration>(seconds(s));
    run_s += s;
  }

  std::chrono::steady_clock::time_point now{std::chrono::hours(1)};
  double run_s = 100;
  DisplayState items;
  PageSources sources;
  std::unique_ptr<PageSession> session;
  std::map<std::uint64_t, std::string> slices;
  json clock;
  std::size_t bytes = 0;
  bool more = false;
};

TEST(PacedPage, EachFrameHasItsNumberAndTellsWhenItWasMadeAndWhatWasSeen) {
  PacedPage page;
  page.items.set(DisplayKind::kVehicle, 0, at_s(1), "here");
  const auto first = page.frame();
  ASSERT_THAT(first, SizeIs(2));
  EXPECT_EQ(first[0].kind, DisplayKind::kClock);
  EXPECT_TRUE(first[0].forget);
  EXPECT_FALSE(first[1].forget) << "once";
  EXPECT_EQ(page.clock.at("frame"), 1);
  EXPECT_EQ(page.clock.at("made_s"), 0.0);
  EXPECT_EQ(page.clock.at("seen"), -1.0);
  page.pass(0.7);
  EXPECT_EQ(page.see().refused, "");
  page.pass(0.3);
  page.items.set(DisplayKind::kVehicle, 0, at_s(2), "there");
  EXPECT_THAT(of_kind(page.frame(), DisplayKind::kVehicle), SizeIs(1));
  EXPECT_EQ(page.clock.at("frame"), 2);
  EXPECT_EQ(page.clock.at("made_s"), 1.0);
  EXPECT_EQ(page.clock.at("seen"), 1.0);
  EXPECT_EQ(page.clock.at("seen_s"), 0.7);
}

TEST(PacedPage, WithoutNewsAClockComesTwiceASecond) {
  PacedPage page;
  page.sources.over = [] { return true; };
  page.frame();
  page.see();
  page.now += std::chrono::milliseconds(400);
  EXPECT_THAT(page.frame(), IsEmpty());
  page.now += std::chrono::milliseconds(200);
  EXPECT_THAT(page.frame(), SizeIs(1));
  EXPECT_EQ(page.clock.at("made_s"), 0.6);
}

/// A page that takes nothing gets the newest of each item in the end, not what it missed.
TEST(PacedPage, WhatAPageDoesNotAnswerIsNotSentAndNotQueued) {
  PacedPage page;
  std::size_t sent = 0;
  for (int i = 0; i < 500; ++i) {
    page.pass(0.1);
    page.items.set(DisplayKind::kVehicle, 0, at_s(i), noise(72, static_cast<unsigned>(i)));
    page.frame();
    sent += page.bytes;
  }
  EXPECT_LT(sent, LinkPace::kFirstWindow + 2048);
  page.see();
  page.items.set(DisplayKind::kVehicle, 0, at_s(500), "newest");
  const auto vehicles = of_kind(page.frame(), DisplayKind::kVehicle);
  ASSERT_THAT(vehicles, SizeIs(1));
  EXPECT_EQ(vehicles[0].payload, "newest");
}

TEST(PacedPage, WhatIsActedOnGoesBetweenTheSlicesOfAPing) {
  PacedPage page;
  const std::string ping = noise(200'000, 1);
  page.items.set(DisplayKind::kEchoes, 0, at_s(0), ping);
  int frames = 0;
  std::vector<Record> echoes;
  while (echoes.empty() && frames < 1000) {
    page.items.set(DisplayKind::kVehicle, 0, at_s(frames), std::to_string(frames));
    const auto records = page.frame();
    EXPECT_LT(page.bytes, LinkPace::kFirstWindow);
    EXPECT_THAT(of_kind(records, DisplayKind::kVehicle), SizeIs(1));
    EXPECT_FALSE(page.clock.contains("maps_s")) << "samples are not complete";
    echoes = of_kind(records, DisplayKind::kEchoes);
    ++frames;
    page.pass(4.0 * static_cast<double>(page.bytes) / 32e3);  // the link is slow, and the window stays small
    page.see();
  }
  EXPECT_GT(frames, 10);
  ASSERT_THAT(echoes, SizeIs(1));
  EXPECT_EQ(echoes[0].payload, ping);
  page.frame();
  EXPECT_TRUE(page.clock.contains("maps_s"));
}

TEST(PacedPage, AfterARunIsClearedItIsForgottenOnce) {
  PacedPage page;
  page.items.set(DisplayKind::kVehicle, 0, at_s(0), "a");
  page.items.set(DisplayKind::kDepth, 7, at_s(0), "tile");
  EXPECT_THAT(of_kind(page.frame(), DisplayKind::kDepth), SizeIs(1));
  page.see();
  page.items.clear();
  page.items.set(DisplayKind::kDepth, 8, at_s(1), "another");
  page.pass(0.1);
  int forgets = 0;
  for (int i = 0; i < 3; ++i) {
    for (const Record& r : page.frame()) forgets += r.forget ? 1 : 0;
    page.see();
    page.pass(0.1);
  }
  EXPECT_EQ(forgets, 1);
}

TEST(PacedPage, OnAFastLinkItGetsWhatAllPagesGet) {
  PacedPage page;
  bool unpacked_ones = false;
  for (int i = 0; i < 200 && !unpacked_ones; ++i) {
    page.items.set(DisplayKind::kDepth, 0, at_s(i), noise(500'000, static_cast<unsigned>(i)));
    do {
      const WebFrame sent = page.session->next();
      if (sent.bytes() == 0) break;
      unpacked_ones = !of_kind(records_of(sent), DisplayKind::kDepth).empty();
      page.more = sent.more;
    } while (page.more && !unpacked_ones);
    page.pass(0.01);
    page.session->on_message(json{{"ask", "seen"}, {"frame", i + 1}}.dump());
  }
  EXPECT_TRUE(unpacked_ones);
}

TEST(PacedPage, OnlyAPacedPageAnswers) {
  PacedPage page;
  PageSession other(page.sources);
  EXPECT_EQ(other.on_message(R"({"ask": "seen", "frame": 1})").refused, "ask");
  for (const char* frame : {"-1", "0.5", "1e20", "\"1\""}) {
    EXPECT_EQ(page.session->on_message(std::string(R"({"ask": "seen", "frame": )") + frame + "}").refused, "ask");
  }
}

}  // namespace
}  // namespace isobath::paced_page
