// StandInLink: the end of a stand-in on its link, whose cable is pulled now and then: a stand-in of a device is heard
// through it by what is tested. A pull falls on a random byte of what is sent.
#pragma once

#include <atomic>
#include <isobath/base/random.hpp>
#include <isobath/links/link_hub.hpp>
#include <optional>
#include <vector>

namespace isobath {

struct UnplugConfig {
  int times = 0;         ///< of each link; 0: never
  double mean_s = 5;     ///< between the end of a pull and the next
  double longest_s = 2;  ///< a link is out for 0.2 s to this
  std::uint64_t seed = 1;
  double speed = 1;  ///< of the clock, times real time
};

class StandInLink {
 public:
  /// In the thread of the hub.
  StandInLink(const UnplugConfig& config, std::uint64_t stream)
      : config_(config), random_(config.seed * 1000 + stream), left_(config.times) {}
  void use(ByteLink& link) { link_ = &link; }
  [[nodiscard]] int port() const { return link_ ? link_->port() : 0; }

  void send(std::vector<std::byte> bytes, Time now) {
    if (!due_) due_ = now + wait();
    if (left_ <= 0 || now < *due_ || bytes.empty()) return link_->send(std::move(bytes));
    --left_;
    ++pulled_;
    bytes.resize(static_cast<std::size_t>(random_.uniform() * static_cast<double>(bytes.size())));
    if (!bytes.empty()) link_->send(std::move(bytes));
    const double lasts_s = 0.2 + random_.uniform() * (config_.longest_s - 0.2);
    link_->cut(std::chrono::milliseconds(static_cast<int>(1000 * lasts_s / config_.speed)));
    due_ = now + seconds(lasts_s) + wait();
  }
  [[nodiscard]] int pulled() const { return pulled_; }

 private:
  [[nodiscard]] Duration wait() { return seconds(config_.mean_s * (0.5 + random_.uniform())); }

  UnplugConfig config_;
  Random random_;
  ByteLink* link_ = nullptr;
  int left_ = 0;
  std::atomic<int> pulled_{0};
  std::optional<Time> due_;
};

}  // namespace isobath
