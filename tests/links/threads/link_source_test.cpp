// The source of a run aboard: it waits for its devices, and does not wait when the vehicle must be steered anew.
#include <gtest/gtest.h>
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

}  // namespace
}  // namespace isobath
