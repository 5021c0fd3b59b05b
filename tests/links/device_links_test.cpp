// Links of devices and autopilots, their addresses, vehicle files, and the mission of an autopilot: without sockets.
#include <deque>
#include <gmock/gmock.h>
#include <isobath/base/error.hpp>
#include <isobath/geometry/geodesy.hpp>
#include <isobath/links/vehicle_file.hpp>
#include <isobath/mission/plan/mission_file.hpp>
#include <isobath/standin/stand_ins.hpp>

namespace isobath::links {
namespace {

using testing::HasSubstr;

std::string problem(const std::function<void()>& work) {
  try {
    work();
  } catch (const Error& e) {
    return e.what();
  }
  return "";
}

TEST(LinkAddress, SaysWhereADeviceIs) {
  const LinkAddress udp = link_address_of("udp:192.168.2.2:9092", "link");
  EXPECT_EQ(udp.kind, LinkAddress::Kind::kUdp);
  EXPECT_EQ(udp.host, "192.168.2.2");
  EXPECT_EQ(udp.port, 9092);
  EXPECT_EQ(link_address_of("udp-server:14550", "link").host, "127.0.0.1") << "other machines are let in by name only";
  EXPECT_EQ(link_address_of("tcp-server:0.0.0.0:52100", "link").host, "0.0.0.0");
  const LinkAddress serial = link_address_of("serial:/dev/ttyUSB0:115200", "link");
  EXPECT_EQ(serial.host, "/dev/ttyUSB0");
  EXPECT_EQ(serial.port, 115200);
}

TEST(LinkAddress, RefusesWhatIsNone) {
  EXPECT_THAT(problem([] { link_address_of("192.168.2.2", "link"); }), HasSubstr("udp:HOST:PORT"));
  for (const char* wrong : {"upd:host:1", "udp:host", "udp:host:x", "udp:host:70000", "udp:host:0", "udp::5", "tcp:1"})
    EXPECT_NE(problem([&] { link_address_of(wrong, "link"); }), "") << wrong;
}

TEST(VehicleFile, NamesTheLineOfAMistake) {
  const VehicleFile file = parse_vehicle_file(R"(
[autopilot]
link = "tcp:127.0.0.1:5777"
[[device]]
kind = "ping360"
link = "udp:127.0.0.1:9092"
upside_down = true
)",
                                              "vehicle.toml");
  ASSERT_EQ(file.devices.size(), 1u);
  EXPECT_FALSE(file.devices[0].input().clockwise);
  EXPECT_THAT(problem([] { parse_vehicle_file("[[device]]\nkind = \"ping361\"\nlink = \"udp:a:1\"\n", "v.toml"); }),
              HasSubstr("v.toml"));
  EXPECT_THAT(problem([] { parse_vehicle_file("[[device]]\nkind = \"ping1d\"\n", "v.toml"); }), HasSubstr("no link"));
  const std::string twice = "[[device]]\nlink = \"udp:a:1\"\n[[device]]\nlink = \"udp:a:2\"\n";
  EXPECT_THAT(problem([&] { parse_vehicle_file(twice, "v.toml"); }), HasSubstr("two devices are called ping360"));
  EXPECT_THAT(problem([] { parse_vehicle_file("[mission]\nfrom = \"file\"\n", "v.toml"); }), HasSubstr("mission"));
  EXPECT_EQ(parse_vehicle_file(vehicle_file_template(), "template").devices.size(), 1u)
      << "the template describes one device";
}

/// An autopilot that answers a MissionDownload as the mission protocol says, and loses every n-th message.
class LossyAutopilot {
 public:
  LossyAutopilot(AutopilotPlan plan, int loses_every) : plan_(std::move(plan)), loses_every_(loses_every) {}

  MissionDownload::Send send() {
    return [this](std::uint32_t id, const mavlink::PayloadBytes& body) {
      if (++messages_ % loses_every_ == 0) return;
      const MavlinkPayload p(body);
      if (id == mavlink::MissionRequestList::kId) {
        const auto kind = mavlink::MissionRequestList::of(p).kind;
        answer(mavlink::MissionCount::kId, mavlink::MissionCount{size(kind), 1, 196, kind}.body());
      } else if (id == mavlink::MissionRequest::kId) {
        const auto request = mavlink::MissionRequest::of(p);
        mavlink::MissionItem item = list(request.kind)[request.sequence];
        item.kind = request.kind;
        answer(mavlink::MissionItem::kId, item.body());
      }
    };
  }
  /// Feeds all answers, and time, until the download has ended.
  void serve(MissionDownload& download) {
    Time now{};
    for (int i = 0; i < 5000 && !download.done() && download.problem().empty(); ++i) {
      now += std::chrono::milliseconds(50);
      download.on_tick(now);
      for (; !answers_.empty(); answers_.pop_front()) download.on_frame(mavlink_frame(answers_.front()), now);
    }
  }

 private:
  const std::vector<mavlink::MissionItem>& list(mavlink::MissionKind kind) const {
    return kind == mavlink::MissionKind::kFence ? plan_.fence
                                                : (kind == mavlink::MissionKind::kRally ? plan_.rally : plan_.mission);
  }
  std::uint16_t size(mavlink::MissionKind kind) const { return static_cast<std::uint16_t>(list(kind).size()); }
  void answer(std::uint32_t id, const mavlink::PayloadBytes& body) {
    if (++messages_ % loses_every_ == 0) return;
    answers_.push_back(writer_.frame(id, body));
    if (messages_ % 5 == 0) answers_.push_back(answers_.back());  // some come twice
  }

  AutopilotPlan plan_;
  int loses_every_, messages_ = 0;
  MavlinkWriter writer_{1, 1};
  std::deque<std::vector<std::byte>> answers_;
};

TEST(MissionOfAnAutopilot, IsThePlanThatAGroundStationMade) {
  const Scenario scenario = open_scenario();
  const GeoOrigin origin = *scenario.scene.origin();
  for (const int loses_every : {1'000'000, 4, 2}) {
    LossyAutopilot autopilot(autopilot_plan(scenario.mission, origin), loses_every);
    MissionDownload download(1, 1, autopilot.send());
    autopilot.serve(download);
    if (loses_every == 2) {
      EXPECT_THAT(download.problem(), HasSubstr("does not answer")) << "every answer is lost";
      continue;
    }
    ASSERT_TRUE(download.done()) << download.problem();
    const MissionPlan plan = on_plane_of(parse_mission(qground_text(download.plan()), "autopilot.plan"), origin);
    ASSERT_EQ(plan.points.size(), scenario.mission.points.size());
    for (std::size_t i = 0; i < plan.points.size(); ++i) {
      EXPECT_LT((plan.points[i].north_east - scenario.mission.points[i].north_east).norm(), 0.05);
      EXPECT_NEAR(plan.points[i].depth_m, scenario.mission.points[i].depth_m, 1e-3);
    }
    EXPECT_NEAR(plan.speed, scenario.mission.speed, 1e-6);
    EXPECT_EQ(plan.fence.size(), scenario.mission.fence.size());
  }
}

TEST(MissionOfAnAutopilot, OfTooManyItemsIsRefused) {
  MissionDownload download(1, 1, [](std::uint32_t, const mavlink::PayloadBytes&) {});
  MavlinkWriter writer(1, 1);
  const auto count = writer.frame(mavlink::MissionCount::kId, mavlink::MissionCount{60000, 1, 196}.body());
  download.on_frame(mavlink_frame(count), {});
  EXPECT_THAT(download.problem(), HasSubstr("60000 items"));
}

}  // namespace
}  // namespace isobath::links
