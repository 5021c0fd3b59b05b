// The link to the operator: what is sent arrives once and in order, whatever the link loses, repeats, delays or breaks.
#include <gmock/gmock.h>
#include <isobath/base/random.hpp>
#include <isobath/mission/agents/signaling_officer.hpp>
#include <isobath/mission/plan/mission_file.hpp>
#include <tests/mission/agent_script.hpp>

namespace isobath::signaling_officer_test {
namespace {

using Kind = OperatorCommand::Kind;

std::shared_ptr<const MissionPlan> a_plan(const std::string& title) {
  return std::make_shared<const MissionPlan>(
      parse_mission("[mission]\ntitle = \"" + title + "\"\n[[mission_point]]\nnorth = 30.0\ndepth_m = 2.0\n", "plan"));
}

/// Loses, doubles, breaks and delays (so that frames overtake one another).
class Air {
 public:
  Air(std::uint64_t seed, double loss) : random_(seed), loss_(loss) {}

  void send(const FrameBytes& bytes, double now_s) {
    const int copies = random_.uniform() < loss_ ? 0 : random_.uniform() < 0.2 ? 2 : 1;
    for (int i = 0; i < copies; ++i) {
      FrameBytes frame = bytes;
      const std::uint64_t place = random_.index(frame.size());
      if (random_.uniform() < 0.1) frame[place] ^= static_cast<std::uint8_t>(1 + random_.index(255));
      under_way_.emplace_back(now_s + random_.uniform(0.1, 3), std::move(frame));
    }
  }
  std::vector<FrameBytes> arrived(double now_s) {
    std::vector<FrameBytes> out;
    std::erase_if(under_way_, [&](auto& f) {
      if (f.first > now_s) return false;
      out.push_back(std::move(f.second));
      return true;
    });
    return out;
  }

 private:
  Random random_;
  double loss_;
  std::vector<std::pair<double, FrameBytes>> under_way_;
};

/// Operator, air, Signaling Officer, and agents that answer each command with a status.
struct Rig {
  OperatorConsole console;
  SignalingOfficer officer;
  Air up, down;
  std::vector<OperatorCommand> commands;  ///< that the agents got, beats aside
  int beats = 0;
  std::vector<StatusReport> statuses;  ///< that the operator got
  std::vector<Health> health;
  std::vector<Decision> decisions;
  double now_s = 0;
  bool silent = false;

  Rig(std::uint64_t seed, double loss) : up(seed, loss), down(seed + 1000, loss) {}

  void route(Outbox& out) {
    std::vector<Message> said = std::move(out.said());
    for (Message& m : said) {
      if (auto* frame = std::get_if<LinkFrame>(&m)) down.send(frame->bytes, now_s);
      if (auto* h = std::get_if<Health>(&m)) health.push_back(*h);
      if (auto* d = std::get_if<Decision>(&m)) decisions.push_back(*d);
      if (auto* c = std::get_if<OperatorCommand>(&m)) {
        if (c->kind == Kind::kBeat) {
          ++beats;
          continue;
        }
        commands.push_back(*c);
        Outbox answer;
        const StatusReport status{MissionPhase::kUnderWay, commands.size(), 9, "command taken"};
        officer.on_message(status, at(now_s), answer);
        route(answer);
      }
    }
  }
  void run(double for_s) {
    for (const double end_s = now_s + for_s; now_s < end_s; now_s += 0.1) {
      if (!silent) {
        for (const FrameBytes& f : console.due(at(now_s))) up.send(f, now_s);
      }
      for (FrameBytes& f : up.arrived(now_s)) {
        Outbox out;
        officer.on_message(LinkFrame{LinkFrame::Way::kFromOperator, std::move(f)}, at(now_s), out);
        route(out);
      }
      for (const FrameBytes& f : down.arrived(now_s)) {
        if (const auto status = console.on_frame(f)) statuses.push_back(*status);
      }
      Outbox out;
      officer.tick(at(now_s), out);
      route(out);
    }
  }
};

// ledger: S6-40
TEST(SignalingOfficer, CommandsArriveOnceAndInOrderThroughALossyLink) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    Rig rig(seed, 0.5);
    rig.console.command({Kind::kStart, a_plan("first")});
    rig.console.command({Kind::kHold});
    rig.console.command({Kind::kResume});
    rig.run(200);
    ASSERT_EQ(rig.commands.size(), 3u) << "seed " << seed;
    EXPECT_EQ(rig.commands[0].kind, Kind::kStart);
    EXPECT_EQ(rig.commands[0].plan->title, "first");
    EXPECT_EQ(rig.commands[0].plan->points.at(0).north_east, Eigen::Vector2d(30, 0));
    EXPECT_EQ(rig.commands[1].kind, Kind::kHold);
    EXPECT_EQ(rig.commands[2].kind, Kind::kResume);
    EXPECT_TRUE(rig.console.all_acknowledged());
    EXPECT_TRUE(rig.officer.link().all_acknowledged());
    EXPECT_GT(rig.officer.link().damaged(), 0u);
    EXPECT_GT(rig.officer.link().repeated(), 0u);
    ASSERT_FALSE(rig.statuses.empty());
    EXPECT_EQ(rig.statuses.back().point, 3u) << "the newest status arrives, whatever becomes of those before";
    EXPECT_EQ(rig.statuses.back().phase, MissionPhase::kUnderWay);
    EXPECT_EQ(rig.statuses.back().text, "command taken");
    for (std::size_t i = 1; i < rig.statuses.size(); ++i) {
      EXPECT_LT(rig.statuses[i - 1].point, rig.statuses[i].point);
    }
  }
}

// ledger: S6-40
TEST(SignalingOfficer, AnAbortDoesNotWaitBehindAMission) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    Rig rig(seed, 0.6);
    rig.console.command({Kind::kStart, a_plan("first")});
    rig.run(1);
    rig.console.command({Kind::kHold});
    rig.console.command({Kind::kAbort});
    rig.run(200);
    ASSERT_FALSE(rig.commands.empty());
    EXPECT_EQ(rig.commands.back().kind, Kind::kAbort) << "whatever was under way may come before, never after";
    EXPECT_LE(rig.commands.size(), 2u);
  }
}

// ledger: S6-40
TEST(SignalingOfficer, MissesAnOperatorWhoWasHeard) {
  Rig rig(7, 0);
  rig.silent = true;
  rig.run(100);
  EXPECT_TRUE(rig.health.empty()) << "one who was never heard is not missed";
  rig.silent = false;
  rig.run(60);
  EXPECT_TRUE(rig.health.empty());
  EXPECT_GE(rig.beats, 8);
  rig.silent = true;
  rig.run(29);
  EXPECT_TRUE(rig.health.empty());
  rig.run(20);
  ASSERT_EQ(rig.health.size(), 1u);
  EXPECT_EQ(rig.health[0].source, "operator link");
  EXPECT_EQ(rig.health[0].state, HealthState::kLost);
  rig.silent = false;
  rig.run(20);
  ASSERT_EQ(rig.health.size(), 2u);
  EXPECT_EQ(rig.health[1].state, HealthState::kOk);
}

// ledger: S6-40 S6-43
TEST(SignalingOfficer, ABadMissionIsRefusedAndTheOperatorIsTold) {
  Rig rig(8, 0.3);
  auto bad = std::make_shared<MissionPlan>(*a_plan("too deep"));
  bad->points[0].depth_m = 500;
  rig.console.command({Kind::kStart, bad});
  rig.run(60);
  EXPECT_TRUE(rig.commands.empty());
  ASSERT_EQ(rig.decisions.size(), 1u);
  ASSERT_FALSE(rig.statuses.empty());
  EXPECT_THAT(rig.statuses.back().text, testing::HasSubstr("refused: operator link:"));
  EXPECT_THAT(rig.statuses.back().text, testing::HasSubstr("500 m of depth"));
}

// ledger: S6-40
TEST(OperatorLink, AnEndThatStartsAnewIsHeardAnew) {
  LinkEnd vehicle(seconds(1));
  const auto only = [](std::vector<FrameBytes> frames) { return frames.at(0); };
  LinkEnd first(seconds(1));
  first.send({'a'}, false);
  const FrameBytes a = only(first.due(at(10)));
  EXPECT_EQ(vehicle.receive(a).word, FrameBytes{'a'});
  EXPECT_FALSE(vehicle.receive(a).word.has_value());
  LinkEnd second(seconds(1));
  second.send({'b'}, false);
  EXPECT_EQ(vehicle.receive(only(second.due(at(20)))).word, FrameBytes{'b'}) << "number 1 again, of another session";
  EXPECT_FALSE(vehicle.receive(a).word.has_value()) << "a frame of the old session, late";
}

TEST(OperatorLink, FramesOfTheSpecification) {
  const FrameBytes frame = to_bytes(Frame{FrameKind::kWord, 0x0102030405060708, 9, {'h', 'i'}});
  EXPECT_THAT(FrameBytes(frame.begin(), frame.begin() + 22),
              testing::ElementsAre('I', 'L', 1, 1, 8, 7, 6, 5, 4, 3, 2, 1, 9, 0, 0, 0, 2, 0, 0, 0, 'h', 'i'));
  ASSERT_EQ(frame.size(), 26u);
  // What zlib says of the 22 bytes.
  EXPECT_THAT(FrameBytes(frame.begin() + 22, frame.end()), testing::ElementsAre(0xf5, 0x3e, 0xf2, 0x4b));
  for (std::size_t i = 0; i < frame.size(); ++i) {
    EXPECT_FALSE(frame_of(std::span(frame).first(i)).has_value()) << "cut at " << i;
    FrameBytes broken = frame;
    broken[i] ^= 0x10;
    EXPECT_FALSE(frame_of(broken).has_value()) << "broken at " << i;
  }
  ASSERT_TRUE(frame_of(frame).has_value());
  EXPECT_EQ(frame_of(frame)->word, (FrameBytes{'h', 'i'}));
  EXPECT_THROW(command_of(FrameBytes{'c', 9}), Error);
  EXPECT_THROW(command_of(FrameBytes{'c', 0}), Error) << "a start without a mission";
  EXPECT_FALSE(status_of(FrameBytes{'s', 1}).has_value());
}

}  // namespace
}  // namespace isobath::signaling_officer_test
