#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <isobath/geometry/polygon.hpp>
#include <isobath/map/occupancy/obstacle_numbers.hpp>
#include <isobath/onboard/passive_contacts.hpp>
#include <numeric>
#include <tuple>
#include <utility>

namespace isobath {
namespace {

std::string direction_text(const Eigen::Vector2d& from, const Eigen::Vector2d& to) {
  const Eigen::Vector2d d = to - from;
  const int degrees =
      static_cast<int>(std::lround(Angle::radians(std::atan2(d.y(), d.x())).wrapped_positive().degrees()));
  return fmt::format("{:.0f} m off at {:03d}°", d.norm(), degrees % 360);
}

/// Obstacles whose outlines are this near to each other are one, for a sound: the scans show a hull in parts, which
/// have numbers of their own until they grow together. It is the distance within which ObstacleNumbers takes two for
/// one.
constexpr double kTouching_m = ObstacleNumbers::kSame_m;

/// Gives touching obstacles one number: that of the obstacle that a sound is attached to, else of the one seen last.
void join_touching(std::vector<RememberedObstacle>& known, std::span<const Contact> contacts) {
  std::vector<std::size_t> group(known.size());
  std::iota(group.begin(), group.end(), std::size_t{0});
  for (std::size_t i = 0; i < known.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      const bool one =
          known[i].number == known[j].number || gap_between(known[i].outline_W, known[j].outline_W) <= kTouching_m;
      if (one && group[i] != group[j]) std::replace(group.begin(), group.end(), group[i], group[j]);
    }
  }
  const auto is_attached = [&](int number) {
    return std::any_of(contacts.begin(), contacts.end(), [&](const Contact& c) { return c.obstacle == number; });
  };
  std::map<std::size_t, const RememberedObstacle*> first;
  for (std::size_t i = 0; i < known.size(); ++i) {
    const RememberedObstacle*& named = first[group[i]];
    const auto rank = [&](const RememberedObstacle& o) {
      return std::tuple(is_attached(o.number), o.last_seen, -o.number);
    };
    if (!named || rank(*named) < rank(known[i])) named = &known[i];
  }
  std::map<std::size_t, int> numbers;
  for (const auto& [index, named] : first) numbers[index] = named->number;
  for (std::size_t i = 0; i < known.size(); ++i) known[i].number = numbers[group[i]];
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
  std::vector<RememberedObstacle> known = memory_.known(here_, config_.max_range_m);
  join_touching(known, tracker_.contacts());
  tracker_.update(now, known);
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
