#include <fmt/format.h>
#include <gmock/gmock.h>
#include <isobath/io/formats/nmea.hpp>
#include <isobath/io/formats/nmea_decoder.hpp>
#include <isobath/io/open_source.hpp>
#include <tests/io/bytes_by_hand.hpp>
#include <tests/io/survey_events.hpp>
#include <tests/support/data.hpp>

namespace isobath {
namespace {

using test::drain;
using test::in_memory;
using test::only;
using testing::Pair;
using testing::UnorderedElementsAre;

/// "$...*hh" CR LF.
std::string nmea(const std::string& body) {
  unsigned sum = 0;
  for (const char c : body) sum ^= static_cast<unsigned char>(c);
  return fmt::format("${}*{:02X}\r\n", body, sum);
}

const std::string kFix = nmea("GPRMC,092212,A,5759.097,N,01144.345,E,005.5,030.5,200715,000.0,E");

std::unique_ptr<Source> log(const std::string& text, const InputConfig& config = {}) {
  return open_nmea(in_memory(text), config);
}

double heading_deg(const Event& fix) {
  return std::get<Navigation>(fix).X_WB.rotation.heading().wrapped_positive().degrees();
}

// Sentences and checksums as in the format's own description, parsed there by another reader.
TEST(Nmea, WorkedLinesAreSentencesWithARightChecksum) {
  using State = NmeaSentence::State;
  for (const char* line :
       {"$GPGGA,123519.00,4807.0380,N,01131.0000,E,4,08,0.9,545.4,M,46.9,M,1.0,0000*43",
        "$GPRMC,123519.00,A,4807.0380,N,01131.0000,E,002.4,084.4,230394,003.1,W,D*2E", "$HEHDT,274.07,T*19",
        "$SDDBT,7.8,f,2.4,M,1.3,F*0D", "$SDDPT,2.4,0.5,100.0*57",
        "$PASHR,123519.00,274.07,T,-1.25,0.53,0.12,0.020,"
        "0.020,0.150,2,3*00",
        "$HCHDG,101.1,0.0,E,3.1,W*53", "noise$SDDPT,2.4,0.5,100.0*57", "$SDDBT,7.8,f,2.4,M,1.3,F*0d"}) {
    EXPECT_EQ(sentence_of(line).state, State::kGood) << line;
  }
  EXPECT_EQ(sentence_of("$SDDPT,2.5,0.5,100.0*57").state, State::kWrongChecksum);
  EXPECT_EQ(sentence_of("$IIRSA,26,A,,*5").state, State::kWrongChecksum);
  EXPECT_EQ(sentence_of("$SDDPT,2.4,0.5,100.0").state, State::kNoChecksum);
  EXPECT_EQ(sentence_of("!AIVDM,1,1,,B,13u=gHP3CWPlvs2Q8sHW:5fD0h6a,0*1B").state, State::kOther);
  EXPECT_EQ(sentence_of("All went well").state, State::kNone);
}

TEST(Nmea, AFixIsAPlaceAVelocityAndATime) {
  const auto source = log(nmea("GPRMC,123519.25,A,4807.0380,N,01131.0000,E,010.0,090.0,230394,003.1,W,D"));
  const auto events = drain(*source);
  ASSERT_EQ(events.size(), 1u);
  const Navigation& fix = std::get<Navigation>(events[0]);
  EXPECT_EQ(to_text(fix.time), "1994-03-23T12:35:19.250Z");
  EXPECT_NEAR(source->report().origin->latitude_deg, 48.1173, 1e-9);
  EXPECT_NEAR(source->report().origin->longitude_deg, 11 + 31 / 60.0, 1e-9);
  EXPECT_TRUE(fix.v_WB->isApprox(Eigen::Vector3d(0, 10 * 1852.0 / 3600, 0), 1e-12));
}

TEST(Nmea, SouthAndWestAreNegative) {
  const auto source = log(nmea("GPRMC,123519,A,0130.0,S,07015.0,W,0,0,230394,,"));
  drain(*source);
  EXPECT_NEAR(source->report().origin->latitude_deg, -1.5, 1e-12);
  EXPECT_NEAR(source->report().origin->longitude_deg, -70.25, 1e-12);
}

TEST(Nmea, DepthsLieBelowTheTransducer) {
  const auto depth_of = [](const std::string& sentence, double setting) {
    InputConfig config;
    config.survey.transducer_depth_m = setting;
    const auto found = test::soundings(drain(*log(kFix + nmea(sentence), config)));
    return found.size() == 1 ? found[0].bottom.z() : -1;
  };
  EXPECT_NEAR(depth_of("IIDPT,14.8,0.4,100.0", 0), 15.2, 1e-12) << "the offset of the log is above the transducer";
  EXPECT_NEAR(depth_of("IIDPT,14.8,-1.1,100.0", 0), 14.8, 1e-12) << "a negative one is of the keel";
  EXPECT_NEAR(depth_of("IIDPT,14.8,0.4", 1), 15.8, 1e-12) << "the setting takes its place";
  EXPECT_NEAR(depth_of("SDDBT,7.8,f,2.4,M,1.3,F", 0), 2.4, 1e-12);
  EXPECT_NEAR(depth_of("SDDBT,7.8,f,2.4,M,1.3,F", 0.5), 2.9, 1e-12);
  EXPECT_NEAR(depth_of("SDDBS,7.8,f,2.4,M,1.3,F", 0.5), 2.4, 1e-12) << "below the surface already";
}

// ledger: S1-64
TEST(Nmea, NoBottomIsNoReading) {
  const auto source = log(kFix + nmea("IIDPT,,0.4,100.0") + nmea("IIDPT,0.0,0.4,100.0") + nmea("IIDPT,nan,0.4") +
                          nmea("IIDPT,-3,0.4") + nmea("IIDPT,12,5,0.4"));
  EXPECT_EQ(only<RangeReading>(drain(*source)).size(), 1u);
  EXPECT_THAT(source->report().rejected, UnorderedElementsAre(Pair("no bottom", 4)));
}

TEST(Nmea, OneSounderIsTaken) {
  const auto source = log(kFix + nmea("SDDBT,,f,,M,,F") + nmea("SDDPT,2.4,0.5,100.0") +
                          nmea("SDDBT,7.8,f,2.4,M,1.3,F") + nmea("IIDPT,2.5,0.5"));
  EXPECT_EQ(only<RangeReading>(drain(*source)).size(), 1u);
  EXPECT_EQ(source->report().details.at("depths"), "SDDPT");
  EXPECT_EQ(source->report().rejected.at("depth of another sentence or talker"), 2u);
}

TEST(Nmea, EverythingBetweenTwoFixesHappensAtTheFirst) {
  const auto events = drain(*log(nmea("IIDPT,9.0,0.4") + kFix + nmea("IIDPT,9.1,0.4") +
                                 nmea("GPGGA,092213.5,5759.100,N,01144.348,E,1,06,1.9,3.9,M,39.4,M,,") +
                                 nmea("GPGLL,5759.100,N,01144.348,E,092213.5,A") + nmea("IIDPT,9.2,0.4")));
  ASSERT_EQ(events.size(), 4u) << "a depth before all time and the same fix again count";
  EXPECT_EQ(to_text(time_of(events[1])), "2015-07-20T09:22:12.000Z");
  EXPECT_EQ(to_text(time_of(events[2])), "2015-07-20T09:22:13.500Z");
  EXPECT_EQ(to_text(time_of(events[3])), "2015-07-20T09:22:13.500Z");
}

TEST(Nmea, MidnightBetweenTwoDates) {
  const auto events = drain(*log(nmea("GPRMC,235959,A,5759.097,N,01144.345,E,0,0,311215,,") +
                                 nmea("GPGGA,000000,5759.097,N,01144.345,E,1,06,1.9,3.9,M,39.4,M,,") +
                                 nmea("GPGGA,000001,5759.097,N,01144.345,E,1,06,1.9,3.9,M,39.4,M,,")));
  ASSERT_EQ(events.size(), 3u);
  EXPECT_EQ(to_text(time_of(events[2])), "2016-01-01T00:00:01.000Z");
}

TEST(Nmea, LogWithoutADateCountsDaysFromItsStart) {
  const std::string place = ",5759.097,N,01144.345,E,1,06,1.9,3.9,M,39.4,M,,";
  const auto events =
      drain(*log(nmea("GPGGA,235958" + place) + nmea("GPGGA,235959" + place) + nmea("GPGGA,000000" + place)));
  ASSERT_EQ(events.size(), 3u);
  EXPECT_EQ(time_of(events[2]), Time{std::chrono::hours(24)});
}

TEST(Nmea, PositionsThatAreNoneAreCounted) {
  const auto source =
      log(kFix + nmea("GPRMC,092213,V,5759.097,N,01144.345,E,0,0,200715,,") + nmea("GPGGA,092214,,,,,0,00,,,M,,M,,") +
          nmea("GPGGA,092215,5759.097,N,01144.345,E,8,06,1.9,3.9,M,39.4,M,,") +
          nmea("GPGGA,092216,5760.000,N,01144.345,E,1,06,1.9,3.9,M,39.4,M,,") +
          nmea("GPGGA,092217,9100.000,N,01144.345,E,1,06,1.9,3.9,M,39.4,M,,") +
          nmea("IIRMC,092210,A,5759.096,N,01144.343,E,5.5,31.1,,0.0,E,A"));
  EXPECT_EQ(drain(*source).size(), 1u);
  EXPECT_THAT(source->report().rejected,
              UnorderedElementsAre(Pair("invalid position", 5), Pair("position older than the clock", 1)));
}

TEST(Nmea, TheBestHeadingIsTaken) {
  const std::string later = nmea("GPRMC,092213,A,5759.097,N,01144.345,E,005.5,030.5,200715,000.0,E");
  const std::string compass = nmea("HCHDG,101.1,0.5,E,3.1,W");
  EXPECT_NEAR(heading_deg(drain(*log(kFix))[0]), 30.5, 1e-9) << "course, as nothing else is known";
  EXPECT_NEAR(heading_deg(drain(*log(kFix + compass + later))[1]), 98.5, 1e-9) << "deviation and variation";
  EXPECT_NEAR(heading_deg(drain(*log(kFix + compass + nmea("HEHDT,274.07,T") + later))[1]), 274.07, 1e-9);
  EXPECT_NEAR(heading_deg(drain(*log(kFix + nmea("HETHS,12,V") + compass + later))[1]), 98.5, 1e-9) << "V: not valid";
  InputConfig config;
  config.survey.declination = Angle::degrees(4);
  EXPECT_NEAR(heading_deg(drain(*log(kFix + compass + later, config))[1]), 105.6, 1e-9) << "in place of the log's";
  EXPECT_NEAR(heading_deg(drain(*log(kFix + nmea("HCHDM,20,M") + later, config))[1]), 24, 1e-9);
  const std::string much_later = nmea("GPRMC,092230,A,5759.097,N,01144.345,E,005.5,031.5,200715,000.0,E");
  EXPECT_NEAR(heading_deg(drain(*log(kFix + compass + later + much_later))[2]), 31.5, 1e-9) << "the compass is silent";
  const std::string still = nmea("GPRMC,092213,A,5759.097,N,01144.345,E,000.2,200.0,200715,000.0,E");
  EXPECT_NEAR(heading_deg(drain(*log(kFix + kFix + still))[1]), 30.5, 1e-9) << "at rest the last course stays";
}

TEST(Nmea, StatedAccuracyTakesThePlaceOfTheSetting) {
  const auto events = only<Navigation>(drain(*log(nmea("GPGST,092212,1.2,0.8,0.6,45.0,0.7,0.6,1.1") + kFix)));
  ASSERT_EQ(events.size(), 1u);
  EXPECT_NEAR((*events[0].covariance)(0, 0), 0.49, 1e-12);
  EXPECT_NEAR((*events[0].covariance)(1, 1), 0.36, 1e-12);
}

TEST(Nmea, OneWrongDateDoesNotStopTheClock) {
  std::string text = kFix + nmea("GPRMC,092213,A,5759.097,N,01144.345,E,005.5,030.5,200735,000.0,E");
  for (int s = 14; s < 50; ++s) {
    text += nmea(fmt::format("GPRMC,0922{},A,5759.097,N,01144.345,E,005.5,030.5,200715,000.0,E", s));
  }
  const auto events = drain(*log(text));
  ASSERT_EQ(events.size(), 2u + 36 - 20);
  EXPECT_EQ(to_text(time_of(events.back())), "2015-07-20T09:22:49.000Z");
}

TEST(Nmea, DamageIsSkippedAndCounted) {
  const std::string noise("\x01\xff\0$GPG\x80,,,\r\nAll went well\n\n", 29);
  const auto source = log(kFix + noise + "$IIDPT,9.1,0.4*00\r\n$IIDPT,9.1,0.4\n" + std::string(3000, '$') + "\r" +
                          nmea("IIDPT,9.1,0.4"));
  EXPECT_EQ(drain(*source).size(), 2u);
  EXPECT_EQ(source->report().rejected.at("sentence with a wrong checksum"), 1u);
  EXPECT_GE(source->report().rejected.at("sentence without a checksum"), 1u);
  EXPECT_GE(source->report().damages.size(), 1u);
  EXPECT_EQ(source->report().bytes_read, source->report().bytes_total);
}

TEST(Nmea, IsRecognisedByItsChecksums) {
  EXPECT_TRUE(looks_like_nmea(bytes_of(kFix + kFix)));
  EXPECT_FALSE(looks_like_nmea(bytes_of(std::string("$1 for a $2 note\n$3\n"))));
  EXPECT_FALSE(looks_like_nmea(bytes_of("Notes\nof a\ndive\n" + kFix)));
  EXPECT_FALSE(looks_like_nmea({}));
}

// Real: 22 minutes under sail, whose file holds the same recording four times over.
TEST(Nmea, RealLogGivesAllItsDepths) {
  ISOBATH_NEEDS_DATA(folder, "nmea-hakefjord");
  const auto source = open_source(folder / "Hakefjord.log", {});
  EXPECT_EQ(source->report().format, "NMEA 0183");
  const auto events = drain(*source);
  const auto found = test::soundings(events);
  EXPECT_EQ(found.size(), 7528u);
  double least = 100, most = 0;
  for (const auto& s : found) {
    least = std::min(least, *s.reading.range_m);
    most = std::max(most, *s.reading.range_m);
    ASSERT_NEAR(s.bottom.z(), *s.reading.range_m + 0.4, 1e-12) << "the transducer hangs at 0.4 m";
  }
  EXPECT_NEAR(least, 13.6, 1e-9);
  EXPECT_NEAR(most, 16.7, 1e-9);
  EXPECT_EQ(source->report().rejected.at("sentence with a wrong checksum"), 11u);
  EXPECT_EQ(source->report().bytes_skipped, 0u);
  int back = 0;
  for (std::size_t i = 1; i < events.size(); ++i) back += time_of(events[i]) < time_of(events[i - 1]);
  EXPECT_EQ(back, 3);
}

// A live link: events have the time of their arrival, and the clock of the sentences is compared with it.
TEST(NmeaDecoder, GivesTheTimesOfArrivalOnALink) {
  SourceReport report;
  InputConfig config;
  NmeaDecoder decoder(config, report, NmeaDecoder::Times::kHost);
  const Time noon{std::chrono::hours(24 * 20000 + 12)};
  const auto hear = [&](const std::string& body, double s) {
    std::string line = nmea_line(body);
    line.resize(line.find('\n'));
    return decoder.event(sentence_of(line), noon + seconds(s));
  };
  const auto early = hear("SDDPT,4.5,0.5,100", 1);
  ASSERT_TRUE(early) << "a depth needs no position";
  EXPECT_EQ(time_of(*early), noon + seconds(1));
  hear("HEHDT,90.0,T", 2);
  const auto fix = hear("GPGGA,115958.00,4807.0380,N,01131.0000,E,4,08,0.9,0,M,0,M,,", 3);
  ASSERT_TRUE(fix);
  EXPECT_EQ(time_of(*fix), noon + seconds(3));
  EXPECT_NEAR(heading_deg(*fix), 90, 1e-9);
  EXPECT_EQ(report.details["clock"], "5.0 s behind the host's");
  EXPECT_FALSE(hear("GPRMC,115958.00,A,4807.0380,N,01131.0000,E,0,0,010124,,,A", 3)) << "the same time again";
  EXPECT_FALSE(decoder.event(sentence_of("$SDDPT,4.5,0.5,100*00"), noon)) << "a wrong checksum";
  EXPECT_EQ(report.rejected["sentence with a wrong checksum"], 1u);
}

}  // namespace
}  // namespace isobath
