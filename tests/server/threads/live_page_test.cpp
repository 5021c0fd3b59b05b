// All together: a run that fills items in its own thread, a server, and pages on bare sockets, of which one stalls.
// What each page has in the end is what the run has.
#include <atomic>
#include <gmock/gmock.h>
#include <isobath/base/random.hpp>
#include <isobath/server/page_session.hpp>
#include <isobath/server/web_server.hpp>
#include <latch>
#include <map>
#include <nlohmann/json.hpp>
#include <tests/server/records.hpp>
#include <tests/server/wire.hpp>
#include <thread>

namespace isobath {
namespace {

using test::Record;
using test::SocketPage;

/// Items as a page keeps them: by kind and number.
class Kept {
 public:
  void take(const std::string& message) {
    for (const Record& r : test::records_of(message)) {
      if (r.forget) items_.clear();
      const auto key = std::pair(r.kind, r.number);
      if (r.gone) {
        items_.erase(key);
      } else if (r.kind != DisplayKind::kClock) {
        items_[key] = r.payload;
      } else {
        clock = nlohmann::json::parse(r.payload);
      }
    }
  }
  [[nodiscard]] const auto& items() const { return items_; }
  nlohmann::json clock;

 private:
  std::map<std::pair<DisplayKind, std::uint64_t>, std::string> items_;
};

struct Reader {
  std::optional<SocketPage> page;
  Kept kept;
  bool take() {
    const auto message = page->next();
    if (message) kept.take(*message);
    return message.has_value();
  }
  bool comes_to(const Kept& truth) {
    while (kept.items() != truth.items()) {
      if (!take()) return false;
    }
    return true;
  }
};

/// A run of so many steps: echoes, a vehicle, tiles that come, change and go, once all anew.
void sail(DisplayState& items, std::atomic<std::int64_t>& now, int steps) {
  Random random(7);
  for (int i = 1; i <= steps; ++i) {
    const Time time{Duration(i * 1'000'000'000LL)};
    if (i == steps / 2) items.clear();
    items.set(DisplayKind::kEchoes, 0, time, std::string(100'000, static_cast<char>(i)));
    items.set(DisplayKind::kVehicle, 0, time, std::to_string(i));
    for (int k = 0; k < 20; ++k) {
      const auto tile = static_cast<std::uint64_t>(random.uniform(0, 200));
      const auto size = static_cast<std::size_t>(random.uniform(1, 20'000));
      if (size < 2000) {
        items.remove(DisplayKind::kDepth, tile, time);
      } else {
        items.set(DisplayKind::kDepth, tile, time, std::string(size, static_cast<char>(i + k)));
      }
    }
    now = time.time_since_epoch().count();
  }
}

TEST(LivePage, EachPageEndsWithWhatTheRunHas) {
  DisplayState items;
  std::atomic<std::int64_t> now = 0;
  PageSources sources;
  sources.live = std::make_shared<SharedChanges>(items);
  sources.live_span = [&] { return TimeSpan{Time{}, Time{Duration(now.load())}}; };
  check_page_sources(sources);
  WebServerConfig config;
  config.port = 0;
  config.frames_hz = 60;
  config.silent_s = config.stalled_s = 3600;  // a loaded machine drops no page
  WebSite site;
  site.sockets["/socket"].open = [&] { return std::make_unique<PageSession>(sources); };
  WebServer server(config, std::move(site));

  constexpr int kSteps = 300;
  Reader stalled;
  stalled.page.emplace(server.port(), "", 4096);
  ASSERT_TRUE(stalled.page->open());
  std::thread run([&] { sail(items, now, kSteps); });
  std::vector<Reader> readers(4);
  for (Reader& reader : readers) reader.page.emplace(server.port());
  std::vector<std::thread> threads;
  for (Reader& reader : readers) {
    threads.emplace_back([&reader] {
      while (reader.kept.clock.is_null() || reader.kept.clock.at("now_s") != kSteps) {
        if (!reader.take()) break;
      }
    });
  }
  run.join();
  for (std::thread& thread : threads) thread.join();

  Kept truth;
  truth.take(items.changes_after(0).records);
  EXPECT_EQ(truth.items().at({DisplayKind::kVehicle, 0}), std::to_string(kSteps));
  EXPECT_GT(truth.items().size(), 100u);
  // The clock may come a piece before the last items.
  for (Reader& reader : readers) EXPECT_TRUE(reader.comes_to(truth));
  EXPECT_EQ(server.counts().clients_ever, 5u);
  // And who took nothing all the while goes on from there.
  EXPECT_TRUE(stalled.comes_to(truth));
}

/// A page whose next frame takes until it is let go: the server's thread does nothing else meanwhile.
class HeldPage final : public WebSession {
 public:
  HeldPage(const PageSources& sources, std::latch& held, std::latch& let_go)
      : page_(sources), held_(held), let_go_(let_go) {}
  Hearing on_message(std::string_view text) override { return page_.on_message(text); }
  WebFrame next() override {
    if (!std::exchange(was_held_, true)) {
      held_.count_down();
      let_go_.wait();
    }
    return page_.next();
  }

 private:
  PageSession page_;
  std::latch& held_;
  std::latch& let_go_;
  bool was_held_ = false;
};

// ledger: S6-31
TEST(LivePage, TheRunGoesToItsEndWhileAPageHoldsTheServerUp) {
  constexpr int kSteps = 300;
  DisplayState items;
  std::atomic<std::int64_t> now = 0;
  PageSources sources;
  sources.live = std::make_shared<SharedChanges>(items);
  sources.live_span = [&] { return TimeSpan{Time{}, Time{Duration(now.load())}}; };
  std::latch held(1), let_go(1);
  WebServerConfig config;
  config.port = 0;
  WebSite site;
  site.sockets["/socket"].open = [&] { return std::make_unique<HeldPage>(sources, held, let_go); };
  WebServer server(config, std::move(site));

  Reader page;
  page.page.emplace(server.port());
  held.wait();
  sail(items, now, kSteps);  // in this thread: that it comes back at all is what is shown
  EXPECT_EQ(server.counts().frames, 0u) << "nothing was sent all the while";
  let_go.count_down();

  Kept truth;
  truth.take(items.changes_after(0).records);
  std::size_t bytes = 0;
  while (page.kept.items() != truth.items()) {
    const auto message = page.page->next();
    ASSERT_TRUE(message);
    bytes += message->size();
    page.kept.take(*message);
  }
  // What came in between is not made up for: of 300 pings the last alone.
  EXPECT_LT(bytes, items.bytes() + 100 * truth.items().size() + 10'000);
}

TEST(LivePage, CommandsComeThroughForWhoMayGiveThem) {
  DisplayState items;
  std::atomic<int> aborted = 0;
  PageSources sources;
  sources.live = std::make_shared<SharedChanges>(items);
  sources.live_span = [] { return TimeSpan{}; };
  sources.token = "correct horse battery";
  sources.command = [&](PageCommand command, const std::string& /*by*/) {
    aborted += command == PageCommand::kAbort ? 1 : 0;
    return std::string();
  };
  WebServerConfig config;
  config.port = 0;
  WebSite site;
  site.sockets["/socket"].open = [&] { return std::make_unique<PageSession>(sources); };
  WebServer server(config, std::move(site));

  SocketPage guesser(server.port());
  guesser.say(R"({"ask": "command", "command": "abort"})");
  for (int i = 0; i < PageSession::kWrongTokens; ++i) guesser.say(R"({"ask": "control", "token": "correct horse"})");
  EXPECT_EQ(guesser.close_code(), 1008);
  EXPECT_EQ(server.counts().refused.at("token"), 3u);
  EXPECT_EQ(server.counts().refused.at("no_control"), 1u);
  EXPECT_EQ(aborted, 0);

  SocketPage operator_page(server.port());
  operator_page.say(R"({"ask": "control", "token": "correct horse battery"})");
  operator_page.say(R"({"ask": "command", "command": "abort"})");
  operator_page.say(R"({"ask": "command", "command": "?"})");
  while (const auto message = operator_page.next()) {
    if (message->find("hold, resume or abort") != std::string::npos) break;
  }
  EXPECT_EQ(aborted, 1);
}

}  // namespace
}  // namespace isobath
