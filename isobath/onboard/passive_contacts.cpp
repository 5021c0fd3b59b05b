#include <cmath>
#include <fmt/format.h>
#include <isobath/onboard/passive_contacts.hpp>

namespace isobath {
namespace {

std::string direction_text(const Eigen::Vector2d& from, const Eigen::Vector2d& to) {
  const Eigen::Vector2d d = to - from;
  const int degrees =
      static_cast<int>(std::lround(Angle::radians(std::atan2(d.y(), d.x())).wrapped_positive().degrees()));
  return fmt::format("{:.0f} m off at {:03d}°", d.norm(), degrees % 360);
}

/// What the newest judgement says, for a decision.
Decision decision_on(const Contact& contact) {
  Decision decision{{}, "passive array", "sound", origin_text(contact)};
  decision.obstacle_number = contact.obstacle;
  if (contact.obstacle > 0) decision.obstacle = contact.nearest;
  return decision;
}

}  // namespace

std::string origin_text(const Contact& contact) {
  const std::string sound =
      fmt::format("a sound at {:.1f} Hz, heard in {} bearings, ", contact.frequency_hz, contact.bearings);
  switch (contact.origin) {
    case Contact::Origin::kObstacle:
      return sound + fmt::format("comes from obstacle {}, {}; probability {:.2f}", contact.obstacle,
                                 direction_text(contact.p_W, contact.nearest), contact.probability);
    case Contact::Origin::kNone:
      return sound + fmt::format("comes from no known obstacle; probability {:.2f}", contact.none);
    case Contact::Origin::kUnknown: break;
  }
  if (contact.likeliest == 0) return sound + "comes from an unknown place";
  return sound + fmt::format("may come from obstacle {} (probability {:.2f}) or from no known one ({:.2f})",
                             contact.likeliest, contact.probability, contact.none);
}

PassiveContacts::PassiveContacts(const ContactConfig& config, const ObstacleMemoryConfig& memory)
    : config_(config), memory_(memory), tracker_(config) {}

void PassiveContacts::on_bearing(const PassiveBearing& heard, const ListeningPose& pose) {
  if (!config_.on) return;
  here_ = pose.X_WB.translation.head<2>();
  tracker_.hear(heard, pose);
}

void PassiveContacts::on_scan(const ScanResult& scan, double sigma_m) {
  if (tracker_.bearings() == 0 || !scan.posed) return;
  const Detection& found = scan.detection;
  MemorySweep sweep{
      .time = found.time, .X_WL = level(found.X_WB), .sigma_m = {}, .obstacles = found.obstacles, .water = {}};
  if (sigma_m > 0) sweep.sigma_m = sigma_m;
  sweep.water = {found.cells, found.position, found.heading, found.free};
  sweep.jumped = jumped_;
  memory_.add(sweep);
}

void PassiveContacts::on_jump(const Eigen::Vector2d& by_W) {
  jumped_ += by_W;
  here_ += by_W;
  tracker_.move(by_W);
}

bool PassiveContacts::update(Time now, bool at_the_end) {
  if (!(at_the_end ? tracker_.bearings() > 0 : tracker_.is_due(now))) return false;
  tracker_.update(now, memory_.known(here_, config_.max_range_m));
  news_.clear();
  for (const Contact& contact : tracker_.contacts()) {
    std::uint64_t& told = told_[contact.number];
    if (told != contact.changes) news_.push_back(decision_on(contact));
    told = contact.changes;
  }
  return true;
}

std::optional<ContactOutcome> PassiveContacts::outcome() const {
  if (tracker_.bearings() == 0) return std::nullopt;
  const std::span<const Contact> contacts = tracker_.contacts();
  return ContactOutcome{tracker_.bearings(), tracker_.left_out(), {contacts.begin(), contacts.end()}};
}

}  // namespace isobath
