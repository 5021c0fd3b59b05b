#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <fmt/format.h>
#include <isobath/mission/plan/task_steps.hpp>

namespace isobath {
namespace {

constexpr std::array<std::string_view, 7> kActions{"hold", "surface", "go", "survey", "circle", "inspect", "look"};
constexpr std::array<std::string_view, 4> kQuantities{"depth", "battery", "sigma", "range"};
constexpr const char* kEnd = "end";

[[noreturn]] void refuse(Place place, const char* key, const std::string& problem, const std::string& allowed) {
  place.key += (place.key.empty() ? "" : ".") + std::string(key);
  throw Error(problem, std::move(place), allowed);
}

std::vector<std::string_view> tokens_of(std::string_view text) {
  std::vector<std::string_view> words;
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t from = text.find_first_not_of(' ', at);
    if (from == std::string_view::npos) break;
    at = std::min(text.find(' ', from), text.size());
    words.push_back(text.substr(from, at - from));
  }
  return words;
}

std::optional<double> number_of(std::string_view text) {
  double value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  const bool whole = error == std::errc() && end == text.data() + text.size() && std::isfinite(value);
  return whole ? std::optional(value) : std::nullopt;
}

template <class List>
std::string list_of(const List& list) {
  return fmt::format("{}", fmt::join(list, ", "));
}

void check_names(std::span<const TaskStep> steps, std::size_t k) {
  const TaskStep& step = steps[k];
  if (step.task.empty() || step.task.find(' ') != std::string::npos) {
    refuse(step.place, "task", fmt::format("a step of the task \"{}\"", step.task), "a name without blanks");
  }
  if (step.name.empty() || step.name == kEnd) {
    refuse(step.place, "name", fmt::format("a step with the name \"{}\"", step.name), "another name");
  }
  for (const TaskStep& before : steps.first(k)) {
    if (before.task != step.task || before.name != step.name) continue;
    refuse(step.place, "name", fmt::format("two steps of {} are named {}", step.task, step.name),
           "one name for each step");
  }
}

void check_action(const TaskStep& step) {
  const auto words = tokens_of(step.pilot);
  if (words.empty() || std::ranges::find(kActions, words.front()) == kActions.end()) {
    refuse(step.place, "pilot", fmt::format("an unknown action: \"{}\"", step.pilot), list_of(kActions));
  }
}

/// The steps after one, as indices; the number of all steps stands for the end of the task.
std::array<std::size_t, 2> next_of(std::span<const TaskStep> steps, std::size_t k) {
  return {step_after(steps, k, steps[k].then).value_or(steps.size()),
          step_after(steps, k, steps[k].or_else).value_or(steps.size())};
}

/// Which steps are reached from one, and whether the task can end from there.
std::vector<char> reached_from(std::span<const TaskStep> steps, std::size_t first) {
  std::vector<char> reached(steps.size() + 1, 0);
  std::vector<std::size_t> open{first};
  reached[first] = 1;
  while (!open.empty()) {
    const std::size_t k = open.back();
    open.pop_back();
    if (k == steps.size()) continue;
    for (const std::size_t next : next_of(steps, k)) {
      if (reached[next] == 0) open.push_back(next);
      reached[next] = 1;
    }
  }
  return reached;
}

}  // namespace

std::vector<Field> fields(TaskStep& s) {
  return {
      Field::text("task", &s.task, "Name of the task that the step belongs to."),
      Field::text("name", &s.name, "Name of the step."),
      Field::text("pilot", &s.pilot,
                  "What the pilot does: hold, surface, go (to the point), or a task of a back-seat driver with its "
                  "numbers."),
      Field::degrees("sector_deg", &s.sector, {0, 360}, "Sector of the scanning sonar; 0: as configured."),
      Field::degrees("look_deg", &s.look, {-180, 180}, "Azimuth of the middle of that sector, to starboard."),
      Field::real("sonar_range_m", &s.sonar_range_m, {0, 1000}, "m",
                  "Range of the scanning sonar with that sector; 0: as configured."),
      Field::text("tell", &s.tell, "What is told to the operator when the step begins; empty: nothing."),
      Field::text("until", &s.until,
                  "Event that ends the step: done (the pilot's work is), or depth, battery, sigma or range below or "
                  "above a limit, such as \"battery below 0.3\"."),
      Field::real("at_most_s", &s.at_most_s, {0, 1e6}, "s", "Longest duration of the step; 0: executive.task_wait_s."),
      Field::text("then", &s.then, "Step after the event; empty: the next one of the task; end: the task is done."),
      Field::text("or_else", &s.or_else, "Step after at_most_s; empty: the next one; end: the task is done.")};
}

std::vector<std::size_t> steps_of(std::span<const TaskStep> steps, std::string_view task) {
  std::vector<std::size_t> own;
  for (std::size_t k = 0; k < steps.size(); ++k) {
    if (!task.empty() && steps[k].task == task) own.push_back(k);
  }
  return own;
}

std::optional<std::size_t> step_after(std::span<const TaskStep> steps, std::size_t k, const std::string& name) {
  if (name == kEnd) return std::nullopt;
  for (const std::size_t other : steps_of(steps, steps[k].task)) {
    if (name.empty() ? other > k : steps[other].name == name) return other;
  }
  return std::nullopt;
}

std::optional<PlanEvent> step_event_of(const TaskStep& step) {
  const auto words = tokens_of(step.until);
  if (words.size() == 1 && words[0] == "done") return std::nullopt;
  const auto limit = words.size() == 3 ? number_of(words[2]) : std::nullopt;
  const bool known = limit && std::ranges::find(kQuantities, words[0]) != kQuantities.end();
  if (known && words[1] == "below") return PlanEvent::below(std::string(words[0]), *limit);
  if (known && words[1] == "above") return PlanEvent::above(std::string(words[0]), *limit);
  refuse(step.place, "until", fmt::format("an unknown event: \"{}\"", step.until),
         "done, or one of " + list_of(kQuantities) + " with below or above and a limit");
}

void check_steps(std::span<const TaskStep> steps) {
  if (steps.size() > kMaxSteps) {
    refuse(steps.back().place, "task", fmt::format("{} steps", steps.size()), fmt::format("up to {}", kMaxSteps));
  }
  for (std::size_t k = 0; k < steps.size(); ++k) {
    check_names(steps, k);
    check_action(steps[k]);
    (void)step_event_of(steps[k]);
    for (const auto& [key, name] : {std::pair("then", &steps[k].then), std::pair("or_else", &steps[k].or_else)}) {
      if (name->empty() || *name == kEnd || step_after(steps, k, *name)) continue;
      refuse(steps[k].place, key, fmt::format("{} has no step {}", steps[k].task, *name), "the name of a step, or end");
    }
  }
  for (std::size_t k = 0; k < steps.size(); ++k) {
    const std::size_t first = steps_of(steps, steps[k].task).front();
    if (reached_from(steps, first)[k] == 0) {
      refuse(steps[k].place, "name", fmt::format("no step of {} leads to {}", steps[k].task, steps[k].name),
             "a step that another one names, or that follows one");
    }
    if (reached_from(steps, k)[steps.size()] == 0) {
      refuse(steps[k].place, "then", fmt::format("{} never ends after {}", steps[k].task, steps[k].name),
             "a way to the end of the task");
    }
  }
}

}  // namespace isobath
