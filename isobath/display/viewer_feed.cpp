#include <algorithm>
#include <isobath/display/viewer_feed.hpp>
#include <utility>

namespace isobath {

std::size_t ViewerFeed::open(const Channel& channel) {
  const std::lock_guard lock(mutex_);
  const auto known =
      std::ranges::find_if(channels_, [&](const Kept& kept) { return kept.channel.topic == channel.topic; });
  if (known != channels_.end()) return static_cast<std::size_t>(known - channels_.begin());
  channels_.push_back({channel, 0, {}});
  return channels_.size() - 1;
}

void ViewerFeed::write(std::size_t channel, Time time, std::string body) {
  auto shared = std::make_shared<const std::string>(std::move(body));
  const std::lock_guard lock(mutex_);
  if (channel >= channels_.size()) return;
  Kept& kept = channels_[channel];
  kept.messages.push_back({++kept.number, time, std::move(shared)});
  if (kept.messages.size() > (kept.channel.events ? kEvents : 1)) kept.messages.pop_front();
  latest_ = std::max(latest_.value_or(time), time);
}

std::vector<ViewerFeed::Channel> ViewerFeed::channels(std::size_t from) const {
  const std::lock_guard lock(mutex_);
  std::vector<Channel> found;
  for (std::size_t i = from; i < channels_.size(); ++i) found.push_back(channels_[i].channel);
  return found;
}

std::optional<ViewerFeed::Message> ViewerFeed::after(std::size_t channel, std::uint64_t number) const {
  const std::lock_guard lock(mutex_);
  if (channel >= channels_.size()) return std::nullopt;
  for (const Message& message : channels_[channel].messages) {
    if (message.number > number) return message;
  }
  return std::nullopt;
}

std::optional<Time> ViewerFeed::latest() const {
  const std::lock_guard lock(mutex_);
  return latest_;
}

bool ViewerFeed::watched() const {
  const std::lock_guard lock(mutex_);
  return viewers_ > 0;
}

void ViewerFeed::count(int change) {
  const std::lock_guard lock(mutex_);
  viewers_ += change;
}

}  // namespace isobath
