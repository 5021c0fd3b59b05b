// LinkSource: the events of all links of a vehicle, in the order in which they arrived, as the source of a run.
//
// The thread of the links gives events (`give`); the thread of the run takes them. `next` waits for an event, at most
// kBeat: then it returns a health report of "links", so that the clock of the run goes on where every sensor is silent
// and its faults are noticed. `wake` ends that wait at once: what the vehicle is to do has changed, and the set-point
// must not wait for the next sensor. At most kMostWaiting events wait; beyond that the oldest ping is dropped and
// counted in the report. `end` ends the run: the next `next` is empty.
#pragma once

#include <condition_variable>
#include <deque>
#include <functional>
#include <isobath/event/event.hpp>
#include <mutex>

namespace isobath {

class LinkSource final : public Source {
 public:
  static constexpr auto kBeat = std::chrono::milliseconds(50);
  static constexpr std::size_t kMostWaiting = 2048;

  /// `now`: the clock of the links. `beat`: of a steady clock.
  explicit LinkSource(std::function<Time()> now, std::chrono::nanoseconds beat = kBeat);

  /// From the thread of the links.
  /// `arrival`: of the last byte; by default the time of the event.
  void give(Event event, std::optional<Time> arrival = {});
  /// The origin of the world. kFirst: it replaces that of another link if the run has not begun; else the first that
  /// is given stays.
  enum class Locates : std::uint8_t { kFirst, kIfUnknown };
  void locate(const GeoOrigin& origin, Locates locates = Locates::kIfUnknown);
  [[nodiscard]] std::optional<GeoOrigin> origin();
  /// Drops the events that wait, before the run begins: they are old by then.
  void drop_waiting();
  void note(const std::string& key, const std::string& value);
  void refuse(const std::string& reason, std::uint64_t count = 1);
  /// From any thread.
  void wake();
  /// From any thread.
  void end();

  // The run.
  std::optional<Event> next() override;
  /// As of the last `next`.
  [[nodiscard]] const SourceReport& report() const override { return shown_; }
  /// When the last byte of the event of the last `next` arrived.
  [[nodiscard]] Time arrival() const { return arrival_; }

 private:
  const std::function<Time()> now_;
  const std::chrono::nanoseconds beat_;
  std::mutex mutex_;
  std::condition_variable given_;
  struct Arrived {
    Event event;
    Time arrival;
  };
  std::deque<Arrived> waiting_;
  bool ended_ = false, changed_ = false, begun_ = false, woken_ = false;
  SourceReport report_;  ///< guarded by mutex_
  SourceReport shown_;   ///< of the run
  Time arrival_{};       ///< of the run
};

}  // namespace isobath
