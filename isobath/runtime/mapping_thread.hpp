// MappingThread: what is done with events, in a thread of its own: planning never blocks it, and it never blocks
// whoever senses (design: live, mapping runs in its own thread; ledger S6-31).
//
//   MappingThread mapping([&](Event event, auto) { pipeline.take(std::move(event)); });
//   mapping.take(event);            // at once; in order
//   mapping.settle();               // all that was taken is done
//
// A queue that is full loses its oldest ping; navigation, ranges and health reports are never lost. take and settle
// belong to one thread; what `work` touches is that thread's again after settle, until the next take. Where `work`
// throws, nothing more is done, and the next take or settle throws the same.
#pragma once

#include <chrono>
#include <condition_variable>
#include <deque>
#include <exception>
#include <functional>
#include <isobath/io/event.hpp>
#include <mutex>
#include <thread>

namespace isobath {

class MappingThread {
 public:
  static constexpr std::size_t kLongestQueue = 1024;  ///< events that wait
  using Clock = std::chrono::steady_clock;            ///< for timings alone: no result depends on it
  /// An event, and when it was taken.
  using Work = std::function<void(Event event, Clock::time_point taken)>;

  explicit MappingThread(Work work);
  MappingThread(const MappingThread&) = delete;
  MappingThread& operator=(const MappingThread&) = delete;
  /// Does what was taken, then ends.
  ~MappingThread();

  void take(Event event);
  void settle();
  [[nodiscard]] std::uint64_t lost_pings() const { return lost_pings_; }

 private:
  struct Item {
    Event event;
    Clock::time_point taken;
  };
  void run();
  void work(Item item);
  void check() const;

  Work work_;
  std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<Item> queue_;
  bool busy_ = false, stop_ = false;
  std::uint64_t lost_pings_ = 0;
  std::exception_ptr failure_;
  std::thread thread_;  ///< last: it uses all the others
};

}  // namespace isobath
