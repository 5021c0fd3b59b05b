// A viewer that speaks the Foxglove WebSocket protocol, message by message.
#include <gmock/gmock.h>
#include <isobath/server/foxglove_session.hpp>
#include <nlohmann/json.hpp>

namespace isobath {
namespace {

using nlohmann::json;
using testing::ElementsAre;
using testing::HasSubstr;

const Time kFirstTime{Duration(1'600'000'000'000'000'000)};

/// What a viewer gets until there is nothing more.
struct ViewerGot {
  std::vector<json> texts;
  std::vector<std::string> bodies;  ///< of messages, in order
  std::vector<std::uint64_t> times;
};

ViewerGot take(FoxgloveSession& session) {
  ViewerGot got;
  const auto little = [](const std::string& bytes, std::size_t at) {
    std::uint64_t value = 0;
    for (std::size_t i = 0; i < 8; ++i) value |= std::uint64_t{static_cast<unsigned char>(bytes[at + i])} << (8 * i);
    return value;
  };
  for (WebFrame frame = session.next(); frame.bytes() > 0; frame = session.next()) {
    if (frame.text) {
      got.texts.push_back(json::parse(frame.own));
    } else if (frame.own[0] == 1) {
      got.bodies.push_back(frame.own.substr(13));
      EXPECT_GE(little(frame.own, 5), 1'600'000'000'000'000'000);
    } else {
      got.times.push_back(little(frame.own, 1));
    }
  }
  return got;
}

struct ViewedRun {
  ViewerFeed feed;
  std::size_t pose = feed.open({"/pose", "foxglove.PoseInFrame", R"({"type": "object"})"});
  std::size_t log = feed.open({"/log", "foxglove.Log", R"({"type": "object"})", true});
};

// ledger: S6-57
TEST(FoxgloveSession, AdvertisesTheChannelsAndSendsWhatIsSubscribed) {
  ViewedRun run;
  FoxgloveSession session(run.feed, "Isobath 1", "7");
  EXPECT_TRUE(run.feed.watched());
  run.feed.write(run.pose, kFirstTime, "early");
  const ViewerGot first = take(session);
  ASSERT_EQ(first.texts.size(), 2u);
  EXPECT_EQ(first.texts[0]["op"], "serverInfo");
  EXPECT_EQ(first.texts[0]["sessionId"], "7");
  EXPECT_EQ(first.texts[1]["op"], "advertise");
  EXPECT_EQ(first.texts[1]["channels"][0]["topic"], "/pose");
  EXPECT_EQ(first.texts[1]["channels"][0]["schemaName"], "foxglove.PoseInFrame");
  EXPECT_EQ(first.texts[1]["channels"][0]["encoding"], "json");
  EXPECT_THAT(first.bodies, ElementsAre()) << "nothing is subscribed yet";
  EXPECT_THAT(first.times, ElementsAre(1'600'000'000'000'000'000));

  EXPECT_EQ(session.on_message(R"({"op": "subscribe", "subscriptions": [{"id": 5, "channelId": 1}]})").refused, "");
  EXPECT_THAT(take(session).bodies, ElementsAre("early"));
  EXPECT_THAT(take(session).bodies, ElementsAre());
  run.feed.open({"/plan", "foxglove.SceneUpdate", R"({"type": "object"})"});
  const ViewerGot added = take(session);
  ASSERT_EQ(added.texts.size(), 1u);
  EXPECT_EQ(added.texts[0]["channels"][0]["id"], 3);
  EXPECT_EQ(session.on_message(R"({"op": "unsubscribe", "subscriptionIds": [5]})").refused, "");
  run.feed.write(run.pose, kFirstTime, "late");
  EXPECT_THAT(take(session).bodies, ElementsAre());
}

// A slow viewer misses positions and no decision.
TEST(FoxgloveSession, KeepsTheNewestPoseAndEachLineOfTheLog) {
  ViewedRun run;
  FoxgloveSession session(run.feed, "Isobath", "1");
  take(session);
  session.on_message(R"({"op": "subscribe", "subscriptions": [{"id": 1, "channelId": 1}, {"id": 2, "channelId": 2}]})");
  for (int i = 0; i < 3; ++i) {
    run.feed.write(run.pose, kFirstTime + seconds(i), "pose " + std::to_string(i));
    run.feed.write(run.log, kFirstTime + seconds(i), "line " + std::to_string(i));
  }
  EXPECT_THAT(take(session).bodies, testing::UnorderedElementsAre("pose 2", "line 0", "line 1", "line 2"));
}

TEST(FoxgloveSession, TakesNoOrdersAndRefusesWhatIsNotOfTheProtocol) {
  ViewedRun run;
  FoxgloveSession session(run.feed, "Isobath", "1");
  take(session);
  for (const char* wrong : {"", "[]", "subscribe", R"({"op": 1})", R"({"op": "setParameters", "parameters": []})",
                            R"({"op": "advertise", "channels": []})", R"({"op": "subscribe"})",
                            R"({"op": "subscribe", "subscriptions": [1]})",
                            R"({"op": "subscribe", "subscriptions": [{"id": 1, "channelId": 9}]})",
                            R"({"op": "subscribe", "subscriptions": [{"id": -1, "channelId": 1}]})",
                            R"({"op": "subscribe", "subscriptions": [{"id": 1e12, "channelId": 1}]})",
                            R"({"op": "unsubscribe", "subscriptionIds": [4]})"}) {
    EXPECT_EQ(session.on_message(wrong).refused, "foxglove") << wrong;
    const ViewerGot got = take(session);
    ASSERT_EQ(got.texts.size(), 1u) << wrong;
    EXPECT_EQ(got.texts[0]["op"], "status");
  }
  bool hung_up = false;
  for (int i = 0; i < FoxgloveSession::kMaxRefusals; ++i) hung_up = session.on_message("?").hang_up;
  EXPECT_TRUE(hung_up);
}

TEST(FoxgloveSession, IsAViewerAsLongAsItLives) {
  ViewedRun run;
  {
    const FoxgloveSession session(run.feed, "Isobath", "1");
    EXPECT_TRUE(run.feed.watched());
  }
  EXPECT_FALSE(run.feed.watched());
}

}  // namespace
}  // namespace isobath
