// LinkPace: how many bytes may be on the way to one page, so that they do not queue on a slow link.
//
// A socket takes bytes long before they arrive: they wait in the system, in proxies and in modems. So the page tells
// which frame it has shown, and the time T from sending a frame until then, less the shortest such time S, is the time
// that bytes wait. Each round trip the window W goes half the way to W (S + kWait) / T, with the least T of the round
// trip: the window with which bytes wait kWait, as in FAST TCP (Wei, Jin, Low, Hegde 2006, eq. 5). It grows while it is
// full only, and at most to the fourfold. S is forgotten after kForget to 2 kForget; then the window is halved, so that
// S is seen again.
//
// One thread; the caller gives the time. Frames have numbers that grow. Untrusted: a number that was not sent, or was
// told before, changes nothing.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <deque>

namespace isobath {

class LinkPace {
 public:
  using Clock = std::chrono::steady_clock;
  static constexpr std::size_t kFirstWindow = 16 << 10, kMinWindow = 4 << 10, kMaxWindow = 4 << 20;
  static constexpr double kWait = 0.15, kForget = 30, kMaxGrowth = 4;

  void on_sent(std::uint64_t frame, std::size_t bytes, Clock::time_point now);
  /// The page has shown this frame, and all before it.
  void on_seen(std::uint64_t frame, Clock::time_point now);
  /// More would be sent if the window were larger.
  void want_more() { full_ = true; }
  /// Bytes that may be sent now; 0: wait for the page.
  [[nodiscard]] std::size_t room() const { return on_the_way_ < window_ ? window_ - on_the_way_ : 0; }
  [[nodiscard]] std::size_t window() const { return window_; }

 private:
  struct Sent {
    std::uint64_t frame;
    std::size_t bytes;
    Clock::time_point at;
  };
  double shortest(double took, Clock::time_point now);

  std::deque<Sent> sent_;  ///< not yet shown
  std::size_t on_the_way_ = 0, window_ = kFirstWindow;
  std::uint64_t last_ = 0, round_ends_ = 0;  ///< a round trip ends when the frame `round_ends_` has been shown
  bool full_ = false;                        ///< the window was full in this round trip
  double took_ = 0;                          ///< s, the least time in this round trip
  double now_shortest_ = 0, past_shortest_ = 0;
  Clock::time_point shortest_since_{};
  bool measured_ = false;
};

}  // namespace isobath
