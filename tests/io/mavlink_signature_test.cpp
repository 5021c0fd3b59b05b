// ledger: none of its own; the boundary to an autopilot (docs/aboard.md). The golden signature was computed apart.
#include <gtest/gtest.h>
#include <isobath/base/error.hpp>
#include <isobath/io/formats/mavlink/mavlink_frames.hpp>
#include <isobath/io/formats/mavlink/mavlink_messages.hpp>
#include <tests/io/bytes_by_hand.hpp>

namespace isobath::mavlink_signatures {
namespace {

using test::hex;
using Verdict = SignatureCheck::Verdict;

const MavlinkKey kKey("correct horse battery");
const Time kMay2024{std::chrono::seconds(1714521600)};

std::vector<std::byte> beat(MavlinkWriter& writer, Time now) {
  return writer.frame(mavlink::Heartbeat::kId, mavlink::Heartbeat{0, 12, 3, 81, 4}.body(), now);
}

MavlinkWriter signed_writer(std::uint8_t component = 1) {
  MavlinkWriter writer(1, component);
  writer.sign_with(kKey);
  return writer;
}

TEST(MavlinkSignature, IsTheOneOfTheStandard) {
  MavlinkWriter writer = signed_writer();
  for (int i = 0; i < 7; ++i) (void)beat(writer, {});
  EXPECT_EQ(std::string(text_of(beat(writer, kMay2024))),
            hex("fd 09 01 00 07 01 01 00 00 00 00 00 00 00 0c 03 51 04 03 "
                "e1 6d 00 00 00 eb b9 c7 1a 21 81 10 b8 56 72"));
}

TEST(MavlinkSignature, IsTrustedOnceAndInOrder) {
  SignatureCheck check(kKey);
  MavlinkWriter writer = signed_writer();
  const auto first = beat(writer, kMay2024), second = beat(writer, kMay2024);  // of one instant: the time still grows
  EXPECT_EQ(check.judge(second), Verdict::kTrusted);
  EXPECT_EQ(check.judge(second), Verdict::kRepeated);
  EXPECT_EQ(check.judge(first), Verdict::kRepeated);
  MavlinkWriter late = signed_writer(2), old = signed_writer(3);
  EXPECT_EQ(check.judge(beat(late, kMay2024 - std::chrono::seconds(59))), Verdict::kTrusted) << "another clock";
  EXPECT_EQ(check.judge(beat(old, kMay2024 - std::chrono::seconds(61))), Verdict::kRepeated) << "a recording";
  EXPECT_EQ(check.judge(beat(writer, kMay2024)), Verdict::kTrusted);
}

TEST(MavlinkSignature, OfAnyChangedBitIsWrong) {
  SignatureCheck check(kKey);
  MavlinkWriter writer = signed_writer();
  const auto good = beat(writer, kMay2024);
  for (std::size_t i = 3; i < good.size(); ++i) {
    for (int bit = 0; bit < 8; ++bit) {
      auto changed = good;
      changed[i] ^= static_cast<std::byte>(1 << bit);
      EXPECT_EQ(check.judge(changed), Verdict::kWrong) << i;
    }
  }
  EXPECT_EQ(check.judge(good), Verdict::kTrusted) << "the wrong ones taught nothing";
  MavlinkWriter plain(1, 1), other(1, 1);
  EXPECT_EQ(check.judge(beat(plain, kMay2024)), Verdict::kUnsigned);
  other.sign_with(MavlinkKey("correct horse batteries"));
  EXPECT_EQ(check.judge(beat(other, kMay2024 + std::chrono::hours(1))), Verdict::kWrong);
}

TEST(MavlinkSignature, NeedsAPassphraseThatIsHardToGuess) {
  EXPECT_THROW(MavlinkKey("1234567"), Error);
  EXPECT_NO_THROW(MavlinkKey("12345678"));
}

TEST(MavlinkSignature, OfManySendersIsBounded) {
  SignatureCheck check(kKey);
  int trusted = 0;
  for (int sender = 0; sender < 2000; ++sender) {
    MavlinkWriter writer(static_cast<std::uint8_t>(sender % 250 + 1), static_cast<std::uint8_t>(sender / 250 + 1));
    writer.sign_with(kKey);
    trusted += check.judge(beat(writer, kMay2024)) == Verdict::kTrusted ? 1 : 0;
  }
  EXPECT_EQ(trusted, 1024);
}

}  // namespace
}  // namespace isobath::mavlink_signatures
