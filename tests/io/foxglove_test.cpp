// Messages for other viewers: frames turned, numbers that JSON has, bytes in base64. Every message is held against the
// published schemas in tests/recording/conformance.
#include <cmath>
#include <cstring>
#include <gmock/gmock.h>
#include <isobath/io/mcap/foxglove.hpp>
#include <limits>
#include <nlohmann/json.hpp>

namespace isobath {
namespace {

using Eigen::Vector3d;
using nlohmann::json;
using testing::HasSubstr;
using testing::Not;

const double kNan = std::numeric_limits<double>::quiet_NaN();
const Time kTime{Duration(1'600'000'000'250'000'000)};

Pose pose_at(double heading_deg, double pitch_deg, double roll_deg, const Vector3d& place) {
  return {Rotation::from_heading_pitch_roll(Angle::degrees(heading_deg), Angle::degrees(pitch_deg),
                                            Angle::degrees(roll_deg)),
          place};
}

std::vector<std::uint8_t> from_base64(const std::string& text) {
  const std::string digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::vector<std::uint8_t> bytes;
  std::uint32_t word = 0;
  int bits = 0;
  EXPECT_EQ(text.size() % 4, 0u);
  for (const char c : text) {
    if (c == '=') break;
    word = word << 6 | static_cast<std::uint32_t>(digits.find(c));
    bits += 6;
    if (bits < 8) continue;
    bits -= 8;
    bytes.push_back(static_cast<std::uint8_t>(word >> bits));
  }
  return bytes;
}

Vector3d vector_of(const json& v) { return Vector3d(v["x"].get<double>(), v["y"].get<double>(), v["z"].get<double>()); }
Eigen::Quaterniond quaternion_of(const json& q) {
  return Eigen::Quaterniond(q["w"].get<double>(), q["x"].get<double>(), q["y"].get<double>(), q["z"].get<double>());
}

// A point that is ahead, to starboard and below must be so in "map", whatever the attitude: both ways give one place.
TEST(Foxglove, TurnsFramesSoThatPlacesStayTheSame) {
  for (const double heading : {0.0, 37.0, 90.0, 200.0}) {
    const Pose X_WB = pose_at(heading, 10, -20, {12, -5, 7});
    const json message = json::parse(foxglove_transform(kTime, X_WB));
    const Vector3d p_B(3, 2, 1);  // forward, starboard, down
    const Vector3d p_W = X_WB * p_B;
    const Vector3d p_body(3, -2, -1);  // forward, port, up
    const Vector3d p_map = quaternion_of(message["rotation"]) * p_body + vector_of(message["translation"]);
    EXPECT_LT((p_map - Vector3d(p_W.y(), p_W.x(), -p_W.z())).norm(), 1e-4) << heading;
  }
  const json east = json::parse(foxglove_pose(kTime, pose_at(90, 0, 0, {1, 2, 3})));
  EXPECT_LT((vector_of(east["pose"]["position"]) - Vector3d(2, 1, -3)).norm(), 1e-9);
  EXPECT_NEAR(std::abs(quaternion_of(east["pose"]["orientation"]).w()), 1, 1e-6) << "east is x: nothing is turned";
  EXPECT_EQ(east["timestamp"]["sec"], 1'600'000'000);
  EXPECT_EQ(east["timestamp"]["nsec"], 250'000'000);
}

TEST(Foxglove, WritesNoNumberThatJsonLacks) {
  const Pose nowhere = pose_at(0, 0, 0, {kNan, 0, 0});
  EXPECT_EQ(foxglove_transform(kTime, nowhere), "");
  EXPECT_EQ(foxglove_pose(kTime, nowhere), "");
  EXPECT_EQ(foxglove_location(kTime, {{kNan, 0}}), "");
  const std::vector<FoxglovePoint> points{{{1, 2, 3}, 4}, {{NAN, 0, 0}, 1}, {{0, 0, 0}, INFINITY}};
  const json cloud = json::parse(foxglove_points(kTime, points, "intensity"));
  const auto bytes = from_base64(cloud["data"]);
  ASSERT_EQ(bytes.size(), 16u) << "only the whole one";
  float numbers[4];
  std::memcpy(numbers, bytes.data(), 16);
  EXPECT_THAT(numbers, testing::ElementsAre(2, 1, -3, 4));
  FoxgloveEntity entity{"e"};
  entity.lines.push_back({{Vector3d(1, 2, 3), Vector3d(kNan, 0, 0)}, true, {}});
  entity.balls.push_back({Vector3d(kNan, 0, 0), 1, {}});
  entity.texts.push_back({Vector3d(kNan, 0, 0), "x", {}});
  const std::string scene = foxglove_scene(kTime, {&entity, 1});
  EXPECT_THAT(scene, Not(HasSubstr("null")));
  EXPECT_EQ(json::parse(scene)["entities"][0]["lines"][0]["points"].size(), 1u);
  FoxglovePlace place{{1, 103}, 2, Eigen::Matrix3d::Constant(kNan)};
  EXPECT_EQ(json::parse(foxglove_location(kTime, place))["position_covariance_type"], 0);
}

TEST(Foxglove, CovarianceIsOfEastNorthUp) {
  Eigen::Matrix3d ned;
  ned << 4, 1, 0.5, 1, 9, -0.25, 0.5, -0.25, 16;
  const json fix = json::parse(foxglove_location(kTime, {{1, 103}, 2.5, ned, Angle::degrees(-90)}));
  EXPECT_EQ(fix["altitude"], -2.5);
  EXPECT_NEAR(fix["heading"], 3 * M_PI / 2, 1e-6);
  const std::vector<double> want{9, 1, 0.25, 1, 4, -0.5, 0.25, -0.5, 16};
  EXPECT_EQ(fix["position_covariance"].get<std::vector<double>>(), want);
}

// Where a cell of the grid lies, by the rules of foxglove.Grid, is where it lies in W.
TEST(Foxglove, CellsOfAGridLieWhereTheyLie) {
  const int nx = 3, ny = 2;
  const std::vector<std::uint8_t> values{0, 1, 10, 11, 20, 21};  // 10 x + y
  const Vector3d corner_W(5, -3, 2);
  const Angle heading = Angle::degrees(60);
  const json grid = json::parse(foxglove_grid(kTime, {corner_W, heading, nx, ny, 0.5, values}, "occupancy"));
  const auto data = from_base64(grid["data"]);
  const auto columns = grid["column_count"].get<int>();
  ASSERT_EQ(data.size(), 6u);
  for (std::size_t i = 0; i < data.size(); ++i) {
    const auto column = static_cast<double>(i % columns), row = static_cast<double>(i / columns);
    const Vector3d p_map =
        quaternion_of(grid["pose"]["orientation"]) * Vector3d((column + 0.5) * 0.5, (row + 0.5) * 0.5, 0) +
        vector_of(grid["pose"]["position"]);
    const double x = data[i] / 10, y = data[i] % 10;
    const Vector3d p_W = corner_W + Rotation::from_heading(heading) * Vector3d((x + 0.5) * 0.5, (y + 0.5) * 0.5, 0);
    EXPECT_LT((p_map - to_east_north_up(p_W)).norm(), 1e-3) << i;
  }
}

TEST(Foxglove, BytesAreBase64) {  // RFC 4648, 10
  const auto encoded = [](const std::string& text) {
    const std::vector<std::uint8_t> bytes(text.begin(), text.end());
    return json::parse(foxglove_image({}, static_cast<int>(bytes.size()), 1, bytes))["data"].get<std::string>();
  };
  EXPECT_EQ(encoded("f"), "Zg==");
  EXPECT_EQ(encoded("fo"), "Zm8=");
  EXPECT_EQ(encoded("foo"), "Zm9v");
  EXPECT_EQ(encoded("foobar"), "Zm9vYmFy");
}

TEST(Foxglove, TextThatIsNoUtf8DoesNotThrow) {
  EXPECT_TRUE(json::accept(foxglove_log(Time(Duration(-5)), FoxgloveLevel::kInfo, "n\xff", "\xc3(")));
}

}  // namespace
}  // namespace isobath
