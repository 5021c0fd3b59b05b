// Reader of soundings in columns of text.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <fmt/format.h>
#include <isobath/base/error.hpp>
#include <isobath/base/lower_case.hpp>
#include <isobath/io/bytes/text_lines.hpp>
#include <isobath/io/bytes/whole_file.hpp>
#include <isobath/io/charts/prior_reader.hpp>
#include <numbers>

namespace isobath {
namespace {

using Eigen::Vector2d;

constexpr std::uint64_t kMaxBytes = std::uint64_t{1} << 30;

std::string_view unquoted(std::string_view cell) {
  cell = trimmed(cell);
  if (cell.size() >= 2 && cell.front() == '"' && cell.back() == '"') cell = trimmed(cell.substr(1, cell.size() - 2));
  return cell;
}

/// Splits a line at commas, semicolons or tabs if there are any, else at blanks.
void split(std::string_view line, std::vector<std::string_view>& cells) {
  cells.clear();
  const std::size_t mark = line.find_first_of(",;\t");
  const char separator = mark == std::string_view::npos ? ' ' : line[mark];
  while (true) {
    if (separator == ' ') {
      const std::size_t begin = line.find_first_not_of(' ');
      if (begin == std::string_view::npos) return;
      line.remove_prefix(begin);
    }
    const std::size_t end = line.find(separator);
    cells.push_back(unquoted(line.substr(0, end)));
    if (end == std::string_view::npos) return;
    line.remove_prefix(end + 1);
  }
}

/// The meaning of column names.
enum class Axis : std::uint8_t { kPlane, kDegrees, kUnsaid };
struct Meaning {
  const char* name;
  int column;  ///< 0 east or longitude, 1 north or latitude, 2 depth
  Axis axis;
  PriorSign sign;
};
constexpr Meaning kMeanings[] = {
    {"east", 0, Axis::kPlane, {}},       {"north", 1, Axis::kPlane, {}},       {"longitude", 0, Axis::kDegrees, {}},
    {"lon", 0, Axis::kDegrees, {}},      {"long", 0, Axis::kDegrees, {}},      {"latitude", 1, Axis::kDegrees, {}},
    {"lat", 1, Axis::kDegrees, {}},      {"x", 0, Axis::kUnsaid, {}},          {"easting", 0, Axis::kUnsaid, {}},
    {"y", 1, Axis::kUnsaid, {}},         {"northing", 1, Axis::kUnsaid, {}},   {"depth", 2, {}, PriorSign::kDown},
    {"down", 2, {}, PriorSign::kDown},   {"elevation", 2, {}, PriorSign::kUp}, {"height", 2, {}, PriorSign::kUp},
    {"altitude", 2, {}, PriorSign::kUp}, {"z", 2, {}, PriorSign::kAutomatic},
};

/// Ignores case and units: "Depth (m)" means "depth".
const Meaning* meaning_of(std::string_view name) {
  std::string plain = to_lower_case(name);
  plain = std::string(trimmed(plain.substr(0, plain.find_first_of("([_"))));
  for (const Meaning& m : kMeanings) {
    if (plain == m.name) return &m;
  }
  return nullptr;
}

struct Columns {
  int of[3] = {0, 1, 2};  ///< columns of x, y, z
  int run = -1;
  Axis axis = Axis::kUnsaid;
  PriorSign sign = PriorSign::kAutomatic;
};

class TextReading {
 public:
  explicit TextReading(const PriorJob& job) : job_(job) {}
  PriorOfFile read();

 private:
  void comment(std::string_view line);
  void choose(const std::vector<std::string_view>& names);
  [[nodiscard]] int named(const std::string& wanted, const std::vector<std::string_view>& names) const;
  void choose_numbers();
  void row(const std::vector<std::string_view>& cells, std::uint64_t line);
  [[nodiscard]] PlaneMapping mapping() const;
  void place_soundings();

  struct Raw {
    double x, y, z;
    int run;
  };
  const PriorJob& job_;
  Columns columns_;
  bool chosen_ = false;
  std::optional<GeoOrigin> grid_origin_;  ///< origin of "north, east, down" files
  std::vector<Raw> raw_;
  std::uint64_t bad_ = 0;
  std::uint64_t first_bad_ = 0;
  std::map<std::string, int> runs_;
  Prior prior_;
};

/// Reads "#LLH Offset: latitude, longitude (radians), height": the rows after it are north, east, down.
void TextReading::comment(std::string_view line) {
  double latitude = 0, longitude = 0;
  const std::string text(line.substr(0, 200));
  if (text.find("LLH Offset") != std::string::npos) {
    const std::size_t colon = text.find(':');
    std::vector<std::string_view> cells;
    split(std::string_view(text).substr(colon == std::string::npos ? text.size() : colon + 1), cells);
    if (cells.size() >= 2 && parse_number(cells[0], latitude) && parse_number(cells[1], longitude)) {
      const GeoPoint origin{latitude * 180 / std::numbers::pi, longitude * 180 / std::numbers::pi};
      if (!valid(origin))
        job_.refuse("the origin of its cells is not a valid position", "latitude, longitude in radians");
      grid_origin_ = origin;
      columns_ = {{1, 0, 2}, -1, Axis::kPlane, PriorSign::kDown};
      chosen_ = true;
    }
  } else if (text.find("NED Offset") != std::string::npos) {
    prior_.details["offset of the cells"] =
        std::string(trimmed(text.substr(text.find("NED Offset") + 11))) + ", not added";
  }
}

int TextReading::named(const std::string& wanted, const std::vector<std::string_view>& names) const {
  int number = 0;
  if (parse_number(wanted, number) && number >= 1) return number - 1;
  for (std::size_t i = 0; i < names.size(); ++i) {
    if (to_lower_case(names[i]) == to_lower_case(wanted)) return static_cast<int>(i);
  }
  job_.refuse(fmt::format("there is no column \"{}\"", wanted),
              "name a column of the first line, or its number from 1");
}

void TextReading::choose(const std::vector<std::string_view>& names) {
  chosen_ = true;
  int found[3] = {-1, -1, -1};
  Axis axes[3] = {Axis::kUnsaid, Axis::kUnsaid, Axis::kUnsaid};
  const auto take = [&](int k, int column) {
    found[k] = column;
    const Meaning* m =
        static_cast<std::size_t>(column) < names.size() ? meaning_of(names[static_cast<std::size_t>(column)]) : nullptr;
    if (!m) return;
    axes[k] = m->axis;
    if (k == 2) columns_.sign = m->sign;
  };
  const std::string* wanted[3] = {&job_.config.x_column, &job_.config.y_column, &job_.config.z_column};
  for (int k = 0; k < 3; ++k) {
    if (!wanted[k]->empty()) take(k, named(*wanted[k], names));
  }
  for (const bool vague : {false, true}) {  // "z" is the depth only if no column is named "depth"
    for (std::size_t i = 0; i < names.size(); ++i) {
      const Meaning* m = meaning_of(names[i]);
      if (m && found[m->column] < 0 && (std::string_view(m->name) == "z") == vague)
        take(m->column, static_cast<int>(i));
    }
  }
  for (int k = 0; k < 3; ++k) {
    if (found[k] < 0)
      job_.refuse("the columns of east, north and depth are unknown", "set prior.x_column, y_column, z_column");
    columns_.of[k] = found[k];
  }
  columns_.axis = axes[0] == axes[1] ? axes[0] : Axis::kUnsaid;
  if (!job_.config.run_column.empty()) columns_.run = named(job_.config.run_column, names);
}

/// For text without names: x, y, z from the left, or the configured column numbers.
void TextReading::choose_numbers() {
  chosen_ = true;
  const std::string* wanted[3] = {&job_.config.x_column, &job_.config.y_column, &job_.config.z_column};
  for (int k = 0; k < 3; ++k) {
    if (!wanted[k]->empty()) columns_.of[k] = named(*wanted[k], {});
  }
  if (!job_.config.run_column.empty()) columns_.run = named(job_.config.run_column, {});
}

void TextReading::row(const std::vector<std::string_view>& cells, std::uint64_t line) {
  const auto cell = [&](int column) {
    return static_cast<std::size_t>(column) < cells.size() ? cells[static_cast<std::size_t>(column)]
                                                           : std::string_view();
  };
  Raw raw{};
  const bool good = parse_number(cell(columns_.of[0]), raw.x) && parse_number(cell(columns_.of[1]), raw.y) &&
                    parse_number(cell(columns_.of[2]), raw.z);
  if (!good) {
    if (bad_++ == 0) first_bad_ = line;
    return;
  }
  if (columns_.run >= 0) {
    raw.run = runs_.emplace(std::string(cell(columns_.run)), static_cast<int>(runs_.size())).first->second;
  }
  raw_.push_back(raw);
}

PlaneMapping TextReading::mapping() const {
  if (job_.config.epsg > 0) return {job_, nullptr};
  if (columns_.axis == Axis::kPlane) {
    return PlaneMapping::of_plane(grid_origin_ ? LocalPlane(*grid_origin_) : job_.plane);
  }
  if (columns_.axis == Axis::kDegrees) {
    for (const Raw& r : raw_) {
      if (std::abs(r.x) <= 360 && std::abs(r.y) <= 90) continue;
      job_.refuse(
          fmt::format("columns named longitude and latitude hold {:g} and {:g}, which are not degrees", r.x, r.y),
          "set prior.epsg");
    }
    return PlaneMapping::of_degrees(job_);
  }
  return {job_, nullptr};
}

void TextReading::place_soundings() {
  std::uint64_t positive = 0, negative = 0;
  const auto means_nothing = [&](double z) {
    return std::abs(z) >= 1e6 - 1 || z == -9999 || z == -99999 || z == -32767 || z == -32768 ||
           std::find(job_.config.no_data.begin(), job_.config.no_data.end(), z) != job_.config.no_data.end();
  };
  for (const Raw& r : raw_) {
    if (means_nothing(r.z)) continue;
    positive += r.z > 0;
    negative += r.z < 0;
  }
  const double factor = depth_sign(job_, columns_.sign, positive, negative) * job_.unit(0);
  const PlaneMapping way = mapping();
  const LocalPlane grid(grid_origin_.value_or(job_.plane.origin()));
  const bool shifted = grid_origin_ && !(*grid_origin_ == job_.plane.origin());
  for (const Raw& r : raw_) {
    if (means_nothing(r.z)) {
      ++prior_.left_out["soundings without data"];
      continue;
    }
    const double depth = factor * r.z;
    if (!job_.plausible(depth)) {
      ++prior_.left_out["soundings of no plausible depth"];
      continue;
    }
    auto p = way.to_plane(r.x, r.y);
    if (p && p->norm() < 1e6 && shifted) p = job_.plane.to_plane(grid.to_geo(*p));
    if (!p || p->norm() >= 1e6) {
      ++prior_.left_out["soundings too far from the map"];
      continue;
    }
    prior_.soundings.push_back({*p, depth, r.run});
  }
}

PriorOfFile TextReading::read() {
  const std::vector<std::uint8_t> bytes = read_whole_file(job_.file, kMaxBytes);
  std::string_view rest(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  std::vector<std::string_view> cells;
  std::uint64_t number = 0;
  while (!rest.empty()) {
    const std::size_t end = std::min(rest.find_first_of("\r\n"), rest.size());
    const std::string_view line = trimmed(rest.substr(0, end));
    if (end == rest.size() || rest[end] == '\n' || rest.substr(end, 2) != "\r\n") ++number;
    rest.remove_prefix(std::min(end + 1, rest.size()));
    if (line.empty()) continue;
    if (line.front() == '#') {
      comment(line);
      continue;
    }
    split(line, cells);
    if (!chosen_) {
      double value = 0;
      if (std::none_of(cells.begin(), cells.end(), [&](std::string_view c) { return parse_number(c, value); })) {
        choose(cells);
        continue;
      }
      choose_numbers();
    }
    row(cells, number);
  }
  if (raw_.empty() || bad_ > raw_.size() / 10) {
    throw Error(
        fmt::format("{} of {} lines are not numbers in columns", bad_, bad_ + raw_.size()),
        {job_.file, {}, bad_ > 0 ? std::optional(first_bad_) : std::nullopt, {}, {}}, "",
        "use x y z or longitude latitude depth, or set x_column, y_column, z_column; decimal points, not commas");
  }
  prior_.format = "soundings in text";
  if (bad_ > 0) prior_.left_out["lines that are not numbers in columns"] = bad_;
  place_soundings();
  prior_.read["soundings"] = prior_.soundings.size();
  if (prior_.soundings.empty())
    job_.refuse("none of its soundings can be used", "check prior.epsg, unit_m and the plausible depths");
  Vector2d low = Vector2d::Constant(1e300), high = -low;
  for (const SurveyPoint& s : prior_.soundings) {
    low = low.cwiseMin(s.north_east);
    high = high.cwiseMax(s.north_east);
  }
  prior_.raster = empty_raster(window_over(job_, low, high));
  if (!paint_surface(
          job_, prior_.soundings, job_.config.max_distance_m, [](std::size_t, double) { return 0.0; }, prior_.raster)) {
    prior_.details["surface"] = "none: the soundings near the window span no area";
  }
  return {std::move(prior_), true};
}

}  // namespace

PriorOfFile read_text_prior(const PriorJob& job) { return TextReading(job).read(); }

}  // namespace isobath
