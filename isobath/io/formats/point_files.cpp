#include <algorithm>
#include <array>
#include <cmath>
#include <fmt/format.h>
#include <isobath/base/error.hpp>
#include <isobath/io/bytes/text_lines.hpp>
#include <isobath/io/bytes/whole_file.hpp>
#include <isobath/io/formats/depth_csv.hpp>
#include <isobath/io/formats/point_files.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace isobath {
namespace {

constexpr std::uint64_t kMaxPointFileBytes = std::uint64_t{1} << 30;
constexpr std::size_t kMaxFilePoints = 20'000'000;
constexpr double kPointTile = 16;      // m
constexpr double kFarFromZero = 10e3;  // m
constexpr std::size_t kMaxInSwath = 4096;

using Triple = std::array<double, 3>;  // as the file states them

/// Words of a line, between blanks, tabs, commas and semicolons.
std::vector<std::string_view> words_between(std::string_view line) {
  constexpr std::string_view kBetween = " \t,;\r";
  std::vector<std::string_view> words;
  for (std::size_t at = line.find_first_not_of(kBetween); at < line.size(); at = line.find_first_not_of(kBetween, at)) {
    const std::size_t end = std::min(line.find_first_of(kBetween, at), line.size());
    words.push_back(line.substr(at, end - at));
    at = end;
  }
  return words;
}

std::string_view take_text_line(std::string_view& text) {
  const std::size_t end = std::min(text.find('\n'), text.size());
  const std::string_view line = text.substr(0, end);
  text.remove_prefix(std::min(end + 1, text.size()));
  return line;
}

std::optional<Triple> three_numbers(const std::vector<std::string_view>& words, const std::array<std::size_t, 3>& at) {
  Triple triple;
  for (std::size_t i = 0; i < 3; ++i) {
    if (at[i] >= words.size() || !parse_number(words[at[i]], triple[i])) return {};
  }
  return triple;
}

struct PcdField {
  std::string name;
  std::uint64_t bytes = 0, count = 1;
  bool is_real = false;
};

struct PcdHeader {
  std::vector<PcdField> fields;
  std::uint64_t points = 0;
  std::string data;                  ///< ascii, binary, binary_compressed
  std::array<std::size_t, 3> xyz{};  ///< index of each in `fields`
  [[nodiscard]] std::uint64_t bytes_before(std::size_t field) const {
    std::uint64_t sum = 0;
    for (std::size_t i = 0; i < field; ++i) sum += fields[i].bytes * fields[i].count;
    return sum;
  }
};

/// Reads the lines of the header, of which `text` loses them. Throws Error.
PcdHeader take_pcd_header(std::string_view& text, const std::string& name) {
  PcdHeader header;
  const auto refuse = [&](const std::string& problem) { throw Error("is a PCD file " + problem, {name}); };
  constexpr int kMaxLines = 100;
  constexpr std::size_t kMaxFields = 1000, kMaxCount = 1 << 16;
  for (int i = 0; header.data.empty(); ++i) {
    if (text.empty() || i == kMaxLines) refuse("whose header does not end");
    const auto words = words_between(take_text_line(text));
    if (words.size() < 2 || words[0].starts_with('#')) continue;
    if (words.size() > kMaxFields) refuse("with too many fields");
    if (words[0] == "FIELDS") header.fields.resize(words.size() - 1);
    for (std::size_t k = 1; k < words.size() && k <= header.fields.size(); ++k) {
      PcdField& field = header.fields[k - 1];
      if (words[0] == "FIELDS") field.name = words[k];
      if (words[0] == "TYPE") field.is_real = words[k] == "F";
      if (words[0] == "SIZE" && (!parse_number(words[k], field.bytes) || field.bytes > 8)) refuse("with a wrong size");
      if (words[0] == "COUNT" && (!parse_number(words[k], field.count) || field.count > kMaxCount)) {
        refuse("with a wrong count");
      }
    }
    if (words[0] == "POINTS" && !parse_number(words[1], header.points)) refuse("with a wrong number of points");
    if (words[0] == "DATA") header.data = words[1];
  }
  for (std::size_t i = 0; i < 3; ++i) {
    const auto found = std::ranges::find(header.fields, std::string(1, "xyz"[i]), &PcdField::name);
    if (found == header.fields.end() || found->count != 1) refuse("without x, y and z");
    const bool real = found->is_real && (found->bytes == 4 || found->bytes == 8);
    if (!real && header.data != "ascii") refuse("whose x, y and z are not real numbers");
    header.xyz[i] = static_cast<std::size_t>(found - header.fields.begin());
  }
  return header;
}

/// LZF, as liblzf packs; empty: the bytes do not unpack to this size.
std::vector<std::byte> unpack_lzf(Bytes in, std::size_t size) {
  std::vector<std::byte> out;
  constexpr std::size_t kMostPerByte = 100;  // three bytes give 264 at most
  if (size > kMaxPointFileBytes || size / kMostPerByte > in.size()) return {};
  out.reserve(size);
  std::size_t at = 0;
  const auto next = [&] { return std::to_integer<std::size_t>(in[at++]); };
  while (at < in.size()) {
    const std::size_t control = next();
    if (control < 32) {  // so many and one more, as they are
      if (control + 1 > in.size() - at || control + 1 > size - out.size()) return {};
      out.insert(out.end(), in.begin() + at, in.begin() + at + control + 1);
      at += control + 1;
      continue;
    }
    std::size_t length = control >> 5;
    if (at >= in.size()) return {};
    if (length == 7) length += next();
    if (at >= in.size()) return {};
    const std::size_t back = ((control & 31) << 8 | next()) + 1;
    length += 2;
    if (back > out.size() || length > size - out.size()) return {};
    for (std::size_t i = 0; i < length; ++i) out.push_back(out[out.size() - back]);
  }
  if (out.size() != size) return {};
  return out;
}

double real_at(const RecordView& view, std::uint64_t at, std::uint64_t bytes) {
  return bytes == 8 ? view.at<double>(at) : static_cast<double>(view.at<float>(at));
}

class PointSource final : public Source {
 public:
  PointSource(std::string format, std::uint64_t bytes, const InputConfig& config)
      : utm_(utm_zone_of(config.survey.csv_position)), is_ned_(config.axes == LogAxes::kNed) {
    report_.format = std::move(format);
    report_.bytes_total = bytes;
  }

  /// x, y, z in the axes of the settings; z up unless they are "ned".
  void add(const Triple& xyz) {
    const double north = is_ned_ ? xyz[0] : xyz[1], east = is_ned_ ? xyz[1] : xyz[0];
    add(north, east, is_ned_ ? xyz[2] : -xyz[2]);
  }
  void add(double north, double east, double depth) {
    if (!std::isfinite(north) || !std::isfinite(east) || !std::isfinite(depth))
      return refuse("point that is not finite");
    if (depth < 0) return refuse("point above the water");
    if (points_.size() == kMaxFilePoints) return refuse("point over the limit of 20 million");
    if (!place(north, east)) return refuse("point outside the grid of its zone");
    points_.push_back({static_cast<float>(north), static_cast<float>(east), static_cast<float>(depth)});
  }
  void refuse(const char* reason) { ++report_.rejected[reason]; }

  /// Once all points are added.
  void finish() {
    std::ranges::stable_sort(points_, {}, [](const Point& p) {
      const Tile tile = tile_of(p);
      return Tile{tile[0], tile[0] % 2 == 0 ? tile[1] : -tile[1]};
    });
    report_.bytes_read = report_.bytes_total;
    report_.details["points"] = fmt::format("{}", points_.size());
    if (!report_.origin) {
      report_.details["place"] =
          fmt::format("none: metres from x {}, y {} of the file; input.csv_position can name a zone",
                      is_ned_ ? north_0_ : east_0_, is_ned_ ? east_0_ : north_0_);
    }
  }

  std::optional<Event> next() override {
    if (at_ == points_.size()) return {};
    const Tile tile = tile_of(points_[at_]);
    Navigation fix;
    fix.time = time_;
    const auto middle = [](std::int64_t index) { return (static_cast<double>(index) + 0.5) * kPointTile; };
    fix.X_WB.translation = {middle(tile[0]), middle(tile[1]), 0};
    if (!(tile_ == tile)) {
      tile_ = tile;
      return fix;
    }
    Swath swath;
    swath.time = time_;
    time_ += std::chrono::seconds(1);
    tile_.reset();
    for (; at_ < points_.size() && swath.soundings.size() < kMaxInSwath && tile_of(points_[at_]) == tile; ++at_) {
      const Point& p = points_[at_];
      Sounding& s = swath.soundings.emplace_back();
      const Eigen::Vector3d p_B = Eigen::Vector3d(p[0], p[1], p[2]) - fix.X_WB.translation;
      s.point = p_B.cast<float>();
      s.range_m = s.point.norm();
      s.beam = static_cast<std::uint16_t>(swath.soundings.size() - 1);
      s.kind = Sounding::Kind::kBottom;
    }
    return swath;
  }
  [[nodiscard]] const SourceReport& report() const override { return report_; }

 private:
  using Point = std::array<float, 3>;  ///< north, east, depth
  using Tile = std::array<std::int64_t, 2>;
  static Tile tile_of(const Point& p) {
    return {static_cast<std::int64_t>(std::floor(p[0] / kPointTile)),
            static_cast<std::int64_t>(std::floor(p[1] / kPointTile))};
  }

  /// Moves a position into W; false: it has no place there.
  bool place(double& north, double& east) {
    if (!utm_) {
      if (!placed_ && std::hypot(north, east) > kFarFromZero) {
        north_0_ = north;
        east_0_ = east;
      }
      placed_ = true;
      north -= north_0_;
      east -= east_0_;
      return std::hypot(north, east) < kMaxReach;
    }
    const auto point = from_utm(utm_->zone, utm_->northern, east, north);
    if (!point) return false;
    if (!plane_) {
      plane_.emplace(*point);
      report_.origin = *point;
    }
    if (distance_m(*point, plane_->origin()) > kMaxReach) return false;
    const Eigen::Vector2d p = plane_->to_plane(*point);
    north = p.x();
    east = p.y();
    return true;
  }

  static constexpr double kMaxReach = 1e5;  // m
  std::optional<UtmZone> utm_;
  bool is_ned_, placed_ = false;
  double north_0_ = 0, east_0_ = 0;
  std::optional<LocalPlane> plane_;
  SourceReport report_;
  std::vector<Point> points_;
  std::size_t at_ = 0;
  std::optional<Tile> tile_;  ///< whose fix was given
  Time time_{};
};

void add_ascii(const PcdHeader& header, std::string_view text, PointSource& points) {
  std::array<std::size_t, 3> at{};
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t k = 0; k < header.xyz[i]; ++k) at[i] += header.fields[k].count;
  }
  while (!text.empty()) {
    const auto words = words_between(take_text_line(text));
    if (words.empty()) continue;
    const auto triple = three_numbers(words, at);
    triple ? points.add(*triple) : points.refuse("line without three numbers");
  }
}

/// `by_field`: all values of a field together (binary_compressed).
void add_binary(const PcdHeader& header, Bytes data, bool by_field, PointSource& points) {
  const std::uint64_t one = header.bytes_before(header.fields.size());
  const std::uint64_t held = one == 0 ? 0 : std::min<std::uint64_t>(header.points, data.size() / one);
  const std::uint64_t stated = by_field ? header.points : 0;
  if (by_field && held < stated) return points.refuse("packed points of another number than the header states");
  const RecordView view(data, std::endian::little);
  for (std::uint64_t i = 0; i < held; ++i) {
    Triple xyz;
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint64_t bytes = header.fields[header.xyz[k]].bytes, before = header.bytes_before(header.xyz[k]);
      xyz[k] = real_at(view, by_field ? before * stated + i * bytes : i * one + before, bytes);
    }
    points.add(xyz);
  }
  if (held < header.points) points.refuse("points that the end of the file cuts off");
}

Bytes bytes_of_file(const std::vector<std::uint8_t>& file) { return std::as_bytes(std::span(file)); }

}  // namespace

bool looks_like_pcd(std::span<const std::uint8_t> head) {
  std::string_view text(reinterpret_cast<const char*>(head.data()), head.size());
  for (int i = 0; i < 20 && !text.empty(); ++i) {
    const std::string_view line = take_text_line(text);
    if (line.starts_with("VERSION ") || line.starts_with("VERSION\t")) return text.starts_with("FIELDS");
    if (!line.starts_with('#')) return false;
  }
  return false;
}

bool looks_like_xyz(std::span<const std::uint8_t> head) {
  std::string_view text(reinterpret_cast<const char*>(head.data()), head.size());
  constexpr int kEnough = 20;
  int lines = 0;
  while (text.find('\n') != std::string_view::npos && lines < kEnough) {
    const auto words = words_between(take_text_line(text));
    if (words.empty() || words[0].starts_with('#')) continue;
    if (words.size() != 3 || !three_numbers(words, {0, 1, 2})) return false;
    ++lines;
  }
  return lines >= 3;
}

std::unique_ptr<Source> points_of_pcd(Bytes bytes, const std::string& name, const InputConfig& config) {
  std::string_view rest = text_of(bytes);
  const PcdHeader header = take_pcd_header(rest, name);
  auto points = std::make_unique<PointSource>("point cloud (PCD, " + header.data + ")", bytes.size(), config);
  if (header.data == "ascii") {
    add_ascii(header, rest, *points);
  } else if (header.data == "binary") {
    add_binary(header, bytes_of(rest), false, *points);
  } else if (header.data == "binary_compressed") {
    ByteCursor cursor(bytes_of(rest));
    const auto packed = cursor.little<std::uint32_t>(), size = cursor.little<std::uint32_t>();
    const std::vector<std::byte> unpacked = unpack_lzf(cursor.take(packed), size);
    if (unpacked.empty()) points->refuse("packed points that cannot be unpacked");
    if (!unpacked.empty()) add_binary(header, unpacked, true, *points);
  } else {
    throw Error("is a PCD file with data of an unknown kind", {name}, "ascii, binary, binary_compressed");
  }
  points->finish();
  return points;
}

std::unique_ptr<Source> points_of_xyz(Bytes bytes, const std::string&, const InputConfig& config) {
  const double unit =
      metres_of(config.survey.csv_depth_unit) * (config.survey.csv_depth_sign == DepthSign::kUp ? -1 : 1);
  const bool is_ned = config.axes == LogAxes::kNed;
  auto points = std::make_unique<PointSource>("grid of x, y and depth (text)", bytes.size(), config);
  std::string_view text = text_of(bytes);
  while (!text.empty()) {
    const auto words = words_between(take_text_line(text));
    if (words.empty() || words[0].starts_with('#')) continue;
    const auto triple = words.size() == 3 ? three_numbers(words, {0, 1, 2}) : std::nullopt;
    if (!triple) {
      points->refuse("line without three numbers");
      continue;
    }
    const auto [x, y, depth] = *triple;
    points->add(is_ned ? x : y, is_ned ? y : x, unit * depth);
  }
  points->finish();
  return points;
}

std::unique_ptr<Source> open_pcd(const std::filesystem::path& file, const InputConfig& config) {
  return points_of_pcd(bytes_of_file(read_whole_file(file, kMaxPointFileBytes)), file.string(), config);
}

std::unique_ptr<Source> open_xyz(const std::filesystem::path& file, const InputConfig& config) {
  return points_of_xyz(bytes_of_file(read_whole_file(file, kMaxPointFileBytes)), file.string(), config);
}

}  // namespace isobath
