// LogSource: the common base of the file readers. A reader implements read(); LogSource keeps the position, the report,
// and the damage of files that shrink. A log may have a second file beside it, such as the water column of a survey.
// Its frames are merged by time, and its damages begin with its name.
#pragma once

#include <isobath/event/event.hpp>
#include <isobath/io/bytes/byte_window.hpp>
#include <isobath/io/bytes/framing.hpp>

namespace isobath {

class LogSource : public Source {
 public:
  std::optional<Event> next() final {
    std::optional<Event> event = read();
    report_.bytes_read = input_.position() + (beside_ ? beside_->position() : 0);
    if (!event && !ended_) {
      ended_ = true;
      report_.add_damage(input_.position(), input_.missing(), kShrank);
      if (beside_) report_.add_damage(beside_->position(), beside_->missing(), beside_name_ + ": " + kShrank);
    }
    return event;
  }
  [[nodiscard]] const SourceReport& report() const final { return report_; }

 protected:
  LogSource(ByteWindow input, std::string format, std::optional<ByteWindow> beside = std::nullopt)
      : input_(std::move(input)), beside_(std::move(beside)) {
    report_.format = std::move(format);
    report_.bytes_total = input_.size() + (beside_ ? beside_->size() : 0);
    if (beside_) beside_name_ = std::filesystem::path(beside_->name()).filename().string();
  }
  /// The next event; empty at the end of the input.
  virtual std::optional<Event> read() = 0;
  void reject(const char* reason) { ++report_.rejected[reason]; }

  /// A frame of the log or of the file beside it; valid until the next call of next_in_time.
  struct LogFrame {
    Bytes bytes;
    bool beside;
  };
  using FrameTime = std::optional<Time> (*)(Bytes);
  /// The earlier of both files' next frames; at equal times, the log's own. A frame without a time comes at once.
  std::optional<LogFrame> next_in_time(FrameAt frame_at, FrameTime time_at);

  ByteWindow input_;
  std::optional<ByteWindow> beside_;
  std::string beside_name_;
  SourceReport report_;

 private:
  static constexpr const char* kShrank = "the file shrank while it was read";
  std::optional<Bytes> next_beside(FrameAt frame_at);

  std::optional<Bytes> waiting_, waiting_beside_;
  bool ended_ = false;
};

/// Makes times for a log that has none: the first event at zero, each later one an interval after the one before.
class SyntheticClock {
 public:
  /// `interval`: time from this event to the next.
  Event stamped(Event event, Duration interval) {
    std::visit([&](auto& e) { e.time = next_; }, event);
    next_ += interval;
    return event;
  }

 private:
  Time next_{};
};

/// Converts a time of day, which wraps at midnight, to a continuous time.
class DayClock {
 public:
  Time at(Duration time_of_day) {
    constexpr Duration kDay = std::chrono::hours(24);
    // A small step back is disorder, which the pipeline handles. A step back of over half a day is midnight, unless it
    // follows a single damaged time between two times in the morning.
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
