// Dense matching beside OpenCV's StereoBM and StereoSGBM, in one process and on one core (ledger S8-02 S8-03 S8-12):
//   isobath_bench --benchmark_filter=Stereo
// Times are processor time. StereoDebianPairs prints the share of bad pixels of the two Middlebury pairs that Debian
// ships (ISOBATH_DATA/stereo-debian), of all pixels that both cameras see and that every matcher may choose freely.
#include <benchmark/benchmark.h>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <isobath/base/random.hpp>
#include <isobath/io/frames/camera_pictures.hpp>
#include <isobath/stereo/dense_matcher.hpp>
#include <isobath/stereo/disparity_score.hpp>
#ifdef ISOBATH_HAS_OPENCV
#include <opencv2/calib3d.hpp>
#include <opencv2/core.hpp>
#endif

namespace isobath {
namespace {

/// Smoothed noise over a slanted plane of disparities.
std::pair<CameraImage, CameraImage> made_pair(int width, int height) {
  CameraImage left(width, height, 1), right(width, height, 1);
  std::vector<int> row(static_cast<std::size_t>(width + 64));
  Random random(1);
  for (int y = 0; y < height; ++y) {
    for (int& v : row) v = static_cast<int>(random.index(256));
    const auto at = [&](int x) {
      const auto i = static_cast<std::size_t>(x);
      return static_cast<std::uint8_t>((row[i] + 2 * row[i + 1] + row[i + 2]) / 4);
    };
    const int shift = 5 + 40 * y / height;
    for (int x = 0; x < width; ++x) {
      left(x, y) = at(x);
      right(x, y) = at(std::min(x + shift, width + 60));
    }
  }
  return {left, right};
}

/// Arguments: width, height, window.
void StereoIsobath(benchmark::State& state) {
  const auto [left, right] = made_pair(static_cast<int>(state.range(0)), static_cast<int>(state.range(1)));
  StereoConfig config;
  config.window = static_cast<int>(state.range(2));
  DenseMatcher matcher(config);
  DisparityMap map;
  for (auto _ : state) matcher.match(left, right, map);
  state.counters["valid"] = map.share_of(PixelState::kValid);
  state.counters["pairs/s"] = benchmark::Counter(static_cast<double>(state.iterations()), benchmark::Counter::kIsRate);
}
BENCHMARK(StereoIsobath)
    ->Args({256, 256, 5})
    ->Args({640, 480, 5})
    ->Args({640, 480, 7})
    ->Args({640, 480, 9})
    ->Args({640, 480, 15})
    ->Unit(benchmark::kMillisecond);

void StereoPlainLoops(benchmark::State& state) {
  const auto [left, right] = made_pair(256, 256);
  DenseMatcher matcher({}, true);
  DisparityMap map;
  for (auto _ : state) matcher.match(left, right, map);
}
BENCHMARK(StereoPlainLoops)->Unit(benchmark::kMillisecond);

void print_score(const char* name, const DisparityScore& s) {
  std::printf(
      "  %-12s bad or not valid: over 1 %5.2f %%, over 2 %5.2f %%; of the valid: %5.2f, %5.2f %%; valid %5.1f %%\n",
      name, 100 * s.bad_1, 100 * s.bad_2, 100 * s.wrong_1, 100 * s.wrong_2, 100 * s.valid);
}

#ifdef ISOBATH_HAS_OPENCV
cv::Mat view_of(const CameraImage& image) {
  return {image.height, image.width, CV_8UC1, const_cast<std::uint8_t*>(image.samples.data())};
}
cv::Ptr<cv::StereoMatcher> semi_global(int disparities, int block) {
  return cv::StereoSGBM::create(0, disparities, block, 8 * block * block, 32 * block * block, 1, 63, 10, 100, 2);
}
DisparityMap map_of(cv::StereoMatcher& matcher, const CameraImage& left, const CameraImage& right) {
  cv::Mat out;
  matcher.compute(view_of(left), view_of(right), out);
  DisparityMap map;
  map.width = left.width;
  map.height = left.height;
  for (int y = 0; y < out.rows; ++y) {
    for (int x = 0; x < out.cols; ++x) {
      const int v = out.at<short>(y, x);
      map.disparity.push_back(v < 0 ? std::nanf("") : static_cast<float>(v) / 16);
    }
  }
  return map;
}
void time_of(benchmark::State& state, cv::StereoMatcher& matcher) {
  cv::setNumThreads(1);
  const auto [left, right] = made_pair(static_cast<int>(state.range(0)), static_cast<int>(state.range(1)));
  cv::Mat out;
  for (auto _ : state) matcher.compute(view_of(left), view_of(right), out);
}
void StereoOpenCvBM(benchmark::State& state) { time_of(state, *cv::StereoBM::create(64, 15)); }
void StereoOpenCvSGBM(benchmark::State& state) { time_of(state, *semi_global(64, 5)); }
BENCHMARK(StereoOpenCvBM)->Args({256, 256})->Args({640, 480})->Unit(benchmark::kMillisecond);
BENCHMARK(StereoOpenCvSGBM)->Args({256, 256})->Args({640, 480})->Unit(benchmark::kMillisecond);
#endif

void score_pair(const std::filesystem::path& folder, const char* name, const char* left_file, const char* right_file,
                const char* truth_file, int disparities) {
  const CameraImage left = grey_of(read_camera_image(folder / left_file));
  const CameraImage right = grey_of(read_camera_image(folder / right_file));
  const std::vector<float> truth = read_number_map(folder / truth_file, 1).values;
  StereoConfig config;
  config.disparities = disparities;
  std::printf("%s, %d disparities\n", name, disparities);
  print_score("Isobath", score_disparity(DenseMatcher(config).match(left, right), truth, disparities));
#ifdef ISOBATH_HAS_OPENCV
  for (const int block : {9, 15, 21}) {
    const auto matcher = cv::StereoBM::create(disparities, block);
    print_score(("BM " + std::to_string(block)).c_str(),
                score_disparity(map_of(*matcher, left, right), truth, disparities));
  }
  for (const int block : {3, 5, 7}) {
    const auto matcher = semi_global(disparities, block);
    print_score(("SGBM " + std::to_string(block)).c_str(),
                score_disparity(map_of(*matcher, left, right), truth, disparities));
  }
#else
  std::printf("  OpenCV is not installed; its matchers are left out\n");
#endif
}

void StereoDebianPairs(benchmark::State& state) {
  const char* const data = std::getenv("ISOBATH_DATA");
  const std::filesystem::path folder = std::filesystem::path(data ? data : "../shared/data") / "stereo-debian";
  for (auto _ : state) {
    if (!std::filesystem::exists(folder)) {
      state.SkipWithError("no stereo-debian in ISOBATH_DATA or ../shared/data");
      return;
    }
    score_pair(folder, "Motorcycle", "motorcycle_left.png", "motorcycle_right.png", "motorcycle_disp.pfm", 64);
    score_pair(folder, "Aloe", "opencv/aloeL.jpg", "opencv/aloeR.jpg", "opencv/aloeGT.png", 256);
  }
}
BENCHMARK(StereoDebianPairs)->Iterations(1)->Unit(benchmark::kSecond);

}  // namespace
}  // namespace isobath
