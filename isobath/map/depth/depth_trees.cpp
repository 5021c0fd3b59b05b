#include <algorithm>
#include <array>
#include <bit>
#include <isobath/base/error.hpp>
#include <isobath/map/depth/depth_trees.hpp>

namespace isobath {
namespace {

constexpr int kSide = DepthTile::kSide;
using Words = std::array<std::uint32_t, DepthTile::kPixels>;

PixelWindow window_of(Pixel tile) { return {tile.column * kSide, tile.row * kSide, kSide, kSide}; }

}  // namespace

DepthTrees::DepthTrees(int levels) : prior_(levels, 0), sensed_(levels, 0), state_(levels, 0) {}

DepthTrees::DepthTrees(RegionQuadtree prior, RegionQuadtree state)
    : prior_(std::move(prior)), sensed_(prior_.levels(), 0), state_(std::move(state)) {
  ISOBATH_ASSERT(prior_.levels() == state_.levels());
}

DepthTrees::DepthTrees(RegionQuadtree prior, RegionQuadtree sensed, RegionQuadtree state)
    : prior_(std::move(prior)), sensed_(std::move(sensed)), state_(std::move(state)) {
  ISOBATH_ASSERT(prior_.levels() == state_.levels() && sensed_.levels() == state_.levels());
}

DepthPixel DepthTrees::at(Pixel p) const {
  if (!extent().contains(p)) return {};
  DepthPixel pixel{0, state_.at(p)};
  pixel.depth_word = pixel.has(kSensed) ? sensed_.at(p) : prior_.at(p);
  return pixel;
}

void DepthTrees::read(const PixelWindow& window, std::span<DepthPixel> out) const {
  ISOBATH_ASSERT(out.size() == static_cast<std::size_t>(window.width) * window.height);
  std::vector<std::uint32_t> prior(out.size()), sensed(out.size()), state(out.size());
  prior_.read(window, prior.data(), window.width);
  sensed_.read(window, sensed.data(), window.width);
  state_.read(window, state.data(), window.width);
  for (std::size_t i = 0; i < out.size(); ++i) {
    out[i].state_word = state[i];
    out[i].depth_word = out[i].has(kSensed) ? sensed[i] : prior[i];
  }
}

void DepthTrees::read_tile(Pixel tile, DepthTile& out) const {
  Words prior, sensed, state;
  const PixelWindow window = window_of(tile);
  prior_.read(window, prior.data(), kSide);
  sensed_.read(window, sensed.data(), kSide);
  state_.read(window, state.data(), kSide);
  for (std::size_t i = 0; i < out.pixels.size(); ++i) {
    DepthPixel& pixel = out.pixels[i];
    pixel.state_word = state[i];
    pixel.depth_word = pixel.has(kSensed) ? sensed[i] : prior[i];
  }
  out.changed.fill(0);
  out.survey();
}

int DepthTrees::write_tile(Pixel tile, const DepthTile& from) {
  int changed = 0;
  for (const std::uint32_t row : from.changed) changed += std::popcount(row);
  if (changed == 0) return 0;
  const PixelWindow window = window_of(tile);
  if (!extent().contains({window.column, window.row})) return changed;  // tiles lie wholly inside or outside
  // What has not changed is in the trees as it is here, so the whole tile is written as one block.
  Words sensed, state;
  for (std::size_t i = 0; i < from.pixels.size(); ++i) {
    const DepthPixel& pixel = from.pixels[i];
    sensed[i] = pixel.has(kSensed) ? pixel.depth_word : 0;
    state[i] = pixel.state_word;
  }
  sensed_.write(window, {sensed.data(), kSide});
  state_.write(window, {state.data(), kSide});
  return 0;
}

}  // namespace isobath
