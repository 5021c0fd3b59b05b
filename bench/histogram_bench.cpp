// Likelihood ratios of every pixel of an image: of 8 bits as devices write them (ledger S5-25).
// Bar: 5e7 cells/s on one core.
#include <benchmark/benchmark.h>
#include <isobath/base/random.hpp>
#include <isobath/sonar/histogram_model.hpp>

namespace isobath {
namespace {

struct Image {
  Image(int beams, int bins) : samples(static_cast<std::size_t>(beams) * bins) {
    Random random(1);
    for (std::uint8_t& s : samples) s = static_cast<std::uint8_t>(random.index(256));
    auto fan = std::make_shared<BeamFan>();
    for (int b = 0; b < beams; ++b) fan->azimuth.push_back(Angle::degrees(0.2 * b));
    fan->width.assign(static_cast<std::size_t>(beams), Angle::degrees(0.2));
    fan->height = Angle::degrees(15);
    ping.fan = fan;
    ping.window = {0, 0.0508, bins};
  }
  /// Beam after beam, or row after row.
  const Ping& stored(bool rows) {
    const int beams = ping.fan->beams(), bins = ping.window.bins;
    ping.intensity = Intensities(samples.data(), SampleType::kU8, beams, bins, rows ? 1 : bins, rows ? beams : 1);
    return ping;
  }
  std::vector<std::uint8_t> samples;
  Ping ping;
};

void BM_HistogramLookUp(benchmark::State& state) {
  Image image(static_cast<int>(state.range(0)), static_cast<int>(state.range(1)));
  const Ping& ping = image.stored(state.range(2) != 0);
  HistogramLearner learner(HistogramConfig{});
  learner.add_background(ping);
  learner.add_marked(ping, std::vector<std::uint8_t>(image.samples.size(), 1));
  const LikelihoodRatios ratios(std::make_shared<const HistogramModel>(learner.model("bench")));
  std::vector<std::int16_t> out(image.samples.size());
  for (auto _ : state) {
    ratios.look_up(ping, out);
    benchmark::DoNotOptimize(out.data());
  }
  state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(out.size()));
}
BENCHMARK(BM_HistogramLookUp)
    ->ArgNames({"beams", "bins", "rows"})
    ->Args({90, 1968, 0})
    ->Args({90, 1968, 1})
    ->Args({96, 512, 1});

}  // namespace
}  // namespace isobath
