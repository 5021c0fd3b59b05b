// Messages of the agents as JSON: one object each, with nothing in it that JSON lacks.
#include <gtest/gtest.h>
#include <isobath/recording/message_json.hpp>
#include <limits>
#include <nlohmann/json.hpp>

namespace isobath {
namespace {

using nlohmann::json;

json said(Message message) {
  return json::parse(message_json({7, Time(seconds(12.5)), "navigator", std::move(message)}));
}

// ledger: S6-32
TEST(MessageJson, SaysWhoSaidWhatAndWhen) {
  RoutePlanned route;
  route.request = 3;
  route.version = 9;
  route.waypoints = {{1, 2, 3, 1.5, {}}, {-4, 5.25, 3, 1, {}}};
  route.avoiding = true;
  route.why = "leg 1 would run into \"something\"";
  const json message = said(route);
  EXPECT_EQ(message["number"], 7);
  EXPECT_EQ(message["time_ns"], 12'500'000'000);
  EXPECT_EQ(message["sender"], "navigator");
  EXPECT_EQ(message["type"], "route planned");
  const json& content = message["content"];
  EXPECT_EQ(content["waypoints"][1]["east"], 5.25);
  EXPECT_EQ(content["why"], route.why);
  EXPECT_EQ(content["avoiding"], true);
}

TEST(MessageJson, WhatIsLargeIsToldByItsSize) {
  Sweep sweep;
  auto map = std::make_shared<Detection>();
  map->cells = {1000, 1000, 1};
  map->obstacles.resize(12);
  for (Obstacle& o : map->obstacles) o.number = 1 + static_cast<int>(&o - map->obstacles.data()) % 3;
  sweep.map = map;
  const json content = said(sweep)["content"];
  EXPECT_EQ(content["cells"], 1'000'000);
  EXPECT_EQ(content["obstacles"], 3) << "of four pieces each";
  EXPECT_EQ(content["obstacle_pieces"], 12);
  EXPECT_LT(content.dump().size(), 200u);
  LinkFrame frame;
  frame.bytes = {0x00, 0xff, 0x1a};
  EXPECT_EQ(said(frame)["content"]["bytes"], "00ff1a");
}

template <std::size_t... kType>
void expect_an_object_of_each(std::index_sequence<kType...>) {
  const auto expect_object = [](Message message) {
    const json parsed = said(std::move(message));
    EXPECT_TRUE(parsed["content"].is_object()) << parsed;
  };
  (expect_object(Message(std::in_place_index<kType>)), ...);
}

TEST(MessageJson, EveryTypeHasAContentEvenWhenItIsEmpty) {
  expect_an_object_of_each(std::make_index_sequence<kMessageTypes>());
}

TEST(MessageJson, WhatIsNoNumberIsNull) {
  HelmOrder order;
  order.setpoint.depth = std::numeric_limits<double>::quiet_NaN();
  order.setpoint.speed = -std::numeric_limits<double>::infinity();
  EXPECT_TRUE(said(order)["content"]["setpoint"]["depth"].is_null());
  EXPECT_TRUE(said(order)["content"]["setpoint"]["speed"].is_null());
  EXPECT_TRUE(said(SonarEchoes{})["content"]["nearest"].is_null()) << "of no echo none is nearest";
  Health health;
  health.note = "\xff no UTF-8";
  EXPECT_NO_THROW(said(health));
}

}  // namespace
}  // namespace isobath
