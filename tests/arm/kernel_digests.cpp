// Runs the vector kernels of the fan map, of dense stereo and of the simulator on seeded input and prints a digest of
// the bits of each result. Built for two processors, it must print the same (scripts/arm-kernels).
#include <algorithm>
#include <cstdio>
#include <cstring>
#include <hwy/targets.h>
#include <isobath/base/random.hpp>
#include <isobath/perception/fan_kernel.hpp>
#include <isobath/sim/fan_loops.hpp>
#include <isobath/stereo/dense_matcher.hpp>
#include <vector>

namespace isobath {
namespace {

/// FNV-1a of 64 bits over the bytes of numbers.
class Digest {
 public:
  template <class T>
  void take(const std::vector<T>& values) {
    for (const T& value : values) {
      unsigned char bytes[sizeof(T)];
      std::memcpy(bytes, &value, sizeof(T));
      for (const unsigned char byte : bytes) sum_ = (sum_ ^ byte) * 0x100000001b3u;
    }
  }
  void print(const char* kernel) const { std::printf("%-20s %016llx\n", kernel, sum_); }

 private:
  unsigned long long sum_ = 0xcbf29ce484222325u;
};

std::vector<float> draw(Random& random, int count, double low, double high) {
  std::vector<float> values;
  for (int i = 0; i < count; ++i) values.push_back(static_cast<float>(random.uniform(low, high)));
  return values;
}

void run_fan_loops() {
  constexpr int kSize = 509, kRows = 7;
  Random random(1);
  std::vector<std::vector<float>> all;
  std::vector<const float*> rows;
  for (int i = 0; i < kRows; ++i) all.push_back(draw(random, kSize, 0, 3));
  for (const auto& row : all) rows.push_back(row.data());
  const std::vector<float> weights = draw(random, kRows, 0, 1);
  std::vector<float> sum(kSize), loudest(kSize), re(kSize), im(kSize);
  std::vector<std::int32_t> which(kSize);
  Digest rows_digest, normals_digest, echo_digest, wave_digest;
  sum_rows(rows.data(), weights.data(), kRows, kSize, sum.data());
  find_loudest(rows.data(), weights.data(), kRows, kSize, loudest.data(), which.data());
  rows_digest.take(sum);
  rows_digest.take(loudest);
  rows_digest.take(which);
  rows_digest.take(std::vector<float>{largest_product(rows[0], rows[1], kSize)});
  rows_digest.print("rows of a fan");
  draw_normals(77, re.data(), im.data(), kSize);
  normals_digest.take(re);
  normals_digest.take(im);
  normals_digest.print("normal numbers");

  std::vector<float> power(kSize + kLoopPad), strongest(kSize + kLoopPad);
  std::vector<EchoLabel> labels(kSize + kLoopPad);
  for (int i = 0; i < 40; ++i) {
    const double middle = random.uniform(20, 480), half = random.uniform(0.2, 12);
    add_echo({middle - half, middle + half, middle, random.uniform(0, 0.2), random.uniform(0, 5),
              EchoLabel(3 + i % 4, EchoPath::kDirect)},
             static_cast<int>(middle - half), static_cast<int>(middle + half), power.data(), strongest.data(),
             labels.data());
  }
  echo_digest.take(power);
  echo_digest.take(strongest);
  echo_digest.take(labels);
  echo_digest.print("spread echoes");

  std::vector<double> gain, diffuse, noise, amplitude(kSize);
  for (int i = 0; i < kSize; ++i) {
    gain.push_back(random.uniform(0.5, 2));
    diffuse.push_back(random.uniform(0, 0.1));
    noise.push_back(random.uniform(0.1, 1));
  }
  std::vector<float> speckle_re(kSize), speckle_im(kSize);
  draw_normals(78, speckle_re.data(), speckle_im.data(), kSize);
  std::vector<EchoLabel> heard(kSize);
  const FanWaves waves{.noise_re = re.data(),
                       .noise_im = im.data(),
                       .speckle_re = speckle_re.data(),
                       .speckle_im = speckle_im.data(),
                       .texture = all[2].data(),
                       .rough = power.data(),
                       .steady = all[3].data(),
                       .gain = gain.data(),
                       .diffuse = diffuse.data(),
                       .noise = noise.data(),
                       .level = 1.1,
                       .texture_share = 0.8,
                       .mean_square = 1.27,
                       .strongest = strongest.data(),
                       .labels = labels.data(),
                       .spread = 0.3,
                       .audible = 0.5,
                       .speckle = true};
  const int done = add_waves(waves, kSize, amplitude.data(), heard.data());
  amplitude.resize(static_cast<std::size_t>(done / 16 * 16));  // how many are left depends on the vectors' length
  heard.resize(amplitude.size());
  wave_digest.take(amplitude);
  wave_digest.take(heard);
  wave_digest.print("waves of a beam");
}

void run_fan_kernel() {
  constexpr int kBeams = 64, kBins = 100;
  Random random(2);
  FanView view{};
  const float turn = 0.3f, edge = 0.25f;
  const float step[3][3] = {
      {edge * 0.955336f, -edge * 0.295520f, 0}, {edge * 0.295520f, edge * 0.955336f, 0}, {0, 0, edge}};
  std::memcpy(view.step, step, sizeof(step));
  view.voxel_m = edge;
  view.ceiling_m = -20;
  view.slab_m = 0.2f;
  view.sine = 0.17f;
  view.start_m = 0.5f;
  view.bins_per_m = 4;
  view.beams = kBeams;
  view.bins = kBins;
  view.looks_per_beam = turn;
  view.max_looks = 3;
  std::vector<std::int32_t> beams_at(FanView::kDirections + 1);
  for (int i = 0; i <= FanView::kDirections; ++i) {
    const int left =
        std::min(kBeams, std::max(0, (i - FanView::kDirections / 4) * kBeams / (FanView::kDirections / 2)));
    beams_at[static_cast<std::size_t>(i)] = left + 65536 * std::min(kBeams, left + 1);
  }
  std::vector<std::int32_t> sums(static_cast<std::size_t>(kBeams + 1) * (kBins + 1));
  for (int beam = 1; beam <= kBeams; ++beam) {
    std::int32_t row = 0;
    for (int bin = 1; bin <= kBins; ++bin) {
      row += 65536 + (random.uniform(0, 1) < 0.02 ? 1 : 0);
      const auto at = static_cast<std::size_t>(beam) * (kBins + 1) + static_cast<std::size_t>(bin);
      sums[at] = sums[at - kBins - 1] + row;
    }
  }
  const std::vector<float> clear = draw(random, kBins, -300, -50);
  view.beams_at = beams_at.data();
  view.sums = sums.data();
  view.clear = clear.data();
  Digest digest;
  std::size_t changed = 0, listed = 0;
  for (int i = 0; i < 60; ++i) {
    const auto begun = static_cast<LogOdds16>(i * 10);
    std::vector<LogOdds16> block(kBlockVolume, begun);
    std::vector<MixedVoxel> mixed;
    const float corner[3] = {static_cast<float>(random.uniform(-4, 20)), static_cast<float>(random.uniform(-15, 15)),
                             static_cast<float>(random.uniform(-4, 2))};
    look_at_block(view, corner, EvidenceBounds{}, block.data(), mixed);
    digest.take(block);
    changed += static_cast<std::size_t>(std::ranges::count_if(block, [&](LogOdds16 v) { return v != begun; }));
    listed += mixed.size();
    for (const MixedVoxel& m : mixed)
      digest.take(std::vector<std::int32_t>{m.offset, m.bin, m.bin_end, m.beam, m.beam_end});
  }
  digest.print("fan into voxels");
  std::printf("  %zu voxels changed, %zu listed\n", changed, listed);
}

void run_matcher() {
  Digest digest;
  for (const int channels : {1, 3}) {
    Random random(3);
    CameraImage left(150, 60, channels), right(150, 60, channels);
    for (auto& sample : left.samples) sample = static_cast<std::uint8_t>(random.index(256));
    right = left;
    for (int y = 0; y < left.height; ++y) {
      for (int x = 0; x + 7 < left.width; ++x) {
        for (int k = 0; k < channels; ++k) right(x, y, k) = left(x + 7, y, k);
      }
    }
    StereoConfig config;
    config.speckle_pixels = 0;
    const DisparityMap map = DenseMatcher(config).match(left, right),
                       plain = DenseMatcher(config, true).match(left, right);
    for (std::size_t i = 0; i < map.state.size(); ++i) {
      if (map.state[i] != plain.state[i]) std::printf("pixel %zu differs from the plain loops\n", i);
    }
    digest.take(map.state);
    digest.take(map.confidence);
    std::vector<float> valid;
    for (const float d : map.disparity) valid.push_back(d == d ? d : -1);
    digest.take(valid);
  }
  digest.print("dense stereo");
}

}  // namespace
}  // namespace isobath

int main() {
  isobath::run_fan_loops();
  isobath::run_fan_kernel();
  isobath::run_matcher();
}
