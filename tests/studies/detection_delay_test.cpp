// The table of docs/detection-delay.md against the mapper and the closed form.
#include <fstream>
#include <gmock/gmock.h>
#include <tests/studies/detection_delay.hpp>
#include <tests/support/data.hpp>

namespace isobath::test {
namespace {

// ledger: S1-50, S1-D01, S1-D08, S1-47
TEST(DetectionDelay, TheTableSaysWhatTheMapperDoes) {
  std::ifstream file(source_folder() / "docs" / "detection-delay.md");
  const std::string page{std::istreambuf_iterator<char>(file), {}};
  DetectionDelay last;
  for (const int base : {4, 5}) {
    const DetectionDelay delay = measure_delay(base);
    EXPECT_THAT(page, testing::HasSubstr(row_of(delay) + "\n"));
    EXPECT_EQ(delay.readings, base - 2 + 1) << "floor((c0 - T) / s) + 1: the paper's 3 to 4 readings";
    EXPECT_LE(delay.readings_merged, 8) << "two groups of four";
    if (last.base != 0) {
      EXPECT_LT(delay.false_standing.mean, last.false_standing.mean);
      EXPECT_LE(delay.false_under_way.mean, last.false_under_way.mean);
    }
    last = delay;
  }
}

}  // namespace
}  // namespace isobath::test
