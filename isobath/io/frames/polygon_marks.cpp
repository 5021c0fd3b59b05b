#include <algorithm>
#include <charconv>
#include <cmath>
#include <isobath/base/error.hpp>
#include <isobath/io/frames/polygon_marks.hpp>
#include <nlohmann/json.hpp>
#include <optional>

namespace isobath {
namespace {

constexpr std::size_t kMaxShapes = 10'000, kMaxPoints = 1'000'000;
constexpr double kFarthestPixel = 1e6;

struct MarkPoint {
  double x, y;
};
using MarkPolygon = std::vector<MarkPoint>;

class MarksReader {
 public:
  MarksReader(int width, int height, const std::string& file)
      : width_(width), height_(height), file_(file), marks_(static_cast<std::size_t>(width) * height, 0) {}

  [[noreturn]] void refuse(const std::string& problem, const std::string& allowed = {}) const {
    throw Error(problem, {file_, {}, {}, {}, {}}, allowed, "annotate the pictures with LabelMe");
  }
  void read_json(std::string_view text);
  void read_xml(std::string_view text);
  [[nodiscard]] std::vector<std::uint8_t> marks() { return std::move(marks_); }

 private:
  void add(const MarkPolygon& polygon);
  void count_point(MarkPolygon& polygon, double x, double y);

  int width_, height_;
  std::string file_;
  std::vector<std::uint8_t> marks_;
  std::size_t shapes_ = 0, points_ = 0;
};

void MarksReader::count_point(MarkPolygon& polygon, double x, double y) {
  if (!(std::abs(x) <= kFarthestPixel && std::abs(y) <= kFarthestPixel)) refuse("a point far outside the picture");
  if (++points_ > kMaxPoints) refuse("too many points", "up to 1000000");
  polygon.push_back({x, y});
}

/// Marks, row by row, the pixels whose centres lie between an odd and the next even crossing.
void MarksReader::add(const MarkPolygon& polygon) {
  if (++shapes_ > kMaxShapes) refuse("too many shapes", "up to 10000");
  if (polygon.size() < 3) refuse("a polygon of fewer than three points");
  const auto [low, high] =
      std::minmax_element(polygon.begin(), polygon.end(), [](MarkPoint a, MarkPoint b) { return a.y < b.y; });
  const int first = static_cast<int>(std::clamp(std::floor(low->y), 0.0, static_cast<double>(height_)));
  const int last = static_cast<int>(std::clamp(std::ceil(high->y), 0.0, static_cast<double>(height_)));
  std::vector<double> crossings;
  for (int row = first; row < last; ++row) {
    const double y = row + 0.5;
    crossings.clear();
    for (std::size_t i = 0; i < polygon.size(); ++i) {
      const MarkPoint a = polygon[i], b = polygon[(i + 1) % polygon.size()];
      if ((a.y <= y) != (b.y <= y)) crossings.push_back(a.x + (y - a.y) / (b.y - a.y) * (b.x - a.x));
    }
    std::sort(crossings.begin(), crossings.end());
    for (std::size_t i = 0; i + 1 < crossings.size(); i += 2) {
      const auto column = [&](double x) {  // the first column whose centre is not left of x
        return static_cast<int>(std::clamp(std::ceil(x - 0.5), 0.0, static_cast<double>(width_)));
      };
      const auto begin = marks_.begin() + static_cast<std::ptrdiff_t>(row) * width_;
      const int from = column(crossings[i]), upto = column(crossings[i + 1]);
      if (from < upto) std::fill(begin + from, begin + upto, std::uint8_t{1});
    }
  }
}

// JSON ----------------------------------------------------------------------------------------------------------------

void MarksReader::read_json(std::string_view text) {
  const auto json = nlohmann::json::parse(text, nullptr, false);
  if (!json.is_object() || !json.contains("shapes") || !json["shapes"].is_array()) refuse("no LabelMe annotations");
  const auto sized = [&](const char* key, int wanted) {
    const auto found = json.find(key);
    if (found == json.end() || found->is_null()) return;
    if (!found->is_number() || found->get<double>() != wanted) {
      refuse(std::string(key) + " differs from the picture", std::to_string(wanted));
    }
  };
  sized("imageWidth", width_);
  sized("imageHeight", height_);
  for (const auto& shape : json["shapes"]) {
    if (!shape.is_object() || !shape.contains("points") || !shape["points"].is_array())
      refuse("a shape without points");
    std::string type = "polygon";
    if (const auto found = shape.find("shape_type"); found != shape.end() && found->is_string()) {
      type = found->get<std::string>();
    }
    MarkPolygon polygon;
    for (const auto& point : shape["points"]) {
      if (!point.is_array() || point.size() != 2 || !point[0].is_number() || !point[1].is_number()) {
        refuse("a point that is not two numbers");
      }
      count_point(polygon, point[0].get<double>(), point[1].get<double>());
    }
    if (type == "rectangle" && polygon.size() == 2) {
      const MarkPoint a = polygon[0], b = polygon[1];
      polygon = {a, {b.x, a.y}, b, {a.x, b.y}};
    } else if (type != "polygon") {
      refuse("a shape that is not a polygon", "polygon, rectangle");
    }
    add(polygon);
  }
}

// XML -----------------------------------------------------------------------------------------------------------------

/// The content of the next <tag> element from `at` on; moves `at` behind the element. Empty: no such element.
std::optional<std::string_view> next_element(std::string_view text, std::string_view tag, std::size_t& at) {
  const std::string open = "<" + std::string(tag) + ">", close = "</" + std::string(tag) + ">";
  const std::size_t begin = text.find(open, at);
  if (begin == std::string_view::npos) return {};
  const std::size_t from = begin + open.size(), end = text.find(close, from);
  if (end == std::string_view::npos) return {};
  at = end + close.size();
  return text.substr(from, end - from);
}

std::optional<double> number_in(std::string_view text, std::string_view tag) {
  std::size_t at = 0;
  auto found = next_element(text, tag, at);
  if (!found) return {};
  while (!found->empty() && static_cast<unsigned char>(found->front()) <= ' ') found->remove_prefix(1);
  while (!found->empty() && static_cast<unsigned char>(found->back()) <= ' ') found->remove_suffix(1);
  double value = 0;
  const auto [end, problem] = std::from_chars(found->data(), found->data() + found->size(), value);
  return problem == std::errc() && end == found->data() + found->size() ? std::optional(value) : std::nullopt;
}

void MarksReader::read_xml(std::string_view text) {
  for (std::size_t at = 0; const auto object = next_element(text, "object", at);) {
    if (number_in(*object, "deleted") == 1) continue;
    for (std::size_t within = 0; const auto outline = next_element(*object, "polygon", within);) {
      MarkPolygon polygon;
      for (std::size_t behind = 0; const auto point = next_element(*outline, "pt", behind);) {
        const auto x = number_in(*point, "x"), y = number_in(*point, "y");
        if (!x || !y) refuse("a point that is not two numbers");
        count_point(polygon, *x, *y);
      }
      add(polygon);
    }
  }
}

/// The first character after white space and a byte order mark.
char first_of(std::string_view text) {
  const std::size_t first = text.find_first_not_of(" \t\r\n\xEF\xBB\xBF");
  return first == std::string_view::npos ? '\0' : text[first];
}

}  // namespace

bool looks_like_polygon_marks(std::string_view text) {
  const char first = first_of(text);
  return (first == '<' && text.find("<annotation>") != std::string_view::npos) ||
         (first == '{' && text.find("\"shapes\"") != std::string_view::npos);
}

std::vector<std::uint8_t> parse_polygon_marks(std::string_view text, int width, int height, const std::string& file) {
  ISOBATH_ASSERT(width > 0 && height > 0);
  MarksReader reader(width, height, file);
  if (first_of(text) == '<') {
    reader.read_xml(text);
  } else {
    reader.read_json(text);
  }
  return reader.marks();
}

}  // namespace isobath
