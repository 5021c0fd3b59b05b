#include <algorithm>
#include <isobath/links/link_source.hpp>
#include <utility>

namespace isobath {

LinkSource::LinkSource(std::function<Time()> now, std::chrono::nanoseconds beat) : now_(std::move(now)), beat_(beat) {
  shown_.format = report_.format = "devices";
}

void LinkSource::give(Event event, std::optional<Time> arrival) {
  const std::lock_guard lock(mutex_);
  if (waiting_.size() >= kMostWaiting) {
    auto oldest =
        std::ranges::find_if(waiting_, [](const Arrived& a) { return std::holds_alternative<Ping>(a.event); });
    if (oldest == waiting_.end()) oldest = waiting_.begin();
    waiting_.erase(oldest);
    ++report_.rejected["dropped, because the run is behind its devices"];
    changed_ = true;
  }
  const Time at = arrival.value_or(time_of(event));
  waiting_.push_back({std::move(event), at});
  given_.notify_one();
}

void LinkSource::locate(const GeoOrigin& origin, Locates locates) {
  const std::lock_guard lock(mutex_);
  if (!report_.origin || (locates == Locates::kFirst && !begun_)) report_.origin = origin;
  changed_ = true;
}

std::optional<GeoOrigin> LinkSource::origin() {
  const std::lock_guard lock(mutex_);
  return report_.origin;
}

void LinkSource::drop_waiting() {
  const std::lock_guard lock(mutex_);
  waiting_.clear();
}

void LinkSource::note(const std::string& key, const std::string& value) {
  const std::lock_guard lock(mutex_);
  report_.details[key] = value;
  changed_ = true;
}

void LinkSource::refuse(const std::string& reason, std::uint64_t count) {
  const std::lock_guard lock(mutex_);
  report_.rejected[reason] += count;
  changed_ = true;
}

void LinkSource::wake() {
  const std::lock_guard lock(mutex_);
  woken_ = true;
  given_.notify_one();
}

void LinkSource::end() {
  const std::lock_guard lock(mutex_);
  ended_ = true;
  given_.notify_one();
}

std::optional<Event> LinkSource::next() {
  std::unique_lock lock(mutex_);
  begun_ = true;
  given_.wait_for(lock, beat_, [this] { return ended_ || woken_ || !waiting_.empty(); });
  woken_ = false;  // any event is followed by a set-point
  if (std::exchange(changed_, false)) shown_ = report_;
  if (ended_) return std::nullopt;
  if (waiting_.empty()) return Health{.time = now_(), .source = "links"};
  Event event = std::move(waiting_.front().event);
  arrival_ = waiting_.front().arrival;
  waiting_.pop_front();
  return event;
}

}  // namespace isobath
