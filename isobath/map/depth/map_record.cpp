#include <algorithm>
#include <cerrno>
#include <charconv>
#include <cmath>
#include <fmt/format.h>
#include <isobath/base/error.hpp>
#include <isobath/map/depth/map_record.hpp>
#include <isobath/map/storage/disk_file.hpp>
#include <nlohmann/json.hpp>
#include <string_view>
#include <zlib.h>

namespace isobath {
namespace {

namespace fs = std::filesystem;
using nlohmann::ordered_json;

constexpr int kRecordVersion = 1;
constexpr int kMinMapLevels = 5, kMaxMapLevels = 20;           // as area_of makes them
constexpr int kDeepestRecord = 8;                              // levels of JSON; deeper text is none of ours
constexpr double kFarthestCorner = 1e8;                        // m
constexpr std::int64_t kMostRevisits = std::int64_t{1} << 48;  // so that sums do not overflow
constexpr std::int64_t kLatestEpoch = std::int64_t{1} << 62;   // ns; so that differences of times do not overflow

std::uint32_t record_checksum(const std::string& text) {
  return static_cast<std::uint32_t>(::crc32_z(0, reinterpret_cast<const Bytef*>(text.data()), text.size()));
}

std::int64_t nanoseconds(Time time) { return time.time_since_epoch().count(); }

/// Reads the values of a record whose checksum is right; a value that no record may have is an Error.
class RecordReader {
 public:
  RecordReader(const ordered_json& map, const std::string& file) : map_(map), file_(file) {}

  [[nodiscard]] MapRecord read() const {
    const auto version = whole(map_.at("version"), "version", 0, INT32_MAX);
    if (version != kRecordVersion) {
      throw Error(fmt::format("is a map of version {}", version), {file_}, fmt::format("version {}", kRecordVersion));
    }
    MapRecord record;
    MapFacts& f = record.facts;
    f.generation = static_cast<std::uint64_t>(
        whole(map_.at("generation"), "generation", 1, static_cast<std::int64_t>(MapRecord::kLastGeneration)));
    f.area.levels = static_cast<int>(whole(map_.at("levels"), "levels", kMinMapLevels, kMaxMapLevels));
    f.area.grid.pixel_m = real(map_.at("pixel_m"), "pixel_m", 0.01, 100);
    const ordered_json& corner = map_.at("north_west_corner_m");
    for (int i = 0; i < 2; ++i) {
      f.area.grid.corner_m[i] =
          real(corner.at(static_cast<std::size_t>(i)), "north_west_corner_m", -kFarthestCorner, kFarthestCorner);
    }
    f.epoch = Time(Duration(whole(map_.at("epoch_ns"), "epoch_ns", -kLatestEpoch, kLatestEpoch)));
    f.datum = map_.at("datum").get<std::string>();
    f.priors = map_.at("priors").get<std::vector<std::string>>();
    f.configuration = map_.at("configuration").get<std::string>();
    read_origin(f);
    for (const ordered_json& v : map_.at("visits")) f.visits.push_back(visit(v));
    if (map_.contains("revisits")) f.revisits = revisits(map_["revisits"]);
    read_files(record);
    return record;
  }

 private:
  [[noreturn]] void refuse(const std::string& what) const { throw Error(what, {file_}); }
  [[nodiscard]] std::int64_t whole(const ordered_json& value, const char* key, std::int64_t low,
                                   std::int64_t high) const {
    const bool fits = value.is_number_integer() &&
                      (!value.is_number_unsigned() || value.get<std::uint64_t>() <= static_cast<std::uint64_t>(high));
    if (!fits || value.get<std::int64_t>() < low || value.get<std::int64_t>() > high) {
      throw Error(fmt::format("the commit record names an impossible {}: {}", key, shown(value)), {file_},
                  fmt::format("{} .. {}", low, high));
    }
    return value.get<std::int64_t>();
  }
  [[nodiscard]] double real(const ordered_json& value, const char* key, double low, double high) const {
    const double number = value.is_number() ? value.get<double>() : NAN;
    if (!(number >= low && number <= high)) {
      throw Error(fmt::format("the commit record names an impossible {}: {}", key, shown(value)), {file_},
                  fmt::format("{} .. {}", low, high));
    }
    return number;
  }
  static std::string shown(const ordered_json& value) {
    return value.dump(-1, ' ', true, ordered_json::error_handler_t::replace).substr(0, 40);
  }
  void read_origin(MapFacts& f) const {
    if (!map_.contains("origin")) return;
    const ordered_json& origin = map_["origin"];
    f.origin = GeoOrigin{origin.at("latitude_deg").get<double>(), origin.at("longitude_deg").get<double>()};
    if (!valid(*f.origin)) refuse("the origin is not a valid position");
  }
  [[nodiscard]] MapVisit visit(const ordered_json& v) const {
    MapVisit visit;
    visit.input = v.at("input").get<std::string>();
    visit.fingerprint = v.value("fingerprint", "");
    visit.first = Time(Duration(whole(v.at("first_ns"), "first_ns", INT64_MIN, INT64_MAX)));
    visit.last = Time(Duration(whole(v.at("last_ns"), "last_ns", INT64_MIN, INT64_MAX)));
    for (const auto& [name, count] : v.at("counts").items()) {
      visit.counts[name] = static_cast<std::uint64_t>(whole(count, "count", 0, INT64_MAX));
    }
    return visit;
  }
  /// [index, count, index, count, ...] of RevisitRecord::words().
  [[nodiscard]] RevisitRecord revisits(const ordered_json& counts) const {
    std::array<std::uint64_t, RevisitRecord::kWords> words{};
    if (!counts.is_array() || counts.size() % 2 != 0) refuse("the counts of revisits are not pairs");
    for (std::size_t i = 0; i < counts.size(); i += 2) {
      const auto at = whole(counts[i], "index of revisits", 0, RevisitRecord::kWords - 1);
      words[static_cast<std::size_t>(at)] =
          static_cast<std::uint64_t>(whole(counts[i + 1], "count of revisits", 0, kMostRevisits));
    }
    return RevisitRecord::of(words);
  }
  void read_files(MapRecord& record) const {
    record.files = map_.at("files").get<std::map<std::string, std::string>>();
    for (const char* tree : MapRecord::kTrees) {
      const std::string& file = record.files.at(tree);
      const auto generation = generation_of(file);
      if (!generation || !file.starts_with(std::string(tree) + ".") || *generation > record.facts.generation) {
        refuse(fmt::format("the commit record names {} as its {}", file, tree));
      }
      if (!map_.contains("seals")) continue;
      record.seals[tree] = static_cast<std::uint32_t>(whole(map_["seals"].at(tree), "seal", 0, UINT32_MAX));
    }
  }

  const ordered_json& map_;
  const std::string& file_;
};

/// One of the two files. Exactly one of `record` and `problem` is set.
struct OneRecord {
  std::string text;
  std::optional<MapRecord> record;
  std::optional<Error> problem;
  bool absent = false;
};

OneRecord parse_record(std::string text, const std::string& file) {
  OneRecord one{std::move(text), {}, {}};
  const auto shallow = [](int depth, ordered_json::parse_event_t, ordered_json&) { return depth <= kDeepestRecord; };
  const ordered_json whole = ordered_json::parse(one.text, shallow, false);
  if (!whole.is_object() || !whole.contains("isobath_map") || !whole.contains("crc32")) {
    one.problem = Error("is not a commit record of a map", {file});
    return one;
  }
  const ordered_json& map = whole["isobath_map"];
  const std::string body = map.dump(-1, ' ', false, ordered_json::error_handler_t::replace);
  if (!whole["crc32"].is_number_unsigned() || whole["crc32"].get<std::uint64_t>() != record_checksum(body)) {
    one.problem = Error("the commit record is damaged: its checksum does not match", {file});
    return one;
  }
  try {
    one.record = RecordReader(map, file).read();
  } catch (const nlohmann::json::exception& e) {
    throw Error(std::string("the commit record is incomplete: ") + e.what(), {file});
  } catch (const std::out_of_range&) {
    throw Error("the commit record does not name all trees", {file});
  }
  return one;
}

std::optional<std::string> text_if_there(const fs::path& file) {
  try {
    return text_in(file);
  } catch (const DiskError& e) {
    if (e.code() != ENOENT) throw;
    return std::nullopt;
  }
}

OneRecord read_one(const fs::path& file) {
  if (auto text = text_if_there(file)) return parse_record(std::move(*text), file.string());
  return {{}, {}, Error("the commit record is missing", {file.string()}), true};
}

/// What is wrong with the copy beside a record that is right.
std::optional<std::string> fault_of_copy(const OneRecord& first, const OneRecord& copy) {
  const std::uint64_t generation = first.record->facts.generation;
  if (copy.absent) return generation > 1 ? std::optional<std::string>(copy.problem->what()) : std::nullopt;
  if (copy.problem) return copy.problem->what();
  const std::uint64_t copied = copy.record->facts.generation;
  if (copied == generation && copy.text != first.text) return "differs from map.json";
  if (copied + 1 < generation) return fmt::format("is of generation {}, and map.json of {}", copied, generation);
  return std::nullopt;
}

}  // namespace

std::optional<std::uint64_t> generation_of(const std::string& file) {
  constexpr std::string_view kEnding = ".tree";
  for (const std::string_view tree : MapRecord::kTrees) {
    if (!file.starts_with(tree) || !file.ends_with(kEnding) || file.size() < tree.size() + 2 + kEnding.size()) continue;
    const std::string number = file.substr(tree.size() + 1, file.size() - tree.size() - 1 - kEnding.size());
    std::uint64_t generation = 0;
    const auto [end, failed] = std::from_chars(number.data(), number.data() + number.size(), generation);
    if (failed != std::errc{} || fmt::format("{}.{}{}", tree, generation, kEnding) != file) continue;
    return generation;
  }
  return std::nullopt;
}

std::string text_of(const MapRecord& record) {
  const MapFacts& f = record.facts;
  ordered_json map{{"version", kRecordVersion},
                   {"generation", f.generation},
                   {"pixel_m", f.area.grid.pixel_m},
                   {"levels", f.area.levels},
                   {"north_west_corner_m", {f.area.grid.corner_m.x(), f.area.grid.corner_m.y()}},
                   {"epoch_ns", nanoseconds(f.epoch)},
                   {"datum", f.datum},
                   {"files", record.files},
                   {"seals", record.seals},
                   {"priors", f.priors},
                   {"visits", ordered_json::array()},
                   {"configuration", f.configuration}};
  ordered_json revisits = ordered_json::array();
  const auto words = f.revisits.words();
  for (std::size_t i = 0; i < words.size(); ++i) {
    if (words[i] == 0) continue;
    revisits.push_back(i);
    revisits.push_back(words[i]);
  }
  map["revisits"] = std::move(revisits);
  if (f.origin) map["origin"] = {{"latitude_deg", f.origin->latitude_deg}, {"longitude_deg", f.origin->longitude_deg}};
  for (const MapVisit& v : f.visits) {
    map["visits"].push_back({{"input", v.input},
                             {"first_ns", nanoseconds(v.first)},
                             {"last_ns", nanoseconds(v.last)},
                             {"counts", v.counts}});
    if (!v.fingerprint.empty()) map["visits"].back()["fingerprint"] = v.fingerprint;
  }
  const std::string body = map.dump(-1, ' ', false, ordered_json::error_handler_t::replace);
  ordered_json whole{{"isobath_map", ordered_json::parse(body)}, {"crc32", record_checksum(body)}};
  return whole.dump(1) + "\n";
}

ReadRecord read_record(const fs::path& folder) {
  OneRecord first = read_one(folder / MapRecord::kName), copy = read_one(folder / MapRecord::kCopy);
  if (!first.record && !copy.record) throw Error(*first.problem);
  ReadRecord read;
  read.from_copy = !first.record || (copy.record && copy.record->facts.generation > first.record->facts.generation);
  if (!first.record) {
    read.damages.push_back({MapRecord::kName, 0, 0, 0, first.problem->what()});
  } else if (read.from_copy) {
    read.damages.push_back({MapRecord::kName, 0, 0, 0,
                            fmt::format("is of generation {}, and its copy of {}", first.record->facts.generation,
                                        copy.record->facts.generation)});
  } else if (auto fault = fault_of_copy(first, copy)) {
    read.damages.push_back({MapRecord::kCopy, 0, 0, 0, *fault});
  }
  read.record = std::move(read.from_copy ? *copy.record : *first.record);
  read.texts = {std::move(first.text), std::move(copy.text)};
  return read;
}

bool unchanged(const fs::path& folder, const ReadRecord& read) {
  return text_if_there(folder / MapRecord::kName).value_or("") == read.texts[0] &&
         text_if_there(folder / MapRecord::kCopy).value_or("") == read.texts[1];
}

}  // namespace isobath
