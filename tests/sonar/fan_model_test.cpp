// What a recording without marks teaches of a fan, what a file of it may hold, and what a detector does that starts
// from it, right or wrong. Pings are made in here, from exponentials.
#include <gmock/gmock.h>
#include <isobath/base/error.hpp>
#include <isobath/base/random.hpp>
#include <isobath/sonar/fan_learner.hpp>
#include <nlohmann/json.hpp>
#include <numeric>
#include <tests/support/echoes.hpp>

namespace isobath::fan_model_test {
namespace {

constexpr int kBeams = 64, kBins = 200, kPings = 80;
constexpr RangeWindow kWindow{0, 0.1, kBins};
constexpr double kRinging = 1.2;  // m

/// Two beams a cell; beams 20 and 21 are dead, the last 20 are 4 dB louder, a pole stands at 12 m.
std::shared_ptr<const BeamFan> fan() {
  static const auto kFan = [] {
    auto f = std::make_shared<BeamFan>(*test::fan_of(kBeams, Angle::degrees(-31.5), Angle::degrees(1)));
    f->width.assign(kBeams, Angle::degrees(2));
    return std::shared_ptr<const BeamFan>(f);
  }();
  return kFan;
}

Ping ping_of(int number, Random& random, double loudness = 1) {
  Ping ping = test::ping_of<std::uint8_t>(fan(), kWindow, [&](int b, int k) {
    const double range = kWindow.centre(k);
    double power = 100 * loudness * (b >= 44 ? 2.5 : 1);
    if (range < kRinging) power += 2e5 * std::exp(-7 * range);
    if (b >= 40 && b < 44 && k >= 120 && k < 124) power += 8000;
    if (b == 20 || b == 21) return 0.0;
    return std::sqrt(-power * std::log(1 - random.uniform()));
  });
  ping.time = Time{} + seconds(0.1 * number);
  return ping;
}

const std::vector<Ping>& recording() {
  static const auto kAll = [] {
    Random random(3);
    std::vector<Ping> all;
    for (int n = 0; n < kPings; ++n) all.push_back(ping_of(n, random));
    return all;
  }();
  return kAll;
}

FanModel learnt_from(const std::vector<Ping>& pings) {
  FanSurvey survey;
  for (const Ping& ping : pings) survey.add(ping);
  FanLearner learner(*survey.most());
  for (const Ping& ping : pings) learner.add(ping);
  return learner.finish("a recording");
}

const FanModel& model() {
  static const FanModel kModel = learnt_from(recording());
  return kModel;
}

TEST(FanLearner, LearnsWhatTheSonarIs) {
  const FanModel& m = model();
  EXPECT_EQ(m.beams, kBeams);
  EXPECT_EQ(m.pings, kPings);
  EXPECT_NEAR(m.seconds, 0.1 * (kPings - 1), 1e-6);
  EXPECT_NEAR(m.blanking_m, kRinging, 0.25);
  EXPECT_THAT(m.dead_beams, testing::ElementsAre(20, 21));
  ASSERT_EQ(m.gains_db.size(), 32u);
  EXPECT_NEAR(m.gains_db[25] - m.gains_db[5], 10 * std::log10(2.5), 0.3);
  EXPECT_EQ(m.gains_db[10], FanModel::kFaintest_db);
  EXPECT_EQ(m.clipped, 0);
  EXPECT_NEAR(m.correlation.beams, 0, 0.05);
  EXPECT_NEAR(m.correlation.pings, 0, 0.05);
  EXPECT_GT(m.looks, 0.85) << "samples are drawn one by one";
}

// 50 and 5 cells a ping stand out by chance. ledger: S6-06 S6-64
TEST(FanLearner, SaysHowGoodItIs) {
  for (std::size_t i = 0; i < 2; ++i) {
    const auto& q = model().quality[i];
    EXPECT_NEAR(q.whole.ratio, 1, 0.15) << FanModel::kAsked[i];
    EXPECT_LT(q.whole.low, q.whole.ratio);
    EXPECT_GT(q.whole.high, q.whole.ratio);
    for (const auto& third : q.thirds) EXPECT_NEAR(third.ratio, 1, 0.35);
  }
}

TEST(FanLearner, FindsThatPingsShareTheirNoise) {
  std::vector<Ping> twice;
  for (int n = 0; n < kPings; ++n) {
    twice.push_back(recording()[static_cast<std::size_t>(n / 2)]);
    twice.back().time = Time{} + seconds(0.1 * n);
  }
  const FanModel m = learnt_from(twice);
  EXPECT_NEAR(m.correlation.pings, 0.5, 0.1) << "every other ping is the one before";
  EXPECT_NEAR(m.looks, (1 - m.correlation.pings) / (1 + m.correlation.pings), 0.1);
}

TEST(FanLearner, RefusesAFewPings) {
  FanSurvey survey;
  for (int n = 0; n < 5; ++n) survey.add(recording()[static_cast<std::size_t>(n)]);
  EXPECT_THROW(FanLearner{*survey.most()}, Error);
}

TEST(FanModel, IsReadAsItWasWritten) {
  const std::string text = write_fan_model(model());
  EXPECT_TRUE(looks_like_fan_model(text));
  const FanModel again = read_fan_model(text, "file");
  EXPECT_EQ(write_fan_model(again), text);
  EXPECT_EQ(again.quality, model().quality);
  EXPECT_TRUE(same_setting(again, recording().front()));
}

using Json = nlohmann::ordered_json;

TEST(FanModel, RefusesAWrongFileAndSaysWhere) {
  const Json good = Json::parse(write_fan_model(model()));
  const std::vector<std::pair<std::string, Json>> wrong{{"/version", 2},
                                                        {"/format", "other"},
                                                        {"/sonar/beams", 0},
                                                        {"/sonar/beams", 1e9},
                                                        {"/setting/bin_m", -1},
                                                        {"/setting/samples", "u12"},
                                                        {"/blind_m", "far"},
                                                        {"/looks", 2},
                                                        {"/relief", {1, 2}},
                                                        {"/relief/0", -1},
                                                        {"/gains_db", Json::array()},
                                                        {"/dead_beams/0", 64},
                                                        {"/level/0", -1},
                                                        {"/quality/0/whole/ratio", -1},
                                                        {"/laws", Json::array()},
                                                        {"/laws/0/first", 641},
                                                        {"/laws/0/counts/0", 0.5},
                                                        {"/all/counts/0", 4e9},
                                                        {"/more", 1}};
  for (const auto& [key, value] : wrong) {
    Json json = good;
    json[Json::json_pointer(key)] = value;
    try {
      read_fan_model(json.dump(), "model.json");
      ADD_FAILURE() << key << " = " << value;
    } catch (const Error& e) {
      EXPECT_EQ(e.where().file, "model.json") << key;
      EXPECT_FALSE(e.where().key.empty()) << key;
    }
  }
  for (const auto& item : good.items()) {
    Json json = good;
    json.erase(item.key());
    EXPECT_THROW(read_fan_model(json.dump(), "model.json"), Error) << item.key();
  }
  EXPECT_THROW(read_fan_model("{", "model.json"), Error);
}

FanDetector started(const FanModel& from, double false_alarm = 1e-3) {
  FanDetectorConfig config;
  config.false_alarm = false_alarm;
  FanDetector detector(config);
  detector.start_from(std::make_shared<const FanModel>(from));
  return detector;
}

/// Rate of echoes in open water over the asked one, in pings [from, end).
double delivered(FanDetector& detector, int from, int end, double false_alarm = 1e-3) {
  EchoDecisions samples;
  FanLooks looks;
  double hits = 0, all = 0;
  for (int n = from; n < end; ++n) {
    detector.detect(recording()[static_cast<std::size_t>(n)], {}, samples, looks);
    for (int b = 0; b < looks.decisions.beams(); ++b) {
      if (b >= 13 && b < 26) continue;  // where the gain steps, and the pole
      for (int k = 20; k < looks.decisions.bins(); ++k) {
        if (!looks.decisions.tells(b, k)) continue;
        ++all;
        hits += looks.decisions.hit(b, k);
      }
    }
  }
  return hits / all / false_alarm;
}

// ledger: S6-06 S6-70
TEST(FanDetectorFromAModel, HasItsThresholdsAtTheFirstPing) {
  FanDetector knows = started(model()), settled = started(model()), cold;
  delivered(settled, 0, kPings);
  EXPECT_NEAR(delivered(knows, 0, 4), 1, 0.6) << "12 false echoes";
  EXPECT_NEAR(knows.threshold(5, 100) / settled.threshold(5, 100), 1, 0.15);
  EXPECT_FALSE(cold.departure());
  const auto d = settled.departure();
  ASSERT_TRUE(d);
  EXPECT_TRUE(d->same_setting);
  EXPECT_FALSE(d->dropped);
  EXPECT_NEAR(d->level_db, 0, 0.2);
  EXPECT_EQ(d->beams_apart, 0);
  EXPECT_NEAR(d->exceeding / d->asked, 1, 0.2);
}

TEST(FanDetectorFromAModel, SaysNothingInItsBlindZone) {
  FanModel far = model();
  far.blanking_m = 5;
  FanDetector detector = started(far);
  EchoDecisions samples;
  FanLooks looks;
  detector.detect(recording()[0], {}, samples, looks);
  EXPECT_FALSE(looks.decisions.usable(48));
  EXPECT_TRUE(looks.decisions.usable(50));
}

TailLaw scaled(const TailLaw& law, double octaves) {
  std::vector<std::uint32_t> counts(TailLaw::kSteps);
  const int by = static_cast<int>(octaves * (1 << TailLaw::kStepBits));
  for (int i = 0; i < int{TailLaw::kSteps}; ++i) {
    if (i - by >= 0 && i - by < int{TailLaw::kSteps})
      counts[static_cast<std::size_t>(i)] = law.counts()[static_cast<std::size_t>(i - by)];
  }
  return TailLaw::of_counts(counts);
}

// Thresholds of a quarter, of a 16th, four and 16 times what they should be.
TEST(FanDetectorFromAModel, RecoversFromAWrongOne) {
  for (const int octaves : {-4, -2, 2, 4}) {
    FanModel wrong = model();
    for (TailLaw& law : wrong.laws) law = scaled(law, octaves);
    wrong.all = scaled(wrong.all, octaves);
    FanDetector detector = started(wrong);
    FanDetector without = started(model());
    delivered(detector, 0, 40);
    delivered(without, 0, 40);
    EXPECT_TRUE(detector.departure()->dropped);
    EXPECT_NEAR(delivered(detector, 40, kPings), delivered(without, 40, kPings), 0.3) << octaves;
  }
}

// Wrong by too little to be seen at once: the data teach it.
TEST(FanDetectorFromAModel, LearnsOn) {
  FanModel wrong = model();
  const auto fatter = [](const TailLaw& law) {  // its highest values half an octave higher
    const TailLaw higher = scaled(law, 0.5);
    std::vector<std::uint32_t> counts(law.counts().begin(), law.counts().end());
    double above = 0;
    for (std::size_t i = TailLaw::kSteps; i-- > 0 && above < 0.003 * law.total();) {
      above += law.counts()[i];
      counts[i] = higher.counts()[i];
    }
    return TailLaw::of_counts(counts);
  };
  for (TailLaw& law : wrong.laws) law = fatter(law);
  wrong.all = fatter(wrong.all);
  FanDetector detector = started(wrong), right = started(model());
  const float at_first = [&] {
    delivered(detector, 0, 1);
    return detector.threshold(5, 100);
  }();
  delivered(detector, 1, kPings);
  delivered(right, 0, kPings);
  EXPECT_GT(at_first, 1.2f * right.threshold(5, 100));
  EXPECT_NEAR(detector.threshold(5, 100) / right.threshold(5, 100), 1, 0.15);
}

TEST(FanDetectorFromAModel, TellsWaterAndGainsThatAreOther) {
  Random random(7);
  FanModel other = model();
  other.gains_db[3] += 4;
  FanDetector detector = started(other);
  EchoDecisions samples;
  FanLooks looks;
  for (int n = 0; n < 20; ++n) detector.detect(ping_of(n, random, 4), {}, samples, looks);
  const auto d = detector.departure();
  EXPECT_NEAR(d->level_db, 6, 0.5);
  EXPECT_EQ(d->beams_apart, 1);
}

TEST(FanDetectorFromAModel, TakesTheLawsAloneAtAnotherSetting) {
  FanModel other = model();
  other.window.bin_m = 0.2;
  other.cell_m = 0.2;
  FanDetector detector = started(other);
  delivered(detector, 0, 1);
  const auto d = detector.departure();
  EXPECT_FALSE(d->same_setting);
  EXPECT_FALSE(d->dropped);
  EXPECT_EQ(d->rows, 0);
}

TEST(FanModel, KnowsItsSonar) {
  Ping ping = recording().front();
  EXPECT_NO_THROW(require_same_sonar(model(), ping));
  ping.fan = test::fan_of(kBeams, Angle::degrees(-60), Angle::degrees(2));
  EXPECT_THROW(require_same_sonar(model(), ping), Error);
}

}  // namespace
}  // namespace isobath::fan_model_test
