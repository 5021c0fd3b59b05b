// The server on a free port, met by bare sockets (wire.hpp). Times in the configuration are short, so that what waits
// for them is quick; no test fails because something took long, but for kPatience.
#include <atomic>
#include <functional>
#include <gmock/gmock.h>
#include <isobath/server/web_server.hpp>
#include <nlohmann/json.hpp>
#include <ostream>
#include <stdexcept>
#include <tests/server/wire.hpp>
#include <thread>

namespace isobath {
namespace {

using test::frame_bytes;
using test::SocketPage;
using test::Wire;
using testing::HasSubstr;
using testing::Not;
using testing::StartsWith;

/// What all clients are shown: a number, with so many bytes behind it.
struct Shown {
  std::atomic<int> number = 1;
  std::atomic<std::size_t> padding = 0;
  std::atomic<int> sessions = 0;
};

/// Sends the number whenever it has changed; refuses "no", throws at "throw", hangs up at "bye".
class NumberSession final : public WebSession {
 public:
  explicit NumberSession(Shown& shown) : shown_(shown) { ++shown_.sessions; }
  ~NumberSession() override { --shown_.sessions; }
  Hearing on_message(std::string_view text) override {
    if (text == "throw") throw std::runtime_error("thrown");
    if (text == "echo") echo_ = true;
    if (text == "no") return {"said_no", false};
    if (text == "bye") return {"said_bye", true};
    return {};
  }
  WebFrame next() override {
    const int now = shown_.number;
    if (std::exchange(echo_, false)) return {nullptr, "echo", false};
    if (now == last_) return {};
    last_ = now;
    return {std::make_shared<const std::string>(std::to_string(now) + std::string(shown_.padding, ' ')), ".", false};
  }

 private:
  Shown& shown_;
  int last_ = 0;
  bool echo_ = false;
};

struct Site {
  explicit Site(const std::function<void(WebServerConfig&)>& change = [](WebServerConfig&) {}) {
    config.port = 0;
    config.frames_hz = 60;
    config.request_s = 5;
    config.stalled_s = 5;
    change(config);
    WebSite site;
    site.files["/"] = {"text/html; charset=utf-8", "<p>page</p>", "gzipped page"};
    site.files["/large"] = {"text/plain", std::string(3'000'000, 'x')};
    site.sockets["/socket"].open = [this] { return std::make_unique<NumberSession>(shown); };
    site.health = [this] {
      ++reports;
      return std::string(R"({"state": "well"})");
    };
    site.metrics = [] { return std::string("isobath_runs 1\n"); };
    server.emplace(config, std::move(site));
  }
  [[nodiscard]] int port() const { return server->port(); }
  [[nodiscard]] std::uint64_t refused(const std::string& reason) const {
    const WebCounts counts = server->counts();
    const auto found = counts.refused.find(reason);
    return found == counts.refused.end() ? 0 : found->second;
  }
  /// Waits for what comes by itself.
  template <class Condition>
  bool comes(const Condition& condition) const {
    for (int i = 0; i < Wire::kPatienceMs / 2; ++i) {
      if (condition(server->counts())) return true;
      std::this_thread::sleep_for(std::chrono::milliseconds(2));
    }
    return false;
  }
  bool comes_refused(const std::string& reason, std::uint64_t times = 1) const {
    return comes([&](const WebCounts&) { return refused(reason) >= times; });
  }
  /// The whole answer to a request that asks to close.
  std::string get(const std::string& target, const std::string& headers = "", const std::string& method = "GET") const {
    Wire wire(port());
    wire.send(method + " " + target + " HTTP/1.1\r\nHost: localhost\r\nConnection: close\r\n" + headers + "\r\n");
    return wire.take_all();
  }
  /// A well-behaved page gets a frame of what is new now.
  void expect_served() {
    SocketPage page(port());
    ASSERT_TRUE(page.open()) << page.answer;
    ASSERT_TRUE(page.next());
    const int next = ++shown.number;
    std::optional<std::string> frame = page.next();
    ASSERT_TRUE(frame);
    EXPECT_EQ(std::stoi(*frame), next);
  }

  Shown shown;
  std::atomic<int> reports = 0;
  WebServerConfig config;
  std::optional<WebServer> server;  ///< ends first
};

std::string body_of(const std::string& answer) { return answer.substr(answer.find("\r\n\r\n") + 4); }

// ---------------------------------------------------------------------------------------------------------------- HTTP

TEST(WebServer, ServesFilesWithWhatKeepsThemIn) {
  Site site;
  const std::string page = site.get("/?from=a%20friend");
  EXPECT_THAT(page, StartsWith("HTTP/1.1 200"));
  EXPECT_EQ(body_of(page), "<p>page</p>");
  for (const char* header :
       {"Content-Type: text/html; charset=utf-8\r\n", "Content-Length: 11\r\n", "X-Content-Type-Options: nosniff\r\n",
        "X-Frame-Options: DENY\r\n", "Referrer-Policy: no-referrer\r\n", "Cache-Control: no-cache\r\n",
        "default-src 'none'", "connect-src 'self' ws://localhost wss://localhost;", "frame-ancestors 'none'"}) {
    EXPECT_THAT(page, HasSubstr(header));
  }
  EXPECT_THAT(page, Not(HasSubstr("Access-Control")));
  EXPECT_EQ(body_of(site.get("/large")).size(), 3'000'000u);
  EXPECT_THAT(site.get("/nothing"), StartsWith("HTTP/1.1 404"));
  EXPECT_EQ(site.refused("not_found"), 1u);
}

TEST(WebServer, StandsOnlyInFramesOfTheOriginsThatItsSettingsName) {
  Site site([](WebServerConfig& c) { c.frame_origins = "http://blueos.local, http://192.168.2.2"; });
  const std::string page = site.get("/");
  EXPECT_THAT(page, HasSubstr("frame-ancestors http://blueos.local http://192.168.2.2\r\n"));
  EXPECT_THAT(page, Not(HasSubstr("X-Frame-Options")));
}

TEST(WebServer, GzipForWhoTakesIt) {
  Site site;
  const std::string zipped = site.get("/", "Accept-Encoding: br, gzip\r\n");
  EXPECT_EQ(body_of(zipped), "gzipped page");
  EXPECT_THAT(zipped, HasSubstr("Content-Encoding: gzip\r\n"));
  EXPECT_THAT(zipped, HasSubstr("Vary: Accept-Encoding\r\n"));
  EXPECT_EQ(body_of(site.get("/", "Accept-Encoding: gzip;q=0\r\n")), "<p>page</p>");
  EXPECT_THAT(site.get("/large", "Accept-Encoding: gzip\r\n"), Not(HasSubstr("Content-Encoding")));
}

TEST(WebServer, HeadIsGetWithoutTheBody) {
  Site site;
  const std::string head = site.get("/large", "", "HEAD");
  EXPECT_THAT(head, HasSubstr("Content-Length: 3000000\r\n"));
  EXPECT_EQ(body_of(head), "");
}

TEST(WebServer, ManyRequestsOnOneConnection) {
  Site site;
  Wire wire(site.port());
  for (int i = 0; i < 20; ++i) {
    wire.send("GET / HTTP/1.1\r\nHost: localhost\r\n\r\n");
    EXPECT_THAT(wire.take_until("\r\n\r\n"), StartsWith("HTTP/1.1 200"));
    EXPECT_EQ(wire.take(11), "<p>page</p>");
  }
  EXPECT_EQ(site.server->counts().connections_ever, 1u);
  EXPECT_EQ(site.server->counts().requests, 20u);
}

TEST(WebServer, HealthAndMetrics) {
  Site site;
  const std::string health = site.get("/health");
  EXPECT_EQ(body_of(health), R"({"state": "well"})");
  EXPECT_THAT(health, HasSubstr("Content-Type: application/json\r\n"));
  EXPECT_THAT(health, HasSubstr("Cache-Control: no-store\r\n"));
  const std::string metrics = body_of(site.get("/metrics"));
  EXPECT_THAT(metrics, HasSubstr("\nisobath_web_connections_total 2\n"));
  EXPECT_THAT(metrics, HasSubstr("\nisobath_runs 1\n"));
}

TEST(WebServer, HoweverOftenHealthIsAskedForTheSiteIsNot) {
  Site site;
  const auto begun = std::chrono::steady_clock::now();
  for (int i = 0; i < 50; ++i) site.get("/health");
  const double passed = std::chrono::duration<double>(std::chrono::steady_clock::now() - begun).count();
  EXPECT_LE(site.reports, 2 + passed / 0.1);
}

TEST(WebServer, SettingsAreRefusedWhereTheyCannotWork) {
  Site site;
  WebServerConfig config;
  config.port = site.port();
  EXPECT_THROW(WebServer(config, {}), Error);  // taken
  config.address = "boat";
  EXPECT_THROW(WebServer(config, {}), Error);
}

/// One bad request: what it is refused with, and counted as.
struct BadWebRequest {
  const char* name;
  std::string bytes;
  std::string status;
  std::string reason;
  friend std::ostream& operator<<(std::ostream& out, const BadWebRequest& r) { return out << r.name; }
};

class WebServerRefuses : public testing::TestWithParam<BadWebRequest> {};

TEST_P(WebServerRefuses, AndServesTheOthers) {
  Site site;
  {
    Wire wire(site.port());
    wire.send(GetParam().bytes);
    const std::string answer = wire.take_all();
    EXPECT_THAT(answer, StartsWith("HTTP/1.1 " + GetParam().status));
    EXPECT_THAT(answer, HasSubstr("Connection: close\r\n"));
    EXPECT_THAT(answer, Not(HasSubstr("evil")));
    EXPECT_EQ(site.refused(GetParam().reason), 1u) << GetParam().reason;
  }
  site.expect_served();
}

std::string request_of(const std::string& line, const std::string& headers = "Host: localhost\r\n",
                       const std::string& body = "") {
  return line + " HTTP/1.1\r\n" + headers + "\r\n" + body;
}
const std::string kUpgrade =
    "Host: localhost\r\nUpgrade: websocket\r\nConnection: Upgrade\r\nSec-WebSocket-Version: 13\r\n"
    "Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\n";

INSTANTIATE_TEST_SUITE_P(
    , WebServerRefuses,
    testing::Values(
        BadWebRequest{"Post", request_of("POST /"), "405", "method"},
        BadWebRequest{"Options", request_of("OPTIONS *"), "405", "method"},
        BadWebRequest{"Connect", request_of("CONNECT evil.example:443"), "405", "method"},
        BadWebRequest{"NoHttp", "evil\r\n\r\n", "400", "request"},
        BadWebRequest{"Version", "GET / HTTP/9.9\r\nHost: localhost\r\n\r\n", "400", "request"},
        BadWebRequest{"Tls", std::string("\x16\x03\x01\x02\x00\x01\x00\x01\xfc\x03\x03", 11), "400", "request"},
        BadWebRequest{"NoHost", request_of("GET /", ""), "400", "request"},
        BadWebRequest{"TwoHosts", request_of("GET /", "Host: localhost\r\nHost: evil.example\r\n"), "400", "request"},
        BadWebRequest{"OtherHost", request_of("GET /", "Host: evil.example\r\n"), "421", "host"},
        BadWebRequest{"Header", request_of("GET /", "Host: localhost\r\nX: " + std::string(9000, 'x') + "\r\n"), "431",
                      "header_bytes"},
        BadWebRequest{"Target", request_of("GET /" + std::string(2000, 'x')), "414", "target_bytes"},
        BadWebRequest{"Body", request_of("GET /", "Host: localhost\r\nContent-Length: 4\r\n", "evil"), "413", "body"},
        BadWebRequest{"LargeBody", request_of("POST /", "Host: localhost\r\nContent-Length: 99999999999\r\n"), "413",
                      "body"},
        BadWebRequest{
            "Chunked",
            request_of("GET /", "Host: localhost\r\nTransfer-Encoding: chunked\r\n", "4\r\nevil\r\n0\r\n\r\n"), "413",
            "body"},
        BadWebRequest{"Smuggled",
                      request_of("GET /", "Host: localhost\r\nContent-Length: 4\r\nTransfer-Encoding: chunked\r\n"),
                      "400", "request"},
        BadWebRequest{"Climbing", request_of("GET /../../etc/passwd"), "400", "path"},
        BadWebRequest{"ClimbingByEscapes", request_of("GET /%2e%2e/%2E%2E/etc/passwd"), "400", "path"},
        BadWebRequest{"BrokenEscape", request_of("GET /%zz"), "400", "path"},
        BadWebRequest{"BadUtf8", request_of("GET /%ff%fe"), "400", "path"},
        BadWebRequest{"Nul", request_of("GET /%00"), "400", "path"},
        BadWebRequest{"Proxy", request_of("GET http://evil.example/"), "400", "path"},
        BadWebRequest{"File", request_of("GET /etc/passwd"), "404", "not_found"},
        BadWebRequest{"SocketWithoutUpgrade", request_of("GET /socket"), "426", "no_upgrade"},
        BadWebRequest{"SocketOfAnotherPage", request_of("GET /socket", kUpgrade + "Origin: http://evil.example\r\n"),
                      "403", "origin"},
        BadWebRequest{"SocketOfNoPage", request_of("GET /socket", kUpgrade + "Origin: null\r\n"), "403", "origin"},
        BadWebRequest{
            "TwoOrigins",
            request_of("GET /socket", kUpgrade + "Origin: http://localhost\r\nOrigin: http://evil.example\r\n"), "400",
            "request"},
        BadWebRequest{"FramesBeforeTheHandshake", request_of("GET /socket", kUpgrade, frame_bytes(test::kText, "evil")),
                      "426", "no_upgrade"}),
    [](const auto& test) { return test.param.name; });

TEST(WebServer, ARequestThatNeverEndsIsDropped) {
  Site site([](WebServerConfig& c) { c.request_s = 0.2; });
  Wire silent(site.port()), slow(site.port());
  slow.send("GET / HTTP/1.1\r\nHost: loc");
  EXPECT_TRUE(slow.ends());
  EXPECT_TRUE(silent.ends());
  EXPECT_TRUE(site.comes_refused("request_time"));
  site.expect_served();
}

TEST(WebServer, APageThatIsNotReadIsDropped) {
  Site site([](WebServerConfig& c) {
    c.request_s = 0.2;
    c.max_connections = 3;
  });
  Wire wire(site.port(), 4096);
  for (int i = 0; i < 8; ++i) wire.send("GET / HTTP/1.1\r\nHost: localhost\r\nX: " + std::string(10, 'x') + "\r\n\r\n");
  EXPECT_TRUE(site.comes([](const WebCounts& c) { return c.connections == 0; }));
}

// 200 connections that say nothing: clients keep theirs, and who has something to say is heard.
TEST(WebServer, HundredsOfConnectionsKeepNobodyOut) {
  Site site;
  SocketPage page(site.port());
  ASSERT_TRUE(page.open());
  std::vector<Wire> crowd;
  for (int i = 0; i < 200; ++i) crowd.emplace_back(site.port());
  EXPECT_TRUE(site.comes_refused("connections", 200 + 1 - 64));
  EXPECT_LE(site.server->counts().connections, 64 + 1);
  site.expect_served();
  ASSERT_TRUE(page.next());
  site.shown.number = 77;
  while (true) {
    const auto frame = page.next();
    ASSERT_TRUE(frame);
    if (std::stoi(*frame) == 77) break;
  }
}

// ---------------------------------------------------------------------------------------------------------- the socket

TEST(WebServer, FramesAreWhatIsSharedThenWhatIsOwn) {
  Site site;
  SocketPage page(site.port(), "Origin: http://localhost:" + std::to_string(site.port()) + "\r\n");
  ASSERT_TRUE(page.open());
  EXPECT_EQ(page.next(), "1.");
  site.shown.padding = 200'000;  // several pieces
  site.shown.number = 2;
  EXPECT_EQ(page.next(), "2" + std::string(200'000, ' ') + ".");
  page.say("echo");
  EXPECT_EQ(page.next(), "echo");
  ASSERT_TRUE(site.comes([](const WebCounts& c) { return c.frames == 3; }));
  const WebCounts counts = site.server->counts();
  EXPECT_EQ(counts.frame_bytes, 2u + 200'002u + 4u);
  EXPECT_EQ(counts.messages, 1u);
}

TEST(WebServer, WhatAPageAsksForDoesNotWaitForTheNextFrame) {
  Site site([](WebServerConfig& c) { c.frames_hz = 0.1; });
  SocketPage page(site.port());
  ASSERT_TRUE(page.open()) << page.answer;
  ASSERT_TRUE(page.next());
  for (int i = 0; i < 3; ++i) {
    ASSERT_TRUE(page.say("echo"));
    EXPECT_EQ(page.next(3000), "echo");
  }
}

TEST(WebServer, WhoLeavesIsForgotten) {
  Site site;
  {
    SocketPage polite(site.port()), rude(site.port());
    ASSERT_TRUE(polite.open() && rude.open());
    polite.wire.send(frame_bytes(test::kClose, "\x03\xe8"));
    EXPECT_EQ(polite.close_code(), 1000);
  }
  EXPECT_TRUE(site.comes([](const WebCounts& c) { return c.clients == 0 && c.connections == 0; }));
  EXPECT_EQ(site.shown.sessions, 0);
}

TEST(WebServer, OnlySoManyClients) {
  Site site([](WebServerConfig& c) { c.max_clients = 2; });
  SocketPage one(site.port()), two(site.port()), three(site.port());
  EXPECT_TRUE(one.open() && two.open());
  EXPECT_TRUE(three.open());
  EXPECT_EQ(three.close_code(), 1013) << "try again later";
  EXPECT_EQ(site.refused("clients"), 1u);
  EXPECT_TRUE(one.next());
}

/// What a client sends, how the socket is closed (1006: without a word is right, too), and what is counted.
struct BadMessage {
  const char* name;
  std::string bytes;
  int code;
  std::string reason;
  friend std::ostream& operator<<(std::ostream& out, const BadMessage& m) { return out << m.name; }
};

class WebServerHangsUp : public testing::TestWithParam<BadMessage> {};

TEST_P(WebServerHangsUp, AndServesTheOthers) {
  Site site;
  SocketPage other(site.port());
  ASSERT_TRUE(other.next());
  {
    SocketPage page(site.port());
    ASSERT_TRUE(page.open());
    page.wire.send(GetParam().bytes);
    EXPECT_EQ(page.close_code(), GetParam().code);
    EXPECT_TRUE(site.comes_refused(GetParam().reason)) << GetParam().reason;
    EXPECT_EQ(site.refused(GetParam().reason), 1u);
  }
  site.shown.number = 9;
  EXPECT_EQ(other.next(), "9.");
  EXPECT_TRUE(site.comes([](const WebCounts& c) { return c.clients == 1; }));
}

std::string repeated(const std::string& bytes, int times) {
  std::string all;
  for (int i = 0; i < times; ++i) all += bytes;
  return all;
}

INSTANTIATE_TEST_SUITE_P(
    , WebServerHangsUp,
    testing::Values(BadMessage{"Binary", frame_bytes(test::kBinary, "x"), 1003, "binary"},
                    BadMessage{"TooLong", frame_bytes(test::kText, std::string(20000, 'x')), 1009, "message_bytes"},
                    BadMessage{"TooLongInPieces",
                               frame_bytes(test::kText, std::string(9000, 'x'), false) +
                                   frame_bytes(test::kContinuation, std::string(9000, 'x')),
                               1009, "message_bytes"},
                    BadMessage{"PromisesTooMuch", std::string("\x81\xff\x7f\xff\xff\xff\xff\xff\xff\xff\0\0\0\0", 14),
                               1009, "message_bytes"},
                    BadMessage{"BadUtf8", frame_bytes(test::kText, "\xff\xfe"), 1007, "message_utf8"},
                    BadMessage{"NotMasked", frame_bytes(test::kText, "x", true, false), 1002, "message_frame"},
                    BadMessage{"UnknownOpcode", frame_bytes(5, "x"), 1002, "message_frame"},
                    BadMessage{"ReservedBits", std::string("\xf1\x80\0\0\0\0", 6), 1002, "message_frame"},
                    BadMessage{"NothingToContinue", frame_bytes(test::kContinuation, "x"), 1002, "message_frame"},
                    BadMessage{"LongPing", frame_bytes(test::kPing, std::string(126, 'x')), 1002, "message_frame"},
                    BadMessage{"Fragments",
                               frame_bytes(test::kText, "x", false) +
                                   repeated(frame_bytes(test::kContinuation, "x", false), 100),
                               1008, "fragments"},
                    BadMessage{"Pings", repeated(frame_bytes(test::kPing, ""), 500), 1008, "pings"},
                    BadMessage{"SessionHangsUp", frame_bytes(test::kText, "bye"), 1008, "hung_up"},
                    BadMessage{"SessionThrows", frame_bytes(test::kText, "throw"), 1011, "session"}),
    [](const auto& test) { return test.param.name; });

TEST(WebServer, RefusalsOfTheSessionAreCounted) {
  Site site;
  SocketPage page(site.port());
  for (int i = 0; i < 3; ++i) page.say("no");
  EXPECT_TRUE(site.comes_refused("said_no", 3));
  EXPECT_TRUE(page.next());  // and nobody hangs up
}

TEST(WebServer, ManyMessagesWaitForTheirTurn) {
  Site site([](WebServerConfig& c) { c.messages_hz = 50; });
  SocketPage page(site.port());
  const auto begun = std::chrono::steady_clock::now();
  for (int i = 0; i < 75; ++i) page.say("well");
  page.say("echo");
  while (page.next() != "echo") continue;
  // 50 at once, 26 at 50 a second.
  EXPECT_GE(std::chrono::steady_clock::now() - begun, std::chrono::milliseconds(500));
  EXPECT_EQ(site.server->counts().messages, 76u);
  EXPECT_GT(site.refused("message_rate"), 0u);
}

// Empty fragments of a message that never ends never become bytes of a message.
TEST(WebServer, AFloodOfNothingIsHeldBack) {
  Site site([](WebServerConfig& c) {
    c.messages_hz = 1;
    c.max_message_bytes = 256;
  });
  SocketPage other(site.port());
  ASSERT_TRUE(other.next());
  SocketPage page(site.port(), "", 4096);
  ASSERT_TRUE(page.open());
  page.wire.send(frame_bytes(test::kText, "x", false));
  std::thread flood([&] {
    const std::string nothing = repeated(frame_bytes(test::kContinuation, "", false), 10000);
    while (page.wire.send(nothing)) continue;
  });
  site.shown.number = 5;
  EXPECT_EQ(other.next(), "5.");
  EXPECT_TRUE(site.comes_refused("flood"));
  flood.join();
  EXPECT_TRUE(site.comes([](const WebCounts& c) { return c.clients == 1; }));
}

TEST(WebServer, WhoAnswersNoPingIsDropped) {
  Site site([](WebServerConfig& c) { c.silent_s = 0.4; });
  SocketPage dead(site.port()), alive(site.port());
  ASSERT_TRUE(dead.open() && alive.open());
  std::optional<std::string> frame;
  while (site.refused("silent") == 0) {
    alive.next(20);  // answers pings
  }
  EXPECT_EQ(site.refused("silent"), 1u);
  site.shown.number = 8;
  while ((frame = alive.next()) && *frame != "8.") continue;
  EXPECT_TRUE(frame);
}

// One of four takes nothing; the others get all, and it is dropped in the end.
TEST(WebServer, WhoStallsIsDroppedAndHoldsNobodyUp) {
  Site site([](WebServerConfig& c) { c.stalled_s = 0.5; });
  site.shown.padding = 500'000;
  SocketPage stalled(site.port(), "", 4096);
  std::vector<SocketPage> others;
  for (int i = 0; i < 3; ++i) others.emplace_back(site.port());
  ASSERT_TRUE(stalled.open());
  for (SocketPage& page : others) ASSERT_TRUE(page.next());
  for (int number = 2; site.refused("stalled") == 0 && number < 1000; ++number) {
    site.shown.number = number;
    for (SocketPage& page : others) EXPECT_EQ(std::stoi(page.next().value()), number);
  }
  EXPECT_EQ(site.refused("stalled"), 1u);
  EXPECT_TRUE(site.comes([](const WebCounts& c) { return c.clients == 3; }));
}

// What it had not taken when it stood still was never made: there are no old frames to send.
TEST(WebServer, WhoWasSlowGetsTheNewest) {
  Site site([](WebServerConfig& c) { c.stalled_s = 60; });
  site.shown.padding = 1'000'000;
  SocketPage slow(site.port(), "", 4096), quick(site.port());
  ASSERT_TRUE(slow.open());
  for (int number = 2; number <= 30; ++number) {
    ASSERT_TRUE(quick.next());
    site.shown.number = number;
  }
  while (std::stoi(quick.next().value()) != 30) continue;
  std::vector<int> got;
  while (got.empty() || got.back() != 30) got.push_back(std::stoi(slow.next().value()));
  EXPECT_LE(got.size(), 4u) << testing::PrintToString(got);
  EXPECT_EQ(site.refused("stalled"), 0u);
}

TEST(WebServer, StopEndsAllAndCallsNobodyAgain) {
  Site site;
  site.shown.padding = 1'000'000;
  SocketPage stalled(site.port(), "", 4096), reading(site.port());
  Wire asking(site.port());
  asking.send("GET / HT");
  ASSERT_TRUE(stalled.open() && reading.open());
  ASSERT_TRUE(reading.next());
  site.server->stop();
  EXPECT_TRUE(reading.wire.ends());
  EXPECT_TRUE(asking.ends());
  EXPECT_FALSE(Wire(site.port()).send("GET / HTTP/1.1\r\n\r\n"));
  site.server->stop();  // twice is once
  site.server.reset();
  EXPECT_EQ(site.shown.sessions, 0);
}

}  // namespace
}  // namespace isobath
