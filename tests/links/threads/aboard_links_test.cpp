// Devices and an autopilot over real sockets on this machine: what is heard, who may steer, and cables that are pulled.
#include <chrono>
#include <fmt/format.h>
#include <functional>
#include <gmock/gmock.h>
#include <isobath/links/vehicle_links.hpp>
#include <isobath/standin/stand_ins.hpp>
#include <tests/support/data.hpp>
#include <thread>

namespace isobath::links {
namespace {

using namespace std::chrono_literals;

constexpr double kSpeed = 10;  // times real time

/// The stand-ins of the scene, stepped by a thread of their own, and the vehicle that hears them.
class Joined {
 public:
  explicit Joined(StandInRequest request, const std::string& devices) {
    request.speed = kSpeed;
    request.autopilot = "udp-server:0";
    stand_ins_.emplace(open_scenario(test::source_folder() / "scenarios/aboard.toml"), request);
    std::string text =
        fmt::format("[autopilot]\nlink = \"udp:127.0.0.1:{}\"\n", stand_ins_->autopilot_port()) + devices;
    for (const auto& device : stand_ins_->devices()) {
      const std::string key = std::string("@") + to_text(device->kind());
      if (const auto at = text.find(key); at != std::string::npos)
        text.replace(at, key.size(), std::to_string(device->port()));
    }
    vehicle_.emplace(parse_vehicle_file(text, "vehicle.toml"), kSpeed);
    vehicle_->start();
    sails_ = std::thread([this] {
      while (!ended_ && stand_ins_->step()) continue;
    });
  }
  ~Joined() {
    ended_ = true;
    sails_.join();
  }
  /// Takes events until this holds, at most 20 s of the clock.
  bool until(const std::function<bool(const Event&)>& holds) {
    const auto end = std::chrono::steady_clock::now() + 20s;
    while (std::chrono::steady_clock::now() < end) {
      const auto event = vehicle_->source().next();
      if (event && holds(*event)) return true;
    }
    return false;
  }
  VehicleLinks& vehicle() { return *vehicle_; }
  StandIns& stand_ins() { return *stand_ins_; }

 private:
  std::optional<StandIns> stand_ins_;
  std::optional<VehicleLinks> vehicle_;
  std::atomic<bool> ended_{false};
  std::thread sails_;
};

const std::string kPing360 =
    "[[device]]\nkind = \"ping360\"\nlink = \"udp:127.0.0.1:@ping360\"\nrange_m = 20\nsector_deg = 120\n";
const std::string kPing1D = "[[device]]\nkind = \"ping1d\"\nlink = \"udp:127.0.0.1:@ping1d\"\n";
const std::string kDvl = "[[device]]\nkind = \"dvl-a50\"\nlink = \"tcp:127.0.0.1:@dvl-a50\"\n";

StandInRequest with(std::initializer_list<StandInRequest::Device> devices) {
  StandInRequest request;
  request.devices = devices;
  return request;
}

TEST(AboardLinks, HearSonarsAnEchoSounderAndTheAutopilot) {
  Joined joined(with({{DeviceKind::kPing360, "udp-server:0"},
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
  StandInRequest request = with({});
  request.guided_after_s = 5;
  request.turns = {{10, 20}};
  Joined joined(request, "");
  AutopilotLink& autopilot = joined.vehicle().autopilot();
  Setpoint ahead;
  ahead.speed = 0.5;
  ahead.depth = 0.5;
  std::map<Authority, AutopilotLink::Counts> first, last;
  std::optional<Authority> before;
  std::vector<Authority> course;
  joined.until([&](const Event& event) {
    autopilot.command(ahead, {}, time_of(event));
    const Authority now = autopilot.authority();
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

TEST(AboardLinks, AreFoundAgainAfterEachPull) {
  StandInRequest request = with({{DeviceKind::kPing360, "udp-server:0"}, {DeviceKind::kDvlA50, "tcp-server:0"}});
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
