#include <algorithm>
#include <isobath/report/depth_outcome.hpp>

namespace isobath {

DepthOutcome outcome_of(const DepthModel& model) {
  DepthOutcome depth;
  depth.counts = model.counts();
  for (std::size_t i = 0; i < depth.counts.refused.size(); ++i) {
    if (depth.counts.refused[i] > 0) depth.refused[to_text(static_cast<DepthRefusal>(i))] = depth.counts.refused[i];
  }
  depth.generation = model.facts().generation;
  depth.pixels_lost = model.pixels_lost();
  depth.continued = model.continues();
  depth.changes = model.changes();
  depth.origin = model.facts().origin;
  depth.found = model.found();
  depth.sensors = model.sensors();
  depth.priors = model.facts().priors;
  for (const Prior& prior : model.prior().files) {
    for (const auto& [what, count] : prior.read) depth.prior_read[what] += count;
    for (const auto& [reason, count] : prior.left_out) depth.prior_left_out[reason] += count;
  }
  for (const MapDamage& d : model.damages()) depth.damages.push_back(to_text(d));
  const DepthTrees& trees = model.snapshot()->trees();
  for (const RegionQuadtree* tree : {&trees.prior(), &trees.sensed(), &trees.state()}) {
    depth.leaves += tree->statistics().leaves;
    depth.bytes += tree->statistics().bytes;
  }
  trees.state().for_each_leaf(trees.extent(), [&](std::uint32_t word, const PixelWindow& leaf) {
    const DepthPixel pixel{0, word};
    const std::uint64_t pixels = static_cast<std::uint64_t>(leaf.width) * static_cast<std::uint64_t>(leaf.height);
    if (!pixel.has(kSensed) && pixel.has(kSeenByDepth) && pixel.confidence() > model.charted_confidence()) {
      depth.confirmed_pixels += pixels;
    }
    if (!pixel.has(kSensed)) return;
    depth.sensed_pixels += pixels;
    const std::size_t group = static_cast<std::size_t>(pixel.confidence() / 5);
    depth.sensed_by_confidence[std::min(group, depth.sensed_by_confidence.size() - 1)] += pixels;
  });
  depth.pixel_m = model.facts().area.grid.pixel_m;
  depth.datum = model.facts().datum;
  trees.sensed().for_each_leaf(trees.extent(), [&](std::uint32_t word, const PixelWindow&) {
    if (word == DepthPixel::kUnknownDepth) return;
    const double metres = DepthPixel{word, 0}.depth_m();
    depth.shoalest_m = std::min(depth.shoalest_m.value_or(metres), metres);
    depth.deepest_m = std::max(depth.deepest_m.value_or(metres), metres);
  });
  depth.known_pixels = depth.sensed_pixels;
  trees.prior().for_each_leaf(trees.extent(), [&](std::uint32_t word, const PixelWindow& leaf) {
    if (word == DepthPixel::kUnknownDepth) return;
    trees.state().for_each_leaf(leaf, [&](std::uint32_t state, const PixelWindow& part) {
      if (DepthPixel{0, state}.has(kSensed)) return;
      depth.known_pixels += static_cast<std::uint64_t>(part.width) * static_cast<std::uint64_t>(part.height);
    });
  });
  return depth;
}

}  // namespace isobath
