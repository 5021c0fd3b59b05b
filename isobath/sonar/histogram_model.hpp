// HistogramModel: histograms of intensity for the noise in each pixel of one sonar's image and for objects, and the
// likelihood ratio of a pixel's intensity from both.
//
// Source: Horner et al. c. 2009, 4.1.1, 4.1.2; ledger S5-18 to S5-20, S5-23, S5-25, S5-26, S5-E11. A pixel is a range
// bin of a beam. `levels` levels divide the intensities (counts) evenly; the last one is open above. The paper's 25
// levels of 160 counts each span 0 to 4000. With n_b samples of noise in level b of a pixel, N in total, and m_b
// samples of objects, M in total,
//   e_b = (n_b + k) / (N + levels k),   h_b = (m_b + k) / (M + levels k),   increment ln(h_b / e_b),
// so that a level without training samples (the paper does not treat it) is unlikely, not impossible. The increment is
// clamped to +-max_log_odds. All pixels share one object histogram.
//
// Objects in the noise set (the paper asks for "few objects"): marked pixels are left out, and the brightest drop_share
// of the samples of each pixel.
//
// Few images: the paper has 300. n_b is summed over pool_bins neighbours in range and pool_beams in bearing on each
// side. By default beams are not pooled (a frequency-steered array is noisier in some), and ranges are pooled up to
// 1000 samples per pixel, at most 1/32 of the window on each side. Smoothing with k = 0.5 then holds 1.2 % of the
// probability, less than the requested false alarms. 300 images pool 2 bins on each side.
//
// A model belongs to one sonar and its settings: `mismatch` compares them with a ping. Memory: two bytes per pixel and
// level, 8.9 MB for 90 bearings x 1968 ranges, and as much again for the table. Deterministic.
#pragma once

#include <cstdint>
#include <filesystem>
#include <isobath/base/config.hpp>
#include <isobath/sonar/ping.hpp>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace isobath {

struct HistogramConfig {
  int levels = 25;
  double level_width = 0;    ///< counts; 0: full scale over levels; `isobath calibrate` fits it to the background
  double smoothing = 0.5;    ///< k
  double drop_share = 0.01;  ///< share of the brightest samples of a pixel that is left out
  int pool_bins = -1;        ///< on each side; -1: by the number of images
  int pool_beams = 0;        ///< on each side
  double max_log_odds = 4;   ///< maximum log-odds of one look at one pixel
  bool operator==(const HistogramConfig&) const = default;
};
std::vector<Field> fields(HistogramConfig& config);

/// The reason why a model does not fit a ping, or cannot be added to another.
enum class HistogramMismatch : std::uint8_t { kImageSize, kBearings, kRange, kLevels };
const char* to_text(HistogramMismatch mismatch);

struct HistogramModel {
  static constexpr std::size_t kMaxCells = std::size_t{1} << 28;  ///< beams x bins x levels

  std::string source;      ///< description of the recording
  HistogramConfig config;  ///< with all automatic values resolved
  RangeWindow window;
  std::vector<Angle> azimuth;  ///< azimuths of the beams
  double full_scale = 255;
  int background_pings = 0;
  int marked_pings = 0;
  std::vector<std::uint16_t> noise;   ///< counts of samples: beams x bins x levels, not pooled
  std::vector<std::uint64_t> object;  ///< counts of samples by level

  [[nodiscard]] int beams() const { return static_cast<int>(azimuth.size()); }
  [[nodiscard]] int level(float intensity) const {
    const double at = static_cast<double>(intensity) / config.level_width;
    return at >= 1 ? at < config.levels ? static_cast<int>(at) : config.levels - 1 : 0;
  }
  [[nodiscard]] std::span<const std::uint16_t> counts(int beam, int bin) const {
    const auto levels = static_cast<std::size_t>(config.levels);
    return {noise.data() + (static_cast<std::size_t>(beam) * window.bins + bin) * levels, levels};
  }
  /// e_b of a pixel and h_b: for all levels, smoothed; their sum is 1.
  [[nodiscard]] std::vector<double> noise_shares(int beam, int bin) const;
  [[nodiscard]] std::vector<double> object_shares() const;

  /// Throws Error for sizes that disagree or values out of range.
  void check(const std::string& file = {}) const;
};

/// Compares a model with a ping; empty: it fits. Ranges may differ by a quarter of a bin (the sound speed drifts),
/// bearings by a quarter of a beam. The full scale must be the same, since it defines the levels.
std::optional<HistogramMismatch> mismatch(const HistogramModel& model, const Ping& ping);

/// Version 1: a line of text, then little-endian u32 version, u32 bytes of the header, the header (JSON), the counts of
/// noise as u16, the CRC-32 of all before. Reading is strict and throws Error for any deviation.
std::string write_histogram_model(const HistogramModel& model);
HistogramModel read_histogram_model(std::string_view bytes, const std::string& file);
HistogramModel load_histogram_model(const std::filesystem::path& path);

/// Learns a model from pings of one sonar at one setting.
class HistogramLearner {
 public:
  explicit HistogramLearner(const HistogramConfig& config);

  /// Adds a ping of water with few objects. `masked` (beams x bins, beam by beam, nonzero for known objects) may be
  /// empty. The ping must pass `check`. Throws Error if its sonar or setting differs from the first ping's, it is too
  /// large, or it is the 65536th.
  void add_background(const Ping& ping, std::span<const std::uint8_t> masked = {});
  /// Adds the marked pixels of a ping as objects; the others are ignored.
  void add_marked(const Ping& ping, std::span<const std::uint8_t> marked);
  /// Adds a model from another recording of the same sonar. Throws Error for other levels, image or settings.
  void add(const HistogramModel& other);
  /// Adds only the objects of another model, which hold for any image of the sonar. Throws Error for other levels or
  /// full scale.
  void add_objects(const HistogramModel& other);

  [[nodiscard]] bool has_noise() const { return model_.background_pings > 0; }
  [[nodiscard]] bool has_objects() const { return model_.marked_pings > 0; }
  /// Throws Error without background.
  [[nodiscard]] HistogramModel model(const std::string& source) const;

 private:
  void prepare(const Ping& ping);
  HistogramModel model_;
};

/// The increments of a model as a table, and the threshold between echo and no echo.
class LikelihoodRatios {
 public:
  static constexpr double kUnit = 1.0 / 2048;  ///< log-odds per unit of the table

  /// Throws Error if the model has no object samples.
  explicit LikelihoodRatios(std::shared_ptr<const HistogramModel> model);
  [[nodiscard]] const HistogramModel& model() const { return *model_; }

  [[nodiscard]] double log_ratio(int beam, int bin, int level) const {
    return kUnit * table_[(static_cast<std::size_t>(beam) * model_->window.bins + bin) * model_->config.levels + level];
  }
  /// Log ratio of each sample of a ping that fits the model, beam by beam, in units of kUnit. `out` has beams x bins.
  void look_up(const Ping& ping, std::span<std::int16_t> out) const;

  /// The most powerful test at one false-alarm rate over all pixels together (Neyman and Pearson): samples with at
  /// least this ratio are echoes. Rates are those of the training data, where objects in the noise set count as noise.
  struct OperatingPoint {
    std::int16_t threshold = 0;   ///< units of kUnit
    double false_alarm = 0;       ///< the actual rate, at most the requested one
    std::vector<float> p_detect;  ///< by range bin, the mean over its beams; 0 before first_bin
  };
  [[nodiscard]] OperatingPoint operating_point(double false_alarm, int first_bin) const;

 private:
  void pool_beams(int beam, std::vector<double>& sum) const;
  std::shared_ptr<const HistogramModel> model_;
  std::vector<std::int16_t> table_;
};

}  // namespace isobath
