// Thinned echoes against the samples that they stand for, one by one.
#include <cstring>
#include <gtest/gtest.h>
#include <isobath/display/display_bytes.hpp>
#include <isobath/server/thinned_echoes.hpp>
#include <random>
#include <tests/support/display_records.hpp>

namespace isobath::thinned_echoes_of {
namespace {

constexpr std::size_t kBeams = 13, kBins = 50;

struct PingSamples {
  std::vector<std::uint8_t> samples = std::vector<std::uint8_t>(kBeams * kBins);
  std::vector<std::uint8_t> bits = std::vector<std::uint8_t>((kBeams * kBins + 7) / 8);
  [[nodiscard]] std::string payload() const {
    DisplayBytes bytes;
    bytes.add(static_cast<std::uint16_t>(kBeams)).add(static_cast<std::uint16_t>(kBins)).add(std::uint32_t{0});
    for (const double v : {1.0, 2.0, 3.0}) bytes.add(v);
    return bytes.add_floats({1, 0, 0, 0}).append(samples).pad_to(8).append(bits).take();
  }
};

TEST(ThinnedEchoes, EachSampleIsTheLoudestOfItsPartsAndDetectedIfOneIs) {
  PingSamples ping;
  std::mt19937 random(1);
  for (auto& s : ping.samples) s = static_cast<std::uint8_t>(random());
  for (auto& b : ping.bits) b = static_cast<std::uint8_t>(random() & random() & random() & random());
  std::string records;
  append_record(records, DisplayKind::kEchoes, 7, Time(Duration(5)), ping.payload());
  append_record(records, DisplayKind::kGrid, 0, Time{}, std::string(5000, 'g'));
  const ThinnedEchoes thin = thinned_echoes(records, 100);
  EXPECT_TRUE(thin.thinned);
  const auto got = test::records_of(thin.records);
  ASSERT_EQ(got.size(), 2u);
  EXPECT_EQ(got[0].number, 7u);
  EXPECT_EQ(got[0].time, Time(Duration(5)));
  EXPECT_EQ(got[1].payload, std::string(5000, 'g')) << "only echoes are thinned";

  const std::string& bytes = got[0].payload;
  const std::size_t each = static_cast<std::uint8_t>(bytes[4]);
  EXPECT_EQ(each, 3u) << "the smallest that fits: 780 bytes by 9";
  EXPECT_EQ(bytes[5], bytes[4]);
  EXPECT_EQ(bytes.substr(8, 40), ping.payload().substr(8, 40)) << "pose";
  const std::size_t columns = (kBins + each - 1) / each, rows = (kBeams + each - 1) / each;
  const std::size_t bits_at = (48 + rows * columns + 7) / 8 * 8;
  ASSERT_EQ(bytes.size(), bits_at + (rows * columns + 7) / 8);
  for (std::size_t row = 0; row < rows; ++row) {
    for (std::size_t column = 0; column < columns; ++column) {
      int loudest = 0, hit = 0;
      for (std::size_t beam = row * each; beam < std::min(kBeams, (row + 1) * each); ++beam) {
        for (std::size_t bin = column * each; bin < std::min(kBins, (column + 1) * each); ++bin) {
          const std::size_t at = beam * kBins + bin;
          loudest = std::max<int>(loudest, ping.samples[at]);
          hit |= ping.bits[at / 8] >> at % 8 & 1;
        }
      }
      const std::size_t at = row * columns + column;
      EXPECT_EQ(static_cast<std::uint8_t>(bytes[48 + at]), loudest) << at;
      EXPECT_EQ(static_cast<std::uint8_t>(bytes[bits_at + at / 8]) >> at % 8 & 1, hit) << at;
    }
  }
}

TEST(ThinnedEchoes, WhatFitsOrIsNoPingStaysAsItIs) {
  std::string records;
  append_record(records, DisplayKind::kEchoes, 0, Time{}, PingSamples().payload());
  append_record(records, DisplayKind::kEchoes, 1, Time{}, std::string(1000, '\xff'));
  append_record(records, DisplayKind::kEchoes, 2, Time{}, "", true);
  const ThinnedEchoes same = thinned_echoes(records, 900);
  EXPECT_EQ(same.records, records);
  EXPECT_FALSE(same.thinned);
}

}  // namespace
}  // namespace isobath::thinned_echoes_of
