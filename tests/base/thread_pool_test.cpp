// ThreadPool: every piece of every job is done once, by the time the job returns, whoever does it and however late.
#include <array>
#include <atomic>
#include <chrono>
#include <gmock/gmock.h>
#include <isobath/base/thread_pool.hpp>
#include <numeric>
#include <thread>
#include <vector>

namespace isobath {
namespace {

TEST(ThreadPool, DoesEachPieceOfEachJobOnce) {
  for (const int threads : {0, 1, 2, 3, 7}) {
    ThreadPool pool(threads);
    EXPECT_EQ(pool.threads(), std::max(1, threads));
    for (const int count : {0, 1, 5, 8, 9, 64, 1000}) {
      for (const int piece : {1, 3, 8, 2000}) {
        std::vector<int> done(static_cast<std::size_t>(count), 0);  // each written by one thread alone
        pool.share(count, piece, [&](int first, int last) {
          EXPECT_LE(last - first, threads > 1 ? piece : count);
          for (int i = first; i < last; ++i) ++done[static_cast<std::size_t>(i)];
        });
        EXPECT_THAT(done, testing::Each(1)) << threads << " threads, " << count << " by " << piece;
      }
    }
  }
}

// Thousands of jobs too short for anybody to wake up for: none is done twice, none is left.
TEST(ThreadPool, GoesFromJobToJobWithoutLosingAny) {
  ThreadPool pool(3);
  std::array<std::atomic<int>, 10> done{};
  for (int job = 0; job < 3000; ++job) {
    pool.share(10, 1, [&](int first, int) { done[static_cast<std::size_t>(first)].fetch_add(job); });
  }
  for (const auto& sum : done) EXPECT_EQ(sum, 3000 * 2999 / 2);
}

// What one thread alone could not end: two pieces that wait for each other.
TEST(ThreadPool, WorksOnSeveralPiecesAtOnce) {
  ThreadPool pool(2);
  std::atomic<int> there{0};
  pool.share(2, 1, [&](int, int) {
    ++there;
    while (there < 2) std::this_thread::yield();
  });
  EXPECT_EQ(there, 2);
}

TEST(ThreadPool, EndsWithoutEverHavingWorked) {
  const ThreadPool pool(4);
  EXPECT_EQ(pool.threads(), 4);
}

}  // namespace
}  // namespace isobath
