// The MOOS client without a socket: what it sends first, and what it makes of bytes that were written by hand.
#include <gmock/gmock.h>
#include <isobath/base/error.hpp>
#include <isobath/links/moos_link.hpp>
#include <isobath/links/vehicle_file.hpp>
#include <tests/io/bytes_by_hand.hpp>

namespace isobath::moos_link {
namespace {

using test::hex;
using testing::HasSubstr;

/// A link that keeps what it is told to send.
class KeptLink final : public ByteLink {
 public:
  void send(std::vector<std::byte> bytes) override { sent.emplace_back(text_of(bytes)); }
  void cut(std::chrono::milliseconds /*lasts*/) override { ++cuts; }
  [[nodiscard]] int port() const override { return 0; }
  [[nodiscard]] std::uint64_t dropped() const override { return 0; }
  std::vector<std::string> sent;
  int cuts = 0;
};

std::string text(const std::string& of) { return test::little(static_cast<std::uint32_t>(of.size())) + of; }
std::string number(double of) { return test::little(std::bit_cast<std::uint64_t>(of)); }

/// A message by the description of the protocol, not by the codec.
std::string message(char type, char kind, const std::string& key, double time_s, double value,
                    const std::string& string = "") {
  const std::string body = test::little(std::uint32_t{1}) + type + kind + text("pNav") + text("") + text("au") +
                           text(key) + number(time_s) + number(value) + number(0) + text(string);
  return test::little(static_cast<std::uint32_t>(body.size() + 4)) + body;
}
std::string packet(const std::vector<std::string>& messages) {
  std::string body;
  for (const std::string& m : messages) body += m;
  return test::little(static_cast<std::uint32_t>(body.size() + 9)) +
         test::little(static_cast<std::uint32_t>(messages.size())) + '\0' + body;
}

FrontSeatConfig moos_config() {
  FrontSeatConfig config;
  config.kind = FrontSeatKind::kMoos;
  return config;
}

/// A client that has been welcomed by a database whose clock shows `kClock`.
struct Welcomed {
  static constexpr double kClock = 5000;
  explicit Welcomed(const FrontSeatConfig& config = moos_config()) : moos(config, source) {
    moos.use(hub, link);
    moos.on_open(hub.now());
    say({message('W', 'D', "", kClock, 0)});
  }
  void say(const std::vector<std::string>& messages) { moos.on_bytes(bytes_of(packet(messages)), hub.now()); }
  /// The values of NAV_X, NAV_Y, NAV_HEADING, NAV_DEPTH and NAV_SPEED, `age_s` old.
  void navigate(double age_s, double x = 30, double y = 40) {
    const double t = kClock - age_s;
    say({message('.', 'D', "", kClock, kClock), message('N', 'D', "NAV_X", t, x), message('N', 'D', "NAV_Y", t, y),
         message('N', 'D', "NAV_HEADING", t, 90), message('N', 'D', "NAV_DEPTH", t, 2.5),
         message('N', 'D', "NAV_SPEED", t, 0.75)});
  }
  /// The next event; empty: there is none.
  std::optional<Event> event() {
    Health mark;
    mark.source = "end";
    source.give(mark);
    std::optional<Event> found;
    while (auto next = source.next()) {
      const auto* health = std::get_if<Health>(&*next);
      if (health && health->source == "end") break;
      if (!found) found = std::move(next);
    }
    return found;
  }
  std::uint64_t refused(const std::string& reason) {
    (void)event();
    const auto found = source.report().rejected.find("autopilot: " + reason);
    return found == source.report().rejected.end() ? 0 : found->second;
  }

  LinkHub hub;  // does not start: all runs in this thread
  KeptLink link;
  LinkSource source{[this] { return hub.now(); }};
  MoosLink moos;
};

TEST(MoosLink, GreetsAndGivesItsNameThenRegisters) {
  Welcomed client;
  ASSERT_GE(client.link.sent.size(), 3u);
  EXPECT_EQ(client.link.sent[0], hex("45 4C 4B 53 20 43 41 4E 27 54 20 44 41 4E 43 45 20 32 2F 38 2F 31 30 00x9"));
  const std::string& name = client.link.sent[1];
  ASSERT_EQ(name.size(), 9u + 54 + 7 + 7);
  EXPECT_EQ(name.substr(0, 9), hex("4D 00 00 00 01 00 00 00 00"));
  EXPECT_EQ(name.substr(17, 2), "iS");
  EXPECT_EQ(name.substr(name.size() - 11), hex("07 00 00 00") + "isobath");
  EXPECT_EQ(name.substr(34, 4), hex("00 00 00 00")) << "no key: it asks for answers only";
  for (const char* key : {"NAV_X", "NAV_DEPTH", "MOOS_MANUAL_OVERRIDE", "MOOS_MANUAL_OVERIDE"})
    EXPECT_THAT(client.link.sent[2], HasSubstr(text(key)));
}

TEST(MoosLink, ValuesOfOneInstantAreAFix) {
  Welcomed client;
  const Time now = client.hub.now();
  client.navigate(0.25);
  const auto event = client.event();
  const auto* fix = event ? std::get_if<Navigation>(&*event) : nullptr;
  ASSERT_TRUE(fix);
  EXPECT_EQ(fix->X_WB.translation, Eigen::Vector3d(40, 30, 2.5)) << "north, east, down";
  EXPECT_NEAR(fix->X_WB.rotation.heading().degrees(), 90, 1e-9);
  ASSERT_TRUE(fix->v_WB);
  EXPECT_NEAR(fix->v_WB->y(), 0.75, 1e-9);
  EXPECT_NEAR(to_seconds(fix->time - now), -0.25, 0.2) << "as old as the values";
  client.say({message('.', 'D', "", 5000, 5000), message('N', 'D', "NAV_X", 5000, 31)});
  EXPECT_FALSE(client.event()) << "north and heading of that instant are missing";
}

TEST(MoosLink, OldOrImpossibleValuesAreCounted) {
  Welcomed client;
  client.navigate(5);
  client.navigate(-5);
  client.navigate(0, std::nan(""));
  client.say({message('N', 'S', "NAV_X", 5000, 0, "thirty"), message('N', 'D', "NAV_X", std::nan(""), 1),
              message('N', 'S', "MOOS_MANUAL_OVERRIDE", 5000, 0, "maybe")});
  EXPECT_FALSE(client.event());
  EXPECT_EQ(client.refused("NAV_X that is old"), 1u);
  EXPECT_EQ(client.refused("NAV_X from the future"), 1u);
  EXPECT_EQ(client.refused("NAV_X that is no usable number"), 3u);
  EXPECT_EQ(client.refused("MOOS_MANUAL_OVERRIDE that is neither true nor false"), 1u);
}

TEST(MoosLink, OnlyAFalseOverrideGivesAuthority) {
  Welcomed client;
  EXPECT_EQ(client.moos.authority(), Authority::kDisarmed) << "no navigation yet";
  client.navigate(0);
  EXPECT_EQ(client.moos.authority(), Authority::kOtherMode) << "the override is not known";
  client.say({message('N', 'S', "MOOS_MANUAL_OVERRIDE", 5000, 0, "FALSE")});
  EXPECT_EQ(client.moos.authority(), Authority::kOurs);
  client.say({message('N', 'S', "MOOS_MANUAL_OVERIDE", 5000, 0, "true")});
  EXPECT_EQ(client.moos.authority(), Authority::kOtherMode) << "either spelling";
  EXPECT_EQ(client.moos.mode(), "MOOS_MANUAL_OVERRIDE true");
}

TEST(MoosLink, HearsAltitudeAndOrigin) {
  Welcomed client;
  client.say({message('.', 'D', "", 5000, 5000), message('N', 'D', "NAV_ALTITUDE", 5000, 6.5),
              message('N', 'D', "LAT_ORIGIN", 100, 43.8), message('N', 'D', "LONG_ORIGIN", 100, -70.3)});
  const auto event = client.event();
  const auto* range = event ? std::get_if<RangeReading>(&*event) : nullptr;
  ASSERT_TRUE(range);
  EXPECT_EQ(range->range_m, 6.5);
  EXPECT_NEAR((range->X_BS.rotation * Eigen::Vector3d::UnitX()).z(), 1, 1e-9) << "straight down";
  EXPECT_EQ(client.moos.origin(), (GeoOrigin{43.8, -70.3}));
  FrontSeatConfig stated = moos_config();
  stated.latitude_deg = 1.3;
  stated.longitude_deg = 103.7;
  EXPECT_EQ(Welcomed(stated).moos.origin(), (GeoOrigin{1.3, 103.7}));
}

TEST(MoosLink, ConnectsAnewWhereTheDatabaseRefusesOrIsSilent) {
  Welcomed client;
  client.moos.on_open(client.hub.now());
  client.say({message('K', 'S', "", 5000, 0, "a client of this name already exists")});
  EXPECT_EQ(client.link.cuts, 1);
  EXPECT_EQ(client.refused("the MOOSDB refuses the client isobath"), 1u);
  const std::size_t sent = client.link.sent.size();
  client.moos.on_open(client.hub.now());
  EXPECT_EQ(client.link.sent.size(), sent + 2) << "the handshake again";
  client.moos.on_tick(client.hub.now() + std::chrono::seconds(4));
  EXPECT_EQ(client.link.cuts, 2);
}

std::string problem(const std::string& file) {
  try {
    parse_vehicle_file(file, "vehicle.toml");
  } catch (const Error& e) {
    return e.what();
  }
  return "";
}

TEST(MoosLink, IsChosenInTheVehicleFile) {
  const std::string moos = "[autopilot]\nkind = \"moos\"\nlink = \"tcp:127.0.0.1:9000\"\n";
  EXPECT_EQ(problem(moos + "[mission]\nfrom = \"none\"\n"), "");
  EXPECT_THAT(problem(moos), HasSubstr("write from = \"file\""));
  EXPECT_THAT(problem("[autopilot]\nkind = \"moos\"\n[mission]\nfrom = \"none\"\n"), HasSubstr("tcp:HOST:9000"));
}

}  // namespace
}  // namespace isobath::moos_link
