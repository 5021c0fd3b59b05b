// Framing: finding the messages of a protocol in bytes that may be noisy, cut and damaged.
//
// A protocol gives one function, FrameAt, that says what stands at the start of some bytes. Files are walked by
// next_frame without copying; a device link pushes whatever chunks arrive into a FrameStream. Both find the same
// frames: a verdict that was given on a part of the bytes is the verdict on all of them. After damage the search goes
// on one byte further, so that a false start never costs the true frame behind it.
#pragma once

#include <isobath/base/time.hpp>
#include <isobath/io/byte_window.hpp>
#include <isobath/io/bytes.hpp>
#include <isobath/io/event.hpp>
#include <optional>
#include <vector>

namespace isobath {

struct Framing {
  enum class Kind : std::uint8_t {
    kFrame,       ///< a whole frame of `bytes`
    kIncomplete,  ///< may become one: `bytes` must be there, more than there are
    kNoise        ///< nothing starts in the first `bytes`, at least 1
  };
  Kind kind;
  std::size_t bytes;
};
using FrameAt = Framing (*)(Bytes);

/// No frame starts at the first byte: on to the next one that has the value of a start.
Framing noise_until(Bytes bytes, char start);

/// What is wrong with a whole frame whose content cannot be used.
enum class MessageFault : std::uint8_t { kShort, kNoSamples, kBadBearing, kBadRange, kOutOfOrder, kOtherDevice };
const char* to_text(MessageFault fault);

/// The next frame of an input, a view into it; what lies before it is added to the report's damages. Empty at the end.
std::optional<Bytes> next_frame(ByteWindow& input, FrameAt frame_at, SourceReport& report);

/// Whether a whole frame stands anywhere in some bytes.
bool holds_frame(Bytes bytes, FrameAt frame_at);

/// The frames of chunks that arrive one after the other, of any size. Each frame has the time and the place of the
/// chunk in which it begins. Memory: the longest frame that the protocol allows, and one chunk.
class FrameStream {
 public:
  explicit FrameStream(FrameAt frame_at) : frame_at_(frame_at) {}

  struct Found {
    Bytes frame;  ///< valid until the next push
    Time time;
    std::uint64_t offset = 0;
  };
  /// `offset`: of the chunk in its input.
  void push(Bytes chunk, Time time, std::uint64_t offset);
  /// What waits for more bytes will not be continued: it is noise.
  void finish() { finished_ = true; }
  std::optional<Found> next(SourceReport& report);
  /// Bytes that wait for more.
  [[nodiscard]] std::size_t waiting() const { return buffer_.size() - at_; }

 private:
  struct Chunk {
    std::size_t begin;  ///< in buffer_
    Time time;
    std::uint64_t offset;
  };
  [[nodiscard]] std::size_t chunk_of(std::size_t at) const;
  void skip(std::size_t count, SourceReport& report);

  FrameAt frame_at_;
  std::vector<std::byte> buffer_;
  std::size_t at_ = 0;
  std::vector<Chunk> chunks_;
  bool finished_ = false;
};

}  // namespace isobath
