// Whoever tells a DisplayThread something goes on, whatever becomes of it.
#include <gtest/gtest.h>
#include <isobath/base/error.hpp>
#include <isobath/runtime/display_thread.hpp>
#include <latch>
#include <thread>
#include <vector>

namespace isobath {
namespace {

/// Holds the thread in its first note until it is let go.
class HeldThread {
 public:
  explicit HeldThread(DisplayThread& thread) {
    thread.take(DisplayThread::Kind::kNote, [this] {
      in_.count_down();
      let_go_.wait();
    });
    in_.wait();
  }
  void let_go() { let_go_.count_down(); }

 private:
  std::latch in_{1}, let_go_{1};
};

TEST(DisplayThread, DoesAllInOrder) {
  std::vector<int> done;
  DisplayThread thread;
  for (int i = 0; i < 200; ++i)
    thread.take(i % 3 == 0 ? DisplayThread::Kind::kPing : DisplayThread::Kind::kNote,
                [&done, i] { done.push_back(i); });
  thread.settle();
  ASSERT_EQ(done.size(), 200u);
  for (int i = 0; i < 200; ++i) EXPECT_EQ(done[static_cast<std::size_t>(i)], i);
  EXPECT_EQ(thread.left_out().pings + thread.left_out().notes, 0u);
}

// ledger: S6-31
TEST(DisplayThread, OfTooManyPingsTheOldestGiveWayAndNothingElse) {
  std::vector<int> pings, notes;
  DisplayThread thread;
  HeldThread held(thread);
  constexpr int kAll = static_cast<int>(DisplayThread::kMostPings) + 5;
  for (int i = 0; i < kAll; ++i) {
    thread.take(DisplayThread::Kind::kPing, [&pings, i] { pings.push_back(i); });
    thread.take(DisplayThread::Kind::kNote, [&notes, i] { notes.push_back(i); });
  }
  EXPECT_EQ(thread.left_out().pings, 5u);
  EXPECT_EQ(thread.left_out().notes, 0u);
  held.let_go();
  thread.settle();
  ASSERT_EQ(pings.size(), DisplayThread::kMostPings);
  EXPECT_EQ(pings.front(), 5);
  EXPECT_EQ(pings.back(), kAll - 1);
  EXPECT_EQ(notes.size(), static_cast<std::size_t>(kAll));
}

// ledger: S6-31
TEST(DisplayThread, AFullQueueLosesItsPingsFirstThenItsOldest) {
  constexpr int kMost = static_cast<int>(DisplayThread::kLongestQueue);
  int pings = 0;
  std::vector<int> notes;
  DisplayThread thread;
  HeldThread held(thread);
  for (int i = 0; i < 3; ++i) thread.take(DisplayThread::Kind::kPing, [&pings] { ++pings; });
  for (int i = 0; i < kMost + 10; ++i) thread.take(DisplayThread::Kind::kNote, [&notes, i] { notes.push_back(i); });
  EXPECT_EQ(thread.left_out().pings, 3u);
  EXPECT_EQ(thread.left_out().notes, 10u);
  held.let_go();
  thread.settle();
  EXPECT_EQ(pings, 0);
  ASSERT_EQ(notes.size(), static_cast<std::size_t>(kMost));
  EXPECT_EQ(notes.front(), 10) << "the newest stay";
  EXPECT_EQ(notes.back(), kMost + 9);
}

TEST(DisplayThread, WhereANoteFailsTheOthersGoOnAndItIsSaid) {
  int done = 0;
  DisplayThread thread;
  HeldThread held(thread);
  thread.take(DisplayThread::Kind::kNote, [] { throw Error("no room for the picture"); });
  thread.take(DisplayThread::Kind::kPing, [&done] { ++done; });
  held.let_go();
  thread.settle();
  EXPECT_NE(thread.problem().find("no room for the picture"), std::string::npos);
  thread.take(DisplayThread::Kind::kNote, [&done] { ++done; });
  thread.settle();
  EXPECT_EQ(done, 0);
  EXPECT_EQ(thread.left_out().pings, 1u);
  EXPECT_EQ(thread.left_out().notes, 2u);
}

TEST(DisplayThread, EndsWhenAllIsDoneAndTakesNothingMore) {
  int done = 0;
  DisplayThread thread;
  HeldThread held(thread);
  thread.take(DisplayThread::Kind::kNote, [&done] { ++done; });
  held.let_go();
  thread.close();
  EXPECT_EQ(done, 1);
  thread.take(DisplayThread::Kind::kNote, [&done] { ++done; });
  thread.settle();
  EXPECT_EQ(done, 1);
}

TEST(DisplayThread, AnyThreadMayTell) {
  constexpr int kEach = 500;
  int done = 0;
  DisplayThread thread;
  std::vector<std::thread> tellers;
  for (int t = 0; t < 4; ++t) {
    tellers.emplace_back([&] {
      for (int i = 0; i < kEach; ++i) thread.take(DisplayThread::Kind::kNote, [&done] { ++done; });
    });
  }
  for (std::thread& teller : tellers) teller.join();
  thread.settle();
  EXPECT_EQ(static_cast<std::uint64_t>(done) + thread.left_out().notes, 4u * kEach);
}

}  // namespace
}  // namespace isobath
