// Quadtree files: any bytes, and the same with their checksums made right, so that the links are met. What opens must
// be a sound tree, whatever it was: it is read, written, copied and compared.
#include <cstdlib>
#include <isobath/base/error.hpp>
#include <isobath/map/depth/tree_file.hpp>
#include <tests/support/tree_file_bytes.hpp>

namespace {

void use(const std::vector<std::uint8_t>& bytes) {
  using namespace isobath;
  try {
    TreeFile file = parse_tree_file(bytes, nullptr, "fuzz", 7);
    const std::int32_t side = file.tree.side();
    std::vector<std::uint32_t> window(64 * 64);
    std::uint64_t area = 0;
    file.tree.for_each_leaf(file.tree.square(), [&](std::uint32_t, const PixelWindow& leaf) {
      area += std::uint64_t(leaf.width) * std::uint64_t(leaf.height);
    });
    if (area != std::uint64_t(side) * std::uint64_t(side)) std::abort();
    for (const PixelWindow& lost : file.lost) {
      if (file.tree.at({lost.column, lost.row}) != 7) std::abort();
    }
    const RegionQuadtree snapshot = file.tree;
    file.tree.read({side / 2 - 30, side / 3, 64, 64}, window.data(), 64);
    for (std::uint32_t i = 0; i < window.size(); ++i) window[i] = i % 5;
    file.tree.write({side / 3, side / 2 - 30, 64, 64}, {window.data(), 64});
    file.tree.fill({side - 1, 0, 1, 1}, 3);
    file.tree.fill(file.tree.square(), 1);
    if (file.tree.statistics().words != 1) std::abort();
    file.tree.write({0, 0, 64, 64}, {window.data(), 64});
    if (!(snapshot == snapshot)) std::abort();
  } catch (const Error&) {
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  isobath::test::TreeFileBytes file{{data, data + size}};
  use(file.bytes);
  file.seal();
  use(file.bytes);
  return 0;
}
