// split_work: runs independent pieces of one job on a few threads.
#pragma once

#include <thread>
#include <vector>

namespace isobath {

/// Runs work(first, last) on parts of [0, count), one per thread, the calling thread included; returns when all are
/// done.
template <class Work>
void split_work(int count, int threads, const Work& work) {
  if (threads <= 1 || count < 2 * threads) return work(0, count);
  const auto edge = [count, threads](int t) { return static_cast<int>(static_cast<long>(count) * t / threads); };
  std::vector<std::jthread> others;
  for (int t = 1; t < threads; ++t) others.emplace_back([&work, &edge, t] { work(edge(t), edge(t + 1)); });
  work(0, edge(1));
}

}  // namespace isobath
