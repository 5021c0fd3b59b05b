// Back-seat drivers: planners that offer to do what a mission point asks for, and do it when they are taken (Ganesan
// 2015, 5.1; ledger S6-41).
//
// A task is one word and numbers: "survey length_m=80 breadth_m=40". A driver hears TaskCall, TaskAward and Navigation;
// it bids for what it can do, and says its way-points when the award is its own. It does not bid for a task with a
// number that it does not know, or out of range, and says so (Decision): a task done differently than asked is worse
// than none. Way-points have the depth of the point, and its speed if it has one. `turning_radius_m` is the vehicle's.
#pragma once

#include <isobath/base/config.hpp>
#include <isobath/mission/agent.hpp>
#include <map>
#include <string_view>

namespace isobath {

struct Task {
  std::string name;
  std::map<std::string, double, std::less<>> numbers;
};

/// The reason why not: a word that is no name=number, a name twice, a number that is not finite.
Result<Task, std::string> parse_task(std::string_view text);

class BackSeatDriver : public Agent {
 public:
  explicit BackSeatDriver(std::string name) : name_(std::move(name)) {}

  void hear(const Message& message, Time now, Outbox& out) final;
  void tick(Time, Outbox&) final {}

 protected:
  /// What it makes of a task that it can do.
  struct Offer {
    double suitability = 0;  ///< above 0, up to 1
    std::vector<Waypoint> waypoints;
  };
  /// Empty: not a task of this driver. Throws Error where it is one, but cannot be done as asked.
  [[nodiscard]] virtual std::optional<Offer> offer(const Task& task, const MissionPoint& at,
                                                   const std::optional<Eigen::Vector2d>& vehicle) const = 0;

 private:
  void take(const TaskCall& call, Time now, Outbox& out);
  void take(const TaskAward& award, Time now, Outbox& out);

  std::string name_;
  std::optional<TaskCall> call_;  ///< the last that it has bid for
  std::optional<Eigen::Vector2d> vehicle_;
};

/// "survey": lanes over a rectangle about the point, the first at its corner nearest to the vehicle: length_m along
/// heading_deg, breadth_m across, spacing_m or less between lanes. "inspect": the square about it. Lanes nearer than
/// its turns are wide make it less suitable.
struct SurveyConfig {
  double length_m = 60, breadth_m = 40, spacing_m = 10;  ///< where the task does not say
  double speed = 1.2;
  double most_m = 20'000;  ///< of all lanes
};
std::vector<Field> fields(SurveyConfig& config);

class SurveyDriver final : public BackSeatDriver {
 public:
  SurveyDriver(const SurveyConfig& config, double turning_radius_m)
      : BackSeatDriver("survey"), config_(config), turning_radius_m_(turning_radius_m) {}

 private:
  [[nodiscard]] std::optional<Offer> offer(const Task& task, const MissionPoint& at,
                                           const std::optional<Eigen::Vector2d>& vehicle) const override;
  SurveyConfig config_;
  double turning_radius_m_;
};

/// "circle" and "inspect": round the point at radius_m, clockwise, so many turns, from its side that is nearest to the
/// vehicle; the way keeps within 2 % of the radius. Circles tighter than its turns cannot be done.
struct CircleConfig {
  double radius_m = 10, turns = 1;  ///< where the task does not say
  double speed = 0.8;
  double most_turns = 100;
};
std::vector<Field> fields(CircleConfig& config);

class CircleDriver final : public BackSeatDriver {
 public:
  CircleDriver(const CircleConfig& config, double turning_radius_m)
      : BackSeatDriver("circle"), config_(config), turning_radius_m_(turning_radius_m) {}

 private:
  [[nodiscard]] std::optional<Offer> offer(const Task& task, const MissionPoint& at,
                                           const std::optional<Eigen::Vector2d>& vehicle) const override;
  CircleConfig config_;
  double turning_radius_m_;
};

}  // namespace isobath
