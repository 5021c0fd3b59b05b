// Fault table: what can go wrong, how it is noticed, what is done, in which order, and what shows it (design: a
// published table of faults, each with a limit, an action and a test; ledger S6-39, S2-28, S1-43, S1-44).
//
// The one statement of it: the Safety Officer acts by these rows, docs/faults.md is fault_page(), and tests compare
// both. `isobath eval faults` brings each of them about and holds the whole crew to it (fault_proof.hpp).
#pragma once

#include <array>
#include <cstdint>
#include <isobath/mission/messages.hpp>
#include <isobath/mission/safety_config.hpp>
#include <span>
#include <string>
#include <vector>

namespace isobath {

enum class Fault : std::uint8_t {
  kSonarSilent,
  kSonarFrozen,
  kSonarSaturated,
  kSonarDeaf,
  kSonarBlindSide,
  kSonarGarbled,
  kNavigationSilent,
  kNavigationJump,
  kNavigationDrift,
  kDepthLost,
  kAltitudeLost,
  kWayNotFollowed,
  kInsideObstacle,
  kNoPath,
  kPlannerOverBudget,
  kCollisionAhead,
  kCollisionUnavoidable,
  kFenceAhead,
  kFenceBreach,
  kTooDeep,
  kTooLow,
  kAgentDead,
  kLeak,
  kBatteryLow,
  kThrusterLost,
  kHealthSilent,
  kLinkLost,
  kClockJump,
  kDiskFull,
  kMissionTooLong,
};
inline constexpr std::size_t kFaults = 30;

/// A step that comes never, at once, or after a time of the configuration.
struct After {
  enum class When : std::uint8_t { kNever, kAtOnce, kLater } when = When::kNever;
  double SafetyConfig::*wait = nullptr;

  [[nodiscard]] bool due(double held_s, const SafetyConfig& config) const {
    return when == When::kAtOnce || (when == When::kLater && held_s >= config.*wait);
  }
};

/// When a row is over: once its cause is gone, `leave_s` later, or never by itself.
enum class Over : std::uint8_t { kLater, kAtOnce, kNever };

/// The latest that a whole crew may raise a row in a closed loop: so many seconds after one of these, or before the
/// vehicle is this near.
struct Deadline {
  enum class From : std::uint8_t {
    kInjection,  ///< the fault of the scene
    kStart,      ///< the start of the mission
    kOvertime,   ///< the longest time that the mission may take
    kRefusal,    ///< the first route that is refused
    kCrossing,   ///< of the fence, in truth; not at all where it is not crossed
    kNearness,   ///< no time: metres from hull to body or bottom, in truth
  } from = From::kInjection;
  double value = 0;  ///< s, or m
};

struct FaultRow {
  Fault fault;
  const char* name;                 ///< as in SafetyAction::fault
  const char* noticed;              ///< how, for people
  std::vector<const char*> limits;  ///< names among the fields of SafetyConfig, or limits of the mission
  SafetyActionKind action = SafetyActionKind::kNone;
  SafetyActionKind later = SafetyActionKind::kNone;  ///< what replaces the action ...
  After later_after = {};                            ///< ... and when
  After abort = {};                                  ///< when the mission ends
  const char* end = "";                              ///< how it ends, where not by abort_end; for people
  Over over = Over::kLater;
  const char* injected = "";  ///< fault of a scene: "sonar: off"; or what else brings it about
  Deadline deadline = {};
  const char* test = "";  ///< name of the test on a stream of messages
};

/// In the order of Fault.
std::span<const FaultRow> fault_table();
const FaultRow& row_of(Fault fault);
inline const char* to_text(Fault fault) { return row_of(fault).name; }
/// "sonar_silent", of "sonar silent": what files of the row are called.
std::string file_name_of(const FaultRow& row);

/// docs/faults.md, with the limits of this configuration.
std::string fault_page(SafetyConfig config);

}  // namespace isobath
