// Ping: one transmission of an imaging sonar, as a fan of beams by range bins of echo intensity.
//
// A scanning sonar (Ganesan 2015, 1.2; ledger S6-01) gives a fan of one beam that steps; a multibeam sonar gives all
// beams at once. Both use this type. Intensities are not copied: a reader points into its buffer, and `storage` keeps
// the buffer alive.
#pragma once

#include <cstddef>
#include <cstdint>
#include <isobath/base/angle.hpp>
#include <isobath/base/time.hpp>
#include <isobath/geometry/pose.hpp>
#include <memory>
#include <vector>

namespace isobath {

/// Directions of the beams in the sensor frame S (x boresight, y right, z down), azimuth clockwise seen from above.
/// Made once and shared by all pings of the same geometry: equal pointers mean the same fan.
struct BeamFan {
  std::vector<Angle> azimuth;  ///< centre of each beam, strictly increasing
  std::vector<Angle> width;    ///< full -3 dB width of each beam across, in azimuth; same size
  Angle height;                ///< full -3 dB width in elevation
  [[nodiscard]] int beams() const { return static_cast<int>(azimuth.size()); }
};

/// A fan of beams of one width at even steps, from -sector / 2 to sector / 2; a single beam looks ahead.
std::shared_ptr<const BeamFan> even_fan(int beams, Angle sector, Angle width, Angle height);

/// Bin k covers slant ranges [edge(k), edge(k + 1)).
struct RangeWindow {
  double start_m = 0;  ///< near edge of bin 0
  double bin_m = 0;    ///< length of a bin
  int bins = 0;

  [[nodiscard]] double edge(int bin) const { return start_m + bin * bin_m; }
  [[nodiscard]] double centre(int bin) const { return start_m + (bin + 0.5) * bin_m; }
  [[nodiscard]] double end_m() const { return edge(bins); }
  bool operator==(const RangeWindow&) const = default;
};

/// Bins [first, end) of a beam.
struct BinSpan {
  int first = 0, end = 0;
  bool operator==(const BinSpan&) const = default;
};

enum class SampleType : std::uint8_t { kU8, kU16, kF32 };

/// A view of beams x bins samples in a buffer that it does not own, of any alignment, little-endian. Strides in bytes.
class Intensities {
 public:
  Intensities() = default;
  Intensities(const void* data, SampleType type, int beams, int bins, std::ptrdiff_t beam_stride,
              std::ptrdiff_t bin_stride)
      : data_(static_cast<const std::byte*>(data)),
        type_(type),
        beams_(beams),
        bins_(bins),
        beam_stride_(beam_stride),
        bin_stride_(bin_stride) {}

  [[nodiscard]] float operator()(int beam, int bin) const;
  /// Copies one beam, all bins, as floats, the form that detectors read.
  void copy_beam(int beam, float* out) const;

  [[nodiscard]] const std::byte* data() const { return data_; }
  [[nodiscard]] SampleType type() const { return type_; }
  [[nodiscard]] int beams() const { return beams_; }
  [[nodiscard]] int bins() const { return bins_; }
  [[nodiscard]] std::ptrdiff_t beam_stride() const { return beam_stride_; }
  [[nodiscard]] std::ptrdiff_t bin_stride() const { return bin_stride_; }

 private:
  const std::byte* data_ = nullptr;
  SampleType type_ = SampleType::kU8;
  int beams_ = 0;
  int bins_ = 0;
  std::ptrdiff_t beam_stride_ = 0;
  std::ptrdiff_t bin_stride_ = 0;
};

/// Mark of the log on the sweeps of a scanning head; with kUnknown the pipeline finds turns and reversals itself.
enum class SweepMark : std::uint8_t { kUnknown, kInside, kEnd };

struct Ping {
  Time time;                           ///< time of transmission
  std::shared_ptr<const BeamFan> fan;  ///< never null in a valid ping
  RangeWindow window;
  Intensities intensity;                ///< fan->beams() x window.bins
  std::shared_ptr<const void> storage;  ///< owner of the samples
  Pose X_BS;                            ///< sensor in body
  double sound_speed = 1500;            ///< m/s, with which the range window was computed
  float full_scale = 255;               ///< intensity of a saturated sample
  SweepMark sweep = SweepMark::kUnknown;
  /// By beam, the bins that were sampled; the others hold 0 and have no information. Null: all bins of all beams.
  std::shared_ptr<const std::vector<BinSpan>> sampled;
  double blanking_m = 0;  ///< range below which the transmit pulse rings, as the device states it (S6-09)
};

/// A ping that owns its 8-bit samples, beam after beam, each from its nearest bin on. Another number of samples than
/// fan and window have makes a ping that `check` refuses.
Ping make_ping(Time time, std::shared_ptr<const BeamFan> fan, const RangeWindow& window,
               std::vector<std::uint8_t> samples);

/// The bins of a beam that were sampled.
BinSpan sampled_bins(const Ping& ping, int beam);

/// Faults of a ping: values not finite, sizes that disagree, no bins, beams out of order or over more than a turn,
/// sizes that no sonar has (bins below 10 um, a range beyond 1000 km, a mount 10 km from the vehicle).
enum class PingFault : std::uint8_t {
  kNone,
  kNoFan,
  kBadFan,
  kTooWide,
  kBadWindow,
  kBadScale,
  kSizeMismatch,
  kNotFinite
};
PingFault check(const Ping& ping);
const char* to_text(PingFault fault);

}  // namespace isobath
