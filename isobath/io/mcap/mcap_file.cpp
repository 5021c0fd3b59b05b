#include <algorithm>
#include <isobath/io/mcap/mcap_file.hpp>
#include <istream>

namespace isobath::mcap {

SeekableInput::SeekableInput(std::unique_ptr<std::istream> in) : in_(std::move(in)) { measure(); }
SeekableInput::~SeekableInput() = default;

void SeekableInput::measure() {
  in_->clear();
  in_->seekg(0, std::ios::end);
  const auto end = in_->tellg();
  size_ = end > 0 ? static_cast<std::uint64_t>(end) : 0;
  at_ = kNowhere;
}

bool SeekableInput::read(std::uint64_t offset, std::uint64_t count, Buffer& out) {
  out.resize(count);
  if (offset != at_) in_->seekg(static_cast<std::streamoff>(offset));
  in_->read(reinterpret_cast<char*>(out.data()), static_cast<std::streamsize>(count));
  at_ = offset + count;
  if (*in_) return true;
  in_->clear();
  at_ = kNowhere;
  return false;
}

std::optional<SummaryBytes> load_summary(SeekableInput& input) {
  constexpr std::uint64_t kMaxSummary = 256u << 20;
  constexpr std::uint64_t kEnd = kFooterRecord + 8;
  Buffer end;
  if (input.size() < 8 + kEnd || !input.read(input.size() - kEnd, kEnd, end)) return std::nullopt;
  Cursor footer(end);
  const auto record = take_record(footer);
  if (!record || record->opcode != kFooter || record->content.size() != 20) return std::nullopt;
  if (!looks_like_mcap(footer.left())) return std::nullopt;
  Cursor content(record->content);
  SummaryBytes summary;
  summary.start = content.number<std::uint64_t>();
  (void)content.number<std::uint64_t>();
  const auto crc = content.number<std::uint32_t>();
  const std::uint64_t stop = input.size() - kEnd;
  if (summary.start < 8 + kDataEndRecord || summary.start > stop || stop - summary.start > kMaxSummary) {
    return std::nullopt;
  }
  // A summary must follow the end-of-data record; otherwise it would hide records after its start.
  Buffer& before = summary.records;
  if (!input.read(summary.start - kDataEndRecord, kDataEndRecord, before)) return std::nullopt;
  if (before[0] != kDataEnd || before[1] != 4) return std::nullopt;
  if (!input.read(summary.start, stop - summary.start, summary.records)) return std::nullopt;
  const std::uint32_t covered = crc32(std::span(end).first(kFooterRecord - 4), crc32(summary.records));
  if (crc != 0 && crc != covered) return std::nullopt;
  return summary;
}

std::uint64_t find_chunk(SeekableInput& input, std::uint64_t from, std::uint64_t limit) {
  constexpr std::uint64_t kStep = 1u << 20;
  constexpr std::uint64_t kLook = kRecordHead + kChunkHeadBytes;
  Buffer bytes;
  for (; from < limit; from += kStep) {
    const std::uint64_t count = std::min(limit - from, kStep + kLook);
    if (!input.read(from, count, bytes)) return limit;
    for (std::uint64_t i = 0; i < std::min(count, kStep); ++i) {
      if (bytes[i] != kChunk) continue;
      Cursor head{std::span<const std::uint8_t>(bytes).subspan(i + 1)};
      const auto size = head.number<std::uint64_t>();
      if (head.ok() && size <= limit - from - i && chunk_can_begin_so(head.left(), size)) return from + i;
    }
  }
  return limit;
}

}  // namespace isobath::mcap
