#include <charconv>
#include <cmath>
#include <fmt/format.h>
#include <isobath/io/formats/moos/given_obstacle.hpp>

namespace isobath {
namespace {

constexpr std::size_t kMaxCorners = 200;
constexpr double kFarthest = 1e6;  // m

std::optional<double> coordinate_in(std::string_view text) {
  double value = 0;
  const auto [end, fault] = std::from_chars(text.data(), text.data() + text.size(), value);
  const bool whole = fault == std::errc() && end == text.data() + text.size();
  return whole && std::abs(value) <= kFarthest ? std::optional(value) : std::nullopt;
}

/// What stands before the mark; `text` then starts after it. All of it where there is no mark.
std::string_view cut_at(std::string_view& text, char mark) {
  const std::size_t at = text.find(mark);
  const std::string_view head = text.substr(0, at);
  text = at == std::string_view::npos ? std::string_view() : text.substr(at + 1);
  return head;
}

std::optional<Polygon> outline_in(std::string_view text) {
  Polygon outline_W;
  while (!text.empty()) {
    std::string_view corner = cut_at(text, ':');
    const auto x = coordinate_in(cut_at(corner, ',')), y = coordinate_in(corner);
    if (!x || !y || outline_W.size() == kMaxCorners) return std::nullopt;
    outline_W.emplace_back(*y, *x);
  }
  return is_convex(outline_W) ? std::optional(outline_W) : std::nullopt;
}

}  // namespace

std::optional<std::string> given_obstacle_text(const GivenObstacle& obstacle) {
  Polygon rounded_W;
  for (const Eigen::Vector2d& corner : obstacle.outline_W)
    rounded_W.emplace_back(std::round(100 * corner.x()), std::round(100 * corner.y()));
  const Polygon hull = convex_hull(rounded_W);
  if (hull.size() < 3 || hull.size() > kMaxCorners || !(std::abs(area(hull)) > 0)) return std::nullopt;
  std::string points;
  for (const Eigen::Vector2d& corner : hull)
    points += fmt::format("{}{:.2f},{:.2f}", points.empty() ? "" : ":", corner.y() / 100, corner.x() / 100);
  return fmt::format("pts={{{}}},label={},duration={:g}", points, obstacle.label, obstacle.duration_s);
}

std::optional<GivenObstacle> given_obstacle_of(std::string_view text) {
  constexpr std::string_view kOpen = "pts={";
  GivenObstacle obstacle;
  const std::size_t end = text.find('}');
  if (!text.starts_with(kOpen) || end == std::string_view::npos) return std::nullopt;
  const auto outline_W = outline_in(text.substr(kOpen.size(), end - kOpen.size()));
  if (!outline_W) return std::nullopt;
  obstacle.outline_W = *outline_W;
  std::string_view rest = text.substr(end + 1);
  (void)cut_at(rest, ',');
  while (!rest.empty()) {
    std::string_view value = cut_at(rest, ',');
    const std::string_view key = cut_at(value, '=');
    if (key == "label") obstacle.label = value;
    if (key == "duration") obstacle.duration_s = coordinate_in(value).value_or(0);
  }
  if (obstacle.label.empty() || !(obstacle.duration_s > 0)) return std::nullopt;
  return obstacle;
}

}  // namespace isobath
