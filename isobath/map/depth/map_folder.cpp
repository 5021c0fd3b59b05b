#include <algorithm>
#include <cerrno>
#include <fcntl.h>
#include <fmt/format.h>
#include <isobath/base/error.hpp>
#include <isobath/map/depth/map_folder.hpp>
#include <isobath/map/depth/tree_file.hpp>
#include <isobath/map/storage/disk_file.hpp>
#include <string_view>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>
#include <utility>

namespace isobath {
namespace {

namespace fs = std::filesystem;

constexpr int kReadings = 100;  // of a map that another program commits to again and again

// Trees --------------------------------------------------------------------------------------------------------------

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

/// Opens the committed file of a tree. Throws Error where the file is another one, however sound it is.
TreeFile committed_tree(const fs::path& folder, const MapRecord& record, const char* name) {
  const std::string& file = record.files.at(name);
  const std::string path = (folder / file).string();
  TreeFile opened = open_tree_file(path, 0);
  const int levels = record.facts.area.levels;
  if (opened.tree.levels() != levels) {
    throw Error(fmt::format("is a tree of {} levels in a map of {}", opened.tree.levels(), levels), {path});
  }
  if (opened.generation != generation_of(file)) {
    throw Error(fmt::format("is the file of another generation, {}", opened.generation), {path});
  }
  const auto seal = record.seals.find(name);
  if (seal != record.seals.end() && seal->second != opened.seal) {
    throw Error("is not the file that was committed: it is of another map or another tree", {path});
  }
  return opened;
}

/// Damaged parts of a tree read as 0, which means unknown. A file that is missing, is another one or has a damaged
/// header reads as an empty tree; where the system refuses to read a file, that is thrown.
TreeFile read_tree(const fs::path& folder, const MapRecord& record, const char* name, std::vector<MapDamage>& damages) {
  const std::string& file = record.files.at(name);
  const int levels = record.facts.area.levels;
  TreeFile opened;
  try {
    opened = committed_tree(folder, record, name);
  } catch (const Error& e) {
    const auto* refused = dynamic_cast<const DiskError*>(&e);
    if (refused != nullptr && refused->code() != ENOENT) throw;
    damages.push_back({file, 0, 0, std::uint64_t{1} << (2 * levels), e.what(), true});
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

StoredMap read_map(const fs::path& folder, const ReadRecord& read) {
  std::vector<MapDamage> damages = read.damages;
  TreeFile prior = read_tree(folder, read.record, "prior", damages);
  TreeFile sensed = read_tree(folder, read.record, "sensed", damages);
  TreeFile state = read_tree(folder, read.record, "state", damages);
  // Where only the state is lost, the sensed depths still count, with confidence 0.
  for (const PixelWindow& window : state.lost) {
    sensed.tree.for_each_leaf(window, [&](std::uint32_t depth_word, const PixelWindow& leaf) {
      if (depth_word != DepthPixel::kUnknownDepth) state.tree.fill(leaf, DepthPixel::word_of_state(0, kSensed, 0));
    });
  }
  return {read.record.facts, DepthTrees(std::move(prior.tree), std::move(sensed.tree), std::move(state.tree)),
          std::move(damages)};
}

// Names --------------------------------------------------------------------------------------------------------------

bool is_tree(std::string_view name) {
  if (name.ends_with(".part")) name.remove_suffix(5);
  return generation_of(std::string(name)).has_value();
}

/// Accepts also files that a run left when it ended before its first commit.
bool is_of_map(const std::string& name) {
  return name == "lock" || name.starts_with(MapRecord::kName) || name.starts_with("objects.sqlite") ||
         name.ends_with(".tree") || name.ends_with(".tree.part") || name.ends_with(".tree.damaged");
}

void refuse_what_is_no_map(const fs::path& folder) {
  std::error_code failed;
  if (!on_disk(folder)) return;
  if (!fs::is_directory(folder, failed)) {
    throw Error("is a file; a map is a folder", {folder.string()}, {}, "name a new or an empty folder for the map");
  }
  for (const std::string& name : names_in(folder)) {
    if (!is_of_map(name)) {
      throw Error("holds something other than a map: " + name, {folder.string()}, {},
                  "name a new or an empty folder for the map");
    }
    if (generation_of(name).value_or(0) > 1) {  // no run leaves these before its first commit
      throw Error("holds trees of a map whose commit record is lost: " + name, {folder.string()}, {},
                  "restore map.json, or name another folder for the map");
    }
  }
}

/// A write through a link would change a file that is none of this map's.
void refuse_links(const fs::path& folder) {
  std::error_code failed;
  for (const std::string& name : names_in(folder)) {
    if (is_of_map(name) && fs::is_symlink(fs::symlink_status(folder / name, failed))) {
      throw Error("is a link; a map is written only to files of its own folder", {(folder / name).string()}, {},
                  "put the file in the place of the link");
    }
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
  return fs::exists(folder / MapRecord::kName, ignored) || fs::exists(folder / MapRecord::kCopy, ignored);
}

StoredMap open_map(const fs::path& folder) {
  if (!looks_like_map(folder)) {
    throw Error("is not a map: no map.json", {folder.string()}, {}, "make one with isobath run LOG --map FOLDER");
  }
  for (int i = 0; i < kReadings; ++i) {
    const ReadRecord read = read_record(folder);
    StoredMap map = read_map(folder, read);
    // A commit removes the files of the state before it, which this reader may have begun to read.
    if (map.damages.empty() || unchanged(folder, read)) return map;
  }
  throw Error("another program writes to this map all the time", {folder.string()}, {}, "wait until it has ended");
}

MapFolder::MapFolder(fs::path folder) : folder_(std::move(folder)) {
  if (!holds_map()) refuse_what_is_no_map(folder_);
  std::error_code failed;
  made_ = fs::create_directories(folder_, failed);
  if (failed) throw Error("cannot be created: " + failed.message(), {folder_.string()});
  try {
    if (made_) flush_folder(fs::absolute(folder_).parent_path());
    refuse_links(folder_);
    take_lock();
  } catch (...) {
    if (made_) ::rmdir(folder_.c_str());
    throw;
  }
}

MapFolder::~MapFolder() {
  if (made_) remove_own_files();
  ::close(lock_);
}

void MapFolder::take_lock() {
  const fs::path lock = folder_ / "lock";
  lock_ = ::open(lock.c_str(), O_RDWR | O_CREAT | O_CLOEXEC | O_NOFOLLOW, 0644);
  if (lock_ < 0) throw DiskError(folder_, "cannot be written to", errno);
  struct stat held {
  }, named{};
  // The program that held the lock may have removed it meanwhile, with the folder.
  const bool locked = ::flock(lock_, LOCK_EX | LOCK_NB) == 0 && ::fstat(lock_, &held) == 0 &&
                      ::stat(lock.c_str(), &named) == 0 && held.st_ino == named.st_ino;
  if (locked) return;
  ::close(lock_);
  throw Error("another program is writing to this map", {folder_.string()}, {}, "wait until it has ended");
}

bool MapFolder::holds_map() const { return on_disk(folder_ / MapRecord::kName) || on_disk(folder_ / MapRecord::kCopy); }

/// The record that the next commit replaces; without generation if there is none.
ReadRecord MapFolder::last_record() const {
  if (!holds_map()) return {};
  ReadRecord read = read_record(folder_);
  for (const std::string& name : read.from_copy ? names_in(folder_) : std::vector<std::string>()) {
    if (generation_of(name).value_or(0) <= read.record.facts.generation) continue;
    throw Error(fmt::format("a newer state of the map may be lost: {} lies beside a copy of the commit record of "
                            "generation {}; nothing was written",
                            name, read.record.facts.generation),
                {folder_.string()}, {}, "restore map.json, or name another folder for the map");
  }
  return read;
}

StoredMap MapFolder::open() {
  (void)last_record();
  StoredMap map = open_map(folder_);
  for (const MapDamage& damage : map.damages) {
    if (damage.whole_file) {
      throw Error(fmt::format("the map cannot be read whole, so nothing is written to it: {}", damage.reason),
                  {folder_.string()}, {}, "restore this file, or name another folder for the map");
    }
    if (damage.pixels_lost > 0) damaged_.insert(damage.file);
  }
  return map;
}

void MapFolder::commit(MapFacts& facts, const DepthTrees& trees) {
  const ReadRecord last = last_record();
  MapRecord record{facts, {}, {}};
  record.facts.generation = std::max(facts.generation, last.record.facts.generation) + 1;
  if (record.facts.generation > MapRecord::kLastGeneration || record.facts.generation == 0) {
    throw Error("has had all generations that a map can have", {folder_.string()});
  }
  const auto replace = [&](const char* name, const std::string& text) {
    replace_file(folder_ / name, [&](const DiskFile& out) { out.write(text.data(), text.size(), 0); });
  };
  // An interrupted commit left the copy one generation behind; it must not fall further behind.
  if (!last.from_copy && last.texts[1] != last.texts[0]) replace(MapRecord::kCopy, last.texts[0]);
  try {
    write_trees(record, last.record, trees);
  } catch (...) {
    for (const auto& [tree, file] : record.files) {
      if (generation_of(file) == record.facts.generation) ::unlink((folder_ / file).c_str());
    }
    throw;
  }
  const std::string text = text_of(record);
  replace(MapRecord::kName, text);
  facts.generation = record.facts.generation;
  replace(MapRecord::kCopy, text);
  remove_superseded(record);
}

/// Writes the changed trees beside those of the last state, and reads them back.
void MapFolder::write_trees(MapRecord& record, const MapRecord& last, const DepthTrees& trees) const {
  const RegionQuadtree* const all[] = {&trees.prior(), &trees.sensed(), &trees.state()};
  for (std::size_t i = 0; i < MapRecord::kTrees.size(); ++i) {
    const char* const tree = MapRecord::kTrees[i];
    // A map keeps its original prior.
    const bool stays = i == 0 && last.files.contains(tree) && last.facts.epoch == record.facts.epoch &&
                       last.facts.area.levels == record.facts.area.levels;
    record.files[tree] = stays ? last.files.at(tree) : fmt::format("{}.{}.tree", tree, record.facts.generation);
    if (stays) {
      if (last.seals.contains(tree)) record.seals[tree] = last.seals.at(tree);
    } else {
      record.seals[tree] = write_tree_file(folder_ / record.files[tree], *all[i], record.facts.generation, {});
    }
    const TreeFile written = committed_tree(folder_, record, tree);
    if (stays) {
      record.seals[tree] = written.seal;
    } else if (!written.sound()) {
      throw Error("reads back as something other than what was written", {(folder_ / record.files[tree]).string()}, {},
                  "check the disk");
    }
  }
}

/// The files of earlier generations. One that cannot be removed does no harm.
void MapFolder::remove_superseded(const MapRecord& record) const {
  const auto used = [&](const std::string& name) {
    for (const auto& [tree, file] : record.files) {
      if (file == name) return true;
    }
    return false;
  };
  try {
    for (const std::string& name : names_in(folder_)) {
      if (!is_tree(name) || used(name) || generation_of(name).value_or(0) > record.facts.generation) continue;
      if (damaged_.contains(name)) {
        rename_file(folder_ / name, folder_ / (name + ".damaged"));
      } else {
        remove_file(folder_ / name);
      }
    }
  } catch (const DiskError&) {
  }
}

/// After a run that failed before its first commit: its folder would look like a map that is lost.
void MapFolder::remove_own_files() const {
  try {
    if (holds_map()) return;
    for (const std::string& name : names_in(folder_)) {
      if (is_of_map(name)) remove_file(folder_ / name);
    }
    ::rmdir(folder_.c_str());
  } catch (const DiskError&) {
  }
}

}  // namespace isobath
