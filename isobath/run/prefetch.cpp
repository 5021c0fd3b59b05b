#include <isobath/run/prefetch.hpp>

namespace isobath {

PrefetchSource::PrefetchSource(std::unique_ptr<Source> inner)
    : inner_(std::move(inner)), report_(inner_->report()), thread_([this] { read_ahead(); }) {}

PrefetchSource::~PrefetchSource() {
  {
    const std::lock_guard lock(mutex_);
    stop_ = true;
  }
  changed_.notify_all();
  thread_.join();
}

void PrefetchSource::read_ahead() {
  for (bool more = true; more;) {
    std::vector<Event> batch;
    batch.reserve(kBatch);
    while (batch.size() < kBatch) {
      auto event = inner_->next();
      if (!event) {
        more = false;
        break;
      }
      batch.push_back(std::move(*event));
    }
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [this] { return stop_ || ready_.size() < kBatchesAhead; });
    if (stop_) return;
    ready_.push_back(std::move(batch));
    bytes_read_ = inner_->report().bytes_read;
    origin_ = inner_->report().origin;
    done_ = !more;
    changed_.notify_all();
  }
}

std::optional<Event> PrefetchSource::next() {
  while (at_ == batch_.size()) {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [this] { return done_ || !ready_.empty(); });
    if (ready_.empty()) {
      report_ = inner_->report();  // the reading thread no longer uses it
      return std::nullopt;
    }
    batch_ = std::move(ready_.front());
    at_ = 0;
    ready_.erase(ready_.begin());
    report_.bytes_read = bytes_read_;
    report_.origin = origin_;
    changed_.notify_all();
  }
  return std::move(batch_[at_++]);
}

}  // namespace isobath
