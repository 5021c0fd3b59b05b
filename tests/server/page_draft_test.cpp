// Drafts of missions in requests of a page: what is taken, and what each mistake is called.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <isobath/server/page_request.hpp>
#include <nlohmann/json.hpp>

namespace isobath {
namespace {

using nlohmann::json;
using testing::HasSubstr;

const json kDraftPoint{{"north", 1.5}, {"east", -2}, {"depth_m", 3}};

Result<PageRequest, BadRequest> asked(const json& draft) {
  return page_request_of(json{{"ask", "mission"}, {"draft", draft}}.dump());
}
/// Why the draft is refused.
std::string refusal_of(const json& draft) {
  const auto request = asked(draft);
  return request ? "" : request.error().why;
}
json with(json point, const char* key, const json& value) {
  point[key] = value;
  return {{"mission", 0}, {"points", {point}}};
}

TEST(PageDraft, IsReadWithAllThatAPointMayHave) {
  json other{{"north", 4}, {"east", 5}, {"altitude_m", 6}, {"speed", 0.5}, {"from", 2}};
  const auto request = asked({{"mission", 7}, {"points", {kDraftPoint, other}}, {"fence", {{0, 0}, {0, 9}, {9, 9}}}});
  ASSERT_TRUE(request);
  EXPECT_EQ(request->ask, PageRequest::Ask::kMission);
  const MissionDraft& draft = request->draft;
  EXPECT_EQ(draft.mission, 7u);
  ASSERT_EQ(draft.points.size(), 2u);
  EXPECT_EQ(draft.points[0].north_east, Eigen::Vector2d(1.5, -2));
  EXPECT_EQ(draft.points[0].depth_m, 3);
  EXPECT_FALSE(draft.points[0].altitude_m || draft.points[0].from);
  EXPECT_EQ(draft.points[1].altitude_m, 6);
  EXPECT_EQ(draft.points[1].speed, 0.5);
  EXPECT_EQ(draft.points[1].from, 2u);
  ASSERT_TRUE(draft.fence);
  EXPECT_EQ(draft.fence->size(), 3u);
  EXPECT_FALSE(asked({{"mission", 0}, {"points", {kDraftPoint}}})->draft.fence) << "the fence of the mission stays";
}

TEST(PageDraft, WithAMistakeIsRefusedByName) {
  EXPECT_THAT(refusal_of(7), HasSubstr("must be an object"));
  EXPECT_THAT(refusal_of(json::object()), HasSubstr("does not name its mission"));
  EXPECT_THAT(refusal_of({{"mission", 0.5}, {"points", {kDraftPoint}}}), HasSubstr("mission must be a number"));
  EXPECT_THAT(refusal_of({{"mission", 0}}), HasSubstr("no points"));
  EXPECT_THAT(refusal_of({{"mission", 0}, {"points", {kDraftPoint}}, {"title", "x"}}), HasSubstr("wrong keys"));
  EXPECT_THAT(refusal_of({{"mission", 0}, {"points", {1}}}), HasSubstr("point 1: not an object"));
  EXPECT_THAT(refusal_of(with(kDraftPoint, "north", "x")), HasSubstr("point 1: north must be a number from -100000"));
  EXPECT_THAT(refusal_of(with(kDraftPoint, "north", 2e5)), HasSubstr("point 1: north"));
  EXPECT_THAT(refusal_of(with(kDraftPoint, "depth_m", -1)),
              HasSubstr("point 1: depth_m must be a number from 0 to 12000"));
  EXPECT_THAT(refusal_of(with(kDraftPoint, "speed", 11)), HasSubstr("point 1: speed"));
  EXPECT_THAT(refusal_of(with(kDraftPoint, "from", 1.5)), HasSubstr("point 1: from"));
  EXPECT_THAT(refusal_of(with(kDraftPoint, "hold_s", 1)), HasSubstr("point 1: wrong keys"));
  EXPECT_THAT(refusal_of(with(kDraftPoint, "altitude_m", 4)), HasSubstr("either depth_m or altitude_m"));
  EXPECT_THAT(refusal_of({{"mission", 0}, {"points", {{{"north", 1}, {"depth_m", 1}}}}}),
              HasSubstr("no north or no east"));
  EXPECT_THAT(refusal_of({{"mission", 0}, {"points", {kDraftPoint}}, {"fence", {{1, 2, 3}}}}),
              HasSubstr("two numbers"));
  EXPECT_THAT(refusal_of({{"mission", 0}, {"points", {kDraftPoint}}, {"fence", {{1, 1e9}}}}),
              HasSubstr("from the origin"));
}

TEST(PageDraft, IsBounded) {
  const json many = json::array_t(MissionDraft::kMaxPoints + 1, kDraftPoint);
  EXPECT_THAT(refusal_of({{"mission", 0}, {"points", many}}), HasSubstr("101 points; the page may send 100"));
  const json corners = json::array_t(MissionDraft::kMaxCorners + 1, json{1, 2});
  EXPECT_THAT(refusal_of({{"mission", 0}, {"points", {kDraftPoint}}, {"fence", corners}}), HasSubstr("101 corners"));
}

TEST(PageDraft, HasNoNumbersThatAreNotFinite) {
  for (const char* number : {"NaN", "Infinity", "1e999", "-1e999"}) {
    const auto request = page_request_of(fmt::format(
        R"({{"ask": "preview", "draft": {{"mission": 0, "points": [{{"north": {}, "east": 0, "depth_m": 1}}]}}}})",
        number));
    EXPECT_FALSE(request) << number;
  }
}

}  // namespace
}  // namespace isobath
