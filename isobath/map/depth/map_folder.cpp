#include <cerrno>
#include <cstring>
#include <fcntl.h>
#include <fmt/format.h>
#include <fstream>
#include <isobath/base/error.hpp>
#include <isobath/map/depth/map_folder.hpp>
#include <isobath/map/depth/tree_file.hpp>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string_view>
#include <sys/file.h>
#include <unistd.h>
#include <zlib.h>

namespace isobath {
namespace {

namespace fs = std::filesystem;
using nlohmann::ordered_json;

constexpr int kVersion = 1;
constexpr const char* kRecord = "map.json";
constexpr const char* kCopy = "map.json.copy";
constexpr const char* kTrees[] = {"prior", "sensed", "state"};

std::string error_text() { return std::strerror(errno); }

std::uint32_t checksum(const std::string& text) {
  return static_cast<std::uint32_t>(
      crc32(0, reinterpret_cast<const Bytef*>(text.data()), static_cast<uInt>(text.size())));
}

void make_lasting(const fs::path& path) {
  const int file = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
  if (file < 0) throw Error("cannot be opened for a flush to disk: " + error_text(), {path.string()});
  const bool done = ::fsync(file) == 0;
  const std::string reason = error_text();
  ::close(file);
  if (!done) throw Error("cannot be flushed to disk: " + reason, {path.string()});
}

/// Replaces the whole file or nothing.
void replace_file(const fs::path& path, const std::string& text) {
  const fs::path aside = path.string() + ".part";
  {
    std::ofstream file(aside, std::ios::binary | std::ios::trunc);
    file << text;
    file.flush();
    if (!file) throw Error("cannot be written: " + error_text(), {aside.string()});
  }
  make_lasting(aside);
  std::error_code failed;
  fs::rename(aside, path, failed);
  if (failed) throw Error("cannot be replaced: " + failed.message(), {path.string()});
}

// Commit records -----------------------------------------------------------------------------------------------------

std::int64_t nanoseconds(Time time) { return time.time_since_epoch().count(); }
Time time_of(const ordered_json& ns) { return Time(Duration(ns.get<std::int64_t>())); }

struct Record {
  MapFacts facts;
  std::map<std::string, std::string> files;  ///< "sensed" -> "sensed.7.tree"
};

std::string text_of(const Record& record) {
  const MapFacts& f = record.facts;
  ordered_json map{{"version", kVersion},
                   {"generation", f.generation},
                   {"pixel_m", f.area.grid.pixel_m},
                   {"levels", f.area.levels},
                   {"north_west_corner_m", {f.area.grid.corner_m.x(), f.area.grid.corner_m.y()}},
                   {"epoch_ns", nanoseconds(f.epoch)},
                   {"datum", f.datum},
                   {"files", record.files},
                   {"priors", f.priors},
                   {"visits", ordered_json::array()},
                   {"configuration", f.configuration}};
  if (f.origin) map["origin"] = {{"latitude_deg", f.origin->latitude_deg}, {"longitude_deg", f.origin->longitude_deg}};
  for (const MapVisit& v : f.visits) {
    map["visits"].push_back({{"input", v.input},
                             {"first_ns", nanoseconds(v.first)},
                             {"last_ns", nanoseconds(v.last)},
                             {"counts", v.counts}});
  }
  const std::string body = map.dump(-1, ' ', false, ordered_json::error_handler_t::replace);
  ordered_json whole{{"isobath_map", ordered_json::parse(body)}, {"crc32", checksum(body)}};
  return whole.dump(1) + "\n";
}

Record record_of(const std::string& text, const std::string& file) {
  const auto refuse = [&](const std::string& what) -> Error { return Error(what, {file}, {}, {}); };
  const ordered_json whole = ordered_json::parse(text, nullptr, false);
  if (!whole.is_object() || !whole.contains("isobath_map") || !whole.contains("crc32")) {
    throw refuse("is not a commit record of a map");
  }
  const ordered_json& map = whole["isobath_map"];
  const std::string body = map.dump(-1, ' ', false, ordered_json::error_handler_t::replace);
  if (!whole["crc32"].is_number_unsigned() || whole["crc32"].get<std::uint64_t>() != checksum(body)) {
    throw refuse("the commit record is damaged: its checksum does not match");
  }
  try {
    if (map.at("version").get<int>() != kVersion) {
      throw Error(fmt::format("is a map of version {}", map.at("version").get<int>()), {file},
                  fmt::format("version {}", kVersion));
    }
    Record record;
    MapFacts& f = record.facts;
    f.generation = map.at("generation").get<std::uint64_t>();
    f.area.grid.pixel_m = map.at("pixel_m").get<double>();
    f.area.levels = map.at("levels").get<int>();
    f.area.grid.corner_m = {map.at("north_west_corner_m").at(0).get<double>(),
                            map.at("north_west_corner_m").at(1).get<double>()};
    f.epoch = time_of(map.at("epoch_ns"));
    f.datum = map.at("datum").get<std::string>();
    f.priors = map.at("priors").get<std::vector<std::string>>();
    f.configuration = map.at("configuration").get<std::string>();
    record.files = map.at("files").get<std::map<std::string, std::string>>();
    if (map.contains("origin")) {
      f.origin =
          GeoOrigin{map["origin"].at("latitude_deg").get<double>(), map["origin"].at("longitude_deg").get<double>()};
      if (!valid(*f.origin)) throw refuse("the origin is not a valid position");
    }
    for (const ordered_json& v : map.at("visits")) {
      f.visits.push_back({v.at("input").get<std::string>(), time_of(v.at("first_ns")), time_of(v.at("last_ns")),
                          v.at("counts").get<std::map<std::string, std::uint64_t>>()});
    }
    const bool sane =
        f.area.grid.pixel_m > 0 && f.area.levels >= 5 && f.area.levels <= 24 && f.area.grid.corner_m.allFinite();
    if (!sane) throw refuse("the commit record names an impossible area");
    for (const char* name : kTrees) {
      const fs::path tree = record.files.at(name);
      if (tree.has_parent_path() || tree.empty()) throw refuse("the commit record names a file outside the folder");
    }
    return record;
  } catch (const nlohmann::json::exception& e) {
    throw refuse(std::string("the commit record is incomplete: ") + e.what());
  } catch (const std::out_of_range&) {
    throw refuse("the commit record does not name all trees");
  }
}

std::string record_text(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  if (!file) throw Error("cannot be read: " + error_text(), {path.string()});
  std::ostringstream text;
  text << file.rdbuf();
  return text.str();
}

/// The commit record, or its copy where the record is damaged or missing.
Record read_record(const fs::path& folder, std::vector<MapDamage>* damages) {
  std::optional<Error> first;
  for (const char* name : {kRecord, kCopy}) {
    try {
      const fs::path file = folder / name;
      Record record = record_of(record_text(file), file.string());
      if (first && damages) damages->push_back({kRecord, 0, 0, 0, first->what()});
      return record;
    } catch (const Error& e) {
      if (!first) first = e;
    }
  }
  throw Error(*first);
}

/// Makes pixels unknown whose word no map writes, such as those of a tree under the name of another. Later code uses
/// the words as they are.
void refuse_words(TreeFile& opened, bool (*valid)(std::uint32_t), const std::string& file, const char* reason,
                  std::vector<MapDamage>& damages) {
  std::vector<PixelWindow> refused;
  std::uint64_t pixels = 0;
  opened.tree.for_each_leaf(opened.tree.square(), [&](std::uint32_t word, const PixelWindow& leaf) {
    if (valid(word)) return;
    refused.push_back(leaf);
    pixels += static_cast<std::uint64_t>(leaf.width) * static_cast<std::uint64_t>(leaf.height);
  });
  for (const PixelWindow& leaf : refused) opened.tree.fill(leaf, 0);
  opened.lost.insert(opened.lost.end(), refused.begin(), refused.end());
  if (pixels > 0) damages.push_back({file, 0, 0, pixels, reason});
}

/// Damaged parts of a tree read as 0, which means unknown. A tree with a damaged header reads as empty.
TreeFile read_tree(const fs::path& folder, const Record& record, const char* name, std::vector<MapDamage>& damages) {
  const std::string& file = record.files.at(name);
  const int levels = record.facts.area.levels;
  TreeFile opened;
  try {
    opened = open_tree_file(folder / file, 0);
    if (opened.tree.levels() != levels) {
      throw Error(fmt::format("is a tree of {} levels in a map of {}", opened.tree.levels(), levels),
                  {(folder / file).string()});
    }
  } catch (const Error& e) {
    damages.push_back({file, 0, 0, std::uint64_t{1} << (2 * levels), e.what()});
    opened = {};
    opened.tree = RegionQuadtree(levels);
    opened.lost = {opened.tree.square()};
    return opened;
  }
  std::uint64_t lost = 0;
  for (const PixelWindow& window : opened.lost) lost += static_cast<std::uint64_t>(window.width) * window.height;
  const auto note = [&](const TreeFile::Damage& d, const char* what) {
    damages.push_back({file, d.page, d.byte, std::exchange(lost, 0), what});
  };
  for (const TreeFile::Damage& d : opened.damaged_pages) note(d, "the checksum does not match");
  for (const std::uint64_t byte : opened.spare_damage) {
    damages.push_back({file, 0, byte, 0, "a spare copy or padding has changed; nothing is lost"});
  }
  for (const TreeFile::Damage& d : opened.bad_links) note(d, "a link is invalid");
  if (std::string_view(name) == "state") {
    refuse_words(opened, DepthPixel::state_valid, file, "a confidence is above 20", damages);
  } else {
    refuse_words(opened, DepthPixel::depth_valid, file, "a depth is beyond 10000 km", damages);
  }
  return opened;
}

/// Accepts also files that a run left when it ended before its first commit.
bool is_of_map(const std::string& name) {
  return name == "lock" || name.starts_with(kRecord) || name.starts_with("objects.sqlite") || name.ends_with(".tree") ||
         name.ends_with(".tree.part");
}

void refuse_what_is_no_map(const fs::path& folder) {
  std::error_code failed;
  if (fs::exists(folder, failed) && !fs::is_directory(folder, failed)) {
    throw Error("is a file; a map is a folder", {folder.string()}, {}, "name a new or an empty folder for the map");
  }
  for (const auto& entry : fs::directory_iterator(folder, failed)) {
    const std::string name = entry.path().filename().string();
    if (is_of_map(name)) continue;
    throw Error("holds something other than a map: " + name, {folder.string()}, {},
                "name a new or an empty folder for the map");
  }
}

}  // namespace

std::string to_text(const MapDamage& damage) {
  std::string text = fmt::format("{}, block {} at byte {}: {}", damage.file, damage.block, damage.byte, damage.reason);
  if (damage.pixels_lost > 0) text += fmt::format("; {} pixels lost", damage.pixels_lost);
  return text;
}

bool looks_like_map(const fs::path& folder) {
  std::error_code ignored;
  return fs::exists(folder / kRecord, ignored) || fs::exists(folder / kCopy, ignored);
}

StoredMap open_map(const fs::path& folder) {
  if (!looks_like_map(folder)) {
    throw Error("is not a map: no map.json", {folder.string()}, {}, "make one with isobath run LOG --map FOLDER");
  }
  std::vector<MapDamage> damages;
  Record record = read_record(folder, &damages);
  TreeFile prior = read_tree(folder, record, "prior", damages);
  TreeFile sensed = read_tree(folder, record, "sensed", damages);
  TreeFile state = read_tree(folder, record, "state", damages);
  // Where only the state is lost, the sensed depths still count, with confidence 0.
  for (const PixelWindow& window : state.lost) {
    sensed.tree.for_each_leaf(window, [&](std::uint32_t depth_word, const PixelWindow& leaf) {
      if (depth_word != DepthPixel::kUnknownDepth) state.tree.fill(leaf, DepthPixel::word_of_state(0, kSensed, 0));
    });
  }
  return {std::move(record.facts), DepthTrees(std::move(prior.tree), std::move(sensed.tree), std::move(state.tree)),
          std::move(damages)};
}

MapFolder::MapFolder(fs::path folder) : folder_(std::move(folder)) {
  std::error_code failed;
  if (!looks_like_map(folder_)) refuse_what_is_no_map(folder_);
  fs::create_directories(folder_, failed);
  if (failed) throw Error("cannot be created: " + failed.message(), {folder_.string()});
  const fs::path lock = folder_ / "lock";
  lock_ = ::open(lock.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0644);
  if (lock_ < 0) throw Error("cannot be written to: " + error_text(), {folder_.string()});
  if (::flock(lock_, LOCK_EX | LOCK_NB) != 0) {
    ::close(lock_);
    throw Error("another program is writing to this map", {folder_.string()}, {}, "wait until it has ended");
  }
}

MapFolder::~MapFolder() { ::close(lock_); }

void MapFolder::commit(MapFacts& facts, const DepthTrees& trees) {
  Record last;
  if (holds_map()) {
    try {
      last = read_record(folder_, nullptr);
    } catch (const Error&) {
      last = {};  // nothing to keep; its files are removed below
    }
  }
  facts.generation = std::max(facts.generation, last.facts.generation) + 1;
  Record record{facts, {}};
  const RegionQuadtree* all[] = {&trees.prior(), &trees.sensed(), &trees.state()};
  for (int i = 0; i < 3; ++i) {
    const std::string name = fmt::format("{}.{}.tree", kTrees[i], facts.generation);
    // A map keeps its original prior.
    const bool stays = i == 0 && last.files.contains("prior") && last.facts.epoch == facts.epoch &&
                       last.facts.area.levels == facts.area.levels;
    record.files[kTrees[i]] = stays ? last.files[kTrees[i]] : name;
    if (!stays) write_tree_file(folder_ / name, *all[i], facts.generation, {});
  }
  const std::string text = text_of(record);
  replace_file(folder_ / kRecord, text);
  make_lasting(folder_);
  replace_file(folder_ / kCopy, text);
  make_lasting(folder_);
  std::error_code ignored;  // a file that cannot be removed does no harm
  for (const auto& entry : fs::directory_iterator(folder_, ignored)) {
    const std::string name = entry.path().filename().string();
    const bool ours = name.ends_with(".tree") || name.ends_with(".tree.part");
    bool used = false;
    for (const auto& [tree, file] : record.files) used = used || file == name;
    if (ours && !used) fs::remove(entry.path(), ignored);
  }
}

}  // namespace isobath
