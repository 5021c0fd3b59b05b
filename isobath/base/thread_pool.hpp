// ThreadPool: a few threads that wait for pieces of a job, for short jobs (milliseconds) that recur. Starting threads
// for each job would cost some 0.1 ms, and equal parts are not equal amounts of work. For longer jobs see
// split_work.hpp.
//
//   ThreadPool team(2);
//   team.share(blocks, 8, [&](int first, int last) { ... });  // on both threads; returns when all is done
//
// Each free thread takes the next piece, so a late thread or uneven pieces cost little time. Which thread runs a piece
// is not deterministic: the work must give the same result on any thread. It must not throw. Only one thread at a time
// may give jobs.
#pragma once

#include <atomic>
#include <thread>
#include <vector>

namespace isobath {

class ThreadPool {
 public:
  /// `threads` counts the thread that gives the jobs; with 1 or less it works alone.
  explicit ThreadPool(int threads);
  ThreadPool(const ThreadPool&) = delete;
  ThreadPool& operator=(const ThreadPool&) = delete;
  ~ThreadPool();

  [[nodiscard]] int threads() const { return 1 + static_cast<int>(others_.size()); }

  /// Calls work(first, last) on pieces of [0, count) of `piece` each; the last one may be smaller.
  template <class Work>
  void share(int count, int piece, const Work& work) {
    if (others_.empty() || count <= piece) {
      if (count > 0) work(0, count);
      return;
    }
    run_ = [](const void* job, int first, int last) { (*static_cast<const Work*>(job))(first, last); };
    job_ = &work;
    count_ = count;
    piece_ = piece;
    begin();
  }

 private:
  static constexpr int kOver = -1;
  void begin();
  void take_pieces();

  void (*run_)(const void* job, int first, int last) = nullptr;
  const void* job_ = nullptr;
  int count_ = 0, piece_ = 1, pieces_ = 0;
  alignas(64) std::atomic<int> untaken_{0};  ///< pieces that no thread has taken; kOver: no more will come
  alignas(64) std::atomic<int> undone_{0};   ///< pieces that are not finished
  std::vector<std::thread> others_;
};

}  // namespace isobath
