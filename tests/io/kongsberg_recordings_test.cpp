// Real recordings of five ships: what their README states, and what two records of one file say of the same thing.
#include <algorithm>
#include <gmock/gmock.h>
#include <isobath/io/bytes/whole_file.hpp>
#include <isobath/io/formats/kongsberg/kongsberg.hpp>
#include <isobath/io/open_source.hpp>
#include <tests/io/bytes_by_hand.hpp>
#include <tests/support/data.hpp>

namespace isobath {
namespace {

constexpr const char* kFolder = "kongsberg-pings";

struct Recording {
  const char* file;
  std::size_t pings;
  double near_m, far_m;  ///< depths below the transducer (.all) or the reference point (.kmall)
  double transducer_m;   ///< below the reference point, of the installation record; 0 for .kmall
  double latitude, longitude;
};

// The table of the recordings' README.
const Recording kRecordings[] = {
    {"em2040c-australia.all", 35, 10.1, 10.8, 0, -38.40, 142.48},
    {"em2040-northsea-2023.all", 4, 25, 26.4, 0.426, 51.58, 2.59},
    {"em2040-northsea-2016.all", 9, 22, 23, 2.167, 51.49, 2.79},
    {"em710-blacksea.all", 6, 120, 123.2, 7.005, 44.16, 30.65},
    {"em710-svalbard.all", 6, 101, 107, 4.96, 78.53, 10.29},
    {"em2042-harbour-a.kmall", 5, 3.5, 9.5, 0, 51.2349, 2.9282},
    {"em2042-harbour-b.kmall", 5, 7.5, 10.2, 0, 51.2395, 2.9219},
    {"em2042-harbour-c.kmall", 6, 9.1, 9.6, 0, 51.2448, 2.9219},
    {"em2042-harbour-d.kmall", 5, 5.9, 7.6, 0, 51.2254, 2.9385},
    {"em2040-florida.kmall", 25, 2.0, 4.2, 0, 27.583, -82.755},
};

struct Seen {
  std::vector<Swath> swaths;
  std::vector<double> depths;  ///< of bottom soundings, below the reference point
  SourceReport report;
};

Seen see(const std::filesystem::path& file, const InputConfig& config = {}) {
  Seen seen;
  const auto source = open_source(file, config);
  Navigation last;
  while (auto event = source->next()) {
    if (const auto* fix = std::get_if<Navigation>(&*event)) last = *fix;
    auto* swath = std::get_if<Swath>(&*event);
    if (!swath) continue;
    EXPECT_EQ(swath->time, last.time) << "each swath has a fix of its time";
    EXPECT_EQ(check(*swath), SwathFault::kNone);
    for (const Sounding& s : swath->soundings) {
      if (s.kind == Sounding::Kind::kBottom) {
        seen.depths.push_back(static_cast<double>(s.point.z()) - last.X_WB.translation.z());
      }
    }
    seen.swaths.push_back(std::move(*swath));
  }
  std::sort(seen.depths.begin(), seen.depths.end());
  seen.report = source->report();
  return seen;
}

TEST(KongsbergRecordings, AreReadToTheirEndWithThePingsAndDepthsThatTheirReadmeStates) {
  ISOBATH_NEEDS_DATA(folder, kFolder);
  for (const Recording& r : kRecordings) {
    SCOPED_TRACE(r.file);
    const Seen seen = see(folder / r.file);
    EXPECT_EQ(seen.swaths.size(), r.pings);
    EXPECT_EQ(seen.report.bytes_skipped, 0u);
    EXPECT_EQ(seen.report.bytes_read, seen.report.bytes_total);
    EXPECT_FALSE(seen.report.details.contains("checksums"));
    EXPECT_NEAR(seen.report.origin->latitude_deg, r.latitude, 0.01);
    EXPECT_NEAR(seen.report.origin->longitude_deg, r.longitude, 0.01);
    ASSERT_FALSE(seen.depths.empty());
    // The README rounds; and from the reference point the transducer's depth changes with pitch and roll.
    const double slack = 0.1 + 0.15 * r.transducer_m;
    const auto at = [&](std::size_t percent) { return seen.depths[seen.depths.size() * percent / 100]; };
    EXPECT_GT(at(2) - r.transducer_m, r.near_m - slack);
    EXPECT_LT(at(2) - r.transducer_m, r.far_m);
    EXPECT_LT(at(98) - r.transducer_m, r.far_m + slack);
    EXPECT_GT(at(98) - r.transducer_m, r.near_m);
  }
}

TEST(KongsbergRecordings, WaterColumnsMayBeLeftOut) {
  ISOBATH_NEEDS_DATA(folder, kFolder);
  InputConfig dry;
  dry.water_column = false;
  const Seen all = see(folder / "em710-blacksea.wcd", dry), kmall = see(folder / "em2042-harbour-a.kmwcd", dry);
  EXPECT_EQ(all.report.bytes_skipped, 0u);
  EXPECT_EQ(all.report.format, "Kongsberg .all");
  EXPECT_THAT(all.report.details.at("other datagrams"), testing::HasSubstr("k x 21"));
  EXPECT_EQ(kmall.report.bytes_skipped, 0u);
  EXPECT_THAT(kmall.report.details.at("other datagrams"), testing::HasSubstr("#MWC x 5"));
}

TEST(KongsbergRecordings, QuayWallIsThreeMetresToStarboard) {
  ISOBATH_NEEDS_DATA(folder, kFolder);
  for (const Swath& swath : see(folder / "em2042-harbour-a.kmall").swaths) {
    float top = 100, bottom = 0, farthest = 0;
    int on_wall = 0;
    for (const Sounding& s : swath.soundings) {
      farthest = std::max(farthest, s.point.y());
      if (std::abs(s.point.y() - 3.0F) > 0.15F) continue;
      ++on_wall;
      top = std::min(top, s.point.z());
      bottom = std::max(bottom, s.point.z());
    }
    EXPECT_GT(on_wall, 40);
    EXPECT_GT(bottom - top, 2) << "upright";
    EXPECT_LT(farthest, 3.2F) << "nothing is seen behind the wall";
  }
}

// Depth of the transducer as the ping states it, against heave, water line and place of the transducer as the attitude
// and installation records do: so signs and references of three records agree.
TEST(KongsbergRecordings, HeaveAndWaterLineGiveTheStatedDepthOfTheTransducer) {
  ISOBATH_NEEDS_DATA(folder, kFolder);
  const auto bytes = read_whole_file(folder / "em2040c-australia.all", 1 << 24);
  const auto source = open_source(folder / "em2040c-australia.all", {});
  std::vector<double> reference;  // its depth at each ping; the transducer is at the reference point on this boat
  Navigation last;
  while (const auto event = source->next()) {
    if (const auto* fix = std::get_if<Navigation>(&*event)) last = *fix;
    if (std::holds_alternative<Swath>(*event)) reference.push_back(last.X_WB.translation.z());
  }
  std::vector<double> stated;
  for (std::size_t at = 0; at < bytes.size();) {
    const RecordView d(std::as_bytes(std::span(bytes)).subspan(at));
    if (d.at<char>(5) == 'X') stated.push_back(static_cast<double>(d.at<float>(24)));
    at += 4 + d.at<std::uint32_t>(0);
  }
  ASSERT_EQ(reference.size(), stated.size());
  const std::size_t covered = 27;  // attitude ends before the last pings
  for (std::size_t i = 0; i < covered; ++i) EXPECT_NEAR(reference[i], stated[i], 0.015) << i;
}

// Each sounding states its place twice: as forward and starboard metres, and as differences of latitude and longitude.
TEST(KongsbergRecordings, MetresAndDegreesOfASoundingAgree) {
  ISOBATH_NEEDS_DATA(folder, kFolder);
  for (const char* name : {"em2042-harbour-c.kmall", "em2040-florida.kmall"}) {
    const auto bytes = read_whole_file(folder / name, 1 << 24);
    std::size_t compared = 0;
    for (std::size_t at = 0; at < bytes.size();) {
      const RecordView d(std::as_bytes(std::span(bytes)).subspan(at));
      at += d.at<std::uint32_t>(0);
      if (text_of(d.part(4, 4)) != "#MRZ") continue;
      const std::size_t ping = 24 + std::size_t{d.at<std::uint16_t>(24)};
      const std::size_t receiver = ping + d.at<std::uint16_t>(ping) +
                                   std::size_t{d.at<std::uint16_t>(ping + 92)} * d.at<std::uint16_t>(ping + 94);
      const std::size_t first = receiver + d.at<std::uint16_t>(receiver) +
                                std::size_t{d.at<std::uint16_t>(receiver + 28)} * d.at<std::uint16_t>(receiver + 30);
      const GeoPoint ship{d.at<double>(ping + 124), d.at<double>(ping + 132)};
      const Angle heading = Angle::degrees(static_cast<double>(d.at<float>(ping + 96)));
      for (std::size_t i = 0; i < d.at<std::uint16_t>(receiver + 2); ++i) {
        const std::size_t s = first + i * d.at<std::uint16_t>(receiver + 6);
        const Eigen::Vector2d moved =
            LocalPlane(ship).to_plane({ship.latitude_deg + static_cast<double>(d.at<float>(s + 88)),
                                       ship.longitude_deg + static_cast<double>(d.at<float>(s + 92))});
        const double x = static_cast<double>(d.at<float>(s + 104)), y = static_cast<double>(d.at<float>(s + 100));
        ASSERT_NEAR(moved.x(), x * cos(heading) - y * sin(heading), 0.01);
        ASSERT_NEAR(moved.y(), x * sin(heading) + y * cos(heading), 0.01);
        ++compared;
      }
    }
    EXPECT_GT(compared, 1000u);
  }
}

// The two formats state the deviation in different ways; read rightly, sonars of one kind come out alike.
TEST(KongsbergRecordings, BothFormatsStateDeviationsOfTheSameSize) {
  ISOBATH_NEEDS_DATA(folder, kFolder);
  const auto median_share = [&](const char* name) {
    std::vector<float> shares;
    for (const Swath& swath : see(folder / name).swaths) {
      for (const Sounding& s : swath.soundings) shares.push_back(s.sigma_m / s.range_m);
    }
    std::nth_element(shares.begin(), shares.begin() + static_cast<std::ptrdiff_t>(shares.size() / 2), shares.end());
    return shares[shares.size() / 2];
  };
  const float all = median_share("em2040c-australia.all"), kmall = median_share("em2040-florida.kmall");
  EXPECT_GT(all / kmall, 0.3F);
  EXPECT_LT(all / kmall, 3.0F);
}

}  // namespace
}  // namespace isobath
