#include <gmock/gmock.h>
#include <isobath/io/bytes/bytes.hpp>
#include <isobath/io/bytes/line_stream.hpp>
#include <string>
#include <vector>

namespace isobath {
namespace {

TEST(ByteCursor, ReadsBothOrdersAndStaysWithinItsBytes) {
  const std::array<std::byte, 6> raw{std::byte{1}, std::byte{2}, std::byte{3},
                                     std::byte{4}, std::byte{5}, std::byte{6}};
  ByteCursor cursor(raw);
  EXPECT_EQ(cursor.little<std::uint16_t>(), 0x0201);
  EXPECT_EQ(cursor.big<std::uint16_t>(), 0x0304);
  EXPECT_EQ(cursor.left(), 2u);
  EXPECT_TRUE(cursor.ok());
  EXPECT_EQ(cursor.little<std::uint32_t>(), 0u);
  EXPECT_FALSE(cursor.ok());
  EXPECT_EQ(cursor.little<std::uint8_t>(), 0u) << "once beyond the end, always beyond the end";
  EXPECT_FALSE(ByteCursor(raw, 7).ok());
}

TEST(ByteCursor, ReadsFloatingPoint) {
  const std::array<std::byte, 8> raw{std::byte{0}, std::byte{0}, std::byte{0},    std::byte{0},
                                     std::byte{0}, std::byte{0}, std::byte{0xf8}, std::byte{0x3f}};
  EXPECT_EQ(ByteCursor(raw).little<double>(), 1.5);
  EXPECT_EQ(ByteCursor(raw, 4).little<float>(), 1.9375f);
}

TEST(LineStream, KeepsLinesWholeAndBounded) {
  LineStream lines(5);
  std::vector<std::string> heard;
  const auto push = [&](std::string_view text) {
    return lines.push(bytes_of(text), [&](std::string_view line) { heard.emplace_back(line); });
  };
  EXPECT_EQ(push("ab"), 0u);
  EXPECT_EQ(push("c\r\n\r\n12345\n"), 0u);
  EXPECT_EQ(push(std::string(100'000, 'x')), 0u);
  EXPECT_EQ(push("y\nz\n"), 1u) << "one line was too long";
  EXPECT_THAT(heard, testing::ElementsAre("abc", "12345", "z"));
}

}  // namespace
}  // namespace isobath
