// Framing: finds the messages of a protocol in bytes that may be noisy, truncated or damaged.
//
// A protocol supplies one function, FrameAt, that classifies the start of some bytes. next_frame walks through a
// file without copying. A device link pushes the chunks that arrive into a FrameStream. Both find the same frames: a
// verdict on a part of the bytes must hold for all of them. After damage the search continues one byte further, so that
// a false start never hides the true frame behind it.
#pragma once

#include <isobath/base/time.hpp>
#include <isobath/event/event.hpp>
#include <isobath/io/bytes/byte_window.hpp>
#include <isobath/io/bytes/bytes.hpp>
#include <optional>
#include <vector>

namespace isobath {

struct Framing {
  enum class Kind : std::uint8_t {
    kFrame,       ///< a complete frame of `bytes`
    kIncomplete,  ///< may become a frame: needs `bytes`, more than there are
    kNoise        ///< nothing starts in the first `bytes`, at least 1
  };
  Kind kind;
  std::size_t bytes;
};
using FrameAt = Framing (*)(Bytes);

/// The verdict that no frame starts at the first byte: noise up to the next byte with the value `start`.
Framing noise_until(Bytes bytes, char start);

/// What is wrong with a complete frame whose content cannot be used.
enum class MessageFault : std::uint8_t { kShort, kNoSamples, kBadBearing, kBadRange, kOutOfOrder, kOtherDevice };
const char* to_text(MessageFault fault);

/// The next frame of an input, as a view into it. Bytes before it are reported as damage. Empty at the end.
std::optional<Bytes> next_frame(ByteWindow& input, FrameAt frame_at, SourceReport& report);

/// Whether the bytes contain a complete frame.
bool holds_frame(Bytes bytes, FrameAt frame_at);

/// The frames of chunks of any size that arrive one after the other. Each frame has the time and the offset of the
/// chunk in which it begins. Memory: the longest frame that the protocol allows, and one chunk.
class FrameStream {
 public:
  explicit FrameStream(FrameAt frame_at) : frame_at_(frame_at) {}

  struct Found {
    Bytes frame;  ///< valid until the next push
    Time time;
    std::uint64_t offset = 0;
  };
  /// `offset`: position of the chunk in its input.
  void push(Bytes chunk, Time time, std::uint64_t offset);
  /// Ends the input: an incomplete frame becomes noise.
  void finish() { finished_ = true; }
  std::optional<Found> next(SourceReport& report);
  /// Number of bytes held back until more arrive.
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
