#include <algorithm>
#include <isobath/server/link_pace.hpp>
#include <limits>

namespace isobath {

void LinkPace::on_sent(std::uint64_t frame, std::size_t bytes, Clock::time_point now) {
  sent_.push_back({frame, bytes, now});
  on_the_way_ += bytes;
  last_ = frame;
  full_ = full_ || 2 * on_the_way_ >= window_;
}

/// The shortest time of the last kForget to 2 kForget.
double LinkPace::shortest(double took, Clock::time_point now) {
  if (!measured_) {
    measured_ = true;
    now_shortest_ = past_shortest_ = took;
    shortest_since_ = now;
  } else if (std::chrono::duration<double>(now - shortest_since_).count() > kForget) {
    past_shortest_ = now_shortest_;
    now_shortest_ = took;
    shortest_since_ = now;
    window_ = std::max(kMinWindow, window_ / 2);  // what waits drains, so that the shortest time is seen again
  }
  now_shortest_ = std::min(now_shortest_, took);
  return std::min(now_shortest_, past_shortest_);
}

void LinkPace::on_seen(std::uint64_t frame, Clock::time_point now) {
  const auto end = std::find_if(sent_.begin(), sent_.end(), [&](const Sent& s) { return s.frame > frame; });
  if (end == sent_.begin() || std::prev(end)->frame != frame) return;
  const double took = std::chrono::duration<double>(now - std::prev(end)->at).count();
  std::for_each(sent_.begin(), end, [this](const Sent& s) { on_the_way_ -= s.bytes; });
  sent_.erase(sent_.begin(), end);
  const double best = shortest(took, now);
  took_ = round_ends_ == 0 ? took : std::min(took_, took);
  if (frame < round_ends_) return;
  const double change = std::min(kMaxGrowth, (1 + (best + kWait) / std::max(took_, 1e-3)) / 2);
  if (change < 1 || full_) {
    const double window = change * static_cast<double>(window_);
    window_ = std::clamp(static_cast<std::size_t>(window), kMinWindow, kMaxWindow);
  }
  round_ends_ = last_ + 1;
  full_ = 2 * on_the_way_ >= window_;
  took_ = std::numeric_limits<double>::infinity();
}

}  // namespace isobath
