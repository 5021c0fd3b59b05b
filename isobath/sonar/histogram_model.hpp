// HistogramModel: how bright noise is in every pixel of one sonar's image, and how bright objects are, as histograms of
// intensity; and from both the likelihood ratio of what a pixel shows.
//
// Source: Horner et al. c. 2009, 4.1.1, 4.1.2; ledger S5-18 to S5-20, S5-23, S5-25, S5-26, S5-E11. A pixel is a range
// bin of a beam. Levels divide the intensities (counts) evenly, as many as `levels`, the last one open above: the
// paper's 25 of 160 counts each span 0 to 4000. With n_b samples of noise in level b of a pixel, N in all, and h_b of
// objects
//   e_b = (n_b + k) / (N + levels k),   h_b = (m_b + k) / (M + levels k),   increment ln(h_b / e_b),
// so that a level that was never seen in training (the paper is silent) is unlikely, not impossible. The increment is
// held within +-most_evidence. The object histogram is one for all pixels.
//
// Objects in the noise set ("few objects" is what the paper asks of it): marked pixels are left out, and of every pixel
// the brightest drop_share of its samples.
//
// Few images: the paper has 300. n_b is summed over pool_bins neighbours in range and pool_beams in bearing on each
// side. By default the beams stay apart (a frequency-steered array is noisier in some) and ranges are pooled up to 1000
// samples a pixel, 1/32 of the window at most: smoothing with k = 0.5 then holds 1.2 % of the probability, less than
// the false alarms that are asked for. 300 images pool 2 bins on each side.
//
// A model belongs to one sonar and its settings: `mismatch` tells whether a ping is of them. Memory: two bytes a pixel
// and level, 8.9 MB for 90 bearings x 1968 ranges, and as much again for the table. Deterministic.
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
  double drop_share = 0.01;  ///< of the samples of a pixel, the brightest
  int pool_bins = -1;        ///< on each side; -1: by the number of images
  int pool_beams = 0;        ///< on each side
  double most_evidence = 4;  ///< of one look at one pixel, log-odds
  bool operator==(const HistogramConfig&) const = default;
};
std::vector<Field> fields(HistogramConfig& config);

/// Why a model cannot serve a ping, or cannot be added to another.
enum class HistogramMismatch : std::uint8_t { kImageSize, kBearings, kRange, kLevels };
const char* to_text(HistogramMismatch mismatch);

struct HistogramModel {
  static constexpr std::size_t kMostCells = std::size_t{1} << 28;  ///< beams x bins x levels

  std::string source;      ///< which recording, for people
  HistogramConfig config;  ///< in force: nothing left to be chosen by the data
  RangeWindow window;
  std::vector<Angle> azimuth;  ///< of the beams
  double full_scale = 255;
  int background_pings = 0;
  int marked_pings = 0;
  std::vector<std::uint16_t> noise;   ///< samples seen: beams x bins x levels, not pooled
  std::vector<std::uint64_t> object;  ///< samples seen, by level

  [[nodiscard]] int beams() const { return static_cast<int>(azimuth.size()); }
  [[nodiscard]] int level(float intensity) const {
    const double at = static_cast<double>(intensity) / config.level_width;
    return at >= 1 ? at < config.levels ? static_cast<int>(at) : config.levels - 1 : 0;
  }
  [[nodiscard]] std::span<const std::uint16_t> counts(int beam, int bin) const {
    const auto levels = static_cast<std::size_t>(config.levels);
    return {noise.data() + (static_cast<std::size_t>(beam) * window.bins + bin) * levels, levels};
  }
  /// e_b of a pixel and h_b: of every level, smoothed, summing to 1.
  [[nodiscard]] std::vector<double> noise_shares(int beam, int bin) const;
  [[nodiscard]] std::vector<double> object_shares() const;

  /// Throws Error: sizes that disagree, values out of range.
  void check(const std::string& file = {}) const;
};

/// Ranges may differ by a quarter of a bin (the sound speed drifts), bearings by a quarter of a beam. Full scale
/// decides what the levels mean.
std::optional<HistogramMismatch> mismatch(const HistogramModel& model, const Ping& ping);

/// Version 1: a line of text, then little-endian u32 version, u32 bytes of the header, the header (JSON), the counts of
/// noise as u16, the CRC-32 of all before. Reading trusts nothing: what is not exactly that throws Error.
std::string write_histogram_model(const HistogramModel& model);
HistogramModel read_histogram_model(std::string_view bytes, const std::string& file);
HistogramModel load_histogram_model(const std::filesystem::path& path);

/// Learns a model from pings of one sonar at one setting.
class HistogramLearner {
 public:
  explicit HistogramLearner(const HistogramConfig& config);

  /// Water with few objects; `masked` (beams x bins, beam after beam, not 0 where an object is known) may be empty. The
  /// ping must pass `check`. Throws Error: of another sonar or setting than the first one, too large, or the 65536th.
  void add_background(const Ping& ping, std::span<const std::uint8_t> masked = {});
  /// The marked pixels are of objects; the others say nothing.
  void add_marked(const Ping& ping, std::span<const std::uint8_t> marked);
  /// What another recording of the same sonar has taught. Throws Error: other levels, image or settings.
  void add(const HistogramModel& other);
  /// The objects alone, which are those of any image of the sonar. Throws Error: other levels or full scale.
  void add_objects(const HistogramModel& other);

  [[nodiscard]] bool has_noise() const { return model_.background_pings > 0; }
  [[nodiscard]] bool has_objects() const { return model_.marked_pings > 0; }
  /// Throws Error where there is no background.
  [[nodiscard]] HistogramModel model(const std::string& source) const;

 private:
  void prepare(const Ping& ping);
  HistogramModel model_;
};

/// The increments of a model as a table, and where to draw the line between echo and none.
class LikelihoodRatios {
 public:
  static constexpr double kUnit = 1.0 / 2048;  ///< of the table

  /// Throws Error where the model has seen no object.
  explicit LikelihoodRatios(std::shared_ptr<const HistogramModel> model);
  [[nodiscard]] const HistogramModel& model() const { return *model_; }

  [[nodiscard]] double log_ratio(int beam, int bin, int level) const {
    return kUnit * table_[(static_cast<std::size_t>(beam) * model_->window.bins + bin) * model_->config.levels + level];
  }
  /// Of each sample of a ping that fits the model, beam after beam, in units of kUnit. `out` has beams x bins.
  void look_up(const Ping& ping, std::span<std::int16_t> out) const;

  /// The most powerful test at one rate of false alarms over all pixels together (Neyman and Pearson): an echo is what
  /// has at least this ratio. Rates are those of the training data, objects in the noise set counted as noise.
  struct OperatingPoint {
    std::int16_t threshold = 0;   ///< units of kUnit
    double false_alarm = 0;       ///< reached, at most what was asked for
    std::vector<float> p_detect;  ///< of each range bin, the mean over its beams; 0 before first_bin
  };
  [[nodiscard]] OperatingPoint operating_point(double false_alarm, int first_bin) const;

 private:
  void pool_beams(int beam, std::vector<double>& sum) const;
  std::shared_ptr<const HistogramModel> model_;
  std::vector<std::int16_t> table_;
};

}  // namespace isobath
