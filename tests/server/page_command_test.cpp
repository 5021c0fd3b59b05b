// Which page has command: at most one; how it changes hands; and what a page with command may plan.
#include <gmock/gmock.h>
#include <isobath/server/page_session.hpp>
#include <nlohmann/json.hpp>
#include <tests/server/records.hpp>
#include <utility>

namespace isobath {
namespace {

using nlohmann::json;
using test::of_kind;
using test::records_of;
using testing::ElementsAre;
using testing::IsEmpty;
using testing::SizeIs;

constexpr const char* kSeatToken = "0123456789abcdef";
const json kSeatDraft{{"mission", 0}, {"points", {{{"north", 1}, {"east", 2}, {"depth_m", 3}}}}};

/// The pages of a run that is 100 s old.
struct Pages {
  Pages() {
    sources.live = std::make_shared<SharedChanges>(items);
    sources.live_span = [] { return TimeSpan{Time{}, Time{} + seconds(100)}; };
    sources.token = kSeatToken;
    sources.command = [this](PageCommand command, const std::string& by) {
      commands.emplace_back(command, by);
      return std::string();
    };
    sources.handed_over = [this](const std::string& sentence) { said.push_back(sentence); };
    sources.planning = {[this](const MissionDraft& draft, const std::string& by) {
                          sent.emplace_back(draft.points.size(), by);
                          return why;
                        },
                        [this](const MissionDraft&, std::uint64_t session) {
                          previewed = session;
                          return why;
                        },
                        [this](std::uint64_t session) {
                          return session == previewed ? std::exchange(answer, std::nullopt) : std::nullopt;
                        }};
  }
  std::unique_ptr<PageSession> open(const std::string& address) {
    auto page = std::make_unique<PageSession>(sources);
    page->on_client(address);
    return page;
  }
  static std::string_view ask(PageSession& page, const json& request) {
    return page.on_message(request.dump()).refused;
  }
  static std::string_view take(PageSession& page) { return ask(page, {{"ask", "control"}, {"token", kSeatToken}}); }
  /// The clock of a page that was not told its clock before.
  static json clock(PageSession& page) {
    return json::parse(of_kind(records_of(page.next()), DisplayKind::kClock).back().payload);
  }

  DisplayState items;
  PageSources sources;
  std::vector<std::pair<PageCommand, std::string>> commands;
  std::vector<std::pair<std::size_t, std::string>> sent;
  std::vector<std::string> said;
  std::string why;
  std::uint64_t previewed = 0;
  std::optional<std::string> answer;
};

TEST(PageCommandSeat, IsTakenOverWithTheTokenAndEachPageSeesByWhom) {
  Pages pages;
  const auto first = pages.open("10.0.0.1"), second = pages.open("::ffff:10.0.0.2"), third = pages.open("10.0.0.3");
  EXPECT_EQ(Pages::take(*first), "");
  const json own = Pages::clock(*first);
  EXPECT_EQ(own.at("control"), true);
  EXPECT_EQ(own.at("plans"), true);
  const json other = Pages::clock(*third);
  EXPECT_EQ(other.at("control"), false);
  EXPECT_EQ(other.at("command"), json({{"by", "the page at 10.0.0.1"}, {"since_s", 100.0}}));

  EXPECT_EQ(Pages::ask(*second, {{"ask", "control"}, {"token", "guessed"}}), "token");
  EXPECT_EQ(Pages::take(*second), "");
  EXPECT_EQ(Pages::clock(*first).at("control"), false) << "the former page is told";
  EXPECT_EQ(Pages::clock(*third).at("command").at("by"), "the page at 10.0.0.2");
  EXPECT_EQ(Pages::ask(*first, {{"ask", "command"}, {"command", "hold"}}), "no_control");
  EXPECT_EQ(Pages::ask(*second, {{"ask", "command"}, {"command", "return"}}), "");
  EXPECT_THAT(pages.commands, ElementsAre(std::pair(PageCommand::kReturn, "the page at 10.0.0.2")));
  EXPECT_THAT(pages.said,
              ElementsAre("the page at 10.0.0.1 has command",
                          "the page at 10.0.0.2 has command, which it takes over from the page at 10.0.0.1"));
}

TEST(PageCommandSeat, IsGivenUpOnRequestAndByAPageThatCloses) {
  Pages pages;
  auto page = pages.open("10.0.0.1");
  const auto other = pages.open("10.0.0.2");
  EXPECT_EQ(Pages::ask(*page, {{"ask", "release"}}), "no_control");
  Pages::take(*page);
  EXPECT_EQ(Pages::ask(*page, {{"ask", "release"}}), "");
  EXPECT_FALSE(Pages::clock(*page).contains("command"));
  Pages::take(*page);
  page.reset();
  EXPECT_FALSE(Pages::clock(*other).contains("command"));
  EXPECT_THAT(pages.said, ElementsAre("the page at 10.0.0.1 has command",
                                      "the page at 10.0.0.1 has given command up; no page has command",
                                      "the page at 10.0.0.1 has command",
                                      "the page at 10.0.0.1 has closed or lost its connection; no page has command"));
}

TEST(PageCommandSeat, ClosingAPageThatLostItChangesNothing) {
  Pages pages;
  auto page = pages.open("10.0.0.1");
  const auto other = pages.open("10.0.0.2");
  Pages::take(*page);
  Pages::take(*other);
  page.reset();
  EXPECT_THAT(pages.said, SizeIs(2));
  EXPECT_EQ(Pages::ask(*other, {{"ask", "command"}, {"command", "hold"}}), "");
}

TEST(PagePlanning, IsForThePageWithCommand) {
  Pages pages;
  const auto page = pages.open("10.0.0.1"), other = pages.open("10.0.0.2");
  EXPECT_EQ(Pages::ask(*page, {{"ask", "mission"}, {"draft", kSeatDraft}}), "no_control");
  EXPECT_EQ(Pages::ask(*page, {{"ask", "preview"}, {"draft", kSeatDraft}}), "no_control");
  Pages::take(*page);
  EXPECT_EQ(Pages::ask(*page, {{"ask", "preview"}, {"draft", kSeatDraft}}), "");
  EXPECT_THAT(of_kind(records_of(page->next()), DisplayKind::kPreview), IsEmpty()) << "it is not planned yet";
  pages.answer = R"({"legs":[]})";
  EXPECT_THAT(of_kind(records_of(other->next()), DisplayKind::kPreview), IsEmpty()) << "another page did not ask";
  const auto told = of_kind(records_of(page->next()), DisplayKind::kPreview);
  ASSERT_THAT(told, SizeIs(1));
  EXPECT_EQ(told[0].payload, R"({"legs":[]})");
  EXPECT_EQ(Pages::ask(*page, {{"ask", "mission"}, {"draft", kSeatDraft}}), "");
  EXPECT_THAT(pages.sent, ElementsAre(std::pair(std::size_t{1}, "the page at 10.0.0.1")));
  pages.why = "point 1 lies outside the fence";
  EXPECT_EQ(Pages::ask(*page, {{"ask", "mission"}, {"draft", kSeatDraft}}), "mission");
  const auto refusals = of_kind(records_of(page->next()), DisplayKind::kRefusal);
  ASSERT_THAT(refusals, SizeIs(1));
  EXPECT_EQ(json::parse(refusals[0].payload), json({{"request", "mission"}, {"why", pages.why}}));
}

}  // namespace
}  // namespace isobath
