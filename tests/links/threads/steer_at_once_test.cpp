// A run aboard waits for its devices, and does not wait when the vehicle must be steered anew.
#include <gtest/gtest.h>
#include <isobath/links/front_seat.hpp>
#include <isobath/links/link_source.hpp>
#include <thread>

namespace isobath {
namespace {

constexpr Time kNow = Time(std::chrono::seconds(7));

TEST(LinkSource, IsWokenBeforeItsBeat) {
  LinkSource source([] { return kNow; }, std::chrono::hours(1));
  std::thread waker([&source] { source.wake(); });
  const auto woken = source.next();
  waker.join();
  ASSERT_TRUE(woken.has_value());
  ASSERT_TRUE(std::holds_alternative<Health>(*woken));
  EXPECT_EQ(std::get<Health>(*woken).source, "links");
  EXPECT_EQ(time_of(*woken), kNow);
}

TEST(LinkSource, GivesADevicesEventInPlaceOfTheCall) {
  LinkSource source([] { return kNow; }, std::chrono::hours(1));
  source.wake();
  Navigation fix;
  fix.time = kNow;
  source.give(fix);
  const auto event = source.next();
  ASSERT_TRUE(event.has_value());
  EXPECT_TRUE(std::holds_alternative<Navigation>(*event));
  source.end();
  EXPECT_FALSE(source.next().has_value()) << "the call was answered by the fix";
}

/// A front seat that gives its controls away, without a link.
struct Seat final : FrontSeat {
  explicit Seat(LinkSource& source) : FrontSeat({}, source) {}
  void on_bytes(Bytes /*bytes*/, Time /*time*/) override {}
  [[nodiscard]] std::string mode() const override { return "ours"; }
  [[nodiscard]] std::optional<GeoOrigin> origin() const override { return std::nullopt; }
  bool command(const Setpoint& /*setpoint*/, const VehicleParameters& /*limits*/, Time at) override {
    const std::lock_guard lock(mutex_);
    return admits_setpoint(at, at, true);
  }
  void say(int /*severity*/, const std::string& /*text*/) override {}
  void show(const Surroundings& /*around*/, const Navigation& /*fix*/, Time /*now*/) override {}
  [[nodiscard]] Authority authority_at(Time /*now*/) const override { return Authority::kOurs; }
};

TEST(FrontSeat, LetsTheSetpointThatAnswersAPingOutBeforeItsInterval) {
  LinkSource source([] { return kNow; });
  Seat seat(source);
  const auto command_after = [&](int ms) { return seat.command({}, {}, kNow + std::chrono::milliseconds(ms)); };
  EXPECT_TRUE(command_after(0));
  EXPECT_FALSE(command_after(10));
  seat.hasten();
  EXPECT_TRUE(command_after(20));
  EXPECT_FALSE(command_after(30)) << "one for each call";
  EXPECT_TRUE(command_after(70));
}

}  // namespace
}  // namespace isobath
