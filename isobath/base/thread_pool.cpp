#include <algorithm>
#include <isobath/base/thread_pool.hpp>

namespace isobath {

ThreadPool::ThreadPool(int threads) {
  for (int t = 1; t < threads; ++t) {
    others_.emplace_back([this] {
      while (untaken_.load(std::memory_order_acquire) != kOver) {
        take_pieces();
        untaken_.wait(0, std::memory_order_acquire);
      }
    });
  }
}

ThreadPool::~ThreadPool() {
  untaken_.store(kOver, std::memory_order_release);
  untaken_.notify_all();
  for (std::thread& other : others_) other.join();
}

void ThreadPool::begin() {
  pieces_ = (count_ + piece_ - 1) / piece_;
  undone_.store(pieces_, std::memory_order_relaxed);
  untaken_.store(pieces_, std::memory_order_release);  // from here on every thread may take pieces
  untaken_.notify_all();
  take_pieces();
  for (int left = undone_.load(std::memory_order_acquire); left != 0; left = undone_.load(std::memory_order_acquire)) {
    undone_.wait(left, std::memory_order_acquire);
  }
}

/// A thread reads the job only while it holds a piece of it: until that piece is done, the thread that gave the job
/// waits and the job does not change.
void ThreadPool::take_pieces() {
  int untaken = untaken_.load(std::memory_order_relaxed);
  while (untaken > 0) {
    if (!untaken_.compare_exchange_weak(untaken, untaken - 1, std::memory_order_acq_rel, std::memory_order_relaxed)) {
      continue;
    }
    const int first = (pieces_ - untaken) * piece_;
    run_(job_, first, std::min(first + piece_, count_));
    if (undone_.fetch_sub(1, std::memory_order_acq_rel) == 1) undone_.notify_one();
    untaken = untaken_.load(std::memory_order_relaxed);
  }
}

}  // namespace isobath
