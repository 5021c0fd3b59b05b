#include <algorithm>
#include <cstring>
#include <isobath/io/bytes/framing.hpp>

namespace isobath {
namespace {

constexpr const char* kNoise = "no valid frame";
constexpr const char* kBeyond = "frame reaches beyond the end";
constexpr std::size_t kAtHand = 4096;

}  // namespace

Framing noise_until(Bytes bytes, char start) {
  const void* next = bytes.size() > 1 ? std::memchr(bytes.data() + 1, start, bytes.size() - 1) : nullptr;
  const auto skipped = next ? static_cast<const std::byte*>(next) - bytes.data() : std::ptrdiff_t(bytes.size());
  return {Framing::Kind::kNoise, static_cast<std::size_t>(skipped)};
}

const char* to_text(MessageFault fault) {
  switch (fault) {
    case MessageFault::kShort: return "message shorter than its stated length";
    case MessageFault::kNoSamples: return "message without samples";
    case MessageFault::kBadBearing: return "bearing out of the range of the device";
    case MessageFault::kBadRange: return "no usable range setting";
    case MessageFault::kOutOfOrder: return "beams not in the order of their bearings";
    case MessageFault::kOtherDevice: return "message of another kind of device";
  }
  return "unknown";
}

std::optional<Bytes> next_frame(ByteWindow& input, FrameAt frame_at, SourceReport& report) {
  std::size_t wanted = kAtHand;
  const char* reason = kNoise;
  for (;;) {
    const Bytes view = input.want(wanted);
    if (view.empty()) return {};
    const Framing found = frame_at(view);
    if (found.kind == Framing::Kind::kFrame) {
      input.advance(found.bytes);
      return view.first(found.bytes);
    }
    const bool incomplete = found.kind == Framing::Kind::kIncomplete;
    if (incomplete && view.size() >= wanted) {
      wanted = found.bytes;
      continue;
    }
    if (incomplete) reason = kBeyond;  // applies to all bytes that follow, unless a frame follows
    const std::size_t skipped = incomplete ? 1 : found.bytes;
    report.add_damage(input.position(), skipped, reason);
    input.advance(skipped);
    wanted = kAtHand;
  }
}

bool holds_frame(Bytes bytes, FrameAt frame_at) {
  while (!bytes.empty()) {
    const Framing found = frame_at(bytes);
    if (found.kind == Framing::Kind::kFrame) return true;
    bytes = bytes.subspan(found.kind == Framing::Kind::kNoise ? found.bytes : 1);
  }
  return false;
}

void FrameStream::push(Bytes chunk, Time time, std::uint64_t offset) {
  finished_ = false;
  if (chunk.empty()) return;
  if (at_ > 0) {  // drop the consumed bytes
    const std::size_t first = waiting() > 0 ? chunk_of(at_) : chunks_.size();
    chunks_.erase(chunks_.begin(), chunks_.begin() + std::ptrdiff_t(first));
    for (Chunk& c : chunks_) {
      if (c.begin < at_) c.offset += at_ - c.begin;
      c.begin -= std::min(c.begin, at_);
    }
    buffer_.erase(buffer_.begin(), buffer_.begin() + std::ptrdiff_t(at_));
    at_ = 0;
  }
  chunks_.push_back({buffer_.size(), time, offset});
  buffer_.insert(buffer_.end(), chunk.begin(), chunk.end());
}

std::size_t FrameStream::chunk_of(std::size_t at) const {
  const auto after = std::upper_bound(chunks_.begin(), chunks_.end(), at,
                                      [](std::size_t value, const Chunk& c) { return value < c.begin; });
  return static_cast<std::size_t>(after - chunks_.begin()) - 1;
}

// Noise may span chunks that are not adjacent in the input.
void FrameStream::skip(std::size_t count, SourceReport& report) {
  while (count > 0) {
    const std::size_t i = chunk_of(at_);
    const std::size_t end = i + 1 < chunks_.size() ? chunks_[i + 1].begin : buffer_.size();
    const std::size_t part = std::min(count, end - at_);
    report.add_damage(chunks_[i].offset + (at_ - chunks_[i].begin), part, kNoise);
    at_ += part;
    count -= part;
  }
}

std::optional<FrameStream::Found> FrameStream::next(SourceReport& report) {
  while (waiting() > 0) {
    const Bytes rest = Bytes(buffer_).subspan(at_);
    const Framing found = frame_at_(rest);
    if (found.kind == Framing::Kind::kFrame) {
      const Chunk& chunk = chunks_[chunk_of(at_)];
      const Found result{rest.first(found.bytes), chunk.time, chunk.offset + (at_ - chunk.begin)};
      at_ += found.bytes;
      return result;
    }
    if (found.kind == Framing::Kind::kIncomplete && !finished_) return {};
    skip(found.kind == Framing::Kind::kNoise ? found.bytes : 1, report);
  }
  return {};
}

}  // namespace isobath
