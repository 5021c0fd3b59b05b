#include <algorithm>
#include <exception>
#include <isobath/runtime/display_thread.hpp>
#include <utility>

namespace isobath {

DisplayThread::DisplayThread() : thread_([this] { run(); }) {}

DisplayThread::~DisplayThread() { close(); }

void DisplayThread::close() {
  {
    const std::lock_guard lock(mutex_);
    stop_ = true;
  }
  changed_.notify_all();
  if (thread_.joinable()) thread_.join();
}

void DisplayThread::take(Kind kind, Note note) {
  Item gone{Kind::kNote, {}};  // let go where nobody waits for it
  {
    const std::lock_guard lock(mutex_);
    if (stop_) return;
    if (!problem_.empty()) return leave_out(kind);
    const bool too_many_pings = kind == Kind::kPing && pings_ >= kMostPings;
    if (too_many_pings || queue_.size() >= kLongestQueue) gone = take_oldest(pings_ > 0);
    pings_ += kind == Kind::kPing ? 1 : 0;
    queue_.push_back({kind, std::move(note)});
  }
  changed_.notify_all();
}

void DisplayThread::leave_out(Kind kind) { ++(kind == Kind::kPing ? left_out_.pings : left_out_.notes); }

DisplayThread::Item DisplayThread::take_oldest(bool ping) {
  const auto oldest = std::find_if(queue_.begin(), queue_.end(),
                                   [ping](const Item& item) { return !ping || item.kind == Kind::kPing; });
  Item item = std::move(*oldest);
  queue_.erase(oldest);
  if (item.kind == Kind::kPing) --pings_;
  leave_out(item.kind);
  return item;
}

void DisplayThread::settle() {
  std::unique_lock lock(mutex_);
  changed_.wait(lock, [this] { return queue_.empty() && !busy_; });
}

DisplayThread::LeftOut DisplayThread::left_out() const {
  const std::lock_guard lock(mutex_);
  return left_out_;
}

std::string DisplayThread::problem() const {
  const std::lock_guard lock(mutex_);
  return problem_;
}

void DisplayThread::work(const Note& note) {
  std::string problem;
  try {
    return note();
  } catch (const std::exception& e) {
    problem = e.what();
  } catch (...) {
    problem = "an exception of no known kind";
  }
  const std::lock_guard lock(mutex_);
  problem_ = problem.empty() ? "an exception without words" : problem;
  leave_out(Kind::kNote);
  for (const Item& item : queue_) leave_out(item.kind);
  queue_.clear();
  pings_ = 0;
}

void DisplayThread::run() {
  std::unique_lock lock(mutex_);
  while (true) {
    changed_.wait(lock, [this] { return stop_ || !queue_.empty(); });
    if (queue_.empty()) return;
    Item item = std::move(queue_.front());
    queue_.pop_front();
    if (item.kind == Kind::kPing) --pings_;
    busy_ = true;
    lock.unlock();
    work(item.note);
    item.note = {};
    lock.lock();
    busy_ = false;
    if (queue_.empty()) changed_.notify_all();
  }
}

}  // namespace isobath
