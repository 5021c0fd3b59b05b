// Devices and an autopilot over real sockets on this machine: what is heard, who may steer, and cables that are pulled.
#include <fstream>
#include <gmock/gmock.h>
#include <tests/links/joined.hpp>

namespace isobath::links {
namespace {

using test::Joined;

const std::string kPing360 =
    "[[device]]\nkind = \"ping360\"\nlink = \"udp:127.0.0.1:@ping360\"\nrange_m = 20\nsector_deg = 120\n";
const std::string kPing1D = "[[device]]\nkind = \"ping1d\"\nlink = \"udp:127.0.0.1:@ping1d\"\n";
const std::string kDvl = "[[device]]\nkind = \"dvl-a50\"\nlink = \"tcp:127.0.0.1:@dvl-a50\"\n";

std::string key_file(const std::filesystem::path& folder, const std::string& passphrase) {
  const auto file = folder / "key.txt";
  std::ofstream(file) << passphrase << "\n";
  return file.string();
}

TEST(AboardLinks, HearSonarsAnEchoSounderAndTheAutopilot) {
  Joined joined(Joined::with({{DeviceKind::kPing360, "udp-server:0"},
                              {DeviceKind::kPing1D, "udp-server:0"},
                              {DeviceKind::kDvlA50, "tcp-server:0"}}),
                kPing360 + kPing1D + kDvl);
  int pings = 0, ranges = 0, fixes = 0, beats = 0;
  double reach_m = 0;
  EXPECT_TRUE(joined.until([&](const Event& event) {
    if (const auto* ping = std::get_if<Ping>(&event)) {
      ++pings;
      reach_m = ping->window.end_m();
    }
    ranges += std::holds_alternative<RangeReading>(event);
    fixes += std::holds_alternative<Navigation>(event);
    const auto* health = std::get_if<Health>(&event);
    beats += health && health->source == "vehicle";
    return pings > 20 && ranges > 5 && fixes > 20 && beats > 1;
  })) << pings
      << " pings, " << ranges << " ranges, " << fixes << " fixes, " << beats << " reports";
  EXPECT_NEAR(reach_m, 20, 0.1) << "the range that the head was commanded to";
  for (const auto& device : joined.vehicle().devices()) EXPECT_TRUE(device->heard()) << device->config().called();
  const auto origin = joined.vehicle().autopilot().origin();
  ASSERT_TRUE(origin);
  EXPECT_NEAR(origin->latitude_deg, 1.312, 1e-6);
}

TEST(AboardLinks, SteerOnlyWhileTheVehicleIsArmedAndInGuided) {
  StandInRequest request = Joined::with({});
  request.guided_after_s = 5;
  request.turns = {{10, 20}};
  Joined joined(request, "");
  FrontSeat& autopilot = joined.vehicle().autopilot();
  Setpoint ahead;
  ahead.speed = 0.5;
  ahead.depth = 0.5;
  std::map<Authority, FrontSeat::Counts> first, last;
  std::optional<Authority> before;
  std::vector<Authority> course;
  joined.until([&](const Event& event) {
    autopilot.command(ahead, {}, time_of(event));
    const Authority now = autopilot.authority();
    if (before && now == Authority::kNoAutopilot) return false;  // a busy machine was silent for a moment
    if (before != now) {
      course.push_back(now);
      first[now] = autopilot.counts();
    }
    before = now;
    last[now] = autopilot.counts();
    return course.size() >= 5 && now == Authority::kOurs && last[now].setpoints > first[now].setpoints + 5;
  });
  using enum Authority;
  EXPECT_THAT(course, testing::ElementsAre(kNoAutopilot, kDisarmed, kOurs, kOtherMode, kOurs));
  EXPECT_EQ(first[kDisarmed].setpoints, 0u);
  EXPECT_EQ(last[kOtherMode].setpoints, first[kOtherMode].setpoints) << "the pilot has the vehicle";
  EXPECT_GT(last[kOtherMode].withheld, first[kOtherMode].withheld);
  EXPECT_GT(joined.stand_ins().autopilot().setpoints, 5u);
}

TEST(AboardLinks, TrustOnlyAnAutopilotThatSignsByTheirKey) {
  const auto folder = test::scratch_folder();
  for (const std::string ours : {"a boat among buoys", "another passphrase"}) {
    StandInRequest request = Joined::with({});
    request.key.emplace("a boat among buoys");
    Joined joined(request, fmt::format("key_file = \"{}\"\n", key_file(folder, ours)));
    const bool right = ours == "a boat among buoys";
    std::uint64_t refused = 0;
    EXPECT_TRUE(joined.until([&](const Event&) {
      joined.vehicle().autopilot().command({}, {}, joined.vehicle().now());
      const auto& rejected = joined.vehicle().source().report().rejected;
      const auto found = rejected.find("autopilot: frame with a wrong signature");
      if (found != rejected.end()) refused = found->second;
      return right ? joined.stand_ins().autopilot().setpoints > 5 : refused > 20;
    }));
    EXPECT_EQ(joined.vehicle().autopilot().authority() == Authority::kNoAutopilot, !right);
    EXPECT_EQ(joined.stand_ins().autopilot().untrusted > 0, !right);
    EXPECT_EQ(refused > 0, !right);
  }
}

TEST(AboardLinks, AreFoundAgainAfterEachPull) {
  StandInRequest request =
      Joined::with({{DeviceKind::kPing360, "udp-server:0"}, {DeviceKind::kDvlA50, "tcp-server:0"}});
  request.unplug = {.times = 4, .mean_s = 2, .longest_s = 2, .seed = 3};
  Joined joined(request, kPing360 + kDvl);
  int pings = 0, fixes = 0;
  const auto pulled = [&] {
    int sum = joined.stand_ins().autopilot().pulled;
    for (const auto& device : joined.stand_ins().devices()) sum += device->pulled();
    return sum;
  };
  EXPECT_TRUE(joined.until([&](const Event& event) {
    if (pulled() < 12) return false;
    pings += std::holds_alternative<Ping>(event);
    fixes += std::holds_alternative<Navigation>(event);
    return pings > 10 && fixes > 10;
  })) << pulled()
      << " pulls, then " << pings << " pings, " << fixes << " fixes";
}

}  // namespace
}  // namespace isobath::links
