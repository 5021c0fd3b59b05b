// A recorded display is what the page showed: at any time, forwards, backwards, and while it is being recorded.
#include <algorithm>
#include <gtest/gtest.h>
#include <isobath/base/error.hpp>
#include <isobath/base/random.hpp>
#include <isobath/recording/recorded_display.hpp>
#include <isobath/recording/recorded_playback.hpp>
#include <isobath/recording/run_recorder.hpp>
#include <map>
#include <tests/support/data.hpp>

namespace isobath {
namespace {

using Picture = std::map<std::pair<DisplayKind, std::uint64_t>, std::string>;

Picture picture_of(const DisplayState& items) {
  Picture picture;
  for_each_record(items.changes_after(0).records, [&](const DisplayRecord& record) {
    if (!record.gone) picture[{record.kind, record.number}] = record.payload;
  });
  return picture;
}

constexpr std::int64_t kStart = 1'600'000'000'000'000'000;
Time at_ms(std::int64_t ms) { return Time(Duration(kStart + ms * 1'000'000)); }

/// A display that lives: tiles that are rewritten, voxels that come and go, and once all is forgotten.
class Scene {
 public:
  explicit Scene(std::size_t tile_bytes = 300) : tile_bytes_(tile_bytes) {}
  void step(Time time) {
    ++steps_;
    items.set(DisplayKind::kVehicle, 0, time, std::to_string(steps_));
    const std::size_t tile = random_.index(20);
    items.set(DisplayKind::kDepth, tile, time, bytes(tile_bytes_));
    const std::size_t block = random_.index(30);
    if (random_.index(3) == 0) {
      items.remove(DisplayKind::kVoxels, block, time);
    } else {
      items.set(DisplayKind::kVoxels, block, time, bytes(50));
    }
    if (steps_ % 700 == 0) items.clear();
  }
  DisplayState items;

 private:
  std::string bytes(std::size_t count) {
    std::string text(count, '\0');
    for (char& c : text) c = static_cast<char>(random_.bits());
    return text;
  }
  std::size_t tile_bytes_;
  Random random_{9};
  int steps_ = 0;
};

/// Pictures at each moment that was recorded.
std::map<std::int64_t, Picture> record_scene(const std::filesystem::path& file, int steps) {
  std::map<std::int64_t, Picture> moments;
  RunRecorder recorder(file, {});
  Scene scene;
  for (int i = 0; i < steps; ++i) {
    const std::int64_t ms = i * 70;
    scene.step(at_ms(ms));
    if (recorder.sample(at_ms(ms), scene.items)) moments[ms] = picture_of(scene.items);
  }
  recorder.close();
  return moments;
}

TEST(RecordedDisplay, ShowsWhatWasShownAtAnyTime) {
  const auto file = test::scratch_folder() / "run.mcap";
  const auto moments = record_scene(file, 2500);
  EXPECT_GT(moments.size(), 600u) << "four a second";
  RecordedDisplay recorded(file);
  EXPECT_TRUE(recorded.complete());
  EXPECT_EQ(recorded.span()->first, at_ms(0));
  EXPECT_EQ(recorded.span()->last, at_ms(moments.rbegin()->first));
  DisplayState items;
  Random random(1);
  for (int i = 0; i < 150; ++i) {
    const auto ms = static_cast<std::int64_t>(random.index(2500 * 70 + 1000));
    if (random.index(2) == 0) {
      recorded.seek(at_ms(ms), items);
    } else {
      recorded.advance(at_ms(ms), items);
    }
    const auto moment = std::prev(moments.upper_bound(ms));
    ASSERT_EQ(recorded.at(), at_ms(moment->first)) << ms;
    ASSERT_TRUE(picture_of(items) == moment->second) << ms;
  }
}

TEST(RecordedDisplay, StepsFromMomentToMoment) {
  const auto file = test::scratch_folder() / "run.mcap";
  const auto moments = record_scene(file, 400);
  RecordedDisplay recorded(file);
  DisplayState items;
  Time time = at_ms(-1);
  for (const auto& [ms, picture] : moments) {
    ASSERT_EQ(recorded.moment_after(time), at_ms(ms));
    time = at_ms(ms);
    recorded.advance(time, items);
    ASSERT_TRUE(picture_of(items) == picture);
  }
  EXPECT_FALSE(recorded.moment_after(time));
  for (auto moment = std::next(moments.rbegin()); moment != moments.rend(); ++moment) {
    ASSERT_EQ(recorded.moment_before(time), at_ms(moment->first));
    time = at_ms(moment->first);
    recorded.seek(time, items);
    ASSERT_TRUE(picture_of(items) == moment->second);
  }
  EXPECT_FALSE(recorded.moment_before(time));
}

TEST(RecordedDisplay, BeforeTheFirstMomentThereIsNothing) {
  const auto file = test::scratch_folder() / "run.mcap";
  record_scene(file, 50);
  RecordedDisplay recorded(file);
  DisplayState items;
  recorded.seek(at_ms(1000), items);
  recorded.seek(at_ms(-1), items);
  EXPECT_FALSE(recorded.at());
  EXPECT_TRUE(picture_of(items).empty());
}

/// Rows of the signals, and what the vehicle is, at a moment.
std::pair<std::string, std::string> signals_and_vehicle(const DisplayState& items) {
  std::pair<std::string, std::string> found;
  for_each_record(items.changes_after(0).records, [&found](const DisplayRecord& record) {
    if (record.kind == DisplayKind::kSignals) found.first = record.payload;
    if (record.kind == DisplayKind::kVehicle) found.second = record.payload;
  });
  return found;
}

// A page plots its signals over the whole recording, wherever it begins.
TEST(RecordedPlayback, TellsTheSignalsOfTheWholeRecordingFirst) {
  const auto file = test::scratch_folder() / "run.mcap";
  RunRecorder recorder(file, {});
  DisplayState scene;
  std::string rows;
  for (int i = 0; i < 40; ++i) {
    scene.set(DisplayKind::kVehicle, 0, at_ms(i * 1000), std::to_string(i));
    scene.set(DisplayKind::kSignals, 0, at_ms(i * 1000), rows += static_cast<char>('a' + i % 26));
    recorder.sample(at_ms(i * 1000), scene);
  }
  recorder.close();
  RecordedPlayback playback(file);
  DisplayState items;
  playback.show(at_ms(5000), items);
  EXPECT_EQ(signals_and_vehicle(items), std::pair(rows, std::string("5")));
  playback.show(at_ms(6000), items);
  EXPECT_EQ(signals_and_vehicle(items).second, "6");
}

// A page that is shown another time gets what differs.
TEST(RecordedDisplay, ASeekChangesOnlyWhatDiffers) {
  const auto file = test::scratch_folder() / "run.mcap";
  RunRecorder recorder(file, {});
  DisplayState scene;
  scene.set(DisplayKind::kDepth, 1, at_ms(0), std::string(100'000, 'a'));
  for (int i = 0; i < 100; ++i) {
    scene.set(DisplayKind::kVehicle, 0, at_ms(i * 250), std::to_string(i));
    recorder.sample(at_ms(i * 250), scene);
  }
  recorder.close();
  RecordedDisplay recorded(file);
  DisplayState items;
  recorded.seek(at_ms(20'000), items);
  const std::uint64_t stamp = items.stamp();
  recorded.seek(at_ms(10'000), items);
  EXPECT_LT(items.changes_after(stamp).records.size(), 100u);
  EXPECT_EQ(picture_of(items).at({DisplayKind::kVehicle, 0}), "40");
}

// What is changed after the last event has the time of that event: it is seen there, whichever way one comes to it.
TEST(RecordedDisplay, TheEndShowsWhatChangedAtItsVeryTime) {
  for (const std::int64_t end_ms :
       {0, 250, 10'000}) {  // with the first sample, a whole one; after it; with a later whole
    const auto file = test::scratch_folder() / "run.mcap";
    DisplayState scene;
    RunRecorder recorder(file, {});
    for (std::int64_t ms = 0; ms <= end_ms; ms += 250) {
      scene.set(DisplayKind::kVehicle, 0, at_ms(ms), std::to_string(ms));
      scene.set(DisplayKind::kDepth, 0, at_ms(ms), std::string(1000, static_cast<char>(ms / 250)));
      ASSERT_TRUE(recorder.sample(at_ms(ms), scene));
    }
    const Picture before = picture_of(scene);
    EXPECT_FALSE(recorder.sample(at_ms(end_ms), scene)) << "one at a time, but at once";
    scene.set(DisplayKind::kGrid, 0, at_ms(end_ms), "of the last sweep");
    scene.remove(DisplayKind::kDepth, 0, at_ms(end_ms));
    EXPECT_TRUE(recorder.sample(at_ms(end_ms), scene, true));
    EXPECT_FALSE(recorder.sample(at_ms(end_ms - 1), scene, true)) << "never before the last";
    recorder.close();
    ASSERT_FALSE(picture_of(scene) == before);

    RecordedDisplay sought(file), followed(file);
    EXPECT_EQ(sought.span()->last, at_ms(end_ms));
    DisplayState items;
    sought.seek(at_ms(end_ms), items);
    EXPECT_TRUE(picture_of(items) == picture_of(scene)) << end_ms;
    DisplayState on_the_way;
    for (std::int64_t ms = -100; ms <= end_ms; ms += 50) followed.advance(at_ms(ms), on_the_way);
    EXPECT_TRUE(picture_of(on_the_way) == picture_of(scene)) << end_ms;
  }
}

// Also for who was there already when it was written.
TEST(RecordedDisplay, TheEndShowsWhatCameToItLater) {
  const auto file = test::scratch_folder() / "run.mcap";
  Configuration configuration;
  configuration.recorder.log.chunk_kib = 1;
  RunRecorder recorder(file, configuration);
  DisplayState scene;
  for (std::int64_t ms = 0; ms <= 1000; ms += 250) {
    scene.set(DisplayKind::kDepth, 0, at_ms(ms), std::string(3000, static_cast<char>(ms / 250)));  // more than a chunk
    recorder.sample(at_ms(ms), scene);
  }
  RecordedDisplay recorded(file);
  DisplayState items;
  recorded.seek(at_ms(900), items);
  recorded.advance(at_ms(1000), items);
  ASSERT_TRUE(picture_of(items) == picture_of(scene));
  scene.set(DisplayKind::kGrid, 0, at_ms(1000), "of the last sweep");
  recorder.sample(at_ms(1000), scene, true);
  recorder.close();
  EXPECT_TRUE(recorded.refresh());
  recorded.advance(at_ms(1000), items);
  EXPECT_TRUE(picture_of(items) == picture_of(scene));
}

// What is shown of a run that goes on is at most one chunk behind, and grows.
TEST(RecordedDisplay, FollowsARecordingThatIsBeingMade) {
  const auto file = test::scratch_folder() / "run.mcap";
  RunRecorder recorder(file, {});
  RecordedDisplay recorded(file);
  EXPECT_FALSE(recorded.span());
  Scene scene;
  std::map<std::int64_t, Picture> moments;
  DisplayState items;
  for (int i = 0; i < 1000; ++i) {
    scene.step(at_ms(i * 70));
    if (recorder.sample(at_ms(i * 70), scene.items)) moments[i * 70] = picture_of(scene.items);
    if (i % 50 != 49) continue;
    recorded.refresh();
    recorded.advance(at_ms(i * 70), items);
    if (i * 70 > 6000) {
      ASSERT_GE(recorded.at(), at_ms(i * 70 - 5500));
    }
    if (recorded.at()) {
      const auto shown = (recorded.at()->time_since_epoch().count() - kStart) / 1'000'000;
      ASSERT_TRUE(picture_of(items) == moments.at(shown)) << i;
    }
  }
  EXPECT_FALSE(recorded.complete());
  recorder.close();
  EXPECT_TRUE(recorded.refresh());
  EXPECT_TRUE(recorded.complete());
  recorded.advance(at_ms(1'000'000), items);
  EXPECT_TRUE(picture_of(items) == moments.rbegin()->second);
}

// An hour of a display beside ten times as many bytes of events: how much of it a seek unpacks does not depend on how
// long the recording is, nor on what else is in it.
TEST(RecordedDisplay, ASeekReadsAboutTwoWholesAndNothingElse) {
  const auto file = test::scratch_folder() / "hour.mcap";
  constexpr std::size_t kTile = 2000;
  std::size_t changed = 0, held = 0;
  {
    RunRecorder recorder(file, {});
    Scene scene(kTile);
    Health loud;
    loud.note = std::string(5000, 'x');
    std::uint64_t stamp = 0;
    for (int i = 0; i < 4 * 3600; ++i) {
      loud.time = at_ms(i * 250);
      recorder.on_event(Event(loud));
      scene.step(at_ms(i * 250));
      const auto changes = scene.items.changes_after(stamp);
      stamp = changes.stamp;
      changed += changes.records.size();
      recorder.sample(at_ms(i * 250), scene.items);
      held = std::max(held, scene.items.bytes());
    }
    recorder.close();
  }
  const std::size_t ten_seconds = changed / 360;
  McapIndex index(file);
  std::size_t wholes = 0, sizes = 0;
  const std::uint16_t channel = *index.channel_of(kWholeDisplayTopic);
  index.visit({&channel, 1}, 0, ~0ull, [&](const McapMessage& message) {
    ++wholes;
    sizes += message.data.size();
    return true;
  });
  EXPECT_GT(wholes, 100u);
  EXPECT_LE(sizes, changed + held * 2) << "wholes at most double the recording of the display";

  RecordedDisplay recorded(file);
  EXPECT_EQ(recorded.counts().unpacked, 0u);
  Random random(2);
  for (int i = 0; i < 50; ++i) {
    DisplayState items;
    const auto before = recorded.counts();
    recorded.seek(at_ms(static_cast<std::int64_t>(random.index(3'600'000))), items);
    const auto after = recorded.counts();
    const std::size_t chunk = ten_seconds;  // of five seconds of changes, and with slack
    EXPECT_LE(after.unpacked_bytes - before.unpacked_bytes, 2 * held + 2 * ten_seconds + 2 * chunk);
    EXPECT_LE(after.unpacked - before.unpacked, 8u);
  }
}

TEST(RecordedDisplay, NeedsADisplay) {
  const auto file = test::scratch_folder() / "log.mcap";
  NativeLogWriter(file).close();
  EXPECT_THROW(RecordedDisplay{file}, Error);
}

}  // namespace
}  // namespace isobath
