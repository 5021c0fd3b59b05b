// TaskThread: does tasks one after the other in a thread of its own; who gives it one goes on at once, however long
// those before it take (ledger S6-31).
//
//   TaskThread thread({.pings = 256, .all = 4096});
//   thread.take(TaskThread::Kind::kPing, [=] { ... });  // from any thread
//   thread.settle();                                    // all of them are done
//
// Bounded: of more tasks of kind kPing than `pings`, and of more tasks than `all`, the oldest give way, those of kind
// kPing before the others. What gave way is counted. take holds the lock for as long as it takes to put a task into the
// queue, and never waits for one to be done.
//
// Where a task throws, nothing more is done: what waits and all that comes counts as left out; `failure` says what was
// thrown.
#pragma once

#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <exception>
#include <functional>
#include <mutex>
#include <string>
#include <thread>

namespace isobath {

class TaskThread {
 public:
  enum class Kind : std::uint8_t { kPing, kNote };  ///< kPing: holds a ping, or all of a scan
  struct Bounds {
    std::size_t pings = 256;  ///< that wait
    std::size_t all = 4096;   ///< that wait
    bool keep_notes = false;  ///< kNote never gives way, however many wait
  };
  using Task = std::function<void()>;

  explicit TaskThread(const Bounds& bounds);
  TaskThread(const TaskThread&) = delete;
  TaskThread& operator=(const TaskThread&) = delete;
  /// As close.
  ~TaskThread();

  void take(Kind kind, Task task);
  /// Waits until all that was taken is done.
  void settle();
  /// Does what was taken, then ends: what comes later is let go. Once, by the thread that made it.
  void close();

  /// What was taken and not done.
  struct LeftOut {
    std::uint64_t pings = 0, notes = 0;
  };
  [[nodiscard]] LeftOut left_out() const;
  /// Null as long as all is well.
  [[nodiscard]] std::exception_ptr failure() const;
  /// Throws what a task has thrown.
  void check() const;

 private:
  struct Item {
    Kind kind;
    Task task;
  };
  void leave_out(Kind kind);
  [[nodiscard]] Item make_room(Kind kind);
  void run();
  void work(const Task& task);

  const Bounds bounds_;
  mutable std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<Item> queue_;
  std::size_t pings_ = 0;  ///< in the queue
  bool busy_ = false, stop_ = false;
  LeftOut left_out_;
  std::exception_ptr failure_;
  std::thread thread_;  ///< last: it uses all the others
};

/// In words; empty for null.
std::string words_of(const std::exception_ptr& failure);

}  // namespace isobath
