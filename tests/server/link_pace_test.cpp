// The window of a page against a link that is simulated: what waits on it, and how much of it is used.
#include <algorithm>
#include <gtest/gtest.h>
#include <isobath/base/time.hpp>
#include <isobath/server/link_pace.hpp>
#include <vector>

namespace isobath {
namespace {

using Clock = std::chrono::steady_clock;

/// A link with a rate and a time there and back. The sender fills the room that it has, in quarters of the window, ten
/// times a second and after each answer.
struct SimulatedLink {
  double rate, back_and_forth_s;
  LinkPace pace = {};
  double now = 0, free = 0;  ///< s; when the link has sent all
  std::uint64_t frame = 0;
  std::vector<std::pair<double, std::uint64_t>> answers = {};
  double sent = 0, longest_wait = 0;

  static Clock::time_point at(double s) {
    return Clock::time_point(std::chrono::duration_cast<Clock::duration>(seconds(1000 + s)));
  }
  void fill() {
    while (pace.room() > 0) {
      const auto bytes = std::max<std::size_t>(2048, std::min(pace.room(), pace.window() / 4));
      pace.on_sent(++frame, bytes, at(now));
      free = std::max(now, free) + static_cast<double>(bytes) / rate;
      longest_wait = std::max(longest_wait, free - now);
      sent += static_cast<double>(bytes);
      answers.emplace_back(free + back_and_forth_s, frame);
    }
  }
  void pass(double s) {
    sent = longest_wait = 0;
    for (const double end = now + s; now < end; now += 0.01) {
      bool answered = false;
      while (!answers.empty() && answers.front().first <= now) {
        pace.on_seen(answers.front().second, at(now));
        answers.erase(answers.begin());
        answered = true;
      }
      if (answered || static_cast<int>(now * 100) % 10 == 0) fill();
    }
  }
};

TEST(LinkPace, OnASlowLinkLittleWaitsAndMostOfItIsUsed) {
  SimulatedLink link{32e3, 0.6};
  link.pass(10);
  link.pass(60);
  EXPECT_LT(link.longest_wait, 0.9);
  EXPECT_GT(link.sent / 60, 0.7 * 32e3);
}

TEST(LinkPace, OnAFastLinkTheWindowOpensWithinASecond) {
  SimulatedLink link{50e6, 0.02};
  link.pass(1);
  EXPECT_GE(link.pace.window(), std::size_t{1} << 20);
}

TEST(LinkPace, ALinkThatBecomesSlowIsFollowed) {
  SimulatedLink link{5e6, 0.05};
  link.pass(5);
  link.rate = 32e3;
  link.pass(300);  // what was on its way has to go first
  link.pass(30);
  EXPECT_LT(link.longest_wait, 0.9);
}

TEST(LinkPace, NothingIsSentWhileThePageIsSilent) {
  LinkPace pace;
  std::uint64_t frame = 0;
  while (pace.room() > 0) pace.on_sent(++frame, 1000, {});
  EXPECT_EQ(frame, 17u);
  pace.on_seen(3, SimulatedLink::at(0));
  EXPECT_GT(pace.room(), 2000u);
}

/// A page may say what it likes.
TEST(LinkPace, AnAnswerToWhatWasNotSentChangesNothing) {
  LinkPace pace;
  pace.on_sent(5, 1000, {});
  const std::size_t room = pace.room();
  for (const std::uint64_t frame : {0, 4, 6}) pace.on_seen(frame, SimulatedLink::at(0));
  EXPECT_EQ(pace.room(), room);
  pace.on_seen(5, SimulatedLink::at(0));
  EXPECT_EQ(pace.room(), pace.window());
  pace.on_seen(5, SimulatedLink::at(0));
  EXPECT_EQ(pace.room(), pace.window());
}

}  // namespace
}  // namespace isobath
