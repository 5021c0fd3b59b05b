// The run that a report embeds (web/README.md, "A run in a page"), taken apart by a reading that shares no code with
// what writes it.
#pragma once

#include <gtest/gtest.h>
#include <string>
#include <tests/support/display_records.hpp>
#include <vector>
#include <zlib.h>

namespace isobath::test {

inline std::string from_base64(const std::string& text) {
  const std::string letters = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string out;
  unsigned word = 0, bits = 0;
  for (const char c : text) {
    if (c == '=') break;
    word = word << 6 | static_cast<unsigned>(letters.find(c));
    if ((bits += 6) >= 8) out += static_cast<char>(word >> (bits -= 8) & 255);
  }
  return out;
}

inline std::string unzipped(std::string packed) {
  z_stream stream{};
  EXPECT_EQ(inflateInit2(&stream, MAX_WBITS + 16), Z_OK);
  stream.next_in = reinterpret_cast<Bytef*>(packed.data());
  stream.avail_in = static_cast<uInt>(packed.size());
  std::string out;
  int said = Z_OK;
  while (said == Z_OK) {
    char piece[65536];
    stream.next_out = reinterpret_cast<Bytef*>(piece);
    stream.avail_out = sizeof piece;
    said = inflate(&stream, Z_NO_FLUSH);
    out.append(piece, sizeof piece - stream.avail_out);
  }
  EXPECT_EQ(said, Z_STREAM_END);
  EXPECT_EQ(stream.avail_in, 0U) << "browsers take one stream and nothing after it";
  inflateEnd(&stream);
  return out;
}

/// web/README.md, "A run in a page".
struct Block {
  Time time;
  std::vector<Record> records;
  bool whole;
};
inline std::vector<Block> blocks_of(const std::string& film) {
  const std::string bytes = unzipped(from_base64(film));
  std::vector<Block> blocks;
  for (std::size_t at = 0; at < bytes.size();) {
    const auto size = number_at<std::uint32_t>(bytes, at + 8);
    EXPECT_EQ(number_at<std::uint32_t>(bytes, at + 12), 0U);
    auto records = records_of(bytes.substr(at + 16, size));
    const bool whole = !records.empty() && records.front().forget;
    blocks.push_back({Time(Duration(number_at<std::int64_t>(bytes, at))), std::move(records), whole});
    at += 16 + size;
  }
  return blocks;
}

/// The blocks of the run in the text of a report; none where it has no run.
inline std::vector<Block> run_in_report(const std::string& report) {
  const std::string begin = "id=&quot;isobath-recording&quot;&gt;", end = "&lt;/script";
  const std::size_t from = report.find(begin);
  if (from == std::string::npos) return {};
  const std::size_t first = from + begin.size();
  return blocks_of(report.substr(first, report.find(end, first) - first));
}

}  // namespace isobath::test
