#include <algorithm>
#include <cmath>
#include <cstdio>
#include <isobath/base/error.hpp>
#include <isobath/sonar/fan_model.hpp>
#include <isobath/sonar/strict_json.hpp>
#include <nlohmann/json.hpp>

namespace isobath {
namespace {

constexpr int kFanVersion = 1;
constexpr const char* kFanFormat = "isobath-fan-model";
constexpr const char* kFanAdvice = "a fan model is written by `isobath calibrate`";
constexpr int kFanMaxBeams = 1 << 14, kFanMaxBins = 1 << 20;
constexpr double kFanMaxPower = 1e30, kFanMaxRatio = 1e9;
constexpr std::size_t kFanMaxText = 4096;

Angle median_width(const BeamFan& fan) {
  std::vector<Angle> width = fan.width;
  const auto middle = width.begin() + static_cast<std::ptrdiff_t>(width.size() / 2);
  std::nth_element(width.begin(), middle, width.end());
  return *middle;
}

Angle span_of(const BeamFan& fan) { return fan.azimuth.back() - fan.azimuth.front(); }

bool about(Angle a, Angle b) { return std::abs(a / b - 1) < 0.02; }

Json law_json(const TailLaw& law) {
  const auto counts = law.counts();
  std::size_t first = 0, end = counts.size();
  while (end > 0 && counts[end - 1] == 0) --end;
  while (first < end && counts[first] == 0) ++first;
  Json all = Json::array();
  for (std::size_t i = first; i < end; ++i) all.push_back(counts[i]);
  return {{"first", first}, {"counts", all}};
}

TailLaw read_law(const Json& json, const std::string& file, const std::string& path) {
  const JsonObject r(json, file, path, kFanAdvice, {"first", "counts"});
  constexpr int kSteps = static_cast<int>(TailLaw::kSteps);
  std::vector<std::uint32_t> counts(static_cast<std::size_t>(r.integer("first", 0, kSteps)));
  std::uint64_t total = 0;
  constexpr int kMax = static_cast<int>(TailLaw::kMaxCounted);
  for (const auto n : r.integers<std::uint32_t>("counts", TailLaw::kSteps - counts.size(), 0, kMax)) {
    counts.push_back(n);
    total += n;
  }
  if (total > TailLaw::kMaxCounted) r.fail("counts", "too many", "at most 100 million");
  return TailLaw::of_counts(counts);
}

Json delivered_json(const FanModel::Delivered& d) {
  return {{"ratio", d.ratio}, {"low", d.low}, {"high", d.high}, {"cells", d.cells}};
}

FanModel::Delivered read_delivered(const Json& json, const std::string& file, const std::string& path) {
  const JsonObject r(json, file, path, kFanAdvice, {"ratio", "low", "high", "cells"});
  return {r.number("ratio", 0, kFanMaxRatio), r.number("low", 0, kFanMaxRatio), r.number("high", 0, kFanMaxRatio),
          r.number("cells", 0, 1e18)};
}

Json quality_json(const FanModel& model) {
  Json all = Json::array();
  for (std::size_t i = 0; i < model.quality.size(); ++i) {
    Json thirds = Json::array();
    for (const FanModel::Delivered& d : model.quality[i].thirds) thirds.push_back(delivered_json(d));
    all.push_back(
        {{"asked", FanModel::kAsked[i]}, {"whole", delivered_json(model.quality[i].whole)}, {"thirds", thirds}});
  }
  return all;
}

void read_quality(const JsonObject& top, const std::string& file, FanModel& model) {
  const Json& all = top.list("quality", model.quality.size());
  if (all.size() != model.quality.size()) top.fail("quality", "wrong size", "3 rates");
  for (std::size_t i = 0; i < all.size(); ++i) {
    const std::string path = "quality[" + std::to_string(i) + "].";
    const JsonObject r(all[i], file, path, kFanAdvice, {"asked", "whole", "thirds"});
    if (r.number("asked") != FanModel::kAsked[i]) r.fail("asked", "out of order", "0.01, 0.001, 0.0001");
    model.quality[i].whole = read_delivered(all[i]["whole"], file, path + "whole.");
    const Json& thirds = r.list("thirds", FanModel::kThirds);
    if (thirds.size() != FanModel::kThirds) r.fail("thirds", "wrong size", "3 thirds");
    for (std::size_t t = 0; t < thirds.size(); ++t) {
      model.quality[i].thirds[t] = read_delivered(thirds[t], file, path + "thirds[" + std::to_string(t) + "].");
    }
  }
}

void read_sonar(const Json& json, const std::string& file, FanModel& model) {
  const JsonObject sonar(json["sonar"], file, "sonar.", kFanAdvice, {"beams", "beam_width_deg", "span_deg"});
  model.beams = sonar.integer("beams", 1, kFanMaxBeams);
  model.beam_width = Angle::degrees(sonar.number("beam_width_deg", 1e-6, 360));
  model.span = Angle::degrees(sonar.number("span_deg", 1e-6, 360));
  const JsonObject setting(json["setting"], file, "setting.", kFanAdvice,
                           {"start_m", "bin_m", "bins", "samples", "full_scale"});
  model.window = {setting.number("start_m", 0, 1e6), setting.number("bin_m", 1e-5, 1e6),
                  setting.integer("bins", 1, kFanMaxBins)};
  model.full_scale = setting.number("full_scale", 1e-30, kFanMaxPower);
  const std::string samples = setting.text("samples");
  constexpr std::array kTypes{SampleType::kU8, SampleType::kU16, SampleType::kF32};
  const auto* type = std::find_if(kTypes.begin(), kTypes.end(), [&](SampleType t) { return samples == to_text(t); });
  if (type == kTypes.end()) setting.fail("samples", "unknown sample type", "u8, u16 or f32");
  model.type = *type;
}

}  // namespace

const char* to_text(SampleType type) {
  switch (type) {
    case SampleType::kU8: return "u8";
    case SampleType::kU16: return "u16";
    case SampleType::kF32: return "f32";
  }
  return "unknown";
}

void set_sonar(FanModel& model, const BeamFan& fan) {
  model.beams = fan.beams();
  model.beam_width = median_width(fan);
  model.span = span_of(fan);
}

bool same_sonar(const FanModel& model, const BeamFan& fan) {
  return fan.beams() == model.beams && about(median_width(fan), model.beam_width) && about(span_of(fan), model.span);
}

bool same_setting(const FanModel& model, const Ping& ping) {
  const RangeWindow &a = model.window, &b = ping.window;
  const double slack = 0.01 * a.bin_m;  // formats round the sound speed
  return a.bins == b.bins && std::abs(a.start_m - b.start_m) <= slack && std::abs(a.end_m() - b.end_m()) <= slack &&
         model.type == ping.intensity.type() && model.full_scale == double{ping.full_scale};
}

std::string sonar_text(int beams, Angle beam_width, Angle span) {
  std::array<char, 96> text{};
  std::snprintf(text.data(), text.size(), "%d beams of %.2f deg over %.1f deg", beams, beam_width.degrees(),
                span.degrees());
  return text.data();
}

void require_same_sonar(const FanModel& model, const Ping& ping) {
  if (same_sonar(model, *ping.fan)) return;
  throw Error("the fan model is of another sonar: " + sonar_text(model.beams, model.beam_width, model.span) +
                  "; the pings have " + sonar_text(ping.fan->beams(), median_width(*ping.fan), span_of(*ping.fan)),
              {{}, {}, {}, {}, "sensor.model"}, {}, "run `isobath calibrate` on a recording of this sonar");
}

void FanModel::check(const std::string& file) const {
  const auto require = [&](bool good, const char* key, const char* problem, const std::string& allowed) {
    if (!good) throw Error(problem, {file, {}, {}, {}, key}, allowed, kFanAdvice);
  };
  require(beams > 0 && beams <= kFanMaxBeams, "sonar.beams", "out of range", "1 .. 16384");
  require(!gains_db.empty() && gains_db.size() <= static_cast<std::size_t>(beams), "gains_db", "wrong size",
          "1 .. beams");
  require(relief.size() == gains_db.size(), "relief", "wrong size", "as many as gains_db");
  require(!level.empty() && level.size() <= static_cast<std::size_t>(window.bins), "level", "wrong size",
          "1 .. setting.bins");
  for (const int b : dead_beams) require(b >= 0 && b < beams, "dead_beams", "out of range", "0 .. beams - 1");
  require(blanking_m >= 0 && blanking_m <= window.end_m(), "blind_m", "out of range", "0 .. end of the window");
  require(cell_m >= window.bin_m * 0.999, "cell_m", "out of range", "bin_m and more");
}

std::string write_fan_model(const FanModel& model) {
  Json laws = Json::array();
  for (const TailLaw& law : model.laws) laws.push_back(law_json(law));
  const Json json = {
      {"format", kFanFormat},
      {"version", kFanVersion},
      {"source", model.source},
      {"sonar",
       {{"beams", model.beams}, {"beam_width_deg", model.beam_width.degrees()}, {"span_deg", model.span.degrees()}}},
      {"setting",
       {{"start_m", model.window.start_m},
        {"bin_m", model.window.bin_m},
        {"bins", model.window.bins},
        {"samples", to_text(model.type)},
        {"full_scale", model.full_scale}}},
      {"pings", model.pings},
      {"seconds", model.seconds},
      {"blind_m", model.blanking_m},
      {"clipped", model.clipped},
      {"silent", model.silent},
      {"correlation",
       {{"beams", model.correlation.beams}, {"bins", model.correlation.bins}, {"pings", model.correlation.pings}}},
      {"looks", model.looks},
      {"quality", quality_json(model)},
      {"dead_beams", model.dead_beams},
      {"gains_db", model.gains_db},
      {"relief", model.relief},
      {"cell_m", model.cell_m},
      {"level", model.level},
      {"laws", laws},
      {"all", law_json(model.all)}};
  return json.dump(-1, ' ', false, Json::error_handler_t::replace) + "\n";
}

FanModel read_fan_model(std::string_view text, const std::string& file) {
  const Json json = parse_json(text, file, kFanAdvice);
  const JsonObject top(json, file, "", kFanAdvice,
                       {"format",   "version", "source", "sonar",       "setting", "pings",   "seconds",
                        "blind_m",  "clipped", "silent", "correlation", "looks",   "quality", "dead_beams",
                        "gains_db", "relief",  "cell_m", "level",       "laws",    "all"});
  if (top.text("format") != kFanFormat) top.fail("format", "not a fan model", kFanFormat);
  if (top.number("version") != kFanVersion) top.fail("version", "unknown version", std::to_string(kFanVersion));
  FanModel model;
  model.source = top.text("source");
  if (model.source.size() > kFanMaxText) top.fail("source", "too long", "at most 4096 bytes");
  read_sonar(json, file, model);
  model.pings = top.integer("pings", 1, 1'000'000'000);
  model.seconds = top.number("seconds", 0, 1e9);
  model.blanking_m = top.number("blind_m", 0, 1e6);
  model.clipped = top.number("clipped", 0, 1);
  model.silent = top.number("silent", 0, 1);
  const JsonObject r(json["correlation"], file, "correlation.", kFanAdvice, {"beams", "bins", "pings"});
  model.correlation = {r.number("beams", -1, 1), r.number("bins", -1, 1), r.number("pings", -1, 1)};
  model.looks = top.number("looks", 0, 1);
  read_quality(top, file, model);
  model.dead_beams = top.integers<int>("dead_beams", kFanMaxBeams, 0, kFanMaxBeams);
  model.gains_db = top.numbers("gains_db", kFanMaxBeams, FanModel::kFaintest_db, 200);
  model.relief = top.numbers("relief", kFanMaxBeams, 1e-6, 1e6);
  model.cell_m = top.number("cell_m", 1e-5, 1e6);
  model.level = top.numbers("level", kFanMaxBins, 0, kFanMaxPower);
  const Json& laws = top.list("laws", FanModel::kStrata);
  if (laws.size() != FanModel::kStrata) top.fail("laws", "wrong size", "18 laws");
  for (std::size_t i = 0; i < laws.size(); ++i) {
    model.laws[i] = read_law(laws[i], file, "laws[" + std::to_string(i) + "].");
  }
  model.all = read_law(json["all"], file, "all.");
  model.check(file);
  return model;
}

bool looks_like_fan_model(std::string_view text) {
  return text.substr(0, 200).find(kFanFormat) != std::string_view::npos;
}

}  // namespace isobath
