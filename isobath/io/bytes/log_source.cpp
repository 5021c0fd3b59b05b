#include <isobath/io/bytes/log_source.hpp>

namespace isobath {

std::optional<LogSource::LogFrame> LogSource::next_in_time(FrameAt frame_at, FrameTime time_at) {
  if (!waiting_) waiting_ = next_frame(input_, frame_at, report_);
  if (!waiting_beside_ && beside_) waiting_beside_ = next_beside(frame_at);
  if (!waiting_ && !waiting_beside_) return std::nullopt;
  const auto time = [time_at](const std::optional<Bytes>& frame) {
    return frame ? time_at(*frame).value_or(Time::min()) : Time::max();
  };
  const bool beside = !waiting_ || (waiting_beside_ && time(waiting_beside_) < time(waiting_));
  return LogFrame{*std::exchange(beside ? waiting_beside_ : waiting_, std::nullopt), beside};
}

std::optional<Bytes> LogSource::next_beside(FrameAt frame_at) {
  SourceReport own;
  auto frame = next_frame(*beside_, frame_at, own);
  for (const Damage& damage : own.damages) {
    report_.add_damage(damage.offset, damage.bytes, beside_name_ + ": " + damage.reason);
  }
  return frame;
}

}  // namespace isobath
