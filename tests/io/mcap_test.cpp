// The MCAP container and the native log in it. tests/io/mcap_conformance reads our files with another's reader.
#include <algorithm>
#include <bit>
#include <cmath>
#include <fstream>
#include <gmock/gmock.h>
#include <isobath/base/error.hpp>
#include <isobath/base/random.hpp>
#include <isobath/io/bytes/whole_file.hpp>
#include <isobath/io/frames/frame_folder.hpp>
#include <isobath/io/mcap/mcap_records.hpp>
#include <isobath/io/mcap/native_log.hpp>
#include <sstream>
#include <tests/io/sample_events.hpp>
#include <tests/support/data.hpp>

namespace isobath {
namespace {

namespace fs = std::filesystem;
using mcap::Buffer;
using testing::HasSubstr;

McapReader reader_of(const Buffer& bytes) {
  return McapReader(std::make_unique<std::istringstream>(std::string(bytes.begin(), bytes.end())), "x.mcap");
}

/// Ten chunks of four messages, 100 bytes each, "<i>" in front, with metadata and an attachment.
Buffer small_file(McapCompression compression) {
  const fs::path file = test::scratch_folder() / "small.mcap";
  McapWriter writer(file, {compression, 1024});
  const auto schema = writer.add_schema({0, "test/Text", "jsonschema", "{}"});
  const auto channel = writer.add_channel({0, schema, "/text", "json", {{"key", "value"}}});
  writer.add_metadata({"about", {{"a", "1"}, {"b", "2"}}});
  writer.add_attachment({1, 2, "note.txt", "text/plain", "hello"});
  for (int i = 0; i < 40; ++i) {
    std::vector<std::uint8_t> data(100, static_cast<std::uint8_t>(i * 7));
    data[0] = static_cast<std::uint8_t>(i);
    const auto time = static_cast<std::uint64_t>(1000 + i);
    writer.write({channel, static_cast<std::uint32_t>(i), time, time, data, nullptr});
    if (i % 4 == 3) writer.flush();
  }
  writer.close();
  return read_whole_file(file, 1 << 20);
}

struct ReadBack {
  std::vector<int> messages;
  SourceReport report;
};

ReadBack read_back(const Buffer& bytes) {
  ReadBack result;
  McapReader reader = reader_of(bytes);
  while (const auto message = reader.next()) {
    if (message->data.size() == 100) result.messages.push_back(message->data[0]);
  }
  result.report = reader.report();
  return result;
}

std::vector<int> counted(int from, int to) {
  std::vector<int> all;
  for (int i = from; i < to; ++i) all.push_back(i);
  return all;
}

struct At {
  std::uint8_t opcode;
  std::size_t offset, size;
};
/// The records of a sound file.
std::vector<At> records_of(const Buffer& bytes) {
  std::vector<At> all;
  for (std::size_t at = 8; at + 8 < bytes.size();) {
    std::uint64_t length = 0;
    std::memcpy(&length, &bytes[at + 1], 8);
    all.push_back({bytes[at], at, 9 + length});
    at += 9 + length;
  }
  return all;
}

std::vector<At> chunks_of(const Buffer& bytes) {
  auto all = records_of(bytes);
  std::erase_if(all, [](const At& r) { return r.opcode != mcap::kChunk; });
  return all;
}

// The worked bytes of the format: magic, header and the checksum of "123456789".
TEST(Mcap, WritesTheBytesOfTheSpecification) {
  const Buffer bytes = small_file(McapCompression::kNone);
  const std::uint8_t head[] = {0x89, 0x4D, 0x43, 0x41, 0x50, 0x30, 0x0D, 0x0A, 0x01, 0x0F, 0,   0,   0,   0,   0,  0, 0,
                               0,    0,    0,    0,    0x07, 0,    0,    0,    'i',  's',  'o', 'b', 'a', 't', 'h'};
  EXPECT_TRUE(std::equal(std::begin(head), std::end(head), bytes.begin()));
  const std::string digits = "123456789";
  EXPECT_EQ(mcap::crc32({reinterpret_cast<const std::uint8_t*>(digits.data()), 9}), 0xCBF43926u);
  EXPECT_TRUE(looks_like_mcap(std::span(bytes).last(8)));
  const auto records = records_of(bytes);
  std::string opcodes;
  for (const At& r : records) opcodes += static_cast<char>('@' + r.opcode);
  EXPECT_EQ(opcodes,
            "ACDLI"
            "FGFGFGFGFGFGFGFGFGFG"
            "O"
            "CDK"
            "HHHHHHHHHH"
            "JM"
            "NNNNNN"
            "B");
}

TEST(Mcap, RoundTripsEveryCompression) {
  for (const auto compression : {McapCompression::kNone, McapCompression::kLz4, McapCompression::kZstd}) {
    const Buffer bytes = small_file(compression);
    EXPECT_EQ(bytes, small_file(compression));
    McapReader reader = reader_of(bytes);
    EXPECT_EQ(reader.messages_in_summary(), 40u);
    ASSERT_EQ(reader.metadata().size(), 1u) << "known before the first message";
    EXPECT_EQ(reader.metadata()[0].values.at("b"), "2");
    ASSERT_EQ(reader.attachments().size(), 1u);
    EXPECT_EQ(reader.attachments()[0].data, "hello");
    EXPECT_EQ(reader.channel(1)->metadata.at("key"), "value");
    EXPECT_EQ(reader.schema(1)->name, "test/Text");
    int count = 0;
    for (; const auto m = reader.next(); ++count) {
      EXPECT_EQ(m->sequence, static_cast<std::uint32_t>(count));
      EXPECT_EQ(m->log_time, 1000u + count);
      EXPECT_EQ(m->data.back(), static_cast<std::uint8_t>(7 * count));
    }
    EXPECT_EQ(count, 40);
    EXPECT_EQ(reader.report().bytes_skipped, 0u);
    EXPECT_TRUE(reader.report().rejected.empty());
  }
}

TEST(Mcap, IsReadableUpToTheLastWholeChunkWhereverItIsCutOff) {
  const Buffer bytes = small_file(McapCompression::kZstd);
  const auto chunks = chunks_of(bytes);
  for (std::size_t size = 0; size < bytes.size(); ++size) {
    const Buffer cut(bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(size));
    if (size < 8) {
      EXPECT_THROW(read_back(cut), Error);
      continue;
    }
    int whole = 0;
    for (const At& c : chunks) whole += c.offset + c.size <= size;
    const ReadBack got = read_back(cut);
    ASSERT_EQ(got.messages, counted(0, 4 * whole)) << "cut at " << size;
    ASSERT_EQ(got.report.details.count("index"), 1u);
  }
}

TEST(Mcap, LosesOnlyTheDamagedChunk) {
  for (const bool with_summary : {true, false}) {
    Buffer bytes = small_file(McapCompression::kZstd);
    const At chunk = chunks_of(bytes)[3];
    if (!with_summary) bytes.resize(bytes.size() - 8);
    bytes[chunk.offset + chunk.size - 3] ^= 0x10;
    const ReadBack got = read_back(bytes);
    std::vector<int> expected = counted(0, 40);
    expected.erase(expected.begin() + 12, expected.begin() + 16);
    EXPECT_EQ(got.messages, expected);
    ASSERT_EQ(got.report.damages.size(), 1u);
    EXPECT_EQ(got.report.damages[0].offset, chunk.offset);
    EXPECT_EQ(got.report.damages[0].bytes, chunk.size);
    EXPECT_THAT(got.report.damages[0].reason, HasSubstr("chunk"));
  }
}

TEST(Mcap, FindsTheNextChunkAfterAStretchOfGarbage) {
  for (const bool with_summary : {true, false}) {
    Buffer bytes = small_file(McapCompression::kLz4);
    const auto chunks = chunks_of(bytes);
    for (std::size_t i = chunks[2].offset - 5; i < chunks[3].offset + 30; ++i) bytes[i] = 0xA5;
    if (!with_summary) bytes.resize(bytes.size() - 20);
    const ReadBack got = read_back(bytes);
    std::vector<int> expected = counted(0, 40);
    expected.erase(expected.begin() + 8, expected.begin() + 16);
    EXPECT_EQ(got.messages, expected) << with_summary;
    EXPECT_GE(got.report.bytes_skipped, chunks[3].offset + 30 - chunks[2].offset);
  }
}

TEST(Mcap, LosesNothingWhereverTheFooterPoints) {
  const Buffer good = small_file(McapCompression::kZstd);
  for (std::uint64_t start = 0; start < good.size() + 3; ++start) {
    Buffer bytes = good;
    std::uint8_t* footer = &bytes[bytes.size() - 8 - 20];
    std::memcpy(footer, &start, 8);
    std::memset(footer + 16, 0, 4);  // no checksum of the summary
    ASSERT_EQ(read_back(bytes).messages, counted(0, 40)) << start;
  }
}

TEST(Mcap, RefusesWhatASizeOrANestingLiesAbout) {
  Buffer out;
  Buffer inner;
  mcap::Writer(inner).record(mcap::kChunk, [] {});
  const auto chunk_of = [](std::span<const std::uint8_t> records, std::uint64_t size, const char* compression) {
    return mcap::ChunkHead{0, 0, size, 0, compression, records};
  };
  EXPECT_THAT(mcap::unpack(chunk_of(inner, 3, ""), out), HasSubstr("size differs from the stated size"));
  EXPECT_THAT(mcap::unpack(chunk_of(inner, kMaxMcapChunkBytes + 1, ""), out), HasSubstr("larger"));
  EXPECT_THAT(mcap::unpack(chunk_of(inner, 9, "gzip"), out), HasSubstr("unknown"));
  const Buffer zeros(1 << 20);
  for (const auto c : {McapCompression::kZstd, McapCompression::kLz4}) {
    const Buffer packed = mcap::pack(zeros, c);
    EXPECT_THAT(mcap::unpack(chunk_of(packed, 1000, mcap::name_of(c)), out), HasSubstr("more data"));
    EXPECT_THAT(mcap::unpack(chunk_of(packed, 1 << 21, mcap::name_of(c)), out),
                HasSubstr("size differs from the stated size"));
    EXPECT_THAT(mcap::unpack(chunk_of(std::span(packed).first(packed.size() - 5), 1 << 20, mcap::name_of(c)), out),
                HasSubstr("chunk: "));
    EXPECT_EQ(mcap::unpack(chunk_of(packed, 1 << 20, mcap::name_of(c)), out), "");
    EXPECT_EQ(out, zeros);
  }
}

// A file by hand: no chunks, no summary; ids that lie, records that contradict.
TEST(Mcap, CountsContradictions) {
  Buffer bytes;
  mcap::Writer w(bytes);
  w.bytes(mcap::kMagic);
  w.record(mcap::kHeader, [&] { w.text("").text("hand"); });
  const auto channel = [&](const char* topic) {
    w.record(mcap::kChannel,
             [&] { w.number(std::uint16_t{1}).number(std::uint16_t{0}).text(topic).text("json").map({}); });
  };
  const auto message = [&](std::uint16_t id) {
    w.record(mcap::kMessage,
             [&] { w.number(id).number(0u).number(std::uint64_t{0}).number(std::uint64_t{0}).bytes(Buffer(100, 1)); });
  };
  channel("/a");
  channel("/a");
  channel("/b");
  message(1);
  message(2);
  w.record(mcap::kSchema, [&] { w.number(std::uint16_t{0}).text("n").text("e").text(""); });
  w.record(mcap::kMetadata, [&] { w.text("odd").number(3u).number(std::uint8_t{1}); });
  w.record(mcap::kMessage, [&] { w.number(std::uint16_t{1}); });
  w.record(static_cast<mcap::Opcode>(0x90), [&] { w.text("private"); });
  w.record(mcap::kChunk, [&] {
    w.number(std::uint64_t{0}).number(std::uint64_t{0}).number(std::uint64_t{18}).number(0u).text("");
    w.counted([&] {
      w.number(0u);
      w.record(mcap::kChunk, [] {});
      w.number(std::uint8_t{5}).number(std::uint64_t{1} << 60);
    });
  });
  // the chunk's length of records is 64 bits wide: what `counted` wrote becomes its low half
  const std::size_t at = bytes.size() - 18 - 8;
  const std::uint64_t records = 18;
  std::memcpy(&bytes[at], &records, 8);
  message(1);
  const ReadBack got = read_back(bytes);
  EXPECT_EQ(got.messages, (std::vector<int>{1, 1}));
  EXPECT_EQ(got.report.details.at("written by"), "hand");
  const auto& rejected = got.report.rejected;
  EXPECT_EQ(rejected.at("channel defined twice with different content"), 1u);
  EXPECT_EQ(rejected.at("message on an unknown channel"), 1u);
  EXPECT_EQ(rejected.at("schema that cannot be read"), 1u);
  EXPECT_EQ(rejected.at("metadata that cannot be read"), 1u);
  EXPECT_EQ(rejected.at("message that cannot be read"), 1u);
  EXPECT_EQ(rejected.at("record that is not allowed in a chunk"), 1u);
  EXPECT_EQ(rejected.at("chunk with a broken record inside"), 1u);
}

TEST(Mcap, SurvivesRandomDamage) {
  Random random(11);
  const Buffer good = small_file(McapCompression::kZstd);
  for (int round = 0; round < 3000; ++round) {
    Buffer bytes = good;
    const int hits = 1 + static_cast<int>(random.index(8));
    for (int i = 0; i < hits; ++i) bytes[random.index(bytes.size())] = static_cast<std::uint8_t>(random.bits());
    if (random.index(3) == 0) {
      const auto from = static_cast<std::ptrdiff_t>(random.index(bytes.size()));
      const auto count =
          static_cast<std::ptrdiff_t>(std::min(random.index(200), bytes.size() - static_cast<std::size_t>(from)));
      bytes.erase(bytes.begin() + from, bytes.begin() + from + count);
    }
    try {
      const ReadBack got = read_back(bytes);
      EXPECT_LE(got.report.bytes_read, bytes.size());
      EXPECT_LE(got.messages.size(), 44u);
    } catch (const Error& e) {
      EXPECT_THAT(e.what(), HasSubstr("not MCAP"));
    }
  }
}

TEST(Mcap, SaysWhenTheDiskRefuses) {
  EXPECT_THROW(McapWriter("/nowhere/at/all.mcap", {}), Error);
  if (fs::exists("/dev/full")) {
    McapWriter writer("/dev/full", {});
    EXPECT_THROW(writer.flush(), Error);
    EXPECT_THROW(writer.close(), Error);
  }
}

std::vector<Event> read_events(Source& source) {
  std::vector<Event> events;
  while (auto event = source.next()) events.push_back(*std::move(event));
  return events;
}

TEST(NativeLog, GivesBackEveryEventBitForBit) {
  const fs::path file = test::scratch_folder() / "log.mcap";
  for (const auto compression : {McapCompression::kNone, McapCompression::kLz4, McapCompression::kZstd}) {
    const std::vector<Event> events = test::sample_events(200, 3);
    NativeLogWriter writer(file, {compression, 16});
    writer.set_details({{"sonar", "made up"}});
    for (const Event& event : events) ASSERT_TRUE(writer.write(event));
    writer.set_origin({60.123456789012345, -10.1});
    writer.close();
    const auto source = open_native_log(file, {});
    EXPECT_EQ(source->report().details.at("sonar"), "made up");
    const std::vector<Event> read = read_events(*source);
    ASSERT_EQ(read.size(), events.size());
    for (std::size_t i = 0; i < events.size(); ++i) EXPECT_TRUE(test::same(events[i], read[i])) << i;
    EXPECT_EQ(*source->report().origin, (GeoOrigin{60.123456789012345, -10.1}));
    EXPECT_EQ(source->report().bytes_skipped, 0u);
    EXPECT_TRUE(source->report().rejected.empty());
    EXPECT_EQ(source->report().bytes_read, source->report().bytes_total) << "progress ends at the end";
  }
}

TEST(NativeLog, SharesTheFanOfPingsOfOneGeometry) {
  const fs::path file = test::scratch_folder() / "log.mcap";
  NativeLogWriter writer(file);
  for (int i = 0; i < 3; ++i) writer.write(test::sample_ping(SampleType::kU8, i == 1 ? 9 : 5, 1));
  writer.close();
  const auto events = read_events(*open_native_log(file, {}));
  EXPECT_EQ(std::get<Ping>(events.at(0)).fan, std::get<Ping>(events.at(2)).fan);
  EXPECT_NE(std::get<Ping>(events.at(0)).fan, std::get<Ping>(events.at(1)).fan);
}

TEST(NativeLog, KeepsWhichBinsWereSampled) {
  const fs::path file = test::scratch_folder() / "log.mcap";
  NativeLogWriter writer(file);
  Ping ping = test::sample_ping(SampleType::kF32, 3, 1);
  writer.write(ping);
  ping.time += std::chrono::seconds(1);
  ping.sampled = std::make_shared<std::vector<BinSpan>>(
      std::vector<BinSpan>{{0, ping.window.bins}, {1, 2}, {ping.window.bins, ping.window.bins}});
  writer.write(ping);
  writer.close();
  const auto events = read_events(*open_native_log(file, {}));
  EXPECT_FALSE(std::get<Ping>(events.at(0)).sampled);
  EXPECT_EQ(*std::get<Ping>(events.at(1)).sampled, *ping.sampled);
}

// A log from before bins could be missing: its messages end with the samples.
TEST(NativeLog, OpensPingsThatDoNotSayWhichBinsWereSampled) {
  const fs::path folder = test::scratch_folder();
  const Ping ping = test::sample_ping(SampleType::kF32, 3, 1);
  NativeLogWriter now(folder / "now.mcap");
  now.write(ping);
  now.close();
  McapReader reader = reader_of(read_whole_file(folder / "now.mcap", 1 << 20));
  const auto message = reader.next();
  ASSERT_TRUE(message);
  McapWriter older(folder / "older.mcap", {McapCompression::kNone, 1 << 20});
  const McapChannel& channel = *reader.channel(message->channel_id);
  const std::uint16_t schema = older.add_schema(*reader.schema(channel.schema_id));
  McapChannel same = channel;
  same.schema_id = schema;
  McapMessage shorter = *message;
  shorter.channel_id = older.add_channel(same);
  shorter.data = message->data.first(message->data.size() - 4);  // the count of the list, which is empty
  older.write(shorter);
  older.close();
  const auto events = read_events(*open_native_log(folder / "older.mcap", {}));
  ASSERT_EQ(events.size(), 1u);
  EXPECT_EQ(std::get<Ping>(events[0]).intensity(2, 0), ping.intensity(2, 0));
  EXPECT_FALSE(std::get<Ping>(events[0]).sampled);
}

TEST(NativeLog, RefusesAPingThatNoReaderCouldUse) {
  const fs::path file = test::scratch_folder() / "log.mcap";
  NativeLogWriter writer(file);
  Ping ping = test::sample_ping(SampleType::kU8, 4, 1);
  ++ping.window.bins;
  EXPECT_FALSE(writer.write(ping));
  ping.fan = nullptr;
  EXPECT_FALSE(writer.write(ping));
  writer.close();
  EXPECT_FALSE(open_native_log(file, {})->next()) << "a log without events is a log";
}

TEST(NativeLog, RefusesAnotherOnesMcap) {
  const Buffer bytes = small_file(McapCompression::kZstd);
  try {
    open_native_log(std::make_unique<std::istringstream>(std::string(bytes.begin(), bytes.end())), "x.mcap");
    FAIL();
  } catch (const Error& e) {
    EXPECT_THAT(e.what(), HasSubstr("it holds /text"));
  }
}

TEST(NativeLog, SurvivesRandomDamageInsideMessages) {
  const fs::path file = test::scratch_folder() / "log.mcap";
  const std::vector<Event> events = test::sample_events(20, 4);
  NativeLogWriter writer(file, {McapCompression::kNone, 4});
  for (const Event& event : events) writer.write(event);
  writer.close();
  const Buffer good = read_whole_file(file, 1 << 24);
  Random random(12);
  for (int round = 0; round < 500; ++round) {
    Buffer bytes = good;
    const At hit = chunks_of(good)[random.index(chunks_of(good).size())];
    for (int i = 0; i < 4; ++i)
      bytes[hit.offset + 41 + random.index(hit.size - 41)] = static_cast<std::uint8_t>(random.bits());
    for (const At& c : chunks_of(good))
      std::fill_n(&bytes[c.offset + 33], 4, 0);  // no checksum: the damage gets through
    const auto source =
        open_native_log(std::make_unique<std::istringstream>(std::string(bytes.begin(), bytes.end())), "x");
    while (const auto event = source->next()) {
      if (const auto* ping = std::get_if<Ping>(&*event)) (void)check(*ping);
    }
  }
}

// Converting a log and running the copy must be the same as running the log.
TEST(NativeLog, CopiesARealRecording) {
  ISOBATH_NEEDS_DATA(folder, "holo-boat");
  const fs::path file = test::scratch_folder() / "holo.mcap";
  NativeLogWriter writer(file);
  const auto source = open_frame_folder(folder, {});
  for (int i = 0; i < 100; ++i) ASSERT_TRUE(writer.write(*source->next()));
  writer.close();
  const auto copy = open_native_log(file, {});
  const auto again = open_frame_folder(folder, {});
  for (int i = 0; i < 100; ++i) ASSERT_TRUE(test::same(*again->next(), *copy->next())) << i;
  EXPECT_FALSE(copy->next());
}

}  // namespace
}  // namespace isobath
