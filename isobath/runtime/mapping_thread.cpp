#include <algorithm>
#include <isobath/runtime/mapping_thread.hpp>
#include <utility>

namespace isobath {

MappingThread::MappingThread(Work work) : work_(std::move(work)), thread_([this] { run(); }) {}

MappingThread::~MappingThread() {
  {
    const std::lock_guard lock(mutex_);
    stop_ = true;
  }
  changed_.notify_all();
  thread_.join();
}

void MappingThread::take(Event event) {
  const Clock::time_point taken = Clock::now();
  {
    const std::lock_guard lock(mutex_);
    check();
    if (queue_.size() >= kLongestQueue) {
      const auto oldest = std::find_if(queue_.begin(), queue_.end(),
                                       [](const Item& item) { return std::holds_alternative<Ping>(item.event); });
      if (oldest != queue_.end()) {
        queue_.erase(oldest);
        ++lost_pings_;
      }
    }
    queue_.push_back({std::move(event), taken});
  }
  changed_.notify_all();
}

void MappingThread::settle() {
  std::unique_lock lock(mutex_);
  changed_.wait(lock, [this] { return queue_.empty() && !busy_; });
  check();
}

void MappingThread::check() const {
  if (failure_) std::rethrow_exception(failure_);
}

void MappingThread::work(Item item) {
  try {
    work_(std::move(item.event), item.taken);
  } catch (...) {
    const std::lock_guard lock(mutex_);
    failure_ = std::current_exception();
    stop_ = true;
    queue_.clear();
  }
}

void MappingThread::run() {
  std::unique_lock lock(mutex_);
  while (true) {
    changed_.wait(lock, [this] { return stop_ || !queue_.empty(); });
    if (queue_.empty()) return;
    Item item = std::move(queue_.front());
    queue_.pop_front();
    busy_ = true;
    lock.unlock();
    work(std::move(item));
    lock.lock();
    busy_ = false;
    if (queue_.empty()) changed_.notify_all();
  }
}

}  // namespace isobath
