// Who gives a TaskThread something to do goes on, whatever becomes of it.
#include <gtest/gtest.h>
#include <isobath/base/error.hpp>
#include <isobath/base/task_thread.hpp>
#include <latch>
#include <thread>
#include <vector>

namespace isobath {
namespace {

constexpr TaskThread::Bounds kBounds{.pings = 256, .all = 4096};

/// Holds the thread in its first task until it is let go.
class HeldThread {
 public:
  explicit HeldThread(TaskThread& thread) {
    thread.push(TaskThread::Kind::kNote, [this] {
      in_.count_down();
      let_go_.wait();
    });
    in_.wait();
  }
  void let_go() { let_go_.count_down(); }

 private:
  std::latch in_{1}, let_go_{1};
};

TEST(TaskThread, DoesAllInOrder) {
  std::vector<int> done;
  TaskThread thread(kBounds);
  for (int i = 0; i < 200; ++i)
    thread.push(i % 3 == 0 ? TaskThread::Kind::kPing : TaskThread::Kind::kNote, [&done, i] { done.push_back(i); });
  thread.settle();
  ASSERT_EQ(done.size(), 200u);
  for (int i = 0; i < 200; ++i) EXPECT_EQ(done[static_cast<std::size_t>(i)], i);
  EXPECT_EQ(thread.left_out().pings + thread.left_out().notes, 0u);
}

// ledger: S6-31
TEST(TaskThread, OfTooManyPingsTheOldestGiveWayAndNothingElse) {
  std::vector<int> pings, notes;
  TaskThread thread(kBounds);
  HeldThread held(thread);
  constexpr int kAll = static_cast<int>(kBounds.pings) + 5;
  for (int i = 0; i < kAll; ++i) {
    thread.push(TaskThread::Kind::kPing, [&pings, i] { pings.push_back(i); });
    thread.push(TaskThread::Kind::kNote, [&notes, i] { notes.push_back(i); });
  }
  EXPECT_EQ(thread.left_out().pings, 5u);
  EXPECT_EQ(thread.left_out().notes, 0u);
  held.let_go();
  thread.settle();
  ASSERT_EQ(pings.size(), kBounds.pings);
  EXPECT_EQ(pings.front(), 5);
  EXPECT_EQ(pings.back(), kAll - 1);
  EXPECT_EQ(notes.size(), static_cast<std::size_t>(kAll));
}

// ledger: S6-31
TEST(TaskThread, AFullQueueLosesItsPingsFirstThenItsOldest) {
  constexpr int kMax = static_cast<int>(kBounds.all);
  int pings = 0;
  std::vector<int> notes;
  TaskThread thread(kBounds);
  HeldThread held(thread);
  for (int i = 0; i < 3; ++i) thread.push(TaskThread::Kind::kPing, [&pings] { ++pings; });
  for (int i = 0; i < kMax + 10; ++i) thread.push(TaskThread::Kind::kNote, [&notes, i] { notes.push_back(i); });
  EXPECT_EQ(thread.left_out().pings, 3u);
  EXPECT_EQ(thread.left_out().notes, 10u);
  held.let_go();
  thread.settle();
  EXPECT_EQ(pings, 0);
  ASSERT_EQ(notes.size(), static_cast<std::size_t>(kMax));
  EXPECT_EQ(notes.front(), 10) << "the newest stay";
  EXPECT_EQ(notes.back(), kMax + 9);
}

// A queue whose notes must stay grows by them. ledger: S6-31
TEST(TaskThread, WhereNotesMustStayOnlyPingsGiveWay) {
  std::vector<int> pings, notes;
  TaskThread thread({.pings = 6, .all = 6, .keep_notes = true});
  HeldThread held(thread);
  for (int i = 0; i < 3; ++i) thread.push(TaskThread::Kind::kPing, [&pings, i] { pings.push_back(i); });
  for (int i = 0; i < 20; ++i) thread.push(TaskThread::Kind::kNote, [&notes, i] { notes.push_back(i); });
  EXPECT_EQ(thread.left_out().pings, 3u);
  EXPECT_EQ(thread.left_out().notes, 0u);
  thread.push(TaskThread::Kind::kPing, [&pings] { pings.push_back(3); });
  held.let_go();
  thread.settle();
  EXPECT_EQ(pings, std::vector<int>{3});
  EXPECT_EQ(notes.size(), 20u);
}

TEST(TaskThread, WhereANoteFailsTheOthersGoOnAndItIsSaid) {
  int done = 0;
  TaskThread thread(kBounds);
  HeldThread held(thread);
  thread.push(TaskThread::Kind::kNote, [] { throw Error("no room for the picture"); });
  thread.push(TaskThread::Kind::kPing, [&done] { ++done; });
  held.let_go();
  thread.settle();
  EXPECT_NE(words_of(thread.failure()).find("no room for the picture"), std::string::npos);
  EXPECT_THROW(thread.check(), Error);
  thread.push(TaskThread::Kind::kNote, [&done] { ++done; });
  thread.settle();
  EXPECT_EQ(done, 0);
  EXPECT_EQ(thread.left_out().pings, 1u);
  EXPECT_EQ(thread.left_out().notes, 2u);
}

TEST(TaskThread, EndsWhenAllIsDoneAndTakesNothingMore) {
  int done = 0;
  TaskThread thread(kBounds);
  HeldThread held(thread);
  thread.push(TaskThread::Kind::kNote, [&done] { ++done; });
  held.let_go();
  thread.close();
  EXPECT_EQ(done, 1);
  thread.push(TaskThread::Kind::kNote, [&done] { ++done; });
  thread.settle();
  EXPECT_EQ(done, 1);
}

TEST(TaskThread, AnyThreadMayTell) {
  constexpr int kEach = 500;
  int done = 0;
  TaskThread thread(kBounds);
  std::vector<std::thread> tellers;
  for (int t = 0; t < 4; ++t) {
    tellers.emplace_back([&] {
      for (int i = 0; i < kEach; ++i) thread.push(TaskThread::Kind::kNote, [&done] { ++done; });
    });
  }
  for (std::thread& teller : tellers) teller.join();
  thread.settle();
  EXPECT_EQ(static_cast<std::uint64_t>(done) + thread.left_out().notes, 4u * kEach);
}

}  // namespace
}  // namespace isobath
