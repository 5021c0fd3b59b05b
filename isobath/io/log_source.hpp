// LogSource: what all readers of files have in common. A reader gives read(); position, shrunken files and the report
// are kept here.
#pragma once

#include <isobath/io/byte_window.hpp>
#include <isobath/io/event.hpp>

namespace isobath {

class LogSource : public Source {
 public:
  std::optional<Event> next() final {
    std::optional<Event> event = read();
    report_.bytes_read = input_.position();
    if (!event && !ended_) {
      ended_ = true;
      report_.add_damage(input_.position(), input_.missing(), "the file shrank while it was read");
    }
    return event;
  }
  [[nodiscard]] const SourceReport& report() const final { return report_; }

 protected:
  LogSource(ByteWindow input, std::string format) : input_(std::move(input)) {
    report_.format = std::move(format);
    report_.bytes_total = input_.size();
  }
  /// The next event; empty at the end of the input.
  virtual std::optional<Event> read() = 0;
  void reject(const char* reason) { ++report_.rejected[reason]; }

  ByteWindow input_;
  SourceReport report_;

 private:
  bool ended_ = false;
};

/// Times for a log that has none: the first event at zero, each further one after the interval of the one before.
class SyntheticClock {
 public:
  /// `interval`: from this event to the next.
  Event stamped(Event event, Duration interval) {
    std::visit([&](auto& e) { e.time = next_; }, event);
    next_ += interval;
    return event;
  }

 private:
  Time next_{};
};

/// Time of day that passes midnight, as a time that does not.
class DayClock {
 public:
  Time at(Duration time_of_day) {
    constexpr Duration kDay = std::chrono::hours(24);
    // A small step back is disorder, which the pipeline judges; one of most of a day is midnight, unless a single
    // damaged time lies between times of a morning.
    const bool evening = before_last_.value_or(kDay) > kDay / 2;
    if (last_ && time_of_day < *last_ - kDay / 2 && evening) days_ += kDay;
    before_last_ = last_;
    last_ = time_of_day;
    return Time{days_ + time_of_day};
  }

 private:
  std::optional<Duration> last_;
  std::optional<Duration> before_last_;
  Duration days_{};
};

}  // namespace isobath
