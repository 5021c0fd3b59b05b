// The records of a ROS 1 bag, and the chunks that hold them. Internal to ros1_bag.cpp.
#pragma once

#include <isobath/base/time.hpp>
#include <isobath/io/bytes/bytes.hpp>
#include <isobath/io/mcap/mcap_records.hpp>
#include <map>
#include <optional>
#include <string>

namespace isobath::ros1 {

enum Op : std::uint8_t { kMessage = 2, kBagHeader = 3, kIndex = 4, kChunk = 5, kChunkInfo = 6, kConnection = 7 };

constexpr std::size_t kMaxHeaderBytes = 1 << 20;
constexpr std::uint64_t kMaxDataBytes = 256u << 20;

/// Fields of a header by name: "op" -> "\x05".
class BagFields {
 public:
  /// Empty: a field does not fit or has no "=".
  static std::optional<BagFields> parse(Bytes bytes);

  [[nodiscard]] std::string_view text(std::string_view name) const;
  /// A little-endian number that fills the field; empty: absent or of another size.
  template <class Number>
  [[nodiscard]] std::optional<Number> number(std::string_view name) const {
    const std::string_view bytes = text(name);
    if (bytes.size() != sizeof(Number)) return {};
    return RecordView(bytes_of(bytes)).at<Number>(0);
  }
  [[nodiscard]] std::optional<Time> time(std::string_view name) const;
  [[nodiscard]] std::uint8_t op() const { return number<std::uint8_t>("op").value_or(0); }

 private:
  std::map<std::string_view, std::string_view> fields_;
};

struct BagRecord {
  BagFields header;
  Bytes data;
};
/// The record at a cursor. Empty: it does not fit; the cursor is then not ok.
std::optional<BagRecord> take_record(ByteCursor& cursor);

/// Unpacks a chunk. Returns what is wrong, or an empty text. `cut`: the data end early, and what they give is kept.
std::string unpack(std::string_view compression, Bytes data, std::uint64_t size, bool cut, mcap::Buffer& out);

}  // namespace isobath::ros1
