// SeekableInput: access to any stretch of an MCAP file, its summary if that is valid, and the search for the next chunk
// after damage. Internal to mcap_reader.cpp and mcap_chunks.cpp.
#pragma once

#include <cstdint>
#include <iosfwd>
#include <isobath/io/mcap/mcap_records.hpp>
#include <memory>
#include <optional>

namespace isobath::mcap {

constexpr std::uint64_t kMaxOtherRecord = 64u << 20;  ///< schema, channel, metadata, attachment, index of messages
constexpr std::uint64_t kFooterRecord = kRecordHead + 20;
constexpr std::uint64_t kDataEndRecord = kRecordHead + 4;

/// Reads any stretch of a file; reading adjacent stretches keeps the stream's buffer.
class SeekableInput {
 public:
  explicit SeekableInput(std::unique_ptr<std::istream> in);
  ~SeekableInput();
  [[nodiscard]] std::uint64_t size() const { return size_; }
  /// Updates the size of a growing file.
  void measure();
  /// False if the file has become shorter.
  bool read(std::uint64_t offset, std::uint64_t count, Buffer& out);

 private:
  static constexpr std::uint64_t kNowhere = ~std::uint64_t{0};
  std::unique_ptr<std::istream> in_;
  std::uint64_t size_ = 0;
  std::uint64_t at_ = kNowhere;
};

/// The records of a summary whose position and checksum are right.
struct SummaryBytes {
  std::uint64_t start = 0;  ///< position in the file; the data end here
  Buffer records;
};
std::optional<SummaryBytes> load_summary(SeekableInput& input);

/// The first position from `from` on that looks like a chunk, or `limit`.
std::uint64_t find_chunk(SeekableInput& input, std::uint64_t from, std::uint64_t limit);

}  // namespace isobath::mcap
