// WorkTeam: every piece of every job is done once, by the time the job returns, whoever does it and however late.
#include <array>
#include <atomic>
#include <chrono>
#include <gmock/gmock.h>
#include <isobath/base/work_team.hpp>
#include <numeric>
#include <thread>
#include <vector>

namespace isobath {
namespace {

TEST(WorkTeam, DoesEachPieceOfEachJobOnce) {
  for (const int threads : {0, 1, 2, 3, 7}) {
    WorkTeam team(threads);
    EXPECT_EQ(team.threads(), std::max(1, threads));
    for (const int count : {0, 1, 5, 8, 9, 64, 1000}) {
      for (const int piece : {1, 3, 8, 2000}) {
        std::vector<int> done(static_cast<std::size_t>(count), 0);  // each written by one thread alone
        team.share(count, piece, [&](int first, int last) {
          EXPECT_LE(last - first, threads > 1 ? piece : count);
          for (int i = first; i < last; ++i) ++done[static_cast<std::size_t>(i)];
        });
        EXPECT_THAT(done, testing::Each(1)) << threads << " threads, " << count << " by " << piece;
      }
    }
  }
}

// Thousands of jobs too short for anybody to wake up for: none is done twice, none is left.
TEST(WorkTeam, GoesFromJobToJobWithoutLosingAny) {
  WorkTeam team(3);
  std::array<std::atomic<int>, 10> done{};
  for (int job = 0; job < 3000; ++job) {
    team.share(10, 1, [&](int first, int) { done[static_cast<std::size_t>(first)].fetch_add(job); });
  }
  for (const auto& sum : done) EXPECT_EQ(sum, 3000 * 2999 / 2);
}

// What one thread alone could not end: two pieces that wait for each other.
TEST(WorkTeam, WorksOnSeveralPiecesAtOnce) {
  WorkTeam team(2);
  std::atomic<int> there{0};
  team.share(2, 1, [&](int, int) {
    ++there;
    while (there < 2) std::this_thread::yield();
  });
  EXPECT_EQ(there, 2);
}

TEST(WorkTeam, EndsWithoutEverHavingWorked) {
  const WorkTeam team(4);
  EXPECT_EQ(team.threads(), 4);
}

}  // namespace
}  // namespace isobath
