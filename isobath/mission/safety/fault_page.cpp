#include <algorithm>
#include <fmt/format.h>
#include <isobath/mission/safety/fault_table.hpp>

namespace isobath {
namespace {

using Act = SafetyActionKind;

/// Value and unit of a setting, such as "1.5 s"; empty for a name that the configuration does not have.
std::string value_of(std::vector<Field>& all, const std::string& name) {
  const auto field = std::find_if(all.begin(), all.end(), [&](const Field& f) { return f.name() == name; });
  if (field == all.end()) return {};
  return field->value() + (field->unit().empty() || field->unit() == "1" ? "" : " " + field->unit());
}

std::string wait_text(const After& after, const SafetyConfig& config) {
  return after.when == After::When::kLater ? fmt::format(" after {:g} s", config.*after.wait) : " at once";
}

std::string action_text(const FaultRow& row, const SafetyConfig& config) {
  std::string text = row.action == Act::kNone ? "report" : to_text(row.action);
  if (row.fault == Fault::kCollisionUnavoidable)
    text = "turn to the freer side, or take the escape manoeuvre that is left; surface where there is none";
  if (row.fault == Fault::kCollisionAhead) text = "stop, then turn on the spot to the ordered heading";
  if (row.fault == Fault::kTooLow) text = "slow and rise, stop at the surface";
  if (row.unstoppable != Act::kNone) text += fmt::format(", or {} where it cannot stop", to_text(row.unstoppable));
  if (row.later != Act::kNone) text += fmt::format("; {}{}", to_text(row.later), wait_text(row.later_after, config));
  if (row.abort.when != After::When::kNever) text += "; abort" + wait_text(row.abort, config);
  if (*row.end != 0) text += fmt::format(" ({})", row.end);
  return text;
}

std::string limits_text(const FaultRow& row, std::vector<Field>& all) {
  std::string text;
  for (const char* name : row.limits) {
    const std::string value = value_of(all, name);
    text += fmt::format("{}`{}`{}", text.empty() ? "" : ", ", name, value.empty() ? " of the mission" : " " + value);
  }
  return text.empty() ? "at once" : text;
}

std::string deadline_text(const Deadline& deadline) {
  switch (deadline.from) {
    case Deadline::From::kInjection: return fmt::format("{:g} s", deadline.value);
    case Deadline::From::kStart: return fmt::format("{:g} s after the start", deadline.value);
    case Deadline::From::kOvertime: return fmt::format("{:g} s after that time", deadline.value);
    case Deadline::From::kRefusal: return fmt::format("{:g} s after the refusal", deadline.value);
    case Deadline::From::kCrossing:
      return deadline.value > 0 ? fmt::format("{:g} s after the crossing", deadline.value) : "before the crossing";
    case Deadline::From::kNearness: return fmt::format("{:g} m from it", deadline.value);
  }
  return "";
}

constexpr const char* kPageHead = R"(# Faults

What can go wrong, how the Safety Officer notices it, what it does about it, and which test shows it. The program acts
by this table. Limits are settings of `[safety]` in [configuration.md](configuration.md) with their defaults, or limits
of the mission file.

- The Safety Officer judges ten times a second and overrides planning and steering. It can only slow, stop, turn away or
  surface: it never asks for more speed than was ordered, but for an escape of a vehicle that cannot stop, which is
  sailed at least at the speed at which the vehicle turns fastest. Such an escape must be free with and without the
  current that the vehicle's headings have not shown yet (up to `unknown_current`). If several faults are active, the
  strongest action is taken.
- *stop* becomes *surface* for a vehicle that needs forward speed to hold its depth, or that was ordered to surface.
- A vehicle that cannot stop surfaces in a circle where its obstacles and the fence leave room, else on its heading.
- A fault is over when its cause has been gone for `clear_after_s` ({} s). Faults of routes are over with the next route, and
  faults with a dagger stay.
- *abort* ends the mission as `abort_end` says ({}), unless the row says otherwise. Each fault, its end and each action
  is logged as a decision with its reason.
- A sensor that has not reported `startup_s` after the start of a mission is silent.
- A scene injects a fault with `[[fault]]` ([scene-format.md](scene-format.md)).
- `isobath eval faults` causes every fault in a closed loop ([scenarios/faults](../scenarios/faults)). Each must be
  raised by its deadline, counted from the injection unless the row says otherwise, and not before the injection.

| fault | noticed by | limit | action | injected by | deadline | test |
| --- | --- | --- | --- | --- | --- | --- |
)";

}  // namespace

std::string fault_page(SafetyConfig config) {
  std::vector<Field> all = fields(config);
  std::string page = fmt::format(kPageHead, config.clear_after_s, value_of(all, "abort_end"));
  for (const FaultRow& row : fault_table()) {
    page += fmt::format("| {}{} | {} | {} | {} | {} | {} | {} |\n", row.name, row.over == Over::kNever ? " †" : "",
                        row.noticed, limits_text(row, all), action_text(row, config), row.injected,
                        deadline_text(row.deadline), row.test);
  }
  return page;
}

}  // namespace isobath
