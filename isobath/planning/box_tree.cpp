#include <isobath/planning/box_tree.hpp>
#include <numeric>

namespace isobath {
namespace {

constexpr std::int32_t kLeaf = 4;

}  // namespace

BoxTree::BoxTree(const std::vector<Eigen::AlignedBox2d>& boxes) : order_(boxes.size()) {
  std::iota(order_.begin(), order_.end(), std::size_t{0});
  if (!boxes.empty()) build(boxes, 0, static_cast<std::int32_t>(boxes.size()));
}

std::int32_t BoxTree::build(const std::vector<Eigen::AlignedBox2d>& boxes, std::int32_t from, std::int32_t to) {
  const auto here = static_cast<std::int32_t>(nodes_.size());
  nodes_.emplace_back();
  Eigen::AlignedBox2d box, centres;
  for (std::int32_t i = from; i < to; ++i) {
    const Eigen::AlignedBox2d& b = boxes[order_[static_cast<std::size_t>(i)]];
    box.extend(b);
    centres.extend(b.center());
  }
  std::int32_t first = -1, second = -1;
  if (to - from > kLeaf) {
    const Eigen::Index axis = centres.sizes().x() >= centres.sizes().y() ? 0 : 1;
    const std::int32_t middle = from + (to - from) / 2;
    std::nth_element(order_.begin() + from, order_.begin() + middle, order_.begin() + to,
                     [&](std::size_t a, std::size_t b) {
                       const double at_a = boxes[a].center()[axis], at_b = boxes[b].center()[axis];
                       return at_a != at_b ? at_a < at_b : a < b;
                     });
    first = build(boxes, from, middle);
    second = build(boxes, middle, to);
  }
  nodes_[static_cast<std::size_t>(here)] = {box, from, to, first, second};
  return here;
}

}  // namespace isobath
