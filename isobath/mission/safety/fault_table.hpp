// Fault table: what can go wrong, how it is noticed, what is done about it, in which order, and what shows it (design:
// a published table of faults, each with a limit, an action and a test; ledger S6-39, S2-28, S1-43, S1-44).
//
// The table is stated only here: the Safety Officer acts by these rows, docs/faults.md is fault_page(), and tests
// compare both. `isobath eval faults` causes each fault and checks how all agents together respond
// (fault_injection_check.hpp).
#pragma once

#include <array>
#include <cstdint>
#include <isobath/mission/messages/messages.hpp>
#include <isobath/mission/safety/safety_config.hpp>
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

/// A step that is taken never, at once, or after a time of the configuration.
struct After {
  enum class When : std::uint8_t { kNever, kAtOnce, kLater } when = When::kNever;
  double SafetyConfig::*wait = nullptr;

  [[nodiscard]] bool due(double held_s, const SafetyConfig& config) const {
    return when == When::kAtOnce || (when == When::kLater && held_s >= config.*wait);
  }
};

/// When a row is over: `clear_after_s` after its cause is gone, as soon as its cause is gone, or never by itself.
enum class Over : std::uint8_t { kLater, kAtOnce, kNever };

/// The latest time at which a complete set of agents may raise a row in a closed loop: this many seconds after one of
/// these events, or at this distance.
struct Deadline {
  enum class From : std::uint8_t {
    kInjection,  ///< the scene injects the fault
    kStart,      ///< the mission starts
    kOvertime,   ///< the mission reaches its maximum duration
    kRefusal,    ///< the first route is refused
    kCrossing,   ///< the fence is crossed, by ground truth; no deadline where it is not
    kNearness,   ///< no time: metres from hull to body or bottom, by ground truth
  } from = From::kInjection;
  double value = 0;  ///< s, or m
};

struct FaultRow {
  Fault fault;
  const char* name;                      ///< as in SafetyAction::fault
  const char* noticed;                   ///< how it is noticed, for people
  std::vector<const char*> limits = {};  ///< names among the fields of SafetyConfig, or limits of the mission
  SafetyActionKind action = SafetyActionKind::kNone;
  SafetyActionKind unstoppable = SafetyActionKind::kNone;  ///< the action of a vehicle that cannot stop, if another
  SafetyActionKind later = SafetyActionKind::kNone;        ///< what replaces the action ...
  After later_after = {};                                  ///< ... and when
  After abort = {};                                        ///< when the mission ends
  const char* end = "";                                    ///< how the mission ends, where not by abort_end; for people
  Over over = Over::kLater;
  const char* injected = "";  ///< fault of a scene: "sonar: off"; or another cause
  Deadline deadline = {};
  const char* test = "";  ///< name of the test on a stream of messages
};

/// In the order of Fault.
std::span<const FaultRow> fault_table();
const FaultRow& row_of(Fault fault);
inline const char* to_text(Fault fault) { return row_of(fault).name; }
/// Base name of the files of a row: "sonar_silent" for "sonar silent".
std::string file_name_of(const FaultRow& row);

/// docs/faults.md, with the limits of this configuration.
std::string fault_page(SafetyConfig config);

}  // namespace isobath
