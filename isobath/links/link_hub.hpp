// LinkHub: the links of a program, served by one thread. A link delivers chunks of bytes with the time of their arrival
// and sends bytes; what they mean is the business of its receiver.
//
// A link opens by itself, and again after a loss: after 0.25 s, then twice as long after each failure, at most 4 s. UDP
// has no connection: its link is open from the start. All calls to a receiver come from the thread of the hub, in the
// order of time; so do ticks, every 50 ms. `send`, `cut` and `post` may be called from any thread and return at once; a
// link that is not open, or whose peer does not read, drops what it is told to send (at most 1 MiB waits), and counts
// it.
//
// Time is that of the host, without its steps: the wall clock at the start and the steady clock since. With a `speed`,
// for stand-ins, it runs that many times as fast. Uses Boost.Asio.
#pragma once

#include <atomic>
#include <functional>
#include <isobath/base/time.hpp>
#include <isobath/links/byte_link.hpp>
#include <isobath/links/link_address.hpp>
#include <memory>
#include <string>
#include <vector>

namespace isobath {

class LinkHub {
 public:
  static constexpr auto kTickInterval = std::chrono::milliseconds(50);

  explicit LinkHub(double speed = 1);
  LinkHub(const LinkHub&) = delete;
  LinkHub& operator=(const LinkHub&) = delete;
  /// Calls `stop`.
  ~LinkHub();

  /// Before `start`. `receiver` must outlive the hub. Throws Error if a server cannot listen at its address.
  ByteLink& add(const LinkAddress& address, ByteReceiver& receiver);
  void start();
  /// Ends the thread; no receiver is called afterwards.
  void stop();
  void post(std::function<void()> work);
  [[nodiscard]] Time now() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace isobath
