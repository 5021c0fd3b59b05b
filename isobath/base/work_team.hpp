// WorkTeam: a few threads that wait for pieces of a job, for jobs of milliseconds that come again and again. (Starting
// threads for each costs some 0.1 ms, and equal parts are not equally much work: see split_work.hpp for longer ones.)
//
//   WorkTeam team(2);
//   team.share(blocks, 8, [&](int first, int last) { ... });  // on both threads; returns when all is done
//
// Whoever is free takes the next piece, so that it takes no longer than it must where a thread is late or pieces
// differ; which thread does a piece is chance, so that work must give the same whoever does it. Work must not throw.
// One thread at a time gives jobs.
#pragma once

#include <atomic>
#include <thread>
#include <vector>

namespace isobath {

class WorkTeam {
 public:
  /// As many threads as this, the one that gives the jobs among them; 1 (or less): that one alone.
  explicit WorkTeam(int threads);
  WorkTeam(const WorkTeam&) = delete;
  WorkTeam& operator=(const WorkTeam&) = delete;
  ~WorkTeam();

  [[nodiscard]] int threads() const { return 1 + static_cast<int>(others_.size()); }

  /// Calls work(first, last) on pieces of [0, count) of `piece` each, the last one perhaps smaller.
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
  alignas(64) std::atomic<int> untaken_{0};  ///< pieces; kOver: there will be none
  alignas(64) std::atomic<int> undone_{0};   ///< pieces that are not finished
  std::vector<std::thread> others_;
};

}  // namespace isobath
