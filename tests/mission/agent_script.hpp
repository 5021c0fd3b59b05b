// An agent under a script: it hears what the test says, when the test says so, and what it answers is kept.
#pragma once

#include <isobath/mission/messages/agent.hpp>
#include <vector>

namespace isobath {

inline Time at(double s) { return Time{} + seconds(s); }

class Script {
 public:
  explicit Script(Agent& agent) : agent_(agent) {}

  /// What it says to this alone, but for what it tells of its plans (LevelPlan), which says nothing new.
  std::vector<Message> hear(const Message& message, double s) {
    Outbox out;
    agent_.on_message(message, at(s), out);
    return keep(out);
  }
  std::vector<Message> tick(double s) {
    Outbox out;
    agent_.tick(at(s), out);
    return keep(out);
  }
  /// All it has said.
  std::vector<Message> said;

 private:
  std::vector<Message> keep(Outbox& out) {
    said.insert(said.end(), out.said().begin(), out.said().end());
    std::erase_if(out.said(), [](const Message& one) { return std::holds_alternative<LevelPlan>(one); });
    return out.said();
  }
  Agent& agent_;
};

template <class T>
std::vector<T> only(const std::vector<Message>& messages) {
  std::vector<T> result;
  for (const Message& m : messages) {
    if (const auto* t = std::get_if<T>(&m)) result.push_back(*t);
  }
  return result;
}

inline Navigation fix(double s, double north, double east, double heading_deg = 0, double speed = 0, double depth = 1) {
  Navigation n;
  n.time = at(s);
  const Angle psi = Angle::degrees(heading_deg);
  n.X_WB = {Rotation::from_heading(psi), {north, east, depth}};
  n.v_WB = Eigen::Vector3d(speed * cos(psi), speed * sin(psi), 0);
  return n;
}

/// A square with sides of 2 `half`.
inline Polygon square(double x, double y, double half) {
  return {{x - half, y - half}, {x + half, y - half}, {x + half, y + half}, {x - half, y + half}};
}

/// As a sweep has it, in L.
inline Obstacle obstacle(const Polygon& outline, double existence) {
  Obstacle o{};
  o.outline = outline;
  o.nearest = nearest_point(outline, Eigen::Vector2d::Zero());
  o.range_m = o.nearest.norm();
  o.existence = existence;
  o.centre.setZero();
  for (const Eigen::Vector2d& p : outline) o.centre += p / static_cast<double>(outline.size());
  o.covariance.setIdentity();
  return o;
}

inline MissionPoint point(double north, double east) {
  MissionPoint p;
  p.north_east = {north, east};
  return p;
}

}  // namespace isobath
