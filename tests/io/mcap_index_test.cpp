// Seeking in MCAP files: closed ones, cut ones, damaged ones, and ones that grow while they are read.
#include <algorithm>
#include <fstream>
#include <gmock/gmock.h>
#include <isobath/base/error.hpp>
#include <isobath/base/random.hpp>
#include <isobath/io/bytes/whole_file.hpp>
#include <isobath/io/mcap/mcap_index.hpp>
#include <isobath/io/mcap/mcap_records.hpp>
#include <sstream>
#include <tests/support/data.hpp>

namespace isobath {
namespace {

namespace fs = std::filesystem;
using mcap::Buffer;

struct Written {
  std::uint16_t channel;
  std::uint64_t time;
  std::uint32_t number;  ///< in the order of writing
  bool operator==(const Written&) const = default;
};

std::vector<std::uint8_t> body_of(std::uint32_t number) {
  std::vector<std::uint8_t> body(60 + number % 50, static_cast<std::uint8_t>(number));
  std::memcpy(body.data(), &number, 4);
  return body;
}

Written read_as(const McapMessage& m) {
  Written w{m.channel_id, m.log_time, 0};
  std::memcpy(&w.number, m.data.data(), 4);
  EXPECT_TRUE(std::equal(m.data.begin(), m.data.end(), body_of(w.number).begin()));
  return w;
}

constexpr std::uint64_t kTick = 1'000'000;

/// Three channels in two groups, times that stumble back now and then; chunks of about a KiB.
struct Sample {
  std::vector<Written> all;
  Buffer bytes;
};
Sample sample_file(int messages, bool close = true) {
  const fs::path file = test::scratch_folder() / "index.mcap";
  Random random(5);
  Sample sample;
  McapWriter writer(file, {McapCompression::kZstd, 1, 0});
  const auto a = writer.add_channel({0, 0, "/a", "json", {}});
  const auto b = writer.add_channel({0, 0, "/b", "json", {}});
  const auto c = writer.add_channel({0, 0, "/c", "json", {}}, 1);
  std::uint64_t time = 1000;
  for (int i = 0; i < messages; ++i) {
    const std::size_t kind = random.index(20);
    const std::uint16_t channel = kind == 0 ? c : kind < 6 ? b : a;
    time += random.index(4);
    const std::uint64_t back = random.index(10) == 0 ? random.index(30) : 0;
    const auto number = static_cast<std::uint32_t>(i);
    sample.all.push_back({channel, (time - back) * kTick, number});
    const auto body = body_of(number);
    writer.write({channel, number, sample.all.back().time, 0, body, nullptr});
  }
  if (close) {
    writer.close();
  } else {
    writer.flush();
  }
  sample.bytes = read_whole_file(file, 1 << 24);
  return sample;
}

std::unique_ptr<std::istream> stream_of(const Buffer& bytes) {
  return std::make_unique<std::istringstream>(std::string(bytes.begin(), bytes.end()));
}

std::vector<Written> visited(McapIndex& index, const std::vector<std::uint16_t>& channels, std::uint64_t from,
                             std::uint64_t to) {
  std::vector<Written> got;
  index.visit(channels, from, to, [&](const McapMessage& m) {
    got.push_back(read_as(m));
    return true;
  });
  return got;
}

/// The slow, obvious answers.
std::vector<Written> chosen(const std::vector<Written>& all, const std::vector<std::uint16_t>& channels,
                            std::uint64_t from, std::uint64_t to) {
  std::vector<Written> want;
  for (const Written& w : all) {
    const bool wanted = std::find(channels.begin(), channels.end(), w.channel) != channels.end();
    if (wanted && w.time >= from && w.time <= to) want.push_back(w);
  }
  std::stable_sort(want.begin(), want.end(), [](const Written& x, const Written& y) { return x.time < y.time; });
  return want;
}

void expect_all_answers(McapIndex& index, const std::vector<Written>& all, int questions, std::uint64_t seed) {
  Random random(seed);
  for (int i = 0; i < questions; ++i) {
    std::vector<std::uint16_t> channels;
    for (std::uint16_t id = 1; id <= 3; ++id) {
      if (random.index(2) == 0) channels.push_back(id);
    }
    const std::uint64_t from = (900 + random.index(2000)) * kTick;
    const std::uint64_t to = from + random.index(400) * kTick;
    const std::vector<Written> got = visited(index, channels, from, to), want = chosen(all, channels, from, to);
    // Between groups the file keeps no order of writing: of the same time any may come first.
    ASSERT_TRUE(std::is_permutation(got.begin(), got.end(), want.begin(), want.end()));
    ASSERT_TRUE(std::is_sorted(got.begin(), got.end(), [](auto& x, auto& y) { return x.time < y.time; }));
    const auto channel = static_cast<std::uint16_t>(1 + random.index(3));
    const auto before = chosen(all, {channel}, 0, from);
    const auto last = index.last(channel, from);
    ASSERT_EQ(last.has_value(), !before.empty());
    if (last) {
      ASSERT_EQ(read_as(*last), before.back());
    }
    const auto earlier = chosen(all, {channel}, 0, from - 1), later = chosen(all, {channel}, from + 1, ~0ull);
    ASSERT_EQ(index.time_before(channel, from), earlier.empty() ? std::nullopt : std::optional(earlier.back().time));
    ASSERT_EQ(index.time_after(channel, from), later.empty() ? std::nullopt : std::optional(later.front().time));
  }
}

TEST(McapIndex, AnswersAsReadingAllWould) {
  const Sample sample = sample_file(1500);
  McapIndex index(stream_of(sample.bytes), "x.mcap");
  EXPECT_TRUE(index.complete());
  EXPECT_EQ(index.channel_of("/b"), 2);
  EXPECT_EQ(index.channel_of("/d"), std::nullopt);
  const auto [first, last] =
      std::minmax_element(sample.all.begin(), sample.all.end(), [](auto& x, auto& y) { return x.time < y.time; });
  EXPECT_EQ(index.span()->first, first->time);
  EXPECT_EQ(index.span()->last, last->time);
  expect_all_answers(index, sample.all, 400, 1);
  EXPECT_EQ(index.report().bytes_skipped, 0u);
  EXPECT_TRUE(index.report().rejected.empty());
}

TEST(McapIndex, KnowsTheSameOfAFileThatWasNeverClosed) {
  const Sample sample = sample_file(1500, false);
  McapIndex index(stream_of(sample.bytes), "x.mcap");
  EXPECT_FALSE(index.complete());
  expect_all_answers(index, sample.all, 400, 2);
}

TEST(McapIndex, MessagesOfOneChannelComeInTheOrderOfWritingWhereTimesAreTheSame) {
  const fs::path file = test::scratch_folder() / "same.mcap";
  McapWriter writer(file, {McapCompression::kNone, 1, 0});
  const auto a = writer.add_channel({0, 0, "/a", "json", {}});
  std::vector<Written> all;
  for (std::uint32_t i = 0; i < 200; ++i) {
    all.push_back({a, (i / 50) * kTick, i});  // many chunks share each time
    const auto body = body_of(i);
    writer.write({a, i, all.back().time, 0, body, nullptr});
  }
  writer.close();
  McapIndex index(file);
  EXPECT_GT(index.counts().chunks, 8u);
  EXPECT_EQ(visited(index, {a}, 0, ~0ull), all);
  EXPECT_EQ(read_as(*index.last(a, 2 * kTick)).number, 149u) << "the last that was written";
}

// What a query costs is chunks: those that hold the answer, and no others.
TEST(McapIndex, UnpacksOnlyWhatItNeeds) {
  const fs::path file = test::scratch_folder() / "hour.mcap";
  McapWriter writer(file, {McapCompression::kZstd, 1024, 5});
  const auto loud = writer.add_channel({0, 0, "/loud", "json", {}});
  const auto rare = writer.add_channel({0, 0, "/rare", "json", {}}, 1);
  const auto body = body_of(7);
  for (std::uint64_t i = 0; i < 36000; ++i) {
    const std::uint64_t time = i * 100 * kTick;
    writer.write({loud, 0, time, 0, body, nullptr});
    if (i % 600 == 0) writer.write({rare, 0, time, 0, body, nullptr});
  }
  writer.close();
  McapIndex index(file);
  EXPECT_GT(index.counts().chunks, 700u) << "five seconds each";
  EXPECT_EQ(index.counts().unpacked, 0u) << "opening unpacks nothing";
  ASSERT_TRUE(index.last(rare, 1800'000 * kTick));
  EXPECT_EQ(index.counts().unpacked, 1u);
  EXPECT_EQ(index.last(rare, 1800'001 * kTick)->log_time, 1800'000 * kTick);
  EXPECT_EQ(index.last(rare, 1799'999 * kTick)->log_time, 1740'000 * kTick);
  EXPECT_EQ(index.counts().unpacked, 2u) << "that a chunk holds nothing so early is known from its index";
  EXPECT_EQ(index.time_after(rare, 1800'000 * kTick), 1860'000 * kTick);
  EXPECT_EQ(index.time_before(loud, 5 * kTick), 0u);
  EXPECT_EQ(index.counts().unpacked, 2u) << "times are asked of the indexes alone";
  EXPECT_EQ(visited(index, {loud}, 1000'000 * kTick, 1019'999 * kTick).size(), 200u);
  EXPECT_LE(index.counts().unpacked, 2u + 5u);
}

/// Bytes that somebody else appends to.
struct Growing {
  std::stringbuf bytes{std::ios::in | std::ios::out | std::ios::binary};
  std::size_t size = 0;
  void grow(const Buffer& all, std::size_t to) {
    bytes.sputn(reinterpret_cast<const char*>(all.data()) + size, static_cast<std::streamsize>(to - size));
    size = to;
  }
};

// Whatever part of a record has reached the disk when it is looked at.
TEST(McapIndex, TakesInAFileThatGrows) {
  const Sample sample = sample_file(300);
  Growing growing;
  growing.grow(sample.bytes, 8);
  McapIndex index(std::make_unique<std::istream>(&growing.bytes), "x.mcap");
  EXPECT_FALSE(index.span());
  Random random(3);
  std::size_t most = 0;
  while (growing.size < sample.bytes.size()) {
    growing.grow(sample.bytes, std::min(growing.size + 1 + random.index(700), sample.bytes.size()));
    index.refresh();
    const Buffer so_far(sample.bytes.begin(), sample.bytes.begin() + static_cast<std::ptrdiff_t>(growing.size));
    McapIndex fresh(stream_of(so_far), "x.mcap");
    const std::vector<Written> got = visited(index, {1, 2, 3}, 0, ~0ull);
    ASSERT_EQ(got, visited(fresh, {1, 2, 3}, 0, ~0ull)) << growing.size;
    ASSERT_GE(got.size(), most);
    most = got.size();
  }
  EXPECT_EQ(most, 300u);
  EXPECT_TRUE(index.complete());
  EXPECT_FALSE(index.refresh());
  EXPECT_EQ(index.report().bytes_skipped, 0u) << "what is not yet whole is no damage";
  expect_all_answers(index, sample.all, 50, 4);
}

/// Where the chunks of a sound file stand.
std::vector<std::pair<std::size_t, std::size_t>> chunks_in(const Buffer& bytes) {
  std::vector<std::pair<std::size_t, std::size_t>> all;
  for (std::size_t at = 8; at + 9 < bytes.size();) {
    std::uint64_t length = 0;
    std::memcpy(&length, &bytes[at + 1], 8);
    if (bytes[at] == mcap::kChunk) all.emplace_back(at, 9 + length);
    at += 9 + length;
  }
  return all;
}

TEST(McapIndex, ADamagedChunkCostsItself) {
  const Sample sample = sample_file(600);
  const auto chunks = chunks_in(sample.bytes);
  McapIndex sound(stream_of(sample.bytes), "x.mcap");
  const auto all = visited(sound, {1, 2, 3}, 0, ~0ull);
  for (const bool closed : {true, false}) {
    Buffer bytes = sample.bytes;
    bytes[chunks[3].first + chunks[3].second - 20] ^= 0x55;
    if (!closed) bytes.resize(bytes.size() - 8);
    McapIndex index(stream_of(bytes), "x.mcap");
    EXPECT_EQ(index.complete(), true) << "by the end of its data";
    const auto got = visited(index, {1, 2, 3}, 0, ~0ull);
    EXPECT_LT(got.size(), all.size());
    EXPECT_GT(got.size(), all.size() - 20);
    for (const Written& w : got) EXPECT_NE(std::find(all.begin(), all.end(), w), all.end());
    ASSERT_EQ(index.report().damages.size(), 1u);
    EXPECT_EQ(index.report().damages[0].offset, chunks[3].first);
    EXPECT_EQ(visited(index, {1, 2, 3}, 0, ~0ull), got) << "asked again, reported once";
    EXPECT_EQ(index.report().damages.size(), 1u);
  }
}

// Where the length of a record is wrong, the next chunk is found by its look.
TEST(McapIndex, FindsItsWayAfterALengthThatLies) {
  const Sample sample = sample_file(600, false);
  const auto chunks = chunks_in(sample.bytes);
  Buffer bytes = sample.bytes;
  bytes[chunks[4].first + 7] = 0x7f;
  McapIndex index(stream_of(bytes), "x.mcap");
  EXPECT_EQ(index.counts().chunks, chunks.size() - 1);
  EXPECT_EQ(index.report().damages.size(), 1u);
  EXPECT_GT(visited(index, {1, 2, 3}, 0, ~0ull).size(), 570u);
}

// An index of messages that lies is found out by the chunk itself.
TEST(McapIndex, DoesNotBelieveAnIndexThatLies) {
  Sample sample = sample_file(100, false);
  const auto chunks = chunks_in(sample.bytes);
  std::size_t at = chunks[0].first + chunks[0].second;  // the first index of messages
  ASSERT_EQ(sample.bytes[at], mcap::kMessageIndex);
  sample.bytes[at + 9 + 6 + 1] ^= 1;  // its first time
  McapIndex index(stream_of(sample.bytes), "x.mcap");
  for (std::uint64_t t = 990; t < 1100; ++t) {
    const auto got = index.last(1, t * kTick);
    EXPECT_TRUE(!got || read_as(*got).time <= t * kTick);
  }
  EXPECT_EQ(visited(index, {1, 2, 3}, 0, ~0ull).size(), 100u) << "what is visited is read from the chunks";
}

TEST(McapIndex, SurvivesRandomDamage) {
  Random random(11);
  const Sample sample = sample_file(60);
  for (int round = 0; round < 1500; ++round) {
    Buffer bytes = sample.bytes;
    const int hits = 1 + static_cast<int>(random.index(8));
    for (int i = 0; i < hits; ++i) bytes[8 + random.index(bytes.size() - 8)] = static_cast<std::uint8_t>(random.bits());
    if (random.index(3) == 0) bytes.resize(8 + random.index(bytes.size() - 8));
    McapIndex index(stream_of(bytes), "x.mcap");
    std::size_t messages = 0;
    index.visit(std::vector<std::uint16_t>{1, 2, 3}, 0, ~0ull, [&](const McapMessage&) { return ++messages < 1000; });
    EXPECT_LE(messages, 60u);
    for (std::uint16_t channel = 1; channel <= 3; ++channel) {
      const auto last = index.last(channel, 1050 * kTick);
      EXPECT_TRUE(!last || last->log_time <= 1050 * kTick);
      (void)index.time_after(channel, 1050 * kTick);
    }
  }
}

TEST(McapIndex, IsOfMcapOnly) {
  EXPECT_THROW(McapIndex(stream_of({1, 2, 3}), "x.mcap"), Error);
  EXPECT_THROW(McapIndex("/nowhere/at/all.mcap"), Error);
}

// What a crash can cost is bounded in time, whatever little is written.
TEST(McapIndex, ChunksAreWrittenAfterFiveSecondsAtTheLatest) {
  const fs::path file = test::scratch_folder() / "slow.mcap";
  McapWriter writer(file, {});
  const auto often = writer.add_channel({0, 0, "/often", "json", {}});
  const auto once = writer.add_channel({0, 0, "/once", "json", {}}, 1);
  const auto body = body_of(1);
  writer.write({once, 0, 0, 0, body, nullptr});
  for (std::uint64_t second = 0; second <= 12; ++second) {
    writer.write({often, 0, second * 1000 * kTick, 0, body, nullptr});
  }
  McapIndex index(file);  // while the writer is at it
  EXPECT_EQ(visited(index, {once}, 0, ~0ull).size(), 1u) << "written when the time of another group had passed it by";
  EXPECT_EQ(visited(index, {often}, 0, ~0ull).size(), 12u) << "all but the second chunk's successor";
  writer.close();
  EXPECT_TRUE(index.refresh());
  EXPECT_EQ(visited(index, {often}, 0, ~0ull).size(), 13u);
}

}  // namespace
}  // namespace isobath
