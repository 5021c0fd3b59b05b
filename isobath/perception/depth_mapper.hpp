// DepthMapper: writes sonar readings into the depth map. It is the only writer of the map (ledger S1-02). It turns each
// reading into evidence on pixels and applies the confidence rule.
//
// Source: Oskard, Hong and Shaffer 1990, III-C, IV, V; ledger S1-29 to S1-33, S1-48 to S1-70, S1-72, S1-73.
//
//   reading with its pose -> prefilter (similar readings merge) -> quarantine (depths without support)
//     -> evidence (pixels and their bounds) -> predicted by the map already? -> rule, pixel by pixel
//
// While the window shifts, readings go into the old window and are queued. The new window then gets all of them in
// order before it replaces the old one. So the map, the counts and the reported changes are, bit for bit, those of an
// instantaneous shift, whether it runs in the background or not (`background`). No reading waits for a shift: once the
// new window is ready, each new reading also applies a few queued ones until none is left.
//
// An echo counts as predicted (S1-66) only by a bottom from a chart or a depth sonar. A bottom from forward beams alone
// is a bound, and where it has been cleared it lies at the very edge of the beam.
//
// Range weighting (S1-73): a reading's step of confidence is the weight of its sensor if its standard deviation is the
// reference one, and falls with its evidence: the log-odds that it agrees because it is right, in whole units. A step
// below half a unit counts as one unit or none at random, by a fixed sequence. With `range_weighting = false` each
// reading counts its weight, as published.
//
// Frames: poses X_WB in W of the map. Threads: one thread calls; a shift has its own worker thread. update() throws
// nothing and allocates nothing after warm-up.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <isobath/base/time.hpp>
#include <isobath/map/depth/depth_map.hpp>
#include <isobath/map/depth/revisit_record.hpp>
#include <isobath/perception/depth_parts.hpp>
#include <isobath/sonar/range_reading.hpp>
#include <isobath/sonar/swath.hpp>
#include <memory>

namespace isobath {

/// The reason why a reading or a sounding is rejected.
enum class DepthRefusal : std::uint8_t {
  kHeldAlone,
  kBeamAlone,
  kImpossible,
  kUseless,
  kTooWeak,
  kManySensors,
  kTooFar
};
inline constexpr std::size_t kDepthRefusals = 7;
const char* to_text(DepthRefusal why);

/// All but `queued`, `spared` and `waited` do not depend on the duration of shifts.
struct DepthCounts {
  std::uint64_t readings = 0;                                ///< range readings received
  std::uint64_t soundings = 0;                               ///< soundings of swaths
  std::uint64_t merged = 0;                                  ///< readings that were merged into another
  std::uint64_t applied = 0;                                 ///< readings applied to the map
  std::uint64_t affirmed = 0, conflicted = 0, replaced = 0;  ///< pixels
  std::uint64_t examined = 0;                                ///< pixels that applied readings have evidence on
  std::uint64_t explained = 0;                               ///< obstacle readings that the map predicted
  std::uint64_t silent = 0;                                  ///< readings without an echo that tell nothing
  std::uint64_t shifts = 0;
  Time first_shift{}, last_shift{};
  double least_shift_gap_s = 0;  ///< least time between two shifts; 0: fewer than two
  std::uint64_t queued = 0;      ///< readings queued during a shift
  std::uint64_t spared = 0;      ///< readings during a shift that changed nothing and were not queued
  std::uint64_t waited = 0;      ///< times that the queue was full or the next shift was due before the last ended
  std::uint64_t outside = 0;     ///< readings wholly outside the window
  std::array<std::uint64_t, kDepthRefusals> refused{};  ///< by DepthRefusal

  /// Readings and soundings that were neither merged, applied, silent nor refused; 0 after finish().
  [[nodiscard]] std::uint64_t lost() const;
  /// Mean number of pixels that an applied reading has evidence on; 0: none was applied. A reading costs a fixed time
  /// and a time for each of these pixels (S1-E03).
  [[nodiscard]] double pixels_per_reading() const {
    return applied > 0 ? static_cast<double>(examined) / static_cast<double>(applied) : 0;
  }
};

class DepthMapper {
 public:
  /// `map` must outlive the mapper. Throws Error for inconsistent rules.
  DepthMapper(DepthMap& map, const DepthMapperParts& parts, Time epoch);
  ~DepthMapper();

  /// `sigma_m`: standard deviation of the vehicle's horizontal position; 0: not known.
  void update(const RangeReading& reading, const Pose& X_WB, double sigma_m);
  void update(const Swath& swath, const Pose& X_WB, double sigma_m);
  /// Reports the vehicle's position: marks its track, and starts a window shift when it is due.
  void passed(Time time, const Pose& X_WB);
  /// Flushes pending data: applies the prefilter's groups, rejects quarantined depths, completes a running shift.
  void finish();

  /// The minute of a time in the pixels of a map that began at `epoch`.
  static std::uint32_t minute_of(Time time, Time epoch);
  [[nodiscard]] const DepthCounts& counts() const { return counts_; }
  /// Depth soundings that met depths of an earlier pass.
  [[nodiscard]] const RevisitRecord& revisits() const;
  /// `listener` is called for each change in order; during a shift, when the change reaches the new window. For audits.
  void on_change(std::function<void(const PixelChange&)> listener);
  /// For tests: `wait` is called in the shift's thread before the shift begins, so that a test can prolong it.
  void before_shift(std::function<void()> wait);

 private:
  struct Work;
  DepthCounts counts_;
  std::unique_ptr<Work> work_;
};

}  // namespace isobath
