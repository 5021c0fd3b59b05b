#include <algorithm>
#include <charconv>
#include <cmath>
#include <fmt/format.h>
#include <isobath/mission/agents/back_seat.hpp>
#include <numbers>

namespace isobath {
namespace {

using Eigen::Vector2d;

constexpr double kOtherTask = 0.5;   // another task that it can do
constexpr double kTightTurns = 0.5;  // factor on the suitability where every turn needs a loop
constexpr int kCircleSides = 16;     // a chord deviates from the circle by 1 - cos(pi / 16) of the radius

std::string_view word_of(std::string_view& rest) {
  const std::size_t first = std::min(rest.find_first_not_of(" \t"), rest.size());
  const std::size_t end = std::min(rest.find_first_of(" \t", first), rest.size());
  const std::string_view word = rest.substr(first, end - first);
  rest = rest.substr(end);
  return word;
}

}  // namespace

double TaskNumbers::take(const char* name, double otherwise, double low, double high) {
  const auto found = left_.find(name);
  if (found == left_.end()) return otherwise;
  const double value = found->second;
  left_.erase(found);
  if (value >= low && value <= high) return value;
  throw Error(fmt::format("{} is out of range", value), place(name), fmt::format("{} .. {}", low, high));
}

void TaskNumbers::refuse_others() const {
  if (!left_.empty()) throw Error("unknown number", place(left_.begin()->first));
}

Place TaskNumbers::place(const std::string& name) const {
  Place place;
  place.key = "task " + task_.name + ": " + name;
  return place;
}

Result<Task, std::string> parse_task(std::string_view text) {
  Task task;
  task.name = word_of(text);
  if (task.name.empty()) return tl::unexpected(std::string("a task without a name"));
  for (std::string_view word = word_of(text); !word.empty(); word = word_of(text)) {
    const std::size_t equals = std::min(word.find('='), word.size());
    const std::string_view said = word.substr(std::min(equals + 1, word.size()));
    double value = 0;
    const auto [end, failed] = std::from_chars(said.data(), said.data() + said.size(), value);
    const bool number = failed == std::errc() && end == said.data() + said.size() && std::isfinite(value);
    if (equals == 0 || !number) return tl::unexpected(fmt::format("\"{}\" is not name=number", word));
    if (!task.numbers.emplace(word.substr(0, equals), value).second) {
      return tl::unexpected(fmt::format("\"{}\" is given twice", word.substr(0, equals)));
    }
  }
  return task;
}

Waypoint BackSeatDriver::waypoint(const MissionPoint& at, const Vector2d& north_east, double speed) {
  return {north_east.x(), north_east.y(), at.depth_m, at.speed > 0 ? at.speed : speed};
}

void BackSeatDriver::on_message(const Message& message, Time now, Outbox& out) {
  if (const auto* fix = std::get_if<Navigation>(&message)) {
    if (fix->X_WB.translation.allFinite()) vehicle_ = fix->X_WB.translation.head<2>();
  } else if (const auto* call = std::get_if<TaskCall>(&message)) {
    on(*call, now, out);
  } else if (const auto* award = std::get_if<TaskAward>(&message)) {
    on(*award, now, out);
  } else {
    hear(message);
  }
}

void BackSeatDriver::on(const TaskCall& call, Time now, Outbox& out) {
  call_.reset();
  try {
    const auto task = parse_task(call.task);
    if (!task) throw Error("cannot be read: " + task.error());
    if (!call.at.north_east.allFinite()) throw Error("the position of the point is not finite");
    auto offered = offer(*task, call.at, vehicle_);
    if (!offered) return;
    call_ = call;
    offer_ = std::move(*offered);
    out.say(TaskBid{call.id, name_, offer_.suitability});
  } catch (const Error& error) {
    out.say(Decision{now, name_, "no bid", "task \"" + call.task + "\": " + error.what()});
  }
}

void BackSeatDriver::on(const TaskAward& award, Time now, Outbox& out) {
  if (!call_ || award.id != call_->id || award.driver != name_) return;
  out.say(Decision{now, name_, "plan task",
                   fmt::format("{} way-points for \"{}\" at {}{}", offer_.waypoints.size(), call_->task, call_->at.name,
                               offer_.what.empty() ? "" : ": " + offer_.what)});
  out.say(TaskPlan{call_->id, name_, offer_.waypoints, offer_.drop_distance_m});
}

std::vector<Field> fields(SurveyConfig& c) {
  return {Field::real("length_m", &c.length_m, {1, 1e4}, "m", "Length of a lane, where the task gives none."),
          Field::real("breadth_m", &c.breadth_m, {1, 1e4}, "m", "Breadth across the lanes, where the task gives none."),
          Field::real("spacing_m", &c.spacing_m, {0.5, 1e3}, "m", "Distance between lanes, where the task gives none."),
          Field::real("speed", &c.speed, {0.01, 10}, "m/s", "Speed, where the mission point gives none."),
          Field::real("max_total_m", &c.max_total_m, {1, 1e6}, "m", "Maximum total length of the lanes of a task.")
              .was("most_m")};
}

std::optional<BackSeatDriver::Offer> SurveyDriver::offer(const Task& task, const MissionPoint& at,
                                                         const std::optional<Vector2d>& vehicle) const {
  const bool inspect = task.name == "inspect";
  if (task.name != "survey" && !inspect) return std::nullopt;
  TaskNumbers numbers(task);
  double length = config_.length_m, breadth = config_.breadth_m;
  if (inspect) {
    (void)numbers.take("turns", 1, 0, 1e9);  // lanes cover everything once
    length = breadth = 2 * numbers.take("radius_m", config_.breadth_m / 2, 0.5, 5e3);
  } else {
    length = numbers.take("length_m", length, 1, 1e4);
    breadth = numbers.take("breadth_m", breadth, 1, 1e4);
  }
  const double spacing = numbers.take("spacing_m", config_.spacing_m, 0.5, 1e3);
  const Angle heading = Angle::degrees(numbers.take("heading_deg", 0, -360, 360));
  numbers.refuse_others();
  const auto lanes = static_cast<int>(std::ceil(breadth / spacing));
  if (lanes * length > config_.max_total_m) {
    throw Error(fmt::format("{} lanes of {} m are too long", lanes, length), {},
                fmt::format("{} m", config_.max_total_m));
  }

  Vector2d along(std::cos(heading.radians()), std::sin(heading.radians()));
  Vector2d across(-along.y(), along.x());
  if (vehicle) {
    if ((*vehicle - at.north_east).dot(along) > 0) along = -along;
    if ((*vehicle - at.north_east).dot(across) > 0) across = -across;
  }
  Offer offer;
  const double between = breadth / lanes;
  offer.suitability = (inspect ? kOtherTask : kOwnTask) * (between < 2 * turning_radius_m_ ? kTightTurns : 1);
  for (int lane = 0; lane < lanes; ++lane) {
    const Vector2d middle = at.north_east + (between * (lane + 0.5) - breadth / 2) * across;
    const Vector2d half = (lane % 2 == 0 ? 0.5 : -0.5) * length * along;
    offer.waypoints.push_back(waypoint(at, middle - half, config_.speed));
    offer.waypoints.push_back(waypoint(at, middle + half, config_.speed));
  }
  return offer;
}

std::vector<Field> fields(CircleConfig& c) {
  return {
      Field::real("radius_m", &c.radius_m, {0.5, 5e3}, "m", "Radius of the circle, where the task gives none."),
      Field::real("turns", &c.turns, {0.1, 1000}, "", "Number of turns, where the task gives none."),
      Field::real("speed", &c.speed, {0.01, 10}, "m/s", "Speed, where the mission point gives none."),
      Field::real("max_turns", &c.max_turns, {1, 1000}, "", "Maximum number of turns of a task.").was("most_turns")};
}

std::optional<BackSeatDriver::Offer> CircleDriver::offer(const Task& task, const MissionPoint& at,
                                                         const std::optional<Vector2d>& vehicle) const {
  if (task.name != "circle" && task.name != "inspect") return std::nullopt;
  TaskNumbers numbers(task);
  const double radius = numbers.take("radius_m", config_.radius_m, std::max(0.5, turning_radius_m_), 5e3);
  const double turns = numbers.take("turns", config_.turns, 0.1, config_.max_turns);
  numbers.refuse_others();
  const Vector2d towards = vehicle.value_or(at.north_east) - at.north_east;
  const double first = towards.norm() > 0 ? std::atan2(towards.y(), towards.x()) : 0;
  Offer offer{kOwnTask, {}};
  const auto corners = static_cast<int>(std::ceil(turns * kCircleSides));
  for (int i = 0; i <= corners; ++i) {
    const double angle = first + 2 * std::numbers::pi * std::min(turns, static_cast<double>(i) / kCircleSides);
    const Vector2d side(std::cos(angle), std::sin(angle));
    offer.waypoints.push_back(waypoint(at, at.north_east + radius * side, config_.speed));
  }
  return offer;
}

}  // namespace isobath
