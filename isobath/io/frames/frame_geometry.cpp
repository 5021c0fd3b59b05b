#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <isobath/base/error.hpp>
#include <isobath/io/frames/frame_geometry.hpp>
#include <nlohmann/json.hpp>

namespace isobath {
namespace {

using Json = nlohmann::json;

constexpr double kDidsonHeightDeg = 14;  // vertical beam of the instrument; the geometry file does not state it

[[noreturn]] void refuse(const std::string& file, const std::string& key, const std::string& problem,
                         const std::string& allowed = {}) {
  throw Error(problem, {file, {}, {}, {}, key}, allowed);
}

double real(const Json& json, const std::string& file, const std::string& key, double low, double high) {
  const auto at = json.find(key);
  if (at == json.end()) refuse(file, key, "is missing");
  if (!at->is_number()) refuse(file, key, "not a number");
  const auto value = at->get<double>();
  if (!(value >= low && value <= high)) {
    refuse(file, key, fmt::format("{} is out of range", value), fmt::format("{} .. {}", low, high));
  }
  return value;
}

int whole(const Json& json, const std::string& file, const std::string& key, int high) {
  const double value = real(json, file, key, 1, high);
  if (value != std::floor(value)) refuse(file, key, "not a whole number");
  return static_cast<int>(value);
}

/// True for the second of two words, false for the first and if the key is absent.
bool second_of(const Json& json, const std::string& file, const std::string& key, const char* first,
               const char* second) {
  const auto at = json.find(key);
  if (at == json.end() || *at == first) return false;
  if (*at != second) refuse(file, key, "unknown word", fmt::format("\"{}\" or \"{}\"", first, second));
  return true;
}

std::vector<Angle> listed_azimuths(const Json& json, const std::string& file, const std::string& key, int beams,
                                   double unit_rad) {
  const Json& list = json[key];
  if (!list.is_array() || list.size() != static_cast<std::size_t>(beams)) {
    refuse(file, key, "not a list of one angle per beam", fmt::format("{} numbers", beams));
  }
  std::vector<Angle> azimuths;
  for (const Json& item : list) {
    if (!item.is_number()) refuse(file, key, "not a list of numbers");
    const double value = item.get<double>() * unit_rad;
    if (!(std::abs(value) <= 2 * std::numbers::pi)) refuse(file, key, "an angle beyond a full turn");
    azimuths.push_back(Angle::radians(value));
  }
  return azimuths;
}

std::vector<Angle> even_azimuths(Angle fov, int beams) {
  std::vector<Angle> azimuths;
  const Angle step = fov / beams;
  for (int i = 0; i < beams; ++i) azimuths.push_back(fov * -0.5 + step * (i + 0.5));
  return azimuths;
}

/// Each beam reaches halfway to its neighbours.
std::vector<Angle> widths_between(const std::vector<Angle>& azimuths) {
  const int n = static_cast<int>(azimuths.size());
  std::vector<Angle> widths;
  for (int i = 0; i < n; ++i) {
    const int low = std::max(i - 1, 0), high = std::min(i + 1, n - 1);
    widths.push_back((azimuths[high] - azimuths[low]) / (high - low));
  }
  return widths;
}

void set_beams(FrameGeometry& g, std::vector<Angle> azimuths, Angle width, Angle height, const std::string& file,
               const std::string& key) {
  if (azimuths.size() > 1 && azimuths.front() > azimuths.back()) {
    std::reverse(azimuths.begin(), azimuths.end());
    g.first_column_is_starboard = true;
  }
  const auto too_close = [](Angle left, Angle right) { return !((right - left).radians() > 1e-9); };
  if (std::adjacent_find(azimuths.begin(), azimuths.end(), too_close) != azimuths.end()) {
    refuse(file, key, "the angles neither rise nor fall from column to column");
  }
  if ((azimuths.back() - azimuths.front()).degrees() > 360) refuse(file, key, "the angles span more than a full turn");
  auto fan = std::make_shared<BeamFan>();
  if (width.radians() > 0) {
    fan->width.assign(azimuths.size(), width);
  } else if (azimuths.size() > 1) {
    fan->width = widths_between(azimuths);
  } else {
    refuse(file, "width_deg", "is missing, and a single beam has no spacing to derive it from");
  }
  fan->azimuth = std::move(azimuths);
  fan->height = height;
  g.fan = std::move(fan);
}

void set_window(FrameGeometry& g, double low, double high, int bins, const std::string& file, const std::string& key) {
  if (!(high - low > 1e-6 * bins)) refuse(file, key, "must exceed the nearest range by over a micrometre per bin");
  g.window = {low, (high - low) / bins, bins};
}

FrameGeometry own_geometry(const Json& json, const std::string& file) {
  static const char* const kKnown[] = {"beams",        "bins",     "range_min_m",  "range_max_m",
                                       "azimuths_deg", "fov_deg",  "first_column", "height_deg",
                                       "width_deg",    "near_row", "full_scale"};
  for (const auto& item : json.items()) {
    if (std::find(std::begin(kKnown), std::end(kKnown), item.key()) == std::end(kKnown)) {
      refuse(file, item.key(), "unknown key", fmt::format("{}", fmt::join(kKnown, ", ")));
    }
  }
  FrameGeometry g;
  const int beams = whole(json, file, "beams", FrameGeometry::kMaxBeams);
  const int bins = whole(json, file, "bins", FrameGeometry::kMaxBins);
  set_window(g, real(json, file, "range_min_m", 0, 1e5), real(json, file, "range_max_m", 0, 1e5), bins, file,
             "range_max_m");
  const Angle height = Angle::degrees(real(json, file, "height_deg", 0.01, 180));
  const bool has_width = json.contains("width_deg");
  const Angle width = Angle::degrees(has_width ? real(json, file, "width_deg", 0.001, 360) : 0);
  if (json.contains("azimuths_deg")) {
    const double degree = std::numbers::pi / 180;
    set_beams(g, listed_azimuths(json, file, "azimuths_deg", beams, degree), width, height, file, "azimuths_deg");
  } else {
    const Angle fov = Angle::degrees(real(json, file, "fov_deg", 0.001, 360));
    set_beams(g, even_azimuths(fov, beams), width.radians() > 0 ? width : fov / beams, height, file, "fov_deg");
    g.first_column_is_starboard = second_of(json, file, "first_column", "port", "starboard");
  }
  g.near_row_is_bottom = second_of(json, file, "near_row", "top", "bottom");
  if (json.contains("full_scale")) g.full_scale = static_cast<float>(real(json, file, "full_scale", 1e-6, 65535));
  return g;
}

FrameGeometry didson_geometry(const Json& json, const std::string& file) {
  FrameGeometry g;
  const int beams = whole(json, file, "num_beams", FrameGeometry::kMaxBeams);
  const int bins = whole(json, file, "num_bins", FrameGeometry::kMaxBins);
  set_window(g, real(json, file, "min_range", 0, 1e5), real(json, file, "max_range", 0, 1e5), bins, file, "max_range");
  const Angle height = Angle::degrees(kDidsonHeightDeg);
  if (json.contains("azimuths")) {
    set_beams(g, listed_azimuths(json, file, "azimuths", beams, 1), {}, height, file, "azimuths");
  } else {
    const Angle fov = Angle::radians(real(json, file, "fov", 1e-5, 2 * std::numbers::pi));
    set_beams(g, even_azimuths(fov, beams), fov / beams, height, file, "fov");
  }
  return g;
}

bool is_didson(const Json& json) {
  return json.contains("num_beams") && json.contains("num_bins") && json.contains("min_range") &&
         json.contains("max_range");
}

}  // namespace

bool looks_like_frame_geometry(std::string_view text) {
  const Json json = Json::parse(text, nullptr, false);
  return json.is_object() && (is_didson(json) || (json.contains("beams") && json.contains("bins")));
}

FrameGeometry parse_frame_geometry(std::string_view text, const std::string& file) {
  Json json;
  try {
    json = Json::parse(text);
  } catch (const Json::parse_error& e) {
    throw Error("not JSON", {file, e.byte, {}, {}, {}}, "", "write a geometry.json as the documentation shows");
  } catch (const Json::exception&) {
    throw Error("a number is out of range", {file, {}, {}, {}, {}});
  }
  if (!json.is_object()) throw Error("not a JSON object", {file, {}, {}, {}, {}});
  return is_didson(json) ? didson_geometry(json, file) : own_geometry(json, file);
}

FrameGeometry simulated_frame_geometry() {
  FrameGeometry g;
  g.window = {0, 8.0 / 512, 512};
  set_beams(g, even_azimuths(Angle::degrees(28.8), 96), Angle::degrees(0.3), Angle::degrees(14), "", "");
  g.first_column_is_starboard = true;
  return g;
}

FrameGeometry with_overrides(FrameGeometry g, const InputConfig& config) {
  if (config.beam_width.radians() <= 0 && config.beam_height.radians() <= 0) return g;
  auto fan = std::make_shared<BeamFan>(*g.fan);
  if (config.beam_width.radians() > 0) fan->width.assign(fan->azimuth.size(), config.beam_width);
  if (config.beam_height.radians() > 0) fan->height = config.beam_height;
  g.fan = std::move(fan);
  return g;
}

std::optional<Ping> ping_from_frame(const FrameGeometry& g, GrayImage image, const InputConfig& config) {
  if (image.width != g.fan->beams() || image.height != g.window.bins) return std::nullopt;
  const auto kept = std::make_shared<const GrayImage>(std::move(image));
  const std::ptrdiff_t pixel = kept->sample_bytes, row = pixel * kept->width;
  const std::uint8_t* first = kept->samples.data();
  if (g.first_column_is_starboard) first += row - pixel;
  if (g.near_row_is_bottom) first += row * (kept->height - 1);
  Ping ping;
  ping.fan = g.fan;
  ping.window = g.window;
  ping.intensity = Intensities(first, pixel == 1 ? SampleType::kU8 : SampleType::kU16, kept->width, kept->height,
                               g.first_column_is_starboard ? -pixel : pixel, g.near_row_is_bottom ? -row : row);
  ping.storage = kept;
  ping.sound_speed = config.sound_speed;
  ping.full_scale = g.full_scale.value_or(pixel == 1 ? 255.0f : 65535.0f);
  return ping;
}

}  // namespace isobath
