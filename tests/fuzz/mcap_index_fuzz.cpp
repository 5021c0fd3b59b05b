// Seeking in MCAP: any bytes, all there at once or in two parts.
#include <algorithm>
#include <cstdint>
#include <isobath/base/error.hpp>
#include <isobath/io/mcap/mcap_index.hpp>
#include <sstream>
#include <string>
#include <vector>

namespace {

using isobath::McapIndex;

/// A stream on bytes that somebody else appends to.
class GrowingStream : public std::istream {
 public:
  explicit GrowingStream(std::stringbuf& bytes) : std::istream(&bytes) {}
};

void ask(McapIndex& index) {
  const auto span = index.span();
  if (!span) return;
  std::vector<std::uint16_t> channels;
  for (const auto& [id, channel] : index.channels()) channels.push_back(id);
  std::uint64_t messages = 0, bytes = 0;
  index.visit(channels, 0, ~std::uint64_t{0}, [&](const isobath::McapMessage& message) {
    for (const std::uint8_t byte : message.data) bytes += byte;
    return ++messages < 100000;
  });
  const std::uint64_t middle = span->first + (span->last - span->first) / 2;
  for (const std::uint16_t channel : channels) {
    const auto last = index.last(channel, middle);
    ISOBATH_ASSERT(!last || (last->log_time <= middle && last->channel_id == channel));
    const auto before = index.time_before(channel, middle), after = index.time_after(channel, middle);
    ISOBATH_ASSERT((!before || *before < middle) && (!after || *after > middle));
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string bytes(reinterpret_cast<const char*>(data), size);
  try {
    McapIndex whole(std::make_unique<std::istringstream>(bytes), "fuzz");
    ask(whole);
  } catch (const isobath::Error&) {
  }
  try {
    const std::size_t part = size < 8 ? size : std::max<std::size_t>(8, size * (data[size - 1] % 16u) / 16);
    std::stringbuf growing(std::ios::in | std::ios::out | std::ios::binary);
    growing.sputn(bytes.data(), static_cast<std::streamsize>(part));
    McapIndex index(std::make_unique<GrowingStream>(growing), "fuzz");
    ask(index);
    growing.sputn(bytes.data() + part, static_cast<std::streamsize>(size - part));
    index.refresh();
    ask(index);
  } catch (const isobath::Error&) {
  }
  return 0;
}
