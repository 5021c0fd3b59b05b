// DepthMapper: sonar x depth map. The only writer of the map (ledger S1-02): turns each reading into evidence on the
// pixels that it speaks of, and applies the rule.
//
// Source: Oskard, Hong and Shaffer 1990, III-C, IV, V; ledger S1-29 to S1-33, S1-48 to S1-70, S1-72, S1-73.
//
//   reading with its pose -> prefilter (alike ones become one) -> quarantine (depths that nothing supports)
//     -> evidence (which pixels, what of them) -> explained by the map already? -> rule, pixel by pixel
//
// While the window shifts, readings go into the old window and are kept; the new window gets them all, in order, before
// it takes the old one's place. So the map, the counts and the changes that are heard are, bit for bit, those of a
// shift without duration, in the background as well as on the spot (`background`). A reading waits for neither: when
// the new window is there, each reading takes a few of the kept ones along until none is left.
//
// An echo is explained (S1-66) by ground that a chart or a depth sonar vouches for, never by what forward beams alone
// have seen: that is a bound, and where it was cleared it lies at the very edge of the beam.
//
// Honest confidence (S1-73): the step of a reading is the weight of its sensor where its standard deviation is that of
// the reference, and falls as its evidence falls: the log-odds that it agrees because it is right, in whole units. What
// is worth less than half a unit counts as one by lot, drawn from a fixed sequence. With `honest = false` every reading
// counts its weight, as published.
//
// Frames: poses X_WB in W of the map. Threads: one calls; the worker of a shift is its own. take() throws nothing and
// allocates nothing after warm-up.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <isobath/base/time.hpp>
#include <isobath/map/depth_map.hpp>
#include <isobath/perception/depth_parts.hpp>
#include <isobath/sonar/range_reading.hpp>
#include <isobath/sonar/swath.hpp>
#include <memory>

namespace isobath {

/// Why a reading or a sounding does not count.
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

/// All but `queued`, `spared` and `waited` are the same however long a shift takes.
struct DepthCounts {
  std::uint64_t readings = 0;                                ///< range readings taken
  std::uint64_t soundings = 0;                               ///< of swaths
  std::uint64_t merged = 0;                                  ///< readings that became part of another
  std::uint64_t applied = 0;                                 ///< that spoke to the map
  std::uint64_t affirmed = 0, conflicted = 0, replaced = 0;  ///< pixels
  std::uint64_t explained = 0;                               ///< obstacle readings that the map predicted
  std::uint64_t shifts = 0;
  std::uint64_t queued = 0;   ///< readings that came during a shift
  std::uint64_t spared = 0;   ///< of which came then and were not kept, for they changed nothing
  std::uint64_t waited = 0;   ///< times that the queue was full or the next shift due before the last was over
  std::uint64_t outside = 0;  ///< readings that lay wholly outside the window
  std::array<std::uint64_t, kDepthRefusals> refused{};  ///< by DepthRefusal
};

class DepthMapper {
 public:
  /// `map` must outlive it. Throws Error where constants do not fit together.
  DepthMapper(DepthMap& map, const DepthMapperParts& parts, Time epoch);
  ~DepthMapper();

  /// `sigma_m`: standard deviation of the vehicle's place in the plane; 0: not known.
  void take(const RangeReading& reading, const Pose& X_WB, double sigma_m);
  void take(const Swath& swath, const Pose& X_WB, double sigma_m);
  /// The vehicle has come here: marks its track, and moves the window when it is due.
  void passed(Time time, const Pose& X_WB);
  /// Lets go of what waits: the prefilter's groups, what is held alone (refused), a shift that runs.
  void finish();

  [[nodiscard]] const DepthCounts& counts() const { return counts_; }
  /// Called for every change in the order in which it counts: during a shift, when the new window gets it. For audits.
  void on_change(std::function<void(const PixelChange&)> listener);
  /// Called in the shift's thread before it begins: so that a test can make one last as long as it likes.
  void before_shift(std::function<void()> wait);

 private:
  struct Work;
  DepthCounts counts_;
  std::unique_ptr<Work> work_;
};

}  // namespace isobath
