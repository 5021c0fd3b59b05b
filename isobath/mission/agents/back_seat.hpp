// BackSeatDriver: a planner that bids for the task of a mission point, and plans it when it gets the award (Ganesan
// 2015, 5.1; ledger S6-41).
//
// A task is one word and numbers: "survey length_m=80 breadth_m=40". A driver receives TaskCall, TaskAward and
// Navigation. It bids for the tasks that it can do, and sends its way-points when it gets the award. It does not bid
// for a task with an unknown number or a number out of range, and reports why (Decision): a task done differently than
// asked is worse than none. A driver does what it has bid, whatever it hears until the award. Way-points have the depth
// of the point, and its speed if it has one. `turning_radius_m`: turning radius of the vehicle.
#pragma once

#include <isobath/base/config.hpp>
#include <isobath/mission/messages/agent.hpp>
#include <map>
#include <string_view>

namespace isobath {

struct Task {
  std::string name;
  std::map<std::string, double, std::less<>> numbers;
};

/// On failure the reason: a word that is not name=number, a name that is given twice, a number that is not finite.
Result<Task, std::string> parse_task(std::string_view text);

/// Takes the numbers that a driver knows out of a task; those that are left at the end are unknown to it.
class TaskNumbers {
 public:
  explicit TaskNumbers(const Task& task) : task_(task), left_(task.numbers.begin(), task.numbers.end()) {}

  /// Throws Error if the number is out of range.
  double take(const char* name, double otherwise, double low, double high);
  /// Throws Error if a number is left.
  void refuse_others() const;

 private:
  [[nodiscard]] Place place(const std::string& name) const;
  const Task& task_;
  std::map<std::string, double, std::less<>> left_;
};

class BackSeatDriver : public Agent {
 public:
  explicit BackSeatDriver(std::string name) : name_(std::move(name)) {}

  void on_message(const Message& message, Time now, Outbox& out) final;
  void tick(Time, Outbox&) final {}

 protected:
  static constexpr double kOwnTask = 0.9;  ///< suitability for the driver's own kind of task
  /// The plan for a task that the driver can do.
  struct Offer {
    double suitability = 0;  ///< above 0, up to 1
    std::vector<Waypoint> waypoints;
    double drop_distance_m = 0;  ///< as in TaskPlan
    std::string what = {};       ///< more about the plan, for the decision
  };
  /// Empty where the driver has no such task. Throws Error where it has, but cannot do it as asked.
  [[nodiscard]] virtual std::optional<Offer> offer(const Task& task, const MissionPoint& at,
                                                   const std::optional<Eigen::Vector2d>& vehicle) const = 0;
  /// At the depth of the point, and with its speed if it has one; else with the driver's.
  static Waypoint waypoint(const MissionPoint& at, const Eigen::Vector2d& north_east, double speed);
  /// Any other message, for a driver whose plan depends on it.
  virtual void hear(const Message&) {}

 private:
  void on(const TaskCall& call, Time now, Outbox& out);
  void on(const TaskAward& award, Time now, Outbox& out);

  std::string name_;
  std::optional<TaskCall> call_;  ///< the last call that the driver bid for
  Offer offer_;                   ///< what it bid
  std::optional<Eigen::Vector2d> vehicle_;
};

/// "survey": lanes over a rectangle about the point, `length_m` along `heading_deg`, `breadth_m` across, at most
/// `spacing_m` between lanes; the first lane begins at the corner nearest to the vehicle. "inspect": the square about
/// the point. Lanes that are closer together than the vehicle's turns are wide lower the suitability.
struct SurveyConfig {
  double length_m = 60, breadth_m = 40, spacing_m = 10;  ///< where the task gives none
  double speed = 1.2;
  double max_total_m = 20'000;  ///< maximum total length of all lanes
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

/// "circle" and "inspect": clockwise around the point at `radius_m` for `turns` turns, from the side nearest to the
/// vehicle; the path keeps within 2 % of the radius. A circle tighter than the vehicle's turns is refused.
struct CircleConfig {
  double radius_m = 10, turns = 1;  ///< where the task gives none
  double speed = 0.8;
  double max_turns = 100;
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
