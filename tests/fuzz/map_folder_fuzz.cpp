// Map folders. The input is the text of a record, a byte 0, and the bytes of one tree (its first byte says which); both
// also with their checksums made right, so that their values are met. What opens must be a map whose every word may be
// used: each confidence is an index from 0 to 20.
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <isobath/base/error.hpp>
#include <isobath/map/depth/map_folder.hpp>
#include <isobath/map/depth/tree_file.hpp>
#include <iterator>
#include <nlohmann/json.hpp>
#include <string>
#include <tests/support/tree_file_bytes.hpp>
#include <unistd.h>

namespace {

namespace fs = std::filesystem;
using isobath::test::TreeFileBytes;

constexpr const char* kTreeFiles[] = {"prior.1.tree", "sensed.1.tree", "state.1.tree"};

/// Of this process, gone at its end.
struct MapFolderScratch {
  fs::path path = fs::temp_directory_path() / ("isobath_map_fuzz_" + std::to_string(::getpid()));
  std::string empty_tree;

  MapFolderScratch() {
    fs::create_directories(path);
    isobath::write_tree_file(path / kTreeFiles[0], isobath::RegionQuadtree(5, 0), 1, {});
    std::ifstream file(path / kTreeFiles[0], std::ios::binary);
    empty_tree.assign(std::istreambuf_iterator<char>(file), {});
  }
  ~MapFolderScratch() { fs::remove_all(path); }

  void put(const std::string& name, const std::string& bytes) const {
    std::ofstream(path / name, std::ios::binary | std::ios::trunc) << bytes;
  }
};

void open_and_use(const fs::path& folder) {
  using namespace isobath;
  try {
    const StoredMap map = open_map(folder);
    std::size_t pixels[kFullConfidence + 1] = {};
    map.trees.state().for_each_leaf(map.trees.extent(), [&](std::uint32_t word, const PixelWindow& leaf) {
      const int confidence = DepthPixel{0, word}.confidence();
      if (confidence > kFullConfidence) std::abort();
      pixels[confidence] += std::size_t(leaf.width) * std::size_t(leaf.height);
    });
    for (const RegionQuadtree* tree : {&map.trees.prior(), &map.trees.sensed()}) {
      tree->for_each_leaf(map.trees.extent(), [](std::uint32_t word, const PixelWindow&) {
        if (!DepthPixel::depth_valid(word)) std::abort();
      });
    }
    DepthMapConfig config;
    config.window_pixels = 64;
    const DepthMap whole(config, map.facts.area, map.trees, {0, 0});
    if (whole.snapshot()->grid().pixel_m < 0.01) std::abort();
    for (const MapDamage& damage : map.damages) {
      if (to_text(damage).empty()) std::abort();
    }
  } catch (const Error&) {
  }
}

/// The text as the facts of a record whose checksum is right; empty if it is no JSON.
std::string sealed_record(const std::string& facts) {
  const auto map = nlohmann::ordered_json::parse(facts, nullptr, false);
  if (map.is_discarded()) return {};
  const std::string body = map.dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace);
  const TreeFileBytes bytes{{body.begin(), body.end()}};
  return nlohmann::ordered_json{{"isobath_map", map}, {"crc32", bytes.crc(0, body.size())}}.dump(
      -1, ' ', false, nlohmann::ordered_json::error_handler_t::replace);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const MapFolderScratch scratch;
  const std::string input(data, data + size);
  const std::string text = input.substr(0, input.find('\0'));
  const std::string rest = text.size() < input.size() ? input.substr(text.size() + 1) : std::string();
  TreeFileBytes tree;
  if (!rest.empty()) {
    tree.bytes.assign(rest.begin() + 1, rest.end());
    tree.seal();
  }
  for (const char* name : kTreeFiles) scratch.put(name, scratch.empty_tree);
  if (!tree.bytes.empty()) {
    scratch.put(kTreeFiles[static_cast<std::uint8_t>(rest[0]) % 3], {tree.bytes.begin(), tree.bytes.end()});
  }
  for (const std::string& record : {text, sealed_record(text)}) {
    scratch.put("map.json", record);
    open_and_use(scratch.path);
  }
  return 0;
}
