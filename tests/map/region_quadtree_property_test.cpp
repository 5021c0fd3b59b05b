// Random edits of all kinds, against a plain array.
#include <algorithm>
#include <gtest/gtest.h>
#include <isobath/base/random.hpp>
#include <isobath/map/depth/region_quadtree.hpp>
#include <rapidcheck/gtest.h>

namespace isobath::region_quadtree_property_test {
namespace {

/// The slow, obvious map.
struct Plain {
  int side;
  std::uint32_t outside;
  std::vector<std::uint32_t> values = std::vector<std::uint32_t>(std::size_t(side) * std::size_t(side), outside);

  [[nodiscard]] bool contains(Pixel p) const { return p.column >= 0 && p.row >= 0 && p.column < side && p.row < side; }
  [[nodiscard]] std::uint32_t at(Pixel p) const {
    return contains(p) ? values[std::size_t(p.row * side + p.column)] : outside;
  }
  void set(Pixel p, std::uint32_t value) {
    if (contains(p)) values[std::size_t(p.row * side + p.column)] = value;
  }
};

class Edits {
 public:
  Edits(std::uint64_t seed, int levels, std::uint32_t outside)
      : random_(seed), tree_(levels, outside), plain_{1 << levels, outside} {}

  void one() {
    const PixelWindow w = window();
    switch (random_.index(4)) {
      case 0: fill({number(0, plain_.side - 1), number(0, plain_.side - 1), 1, 1}); break;
      case 1: fill(w); break;
      default: write(w, random_.index(2) == 0); break;
    }
  }
  void check() {
    const Pixel pixel{number(-3, plain_.side + 3), number(-3, plain_.side + 3)};
    RC_ASSERT(tree_.at(pixel) == plain_.at(pixel));
    const PixelWindow w = window();
    std::vector<std::uint32_t> out(std::size_t(w.width) * std::size_t(w.height) + 1, 12345);
    tree_.read(w, out.data(), w.width);
    each(w, [&](Pixel p, std::size_t i) { RC_ASSERT(out[i] == plain_.at(p)); });
    RC_ASSERT(out.back() == 12345U);
    check_leaves();
    const auto rebuilt =
        RegionQuadtree::from_raster(tree_.levels(), plain_.values, plain_.side, plain_.side, plain_.outside);
    RC_ASSERT(tree_ == rebuilt);
    RC_ASSERT(rebuilt.pool().allocations() == rebuilt.statistics().internal_nodes);
    RC_ASSERT(tree_.statistics().words == rebuilt.statistics().words);
  }

 private:
  void check_leaves() {
    std::uint64_t leaves = 0;
    std::uint64_t area = 0;
    tree_.for_each_leaf(tree_.square(), [&](std::uint32_t v, const PixelWindow& leaf) {
      ++leaves;
      area += std::uint64_t(leaf.width) * std::uint64_t(leaf.height);
      RC_ASSERT(leaf.width == leaf.height && leaf.column % leaf.width == 0 && leaf.row % leaf.width == 0);
      each(leaf, [&](Pixel p, std::size_t) { RC_ASSERT(plain_.at(p) == v); });
      RC_ASSERT(tree_.leaf_at({leaf.column, leaf.row}).window == leaf);
    });
    RC_ASSERT(area == plain_.values.size());
    RC_ASSERT(leaves == tree_.statistics().leaves);
    RC_ASSERT(3 * tree_.statistics().words == 4 * leaves - 1);
  }
  void fill(const PixelWindow& w) {
    const std::uint32_t v = value();
    tree_.fill(w, v);
    each(w, [&](Pixel p, std::size_t) { plain_.set(p, v); });
  }
  void write(const PixelWindow& w, bool masked) {
    const std::ptrdiff_t stride = w.width + number(0, 3);
    std::vector<std::uint32_t> values(std::size_t(stride) * std::size_t(w.height) + 1);
    std::vector<std::uint8_t> changed(values.size());
    for (auto& v : values) v = value();
    const std::uint64_t sparse = 1 + random_.index(20);
    for (auto& c : changed) c = random_.index(sparse) == 0 ? 64 : 0;
    tree_.write(w, {values.data(), stride, masked ? changed.data() : nullptr, stride});
    each(w, [&](Pixel p, std::size_t) {
      const std::size_t i = std::size_t((p.row - w.row) * stride + (p.column - w.column));
      if (!masked || changed[i] != 0) plain_.set(p, values[i]);
    });
  }
  template <class Do>
  static void each(const PixelWindow& w, Do what) {
    for (int i = 0; i < w.width * w.height; ++i) what({w.column + i % w.width, w.row + i / w.width}, std::size_t(i));
  }
  int number(int low, int high) { return low + static_cast<int>(random_.index(std::uint64_t(high - low + 1))); }
  std::uint32_t value() {
    return random_.index(10) == 0 ? RegionQuadtree::kLargestValue : std::uint32_t(random_.index(2));
  }
  PixelWindow window() {
    const int reach = random_.index(3) == 0 ? plain_.side + 6 : std::min(plain_.side, 9);
    return {number(-4, plain_.side + 2), number(-4, plain_.side + 2), number(0, reach), number(0, reach)};
  }

  Random random_;
  RegionQuadtree tree_;
  Plain plain_;
};

// ledger: S1-11 S1-12 S1-15 S1-34 S1-35
RC_GTEST_PROP(RegionQuadtreeProperty, ReadsAsAPlainArrayAfterAnyEdits, ()) {
  const int levels = *rc::gen::element(0, 1, 2, 3, 4, 5, 6);
  Edits edits(*rc::gen::arbitrary<std::uint64_t>(), levels, *rc::gen::element(0U, 1U, 2U));
  for (int i = *rc::gen::element(1, 5, 12); i > 0; --i) {
    edits.one();
    if (i % 4 == 1) edits.check();
  }
}

// ledger: S1-31
RC_GTEST_PROP(RegionQuadtreeProperty, SnapshotsKeepWhatTheyWere, ()) {
  Random random(*rc::gen::arbitrary<std::uint64_t>());
  RegionQuadtree tree(7);
  std::vector<std::pair<RegionQuadtree, std::vector<std::uint32_t>>> snapshots;
  for (int i = 0; i < 6; ++i) {
    std::vector<std::uint32_t> values(128 * 128);
    for (auto& v : values) v = static_cast<std::uint32_t>(random.index(3));
    const int width = static_cast<int>(random.index(128));
    tree.write({static_cast<int>(random.index(100)), static_cast<int>(random.index(100)), width, 40},
               {values.data(), 128});
    tree.read(tree.square(), values.data(), 128);
    snapshots.emplace_back(tree, values);
    if (random.index(3) == 0) snapshots.erase(snapshots.begin());
  }
  for (const auto& [snapshot, values] : snapshots) {
    std::vector<std::uint32_t> now(128 * 128);
    snapshot.read(snapshot.square(), now.data(), 128);
    RC_ASSERT(now == values);
  }
}

}  // namespace
}  // namespace isobath::region_quadtree_property_test
