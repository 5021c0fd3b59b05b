// TaskThread: runs tasks one after the other in its own thread. `push` returns at once, however long the earlier tasks
// run (ledger S6-31).
//
//   TaskThread thread({.pings = 256, .all = 4096});
//   thread.push(TaskThread::Kind::kPing, [=] { ... });  // from any thread
//   thread.settle();                                    // all of them are done
//
// The queue is bounded: when it would hold more than `pings` tasks of kind kPing, or more than `all` tasks, the oldest
// are dropped, those of kind kPing first. Dropped tasks are counted. `push` holds the lock only while it puts a task
// into the queue; it never waits for a task to finish.
//
// After a task has thrown, no further task runs: waiting and later tasks count as left out, and `failure` returns the
// exception.
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
    std::size_t pings = 256;  ///< waiting tasks of kind kPing
    std::size_t all = 4096;   ///< waiting tasks of both kinds
    bool keep_notes = false;  ///< tasks of kind kNote are never dropped, however many wait
  };
  using Task = std::function<void()>;

  explicit TaskThread(const Bounds& bounds);
  TaskThread(const TaskThread&) = delete;
  TaskThread& operator=(const TaskThread&) = delete;
  /// Calls `close`.
  ~TaskThread();

  void push(Kind kind, Task task);
  /// Waits until every task that was taken has run.
  void settle();
  /// Runs the tasks taken so far, then ends the thread; later tasks are discarded. The owner's thread calls it once.
  void close();

  /// Tasks that were taken but not run.
  struct LeftOut {
    std::uint64_t pings = 0, notes = 0;
  };
  [[nodiscard]] LeftOut left_out() const;
  /// Null while no task has thrown.
  [[nodiscard]] std::exception_ptr failure() const;
  /// Rethrows the exception that a task has thrown.
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

/// The exception's message; empty for null.
std::string words_of(const std::exception_ptr& failure);

}  // namespace isobath
