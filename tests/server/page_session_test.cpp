// What a page is told and may do. The clock is the test's, the recording a list of moments; frames are read as
// docs/live-page.md has them, not by the code that wrote them.
#include <gmock/gmock.h>
#include <isobath/server/page_session.hpp>
#include <limits>
#include <nlohmann/json.hpp>
#include <set>
#include <tests/server/records.hpp>

namespace isobath {
namespace {

using nlohmann::json;
using test::of_kind;
using test::Record;
using test::records_of;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;

constexpr const char* kToken = "0123456789abcdef";
const Time kStart{Duration(1'600'000'000'000'000'000)};
Time at_s(double s) { return kStart + seconds(s); }

/// A moment a second from 0 to `last` s; at each the vehicle's item is its number, and a decision of that number comes.
class CountedPlayback final : public Playback {
 public:
  explicit CountedPlayback(int last) : last_(last) {}
  TimeSpan span() override { return {at_s(0), at_s(last_)}; }
  void show(Time moment, DisplayState& items) override {
    if (broken) throw Error("cut short");
    ++shows;
    const int now = number_of(moment);
    items.set(DisplayKind::kVehicle, 0, at_s(now), std::to_string(now));
    for (int i = 0; i <= last_; ++i) {
      if (i <= now) {
        items.set(DisplayKind::kDecision, static_cast<std::uint64_t>(i), at_s(i), "d");
      } else {
        items.remove(DisplayKind::kDecision, static_cast<std::uint64_t>(i), at_s(i));
      }
    }
  }
  Time step(Time from, int steps) override {
    const bool between = from != at_s(number_of(from));
    return at_s(std::clamp(number_of(from) + steps + (between && steps < 0 ? 1 : 0), 0, last_));
  }
  int shows = 0;
  bool broken = false;

 private:
  static int number_of(Time moment) { return static_cast<int>(to_seconds(moment - kStart)); }
  int last_;
};

/// A page, its sources and its clock.
struct Page {
  explicit Page(bool live, int recorded_s = -1) {
    sources.clock = [this] { return now; };
    sources.version = "v";
    if (live) {
      sources.live = std::make_shared<SharedChanges>(items);
      sources.live_span = [this] { return TimeSpan{at_s(0), live_now}; };
      sources.over = [this] { return over; };
    }
    if (recorded_s >= 0) {
      sources.open_playback = [this, recorded_s] {
        auto made = std::make_unique<CountedPlayback>(recorded_s);
        playback = made.get();
        return made;
      };
    }
    sources.token = kToken;
    sources.command = [this](PageCommand command, const std::string& /*by*/) {
      commands.push_back(command);
      return std::string(command == PageCommand::kResume ? "nothing is held" : "");
    };
    session = std::make_unique<PageSession>(sources);
  }
  Hearing ask(const json& request) { return session->on_message(request.dump()); }
  void pass(double s) { now += std::chrono::duration_cast<std::chrono::steady_clock::duration>(seconds(s)); }
  std::vector<Record> frame() { return records_of(session->next()); }
  /// The clock of a page that got all frames so far.
  json clock() {
    const auto clocks = of_kind(frame(), DisplayKind::kClock);
    if (!clocks.empty()) last_clock = json::parse(clocks.back().payload);
    return last_clock;
  }
  /// Why the last request was not followed; empty where it was.
  std::string refusal() {
    const auto refusals = of_kind(frame(), DisplayKind::kRefusal);
    return refusals.empty() ? "" : json::parse(refusals.back().payload).at("why").get<std::string>();
  }

  std::chrono::steady_clock::time_point now{std::chrono::hours(1)};
  Time live_now = at_s(100);
  bool over = false;
  DisplayState items;
  CountedPlayback* playback = nullptr;
  PageSources sources;
  std::vector<PageCommand> commands;
  std::unique_ptr<PageSession> session;
  json last_clock;
};

std::string vehicle_of(const std::vector<Record>& records) {
  const auto found = of_kind(records, DisplayKind::kVehicle);
  return found.empty() ? "" : found.back().payload;
}

TEST(PageSession, ARunIsToldWholeThenWhatChanges) {
  Page page(true);
  page.items.set(DisplayKind::kScene, 0, at_s(0), "{}");
  page.items.set(DisplayKind::kVehicle, 0, at_s(1), "a");
  const auto first = page.frame();
  ASSERT_THAT(first, SizeIs(3));
  EXPECT_TRUE(first[0].forget);
  EXPECT_EQ(first[2].kind, DisplayKind::kClock);
  EXPECT_THAT(page.frame(), IsEmpty());

  page.items.set(DisplayKind::kVehicle, 0, at_s(2), "b");
  page.items.set(DisplayKind::kVehicle, 0, at_s(3), "c");
  const auto next = page.frame();
  ASSERT_THAT(next, SizeIs(1));
  EXPECT_EQ(next[0].payload, "c");
  EXPECT_FALSE(next[0].forget);
}

TEST(PageSession, TheClockIsToldWhenItMoves) {
  Page page(true);
  EXPECT_EQ(page.clock(),
            json::parse(R"({"now_s": 100.0, "start_s": 100.0, "end_s": 100.0, "live": true, "live_s": 100.0,
      "playing": true, "speed": 1, "control": false, "version": "v"})"));
  EXPECT_THAT(page.frame(), IsEmpty());
  page.live_now = at_s(100.25);
  EXPECT_EQ(page.clock().at("now_s"), 100.25);
}

TEST(PageSession, AfterARunIsClearedTheClockIsToldAgain) {
  Page page(true);
  page.items.set(DisplayKind::kVehicle, 0, at_s(1), "a");
  page.frame();
  page.items.clear();
  page.items.set(DisplayKind::kVehicle, 0, at_s(0), "b");
  const auto records = page.frame();
  ASSERT_THAT(records, SizeIs(2));
  EXPECT_TRUE(records[0].forget);
  EXPECT_EQ(records[1].kind, DisplayKind::kClock);
}

TEST(PageSession, APageThatCannotTakeAllAtOnceGetsItInPieces) {
  Page page(true);
  for (std::uint64_t i = 0; i < 40; ++i) {
    page.items.set(DisplayKind::kDepth, i, at_s(0), std::string(100'000, static_cast<char>('a' + i)));
  }
  std::vector<Record> got;
  bool more = true;
  int frames = 0;
  while (more) {
    const WebFrame frame = page.session->next();
    EXPECT_LE(frame.bytes(), SharedChanges::kPieceBytes + 1000);
    more = frame.more;
    for (const Record& r : of_kind(records_of(frame), DisplayKind::kDepth)) got.push_back(r);
    // What changes meanwhile comes once, as it is in the end.
    if (++frames == 1) page.items.set(DisplayKind::kDepth, 39, at_s(1), "new");
  }
  ASSERT_THAT(got, SizeIs(40));
  EXPECT_EQ(frames, 4);
  for (std::uint64_t i = 0; i < 40; ++i) EXPECT_EQ(got[i].number, i);
  EXPECT_EQ(got[39].payload, "new");
  EXPECT_TRUE(got[0].forget);
  EXPECT_EQ(std::count_if(got.begin(), got.end(), [](const Record& r) { return r.forget; }), 1);
}

/// Voxels are most of the bytes: pages that do not show them get their cubes alone.
TEST(PageSession, VoxelsGoToThoseWhoAskAndAfterAllElse) {
  Page page(true);
  page.items.set(DisplayKind::kVoxels, 1, at_s(0), "block");
  page.items.set(DisplayKind::kCubes, 0, at_s(0), "cubes");
  page.items.set(DisplayKind::kVehicle, 0, at_s(0), "here");
  EXPECT_THAT(of_kind(page.frame(), DisplayKind::kCubes), SizeIs(1));
  EXPECT_THAT(page.frame(), IsEmpty());

  EXPECT_EQ(page.ask({{"ask", "detail"}, {"voxels", "all"}}).refused, "");
  const auto voxels = page.frame();
  ASSERT_THAT(voxels, SizeIs(1));
  EXPECT_EQ(voxels[0].payload, "block");
  EXPECT_TRUE(voxels[0].forget_kind) << "of what it had before some may be gone";
  EXPECT_FALSE(voxels[0].forget);
  EXPECT_THAT(page.frame(), IsEmpty());

  page.items.set(DisplayKind::kVoxels, 1, at_s(1), "block grown");
  page.items.set(DisplayKind::kVehicle, 0, at_s(1), "there");
  WebFrame first = page.session->next();
  EXPECT_THAT(of_kind(records_of(first), DisplayKind::kVehicle), SizeIs(1));
  EXPECT_THAT(of_kind(records_of(first), DisplayKind::kVoxels), IsEmpty());
  EXPECT_TRUE(first.more);
  const auto second = page.frame();
  ASSERT_THAT(second, SizeIs(1));
  EXPECT_EQ(second[0].payload, "block grown");
  EXPECT_FALSE(second[0].forget_kind);

  EXPECT_EQ(page.ask({{"ask", "detail"}, {"voxels", "cubes"}}).refused, "");
  page.items.set(DisplayKind::kVoxels, 1, at_s(2), "not told");
  EXPECT_THAT(page.frame(), IsEmpty());
  page.ask({{"ask", "detail"}, {"voxels", "all"}});
  EXPECT_THAT(page.frame(), SizeIs(1));
  EXPECT_EQ(page.ask({{"ask", "detail"}, {"voxels", "some"}}).refused, "ask");
}

TEST(PageSession, WhatIsNewHasItsTurnAmongManyVoxels) {
  Page page(true);
  for (std::uint64_t i = 0; i < 40; ++i) {
    page.items.set(DisplayKind::kVoxels, i, at_s(0), std::string(100'000, static_cast<char>('a' + i)));
  }
  page.ask({{"ask", "detail"}, {"voxels", "all"}});
  std::set<std::uint64_t> got;
  std::vector<DisplayKind> order;
  for (int i = 0; i < 20; ++i) {
    page.items.set(DisplayKind::kVehicle, 0, at_s(i), std::to_string(i));
    const WebFrame frame = page.session->next();
    EXPECT_LE(frame.bytes(), SharedChanges::kPieceBytes + 1000);
    if (frame.bytes() == 0) break;
    const auto records = records_of(frame);
    order.push_back(records.front().kind);
    for (const Record& r : of_kind(records, DisplayKind::kVoxels)) got.insert(r.number);
    if (!frame.more) break;
  }
  EXPECT_THAT(got, SizeIs(40));
  for (std::size_t i = 0; i < order.size(); ++i) {
    EXPECT_EQ(order[i], i % 2 == 0 ? DisplayKind::kVehicle : DisplayKind::kVoxels) << i;
  }
}

/// After a jump from now into the past nothing of now is left, voxels neither.
TEST(PageSession, AWholePictureHasItsVoxelsWholeToo) {
  Page page(true);
  page.items.set(DisplayKind::kVoxels, 1, at_s(0), "block");
  page.ask({{"ask", "detail"}, {"voxels", "all"}});
  while (!page.frame().empty()) continue;
  page.items.clear();
  page.items.set(DisplayKind::kVehicle, 0, at_s(0), "again");
  page.items.set(DisplayKind::kVoxels, 1, at_s(0), "block");
  EXPECT_TRUE(page.frame()[0].forget);
  EXPECT_THAT(of_kind(page.frame(), DisplayKind::kVoxels), SizeIs(1));
}

TEST(PageSession, ARecordingGoesWithTheClockTimesTheSpeed) {
  Page page(false, 50);
  EXPECT_EQ(vehicle_of(page.frame()), "0");
  page.pass(2);
  EXPECT_EQ(vehicle_of(page.frame()), "2");
  page.ask({{"ask", "speed"}, {"times", 4}});
  page.pass(1.5);
  EXPECT_EQ(vehicle_of(page.frame()), "8");
  EXPECT_EQ(page.last_clock, json());  // told by the frames before
  page.pass(0.25);
  const json clock = page.clock();
  EXPECT_EQ(clock.at("now_s"), 9.0);
  EXPECT_EQ(clock.at("start_s"), 0.0);
  EXPECT_EQ(clock.at("end_s"), 50.0);
  EXPECT_EQ(clock.at("speed"), 4.0);
  EXPECT_EQ(clock.at("live"), false);
  EXPECT_FALSE(clock.contains("live_s"));
}

TEST(PageSession, PausePlaySeekAndStep) {
  Page page(false, 50);
  page.ask({{"ask", "pause"}});
  page.pass(10);
  EXPECT_EQ(page.clock().at("now_s"), 0.0);
  page.ask({{"ask", "seek"}, {"to_s", 30.5}});
  page.pass(10);
  EXPECT_EQ(page.clock().at("now_s"), 30.5);  // pauses nothing, starts nothing
  page.ask({{"ask", "step"}, {"steps", -1}});
  EXPECT_EQ(page.clock().at("now_s"), 30.0);
  page.ask({{"ask", "step"}, {"steps", 2}});
  EXPECT_EQ(page.clock().at("now_s"), 32.0);
  page.ask({{"ask", "play"}});
  page.ask({{"ask", "seek"}, {"to_s", 10}});
  page.pass(1);
  EXPECT_EQ(page.clock().at("now_s"), 11.0);
  page.ask({{"ask", "step"}, {"steps", 1}});
  page.pass(5);
  EXPECT_EQ(page.clock().at("now_s"), 12.0);
  EXPECT_EQ(page.last_clock.at("playing"), false);
}

TEST(PageSession, WhatWasAskedForBetweenFramesIsLookedUpOnce) {
  Page page(false, 50);
  page.frame();
  const int before = page.playback->shows;
  for (int i = 0; i <= 20; ++i) page.ask({{"ask", "seek"}, {"to_s", 2 * i}});
  EXPECT_EQ(vehicle_of(page.frame()), "40");
  EXPECT_EQ(page.playback->shows, before + 1);
}

TEST(PageSession, GoingBackTakesAwayWhatWasNotYet) {
  Page page(false, 50);
  page.ask({{"ask", "seek"}, {"to_s", 5}});
  EXPECT_THAT(of_kind(page.frame(), DisplayKind::kDecision), SizeIs(6));
  page.ask({{"ask", "seek"}, {"to_s", 3}});
  const auto gone = of_kind(page.frame(), DisplayKind::kDecision);
  ASSERT_THAT(gone, SizeIs(2));
  EXPECT_TRUE(gone[0].gone && gone[1].gone);
}

TEST(PageSession, ARecordingStopsAtItsEndAndPlaysAgainFromItsStart) {
  Page page(false, 5);
  page.pass(100);
  EXPECT_EQ(page.clock().at("now_s"), 5.0);
  page.pass(1);
  EXPECT_EQ(page.clock().at("playing"), false);
  page.ask({{"ask", "play"}});
  page.pass(1);
  EXPECT_EQ(page.clock().at("now_s"), 1.0);
}

TEST(PageSession, SoughtBeyondTheEndsIsTheEnd) {
  Page page(false, 50);
  page.ask({{"ask", "pause"}});
  page.ask({{"ask", "seek"}, {"to_s", 1e9}});
  EXPECT_EQ(page.clock().at("now_s"), 50.0);
  page.ask({{"ask", "seek"}, {"to_s", -1e9}});
  EXPECT_EQ(page.clock().at("now_s"), 0.0);
  page.ask({{"ask", "step"}, {"steps", -1000}});
  EXPECT_EQ(page.clock().at("now_s"), 0.0);
}

TEST(PageSession, FromNowIntoWhatWasRecordedAndBack) {
  Page page(true, 90);
  page.items.set(DisplayKind::kVehicle, 0, at_s(100), "now");
  EXPECT_EQ(vehicle_of(page.frame()), "now");
  page.ask({{"ask", "seek"}, {"to_s", 20}});
  page.pass(3);
  const auto back = page.frame();
  EXPECT_TRUE(back.at(0).forget);
  EXPECT_EQ(vehicle_of(back), "23");
  page.items.set(DisplayKind::kVehicle, 0, at_s(101), "later");
  EXPECT_EQ(vehicle_of(page.frame()), "");  // it looks elsewhere
  page.pass(0.5);
  const json clock = page.clock();
  EXPECT_EQ(clock.at("live"), false);
  EXPECT_EQ(clock.at("live_s"), 100.0);
  EXPECT_EQ(clock.at("now_s"), 23.5);

  page.ask({{"ask", "live"}});
  const auto now = page.frame();
  EXPECT_TRUE(now.at(0).forget);
  EXPECT_EQ(vehicle_of(now), "later");
  EXPECT_EQ(json::parse(of_kind(now, DisplayKind::kClock).at(0).payload).at("live"), true);
}

TEST(PageSession, AtTheEndOfWhatIsRecordedOfARunItWaitsForMore) {
  Page page(true, 90);
  page.ask({{"ask", "seek"}, {"to_s", 89}});
  page.pass(10);
  EXPECT_EQ(page.clock().at("now_s"), 90.0);
  EXPECT_EQ(page.last_clock.at("playing"), true);
}

/// Nobody waits for news of a run that has ended: the page says so, and plays it from its start.
TEST(PageSession, ARunThatIsOverIsARecording) {
  Page page(true, 50);
  page.live_now = at_s(50);
  EXPECT_FALSE(page.clock().contains("over"));
  page.over = true;
  json clock = page.clock();
  EXPECT_EQ(clock.at("over"), true);
  EXPECT_EQ(clock.at("live"), true) << "its end is what is shown";
  EXPECT_EQ(clock.at("playing"), false);
  EXPECT_EQ(page.ask({{"ask", "play"}}).refused, "");
  page.pass(3);
  clock = page.clock();
  EXPECT_EQ(clock.at("now_s"), 3.0);
  EXPECT_EQ(clock.at("live"), false);
  EXPECT_EQ(clock.at("playing"), true);
  page.pass(60);
  clock = page.clock();
  EXPECT_EQ(clock.at("now_s"), 50.0);
  EXPECT_EQ(clock.at("playing"), false) << "no more will come";
  page.ask({{"ask", "live"}});
  EXPECT_EQ(page.clock().at("live"), true);

  Page unrecorded(true);
  unrecorded.over = true;
  EXPECT_EQ(unrecorded.ask({{"ask", "play"}}).refused, "no_recording");
}

TEST(PageSession, WhatIsEmptyIsForgottenToo) {
  Page page(true, 90);
  page.items.set(DisplayKind::kVehicle, 0, at_s(100), "now");
  page.frame();
  page.ask({{"ask", "pause"}});
  page.frame();
  page.items.clear();
  page.pass(1);
  page.ask({{"ask", "live"}});
  const auto records = page.frame();
  ASSERT_THAT(records, SizeIs(1));
  EXPECT_EQ(records[0].kind, DisplayKind::kClock);
  EXPECT_TRUE(records[0].forget);
}

TEST(PageSession, WithoutARecordingThereIsNothingToSeek) {
  Page page(true);
  for (const json& request : {json{{"ask", "seek"}, {"to_s", 1}}, json{{"ask", "pause"}},
                              json{{"ask", "step"}, {"steps", 1}}, json{{"ask", "speed"}, {"times", 2}}}) {
    EXPECT_EQ(page.ask(request).refused, "no_recording");
    EXPECT_NE(page.refusal(), "");
  }
  EXPECT_EQ(page.ask({{"ask", "play"}}).refused, "");
}

TEST(PageSession, ARecordingHasNoNow) {
  Page page(false, 5);
  EXPECT_EQ(page.ask({{"ask", "live"}}).refused, "no_now");
  EXPECT_THAT(page.refusal(), HasSubstr("no live view"));
}

TEST(PageSession, ARecordingThatCannotBeReadIsSaidOnceAndNotTriedAgain) {
  Page page(false, 50);
  page.frame();
  page.playback->broken = true;
  page.pass(1);
  EXPECT_EQ(page.refusal(), "cut short");
  page.pass(1);
  EXPECT_EQ(page.refusal(), "");
  page.playback->broken = false;
  page.ask({{"ask", "seek"}, {"to_s", 7}});
  EXPECT_EQ(vehicle_of(page.frame()), "7");
}

TEST(PageSession, CommandsNeedTheToken) {
  Page page(true);
  EXPECT_EQ(page.ask({{"ask", "command"}, {"command", "abort"}}).refused, "no_control");
  EXPECT_EQ(page.ask({{"ask", "control"}, {"token", kToken}}).refused, "");
  EXPECT_EQ(page.clock().at("control"), true);
  EXPECT_EQ(page.ask({{"ask", "command"}, {"command", "abort"}}).refused, "");
  EXPECT_EQ(page.ask({{"ask", "command"}, {"command", "hold"}}).refused, "");
  EXPECT_EQ(page.ask({{"ask", "command"}, {"command", "dive"}}).refused, "ask");
  EXPECT_EQ(page.ask({{"ask", "command"}, {"command", "resume"}}).refused, "command");
  EXPECT_EQ(page.refusal(), "nothing is held");
  EXPECT_THAT(page.commands, ElementsAre(PageCommand::kAbort, PageCommand::kHold, PageCommand::kResume));
}

TEST(PageSession, WrongTokensAreRefusedAndAFewHangUp) {
  Page page(true);
  const std::string token = kToken;
  for (const std::string& wrong : {token.substr(1), token + "0"}) {
    const Hearing hearing = page.ask({{"ask", "control"}, {"token", wrong}});
    EXPECT_EQ(hearing.refused, "token");
    EXPECT_FALSE(hearing.hang_up);
  }
  for (const Record& said : page.frame()) EXPECT_THAT(said.payload, testing::Not(HasSubstr(token.substr(1))));
  EXPECT_TRUE(page.ask({{"ask", "control"}, {"token", ""}}).hang_up);
  EXPECT_EQ(page.ask({{"ask", "command"}, {"command", "abort"}}).refused, "no_control");
}

TEST(PageSession, WithoutATokenNobodyCommands) {
  Page page(true);
  page.sources.token.clear();
  EXPECT_EQ(page.ask({{"ask", "control"}, {"token", ""}}).refused, "no_control");
  EXPECT_EQ(page.ask({{"ask", "command"}, {"command", "abort"}}).refused, "no_control");
  EXPECT_THAT(page.commands, IsEmpty());
}

TEST(PageSession, MalformedRequestsAreAnsweredAndCounted) {
  const char* const kBad[] = {"",
                              "play",
                              "[]",
                              "7",
                              "null",
                              "{}",
                              R"({"ask": 1})",
                              R"({"ask": "dance"})",
                              R"({"ask": "play", "now": 1})",
                              R"({"ask": "seek"})",
                              R"({"ask": "seek", "to_s": "1"})",
                              R"({"ask": "seek", "to_s": 1e999})",
                              R"({"ask": "seek", "to_s": NaN})",
                              R"({"ask": "speed", "times": 0})",
                              R"({"ask": "speed", "times": 101})",
                              R"({"ask": "step", "steps": 0.5})",
                              R"({"ask": "step", "steps": 99999999999})",
                              R"({"ask": "control", "token": ["0123456789abcdef"]})",
                              "{\"ask\": \"\xff\"}",
                              R"({"ask": "play"} {"ask": "play"})"};
  for (const char* bad : kBad) {
    Page page(false, 5);
    page.frame();
    const Hearing hearing = page.session->on_message(bad);
    EXPECT_EQ(hearing.refused, "ask") << bad;
    EXPECT_FALSE(hearing.hang_up);
    EXPECT_NE(page.refusal(), "") << bad;
  }
}

TEST(PageSession, ARefusalNamesTheRequestButNeverAtLength) {
  Page page(true);
  page.ask({{"ask", std::string(31, 'x') + "\xc3\xa9" + std::string(3000, 'y')}});
  const auto refusals = of_kind(page.frame(), DisplayKind::kRefusal);
  ASSERT_THAT(refusals, SizeIs(1));
  EXPECT_EQ(json::parse(refusals[0].payload).at("request"), std::string(31, 'x'));
}

TEST(PageSession, OnlySoManyAnswersWait) {
  Page page(true);
  for (int i = 0; i < 20; ++i) page.session->on_message("nonsense");
  EXPECT_THAT(of_kind(page.frame(), DisplayKind::kRefusal), SizeIs(PageSession::kMaxAnswers));
}

TEST(PageSession, TooMuchNonsenseHangsUpSomeIsForgiven) {
  Page slow(true);
  for (int i = 0; i < 100; ++i) {
    slow.pass(1.1);
    EXPECT_FALSE(slow.session->on_message("nonsense").hang_up);
  }
  Page fast(true);
  for (int i = 0; i < PageSession::kMaxRefusals; ++i) EXPECT_FALSE(fast.session->on_message("nonsense").hang_up);
  EXPECT_TRUE(fast.session->on_message("nonsense").hang_up);
}

TEST(PageSession, SourcesThatCannotWorkAreRefused) {
  EXPECT_THROW(check_page_sources({}), Error);
  Page page(true);
  EXPECT_NO_THROW(check_page_sources(page.sources));
  page.sources.token = "short";
  EXPECT_THROW(check_page_sources(page.sources), Error);
}

TEST(SharedChanges, WhoKeepsUpGetsTheVeryBytesOfTheOthers) {
  DisplayState items;
  SharedChanges changes(items);
  const auto now = SharedChanges::Clock::time_point(std::chrono::hours(1));
  items.set(DisplayKind::kVehicle, 0, at_s(0), "a");
  const auto one = changes.after(0, now);
  items.set(DisplayKind::kVehicle, 0, at_s(1), "b");  // while the others wait for their turn
  const auto two = changes.after(0, now + std::chrono::milliseconds(5));
  EXPECT_EQ(one.records, two.records);
  EXPECT_EQ(one.stamp, two.stamp);
  EXPECT_EQ(changes.encoded(), 1u);

  // A frame later all get what came between, once encoded.
  const auto later = now + std::chrono::milliseconds(100);
  EXPECT_EQ(records_of(*changes.after(one.stamp, later).records).at(0).payload, "b");
  EXPECT_EQ(changes.after(two.stamp, later).stamp, 2u);
  EXPECT_EQ(changes.encoded(), 2u);
  // Who comes new then is not given what was.
  EXPECT_EQ(records_of(*changes.after(0, later).records).at(0).payload, "b");
}

TEST(SharedChanges, AnItemThatAloneIsLargerThanAPieceGoesAlone) {
  DisplayState items;
  SharedChanges changes(items);
  const auto now = SharedChanges::Clock::time_point(std::chrono::hours(1));
  items.set(DisplayKind::kScene, 0, at_s(0), "{}");
  items.set(DisplayKind::kDepth, 0, at_s(0), std::string(3 << 20, 'x'));
  items.set(DisplayKind::kVehicle, 0, at_s(0), "a");
  std::vector<std::size_t> sizes;
  for (std::uint64_t stamp = 0; sizes.size() < 10;) {
    const auto piece = changes.after(stamp, now);
    sizes.push_back(records_of(*piece.records).size());
    stamp = piece.stamp;
    if (!piece.more) break;
  }
  EXPECT_THAT(sizes, ElementsAre(1, 1, 1));
}

TEST(SharedChanges, ForgettingIsToldEvenIfWhatCameAfterIsGoneAgain) {
  DisplayState items;
  items.set(DisplayKind::kVehicle, 0, at_s(0), "a");
  const std::uint64_t stamp = items.changes_after(0).stamp;
  items.clear();
  items.set(DisplayKind::kWay, 0, at_s(1), "w");
  items.remove(DisplayKind::kWay, 0, at_s(1));
  const auto nothing = items.changes_after(stamp);
  EXPECT_EQ(nothing.records, "");
  items.set(DisplayKind::kVehicle, 0, at_s(2), "b");
  EXPECT_TRUE(records_of(items.changes_after(nothing.stamp).records).at(0).forget);
}

}  // namespace
}  // namespace isobath
