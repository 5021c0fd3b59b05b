// DisplayThread: what is shown and recorded of a live run, in a thread of its own: whoever senses, maps, decides or
// steers tells it and goes on at once, however slow page and disk are (ledger S6-31).
//
//   DisplayThread thread;
//   thread.take(DisplayThread::Kind::kPing, [=, &display] { display.on_ping(kept->posed()); });  // from any thread
//   thread.settle();                                                                             // all of it is done
//
// Notes are done in the order in which they were taken, by one thread. Bounded: of more than kMostPings that hold a
// ping or a scan, and of more than kLongestQueue in all, the oldest give way, those with a ping before the others; what
// gave way is counted. take holds the lock for as long as it takes to put a note into the queue, and never waits for
// one to be done.
//
// A page is not essential to a vehicle: where a note throws, nothing more is done, all that comes is counted as left
// out, and `problem` says why.
#pragma once

#include <condition_variable>
#include <cstdint>
#include <deque>
#include <functional>
#include <mutex>
#include <string>
#include <thread>

namespace isobath {

class DisplayThread {
 public:
  static constexpr std::size_t kMostPings = 256;      ///< that wait: 64 MiB of 512 beams x 500 samples
  static constexpr std::size_t kLongestQueue = 4096;  ///< all that wait
  enum class Kind : std::uint8_t { kPing, kNote };    ///< kPing: holds a ping, or all of a scan
  using Note = std::function<void()>;

  DisplayThread();
  DisplayThread(const DisplayThread&) = delete;
  DisplayThread& operator=(const DisplayThread&) = delete;
  /// As close.
  ~DisplayThread();

  void take(Kind kind, Note note);
  /// Waits until all that was taken is done.
  void settle();
  /// Does what was taken, then ends: what comes later is let go. Once, by whoever made it.
  void close();

  /// What was taken and not done.
  struct LeftOut {
    std::uint64_t pings = 0, notes = 0;
  };
  [[nodiscard]] LeftOut left_out() const;
  /// Why nothing more is done; empty as long as all is well.
  [[nodiscard]] std::string problem() const;

 private:
  struct Item {
    Kind kind;
    Note note;
  };
  void leave_out(Kind kind);
  Item take_oldest(bool ping);
  void run();
  void work(const Note& note);

  mutable std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<Item> queue_;
  std::size_t pings_ = 0;  ///< in the queue
  bool busy_ = false, stop_ = false;
  LeftOut left_out_;
  std::string problem_;
  std::thread thread_;  ///< last: it uses all the others
};

}  // namespace isobath
