// What a page knows: items that replace one another, and what has changed since somebody asked.
#include <cstring>
#include <gtest/gtest.h>
#include <isobath/display/display_bytes.hpp>
#include <isobath/display/display_state.hpp>
#include <rapidcheck/gtest.h>
#include <tests/support/display_records.hpp>

namespace isobath {
namespace {

using test::Record;
using test::records_of;
using Kind = DisplayKind;

TEST(DisplayState, TellOnlyWhatHasChangedAndOfThatTheNewest) {
  DisplayState items;
  items.set(Kind::kScene, 0, Time(seconds(1.0)), "a lake");
  items.set(Kind::kWay, 0, Time(seconds(2.0)), "north");
  const auto first = items.changes_after(0);
  EXPECT_EQ(records_of(first.records).size(), 2U);

  items.set(Kind::kWay, 0, Time(seconds(3.0)), "east");
  items.set(Kind::kWay, 0, Time(seconds(4.0)), "south");
  items.set(Kind::kScene, 0, Time(seconds(4.0)), "a lake");  // as it was
  const auto later = records_of(items.changes_after(first.stamp).records);
  ASSERT_EQ(later.size(), 1U);
  EXPECT_EQ(later[0].payload, "south");
  EXPECT_EQ(later[0].time, Time(seconds(4.0)));
  EXPECT_TRUE(records_of(items.changes_after(items.stamp()).records).empty());
}

TEST(DisplayState, ASecondPingThatLooksTheSameIsNewsAllTheSame) {
  DisplayState items;
  items.set(Kind::kEchoes, 7, Time(seconds(1.0)), "still water");
  const std::uint64_t stamp = items.stamp();
  items.set(Kind::kEchoes, 7, Time(seconds(2.0)), "still water");
  EXPECT_EQ(records_of(items.changes_after(stamp).records).size(), 1U);
}

TEST(DisplayState, WhatIsGoneIsToldOnceAndNeverToNewcomers) {
  DisplayState items;
  items.set(Kind::kVoxels, 5, Time(seconds(1.0)), "block");
  const std::uint64_t stamp = items.stamp();
  items.remove(Kind::kVoxels, 5, Time(seconds(2.0)));
  items.remove(Kind::kVoxels, 6, Time(seconds(2.0)));  // never was
  const auto told = records_of(items.changes_after(stamp).records);
  ASSERT_EQ(told.size(), 1U);
  EXPECT_TRUE(told[0].gone);
  EXPECT_TRUE(records_of(items.changes_after(0).records).empty());
  EXPECT_EQ(items.bytes(), 0U);
}

TEST(DisplayState, WhoeverAskedBeforeAllWasForgottenGetsItWhole) {
  DisplayState items;
  items.set(Kind::kScene, 0, Time(seconds(1.0)), "before");
  const std::uint64_t stamp = items.stamp();
  items.clear();
  items.set(Kind::kWay, 0, Time(seconds(9.0)), "after");
  const auto told = records_of(items.changes_after(stamp).records);
  ASSERT_EQ(told.size(), 1U);
  EXPECT_TRUE(told[0].forget);
  EXPECT_EQ(told[0].payload, "after");
}

TEST(DisplayState, VoxelsAreToldApartFromAllElse) {
  DisplayState items;
  items.set(Kind::kWay, 0, Time(seconds(1.0)), "way");
  items.set(Kind::kVoxels, 1, Time(seconds(1.0)), "first");
  items.set(Kind::kCubes, 0, Time(seconds(1.0)), "cubes");
  items.set(Kind::kVoxels, 2, Time(seconds(1.0)), "second");
  const auto told = [&](DisplayPart part, std::uint64_t stamp) {
    return records_of(items.changes_after(stamp, 1'000'000, part).records);
  };
  const auto rest = told(DisplayPart::kAllButVoxels, 0), voxels = told(DisplayPart::kVoxels, 0);
  ASSERT_EQ(rest.size(), 2U);
  EXPECT_EQ(rest[1].kind, Kind::kCubes);
  EXPECT_TRUE(rest[0].forget);
  ASSERT_EQ(voxels.size(), 2U);
  EXPECT_FALSE(voxels[0].forget) << "all else stays";
  EXPECT_TRUE(voxels[0].forget_kind);
  EXPECT_FALSE(voxels[1].forget_kind);

  // each part has its own stamp
  items.set(Kind::kWay, 0, Time(seconds(2.0)), "another");
  EXPECT_EQ(told(DisplayPart::kAllButVoxels, 4).size(), 1U);
  EXPECT_TRUE(told(DisplayPart::kVoxels, 4).empty());
  EXPECT_EQ(items.changes_after(4, 1'000'000, DisplayPart::kVoxels).stamp, 5U);
  EXPECT_EQ(told(DisplayPart::kVoxels, 2).size(), 1U);
}

TEST(DisplayState, APartThatIsForgottenLeavesTheRest) {
  DisplayState page, source;
  page.set(Kind::kWay, 0, Time(seconds(1.0)), "way");
  page.set(Kind::kVoxels, 1, Time(seconds(1.0)), "of long ago");
  source.set(Kind::kVoxels, 2, Time(seconds(2.0)), "new");
  page.update(source.changes_after(0, 1'000'000, DisplayPart::kVoxels).records);
  const auto items = test::as_map(page.changes_after(0).records);
  ASSERT_EQ(items.size(), 2U);
  EXPECT_EQ(items.at({Kind::kWay, 0}), "way");
  EXPECT_EQ(items.at({Kind::kVoxels, 2}), "new");
}

TEST(DisplayState, BecomeThoseOfAnotherMoment) {
  DisplayState page, then;
  page.set(Kind::kWay, 0, Time(seconds(1.0)), "way");
  page.set(Kind::kDepth, 1, Time(seconds(1.0)), "tile");
  page.set(Kind::kDecision, 7, Time(seconds(1.0)), "later");
  then.set(Kind::kDepth, 1, Time(seconds(0.5)), "tile");
  then.set(Kind::kWay, 0, Time(seconds(0.5)), "earlier");
  then.set(Kind::kVoxels, 3, Time(seconds(0.5)), "block");
  then.set(Kind::kVoxels, 4, Time(seconds(0.5)), "gone by then");
  then.remove(Kind::kVoxels, 4, Time(seconds(0.6)));
  const std::uint64_t stamp = page.stamp();
  page.become(then, Time(seconds(0.6)));
  const auto told = records_of(page.changes_after(stamp).records);
  ASSERT_EQ(told.size(), 3U) << "the tile is the same";
  EXPECT_TRUE(told[0].gone);
  EXPECT_EQ(told[0].number, 7U);
  EXPECT_EQ(told[0].time, Time(seconds(0.6)));
  EXPECT_EQ(told[1].payload, "earlier");
  EXPECT_EQ(test::as_map(page.changes_after(0).records), test::as_map(then.changes_after(0).records));
}

TEST(DisplayState, DamagedRecordsAreRefusedFromTheFirstThatDoesNotFit) {
  std::string records;
  append_record(records, Kind::kWay, 0, Time(seconds(1.0)), "whole");
  const std::size_t whole = records.size();
  append_record(records, Kind::kScene, 0, Time(seconds(1.0)), "cut in the middle");
  DisplayState items;
  EXPECT_EQ(items.update(std::string_view(records).substr(0, records.size() - 9)), whole);
  EXPECT_EQ(records_of(items.changes_after(0).records).size(), 1U);
  records[whole] = 99;  // a kind that nobody knows
  EXPECT_EQ(items.update(records), whole);
  std::string lies = records.substr(0, whole);
  const std::uint32_t endless = 0xffffffff;
  std::memcpy(lies.data() + 4, &endless, 4);
  EXPECT_EQ(items.update(lies), 0U);
}

TEST(DisplayState, HoweverFarBehindAPageIsItGetsWhatCameAfterItsStamp) {
  for (const std::uint64_t count : {1U, 2U, 9U, 10U}) {
    DisplayState items;
    for (std::uint64_t i = 1; i <= count; ++i) items.set(Kind::kTrack, i, Time(seconds(1.0)), "a place");
    for (std::uint64_t stamp = 1; stamp <= count; ++stamp) {
      const auto told = records_of(items.changes_after(stamp).records);
      ASSERT_EQ(told.size(), count - stamp);
      for (std::uint64_t i = 0; i < told.size(); ++i) EXPECT_EQ(told[i].number, stamp + 1 + i);
    }
  }
}

/// Any order of changes, asked for at any moments: who takes them holds what the source holds.
RC_GTEST_PROP(DisplayState, APageThatAsksNowAndThenKnowsWhatThereIs, ()) {
  DisplayState source, page;
  std::uint64_t stamp = 0;
  const int steps = *rc::gen::inRange(1, 60);
  for (int i = 0; i < steps; ++i) {
    const auto number = *rc::gen::inRange<std::uint64_t>(0, 6);
    const Kind kind = *rc::gen::element(Kind::kWay, Kind::kVoxels, Kind::kDepth);
    switch (*rc::gen::inRange(0, 8)) {
      case 0: source.remove(kind, number, Time(seconds(1.0 * i))); break;
      case 1: source.clear(); break;
      case 2: {
        const auto changes = source.changes_after(stamp);
        RC_ASSERT(page.update(changes.records) == changes.records.size());
        if (changes.records.empty() && source.bytes() == 0) page.clear();
        stamp = changes.stamp;
        break;
      }
      default: source.set(kind, number, Time(seconds(1.0 * i)), *rc::gen::string<std::string>());
    }
  }
  const auto changes = source.changes_after(stamp);
  page.update(changes.records);
  if (source.changes_after(0).records.empty()) page.clear();
  RC_ASSERT(test::as_map(page.changes_after(0).records) == test::as_map(source.changes_after(0).records));
}

RC_GTEST_PROP(DisplayBytes, PackedRunsComeBack, ()) {
  const auto bytes = *rc::gen::container<std::vector<std::uint8_t>>(rc::gen::inRange<std::uint8_t>(0, 3));
  DisplayBytes packed;
  packed.append_packed(bytes);
  const std::string record = packed.take();
  RC_ASSERT(test::unpacked(record) == bytes);
  std::vector<std::uint8_t> again(bytes.size());
  RC_ASSERT(unpack_bits(record, again));
  RC_ASSERT(again == bytes);
}

/// Whatever bytes come: what is accepted is what the plain reading gives, and nothing is read or written outside.
RC_GTEST_PROP(DisplayBytes, DamagedRunsAreRefused, ()) {
  const auto bytes = *rc::gen::container<std::string>(rc::gen::arbitrary<char>());
  std::vector<std::uint8_t> out(*rc::gen::inRange<std::size_t>(0, 300));
  if (unpack_bits(bytes, out)) RC_ASSERT(test::unpacked(bytes) == out);
}

TEST(DisplayBytes, PackedRunsAreShort) {
  DisplayBytes packed;
  packed.append_packed(std::vector<std::uint8_t>(160'000, 255));
  EXPECT_EQ(packed.size(), 2U * 160'000 / 128);
}

}  // namespace
}  // namespace isobath
