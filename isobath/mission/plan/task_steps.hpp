// TaskStep: one step of a task that a mission file describes (Herman 1988, 3.1, 3.2; ledger S2-08, S2-16, S2-18,
// S2-20).
//
// The steps with one `task` name are that task. A mission point that names it begins the first of its steps once the
// point is reached. A step gives each of three planners its job: the pilot what to do, the scanning sonar where to
// look, the link to the operator what to tell. It ends by an event, or after a time; for each of the two it names the
// step that follows. So a task is data: a new one needs no code. An unknown action is refused.
//
// Pilot: "hold" the position, come to the "surface", "go" to the point, or a task of a back-seat driver with its
// numbers ("circle radius_m=8"). Events: "done" (the pilot's work is done; "hold" never is), or a quantity beyond a
// limit: "depth below 1", "battery below 0.3", "sigma above 5", "range above 10" (to the nearest obstacle of the last
// scan). A quantity that is unknown makes no event true. Only the Executive Officer reads steps.
#pragma once

#include <isobath/base/angle.hpp>
#include <isobath/base/config.hpp>
#include <isobath/mission/plan/plan_graph.hpp>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace isobath {

struct TaskStep {
  Place place = {};
  std::string task = {};
  std::string name = {};
  std::string pilot = "hold";
  Angle sector = {}, look = {};  ///< of a scanning sonar; without a sector it looks as configured
  double sonar_range_m = 0;      ///< with a sector; 0: as configured
  std::string tell = {};         ///< to the operator; empty: nothing
  std::string until = "done";
  double at_most_s = 0;      ///< 0: executive.task_wait_s
  std::string then = {};     ///< the step after the event; empty: the next one; "end": the task is done
  std::string or_else = {};  ///< likewise after `at_most_s`
};
std::vector<Field> fields(TaskStep& step);

inline constexpr std::size_t kMaxSteps = 1000;

/// The indices of the steps of a task, in order; none: it is a task of a back-seat driver.
std::vector<std::size_t> steps_of(std::span<const TaskStep> steps, std::string_view task);
/// The step that follows, as an index into `steps`; empty: the task is done. `name`: `then` or `or_else` of step k.
std::optional<std::size_t> step_after(std::span<const TaskStep> steps, std::size_t k, const std::string& name);
/// The quantity beyond a limit that ends the step; empty: "done". Throws Error where it is neither.
std::optional<PlanEvent> step_event_of(const TaskStep& step);

/// Throws Error for a step without a task or a name, or with the name of another step of its task; for an action, an
/// event or a following step that there is not; for a step that no other leads to, and a task that never ends.
void check_steps(std::span<const TaskStep> steps);

}  // namespace isobath
