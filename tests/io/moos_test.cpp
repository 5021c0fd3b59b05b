// Packets of a MOOSDB: bytes by hand from the description of the protocol, round trips, and bytes that cannot be right.
#include <gmock/gmock.h>
#include <isobath/io/formats/moos/given_obstacle.hpp>
#include <isobath/io/formats/moos/moos_messages.hpp>
#include <limits>
#include <tests/io/bytes_by_hand.hpp>

namespace isobath::moos {
namespace {

using test::hex;
using Type = MoosMessage::Type;
using Kind = MoosMessage::Kind;

// 9 bytes of head and one message of 65: NAV_X = 12.5 from pNav of the community "au", at 2 s.
const std::string kNavX =
    hex("4A 00 00 00 | 01 00 00 00 | 00 |"
        "41 00 00 00 | 07 00 00 00 | 4E | 44 |"
        "04 00 00 00 70 4E 61 76 | 00 00 00 00 | 02 00 00 00 61 75 | 05 00 00 00 4E 41 56 5F 58 |"
        "00 00 00 00 00 00 00 40 | 00 00 00 00 00 00 29 40 | 00x8 | 00 00 00 00");
// Two messages: the null message of the database with its time, 4 s, and MOOS_MANUAL_OVERRIDE = "true".
const std::string kOverride =
    hex("8D 00 00 00 | 02 00 00 00 | 00 |"
        "36 00 00 00 | FF FF FF FF | 2E | 44 | 00x16 | 00x8 | 00 00 00 00 00 00 10 40 | 00x8 | 00 00 00 00 |"
        "4E 00 00 00 | 08 00 00 00 | 4E | 53 | 00x12 |"
        "14 00 00 00 4D 4F 4F 53 5F 4D 41 4E 55 41 4C 5F 4F 56 45 52 52 49 44 45 |"
        "00 00 00 00 00 00 08 40 | 00x8 | 00x8 | 04 00 00 00 74 72 75 65");

std::vector<MoosMessage> read(const std::string& packet, SourceReport& report) {
  return moos_messages_of(bytes_of(packet), report);
}

bool is_whole_frame(const std::string& bytes) {
  const Framing found = moos_frame_at(bytes_of(bytes));
  return found.kind == Framing::Kind::kFrame && found.bytes == bytes.size();
}

TEST(MoosMessages, HoldAVariableWithItsNumber) {
  ASSERT_TRUE(is_whole_frame(kNavX));
  SourceReport report;
  const auto messages = read(kNavX, report);
  ASSERT_EQ(messages.size(), 1u);
  const MoosMessage& m = messages[0];
  EXPECT_EQ(m.type, Type::kNotify);
  EXPECT_EQ(m.kind, Kind::kNumber);
  EXPECT_EQ(m.number, 7);
  EXPECT_EQ(m.source, "pNav");
  EXPECT_EQ(m.community, "au");
  EXPECT_EQ(m.key, "NAV_X");
  EXPECT_EQ(m.time_s, 2);
  EXPECT_EQ(m.value, 12.5);
  EXPECT_TRUE(report.rejected.empty());
}

TEST(MoosMessages, ManyFillAPacket) {
  ASSERT_TRUE(is_whole_frame(kOverride));
  SourceReport report;
  const auto messages = read(kOverride, report);
  ASSERT_EQ(messages.size(), 2u);
  EXPECT_EQ(messages[0].type, Type::kNull);
  EXPECT_EQ(messages[0].value, 4);
  EXPECT_EQ(messages[1].key, "MOOS_MANUAL_OVERRIDE");
  EXPECT_EQ(messages[1].kind, Kind::kText);
  EXPECT_EQ(messages[1].text, "true");
}

TEST(MoosMessages, AreWrittenAsTheyAreRead) {
  for (const std::string& packet : {kNavX, kOverride}) {
    SourceReport report;
    const auto bytes = moos_packet(read(packet, report));
    EXPECT_EQ(text_of(bytes), packet);
  }
  MoosMessage name = moos_text("", "isobath", 5);
  name.type = Type::kData;
  const std::vector<MoosMessage> all{name, moos_number("DESIRED_SPEED", -0.0, 1e9),
                                     moos_text("A", std::string(3, '\0'), 0)};
  SourceReport report;
  const auto bytes = moos_packet(all);
  EXPECT_EQ(moos_messages_of(bytes, report), all);
}

TEST(MoosMessages, AGreetingOf32BytesComesFirst) {
  const auto greeting = moos_greeting();
  EXPECT_EQ(text_of(greeting), hex("45 4C 4B 53 20 43 41 4E 27 54 20 44 41 4E 43 45 20 32 2F 38 2F 31 30 00x9"));
  const std::string begin = std::string(text_of(greeting)) + kNavX;
  const Framing found = moos_frame_at(bytes_of(begin));
  EXPECT_EQ(found.kind, Framing::Kind::kFrame);
  ASSERT_EQ(found.bytes, 32u);
  EXPECT_TRUE(is_moos_greeting(bytes_of(begin).first(32)));
  EXPECT_FALSE(is_moos_greeting(bytes_of(kNavX)));
}

TEST(MoosMessages, OfAPacketThatIsCutAreWaitedFor) {
  for (std::size_t size = 0; size < kOverride.size(); ++size) {
    const Framing found = moos_frame_at(bytes_of(kOverride).first(size));
    EXPECT_EQ(found.kind, Framing::Kind::kIncomplete) << size;
    EXPECT_GT(found.bytes, size);
    SourceReport report;
    (void)moos_messages_of(bytes_of(kOverride).first(size), report);  // must not read beyond
  }
}

TEST(MoosMessages, ComeInChunksOfAnySizeAndAfterNoise) {
  const std::string stream = kNavX + hex("01 02 03") + kOverride + kNavX;
  for (const std::size_t chunk : {std::size_t{1}, std::size_t{7}, std::size_t{100}, stream.size()}) {
    FrameStream frames(moos_frame_at);
    SourceReport report;
    std::size_t messages = 0;
    for (std::size_t at = 0; at < stream.size(); at += chunk) {
      frames.push(bytes_of(stream).subspan(at, std::min(chunk, stream.size() - at)), {}, at);
      while (const auto found = frames.next(report)) messages += moos_messages_of(found->frame, report).size();
    }
    EXPECT_EQ(messages, 4u) << chunk;
    EXPECT_EQ(report.bytes_skipped, 3u) << chunk;
  }
}

TEST(MoosMessages, ThatCannotBeRightAreNoiseOrCounted) {
  const auto changed = [](std::string packet, std::size_t at, const std::string& by) {
    return packet.replace(at, by.size(), by);
  };
  const auto kind = [](const std::string& bytes) { return moos_frame_at(bytes_of(bytes)).kind; };
  EXPECT_EQ(kind(changed(kNavX, 0, hex("FF FF FF FF"))), Framing::Kind::kNoise) << "too long";
  EXPECT_EQ(kind(changed(kNavX, 0, hex("08 00 00 00"))), Framing::Kind::kNoise) << "shorter than its head";
  EXPECT_EQ(kind(changed(kNavX, 4, hex("FF FF FF FF"))), Framing::Kind::kNoise) << "more messages than fit";
  EXPECT_EQ(kind(changed(kNavX, 4, hex("00"))), Framing::Kind::kNoise) << "bytes after the last message";
  EXPECT_EQ(kind(changed(kNavX, 9, hex("40"))), Framing::Kind::kNoise) << "a message that ends before the packet";
  EXPECT_EQ(kind(changed(kNavX, 8, hex("02"))), Framing::Kind::kNoise);

  SourceReport report;
  EXPECT_TRUE(read(changed(kNavX, 8, hex("01")), report).empty());
  EXPECT_EQ(report.rejected["compressed packet"], 1u);
  EXPECT_TRUE(read(changed(kNavX, 17, "?"), report).empty());
  EXPECT_EQ(report.rejected["message of an unknown type"], 1u);
  EXPECT_TRUE(read(changed(kNavX, 19, hex("FF FF FF 7F")), report).empty());
  EXPECT_TRUE(read(changed(kNavX, 19, hex("03")), report).empty());
  EXPECT_EQ(report.rejected["message whose texts do not fill it"], 2u);
  EXPECT_EQ(read(changed(kOverride, 9 + 54 + 10, hex("09")), report).size(), 1u) << "the other message is used";
}

TEST(MoosMessages, WithAnyByteChangedAreNoHarm) {
  for (std::size_t at = 0; at < kOverride.size(); ++at) {
    for (const int value : {0x00, 0x01, 0x7F, 0x80, 0xFF}) {
      std::string packet = kOverride;
      packet[at] = static_cast<char>(value);
      SourceReport report;
      EXPECT_LE(read(packet, report).size(), 2u);
      FrameStream frames(moos_frame_at);
      frames.push(bytes_of(packet), {}, 0);
      while (const auto found = frames.next(report)) (void)moos_messages_of(found->frame, report);
    }
  }
}

TEST(GivenObstacles, StateEastAndNorthAndHowLongTheyLast) {
  const GivenObstacle obstacle{{{10, 20}, {12, 20}, {12, 23.256}, {10, 23}}, "isobath_4", 10};
  const auto text = given_obstacle_text(obstacle);
  ASSERT_TRUE(text);
  EXPECT_THAT(*text, testing::StartsWith("pts={"));
  EXPECT_THAT(*text, testing::HasSubstr("23.26,12.00"));
  EXPECT_THAT(*text, testing::EndsWith("},label=isobath_4,duration=10"));
  const auto again = given_obstacle_of(*text);
  ASSERT_TRUE(again);
  EXPECT_EQ(again->label, "isobath_4");
  EXPECT_EQ(again->duration_s, 10);
  EXPECT_NEAR(area(again->outline_W), area(obstacle.outline_W), 0.05);
}

TEST(GivenObstacles, AreConvexAfterRounding) {
  // the middle corner lies a hair outside of a side, and on its inner side when rounded
  const GivenObstacle obstacle{{{0, 0}, {1.0049, 0.5051}, {2, 1}, {0, 3}}, "a", 10};
  const auto text = given_obstacle_text(obstacle);
  ASSERT_TRUE(text);
  EXPECT_TRUE(given_obstacle_of(*text)) << *text;
  EXPECT_FALSE(given_obstacle_text({{{0, 0}, {0.001, 0}, {0, 0.001}}, "a", 10})) << "smaller than a centimetre";
}

TEST(GivenObstacles, OfAnotherFormAreRefused) {
  EXPECT_TRUE(given_obstacle_of("pts={0,0:4,0:4,4},label=ob_1,duration=10"));
  for (const char* wrong :
       {"", "pts={", "pts={}", "pts={0,0:4,0:4,4}", "pts={0,0:4,0:4,4},label=ob_1", "pts={0,0:4,0:4,4},duration=10",
        "pts={0,0:4,0:4,4},label=ob_1,duration=0", "pts={0,0:4,0:x,4},label=ob_1,duration=10",
        "pts={0,0:4,0:nan,4},label=ob_1,duration=10", "pts={0,0:4,0},label=ob_1,duration=10",
        "pts={0,0:4,0:1,1:0,4},label=ob_1,duration=10", "pts={0,0:1e99,0:4,4},label=a,duration=1"})
    EXPECT_FALSE(given_obstacle_of(wrong)) << wrong;
}

}  // namespace
}  // namespace isobath::moos
