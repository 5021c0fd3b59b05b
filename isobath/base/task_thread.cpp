#include <algorithm>
#include <isobath/base/task_thread.hpp>
#include <utility>

namespace isobath {

TaskThread::TaskThread(const Bounds& bounds) : bounds_(bounds), thread_([this] { run(); }) {}

TaskThread::~TaskThread() { close(); }

void TaskThread::close() {
  {
    const std::lock_guard lock(mutex_);
    stop_ = true;
  }
  changed_.notify_all();
  if (thread_.joinable()) thread_.join();
}

void TaskThread::push(Kind kind, Task task) {
  Item gone{Kind::kNote, {}};  // destroyed without the lock
  {
    const std::lock_guard lock(mutex_);
    if (stop_) return;
    if (failure_) return leave_out(kind);
    gone = make_room(kind);
    pings_ += kind == Kind::kPing ? 1 : 0;
    queue_.push_back({kind, std::move(task)});
  }
  changed_.notify_all();
}

void TaskThread::leave_out(Kind kind) { ++(kind == Kind::kPing ? left_out_.pings : left_out_.notes); }

/// Makes room for one more task of this kind; returns the task that was dropped for it.
TaskThread::Item TaskThread::make_room(Kind kind) {
  const bool full = (kind == Kind::kPing && pings_ >= bounds_.pings) || queue_.size() >= bounds_.all;
  const bool ping = pings_ > 0;
  if (!full || (!ping && bounds_.keep_notes)) return {Kind::kNote, {}};
  const auto oldest = std::find_if(queue_.begin(), queue_.end(),
                                   [ping](const Item& item) { return !ping || item.kind == Kind::kPing; });
  Item item = std::move(*oldest);
  queue_.erase(oldest);
  if (item.kind == Kind::kPing) --pings_;
  leave_out(item.kind);
  return item;
}

void TaskThread::settle() {
  std::unique_lock lock(mutex_);
  changed_.wait(lock, [this] { return queue_.empty() && !busy_; });
}

TaskThread::LeftOut TaskThread::left_out() const {
  const std::lock_guard lock(mutex_);
  return left_out_;
}

std::exception_ptr TaskThread::failure() const {
  const std::lock_guard lock(mutex_);
  return failure_;
}

void TaskThread::check() const {
  if (const auto failure = this->failure()) std::rethrow_exception(failure);
}

void TaskThread::work(const Task& task) {
  try {
    task();
  } catch (...) {
    const std::lock_guard lock(mutex_);
    failure_ = std::current_exception();
    leave_out(Kind::kNote);
    for (const Item& item : queue_) leave_out(item.kind);
    queue_.clear();
    pings_ = 0;
  }
}

void TaskThread::run() {
  std::unique_lock lock(mutex_);
  while (true) {
    changed_.wait(lock, [this] { return stop_ || !queue_.empty(); });
    if (queue_.empty()) return;
    Item item = std::move(queue_.front());
    queue_.pop_front();
    if (item.kind == Kind::kPing) --pings_;
    busy_ = true;
    lock.unlock();
    work(item.task);
    item.task = {};
    lock.lock();
    busy_ = false;
    if (queue_.empty()) changed_.notify_all();
  }
}

std::string words_of(const std::exception_ptr& failure) {
  if (!failure) return {};
  try {
    std::rethrow_exception(failure);
  } catch (const std::exception& e) {
    const std::string words = e.what();
    return words.empty() ? "an exception without a message" : words;
  } catch (...) {
    return "an unknown exception";
  }
}

}  // namespace isobath
