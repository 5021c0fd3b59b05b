#include <algorithm>
#include <cmath>
#include <isobath/perception/contact_tracker.hpp>
#include <limits>
#include <numbers>

namespace isobath {
namespace {

using Eigen::Vector2d;

constexpr double kFollow = 0.05;        // share of a new frequency in that of its line
constexpr double kGateSigmas = 5;       // of the direction of a line from one bearing to the next
constexpr double kLeastOwnShare = 0.1;  // of a bearing's own error that no average removes

double angle_from(double a, double b) { return std::remainder(b - a, 2 * std::numbers::pi); }

double squared(double x) { return x * x; }

}  // namespace

std::vector<Field> fields(ContactConfig& c) {
  return {
      Field::flag("on", &c.on, "Whether bearings of passive arrays are followed."),
      Field::real("gate_cells", &c.gate_cells, {0.5, 1000}, "1",
                  "Frequency cells of the array within which a bearing belongs to a line."),
      Field::real("move_m", &c.move_m, {0.05, 1000}, "m", "Bearings within this distance of each other become one."),
      Field::integer("min_bearings", &c.min_bearings, {1, 100000}, "1", "Bearings before a line is reported."),
      Field::real("bias_share", &c.bias_share, {0, 1}, "1",
                  "Share of a bearing's stated deviation that all bearings have in common, as a bias of the array."),
      Field::real("max_range_m", &c.max_range_m, {10, 1e5}, "m", "Farthest place of a sound."),
      Field::real("beyond_m", &c.beyond_m, {0, 1000}, "m",
                  "A machine may sit this far inside or behind the outline that the sonar sees of its hull."),
      Field::real("prior_none", &c.prior_none, {0.01, 0.99}, "1",
                  "Probability beforehand that a sound comes from none of the known obstacles."),
      Field::real("level", &c.level, {0.5, 0.999999}, "1",
                  "Probability from which on a sound is attached to an obstacle, or to none."),
      Field::real("interval_s", &c.interval_s, {0, 3600}, "s", "Shortest time between two judgements."),
      Field::real("drift_share", &c.drift_share, {0, 1}, "1",
                  "Drift of the position as a share of the way, where the navigation states no variance.")};
}

const char* to_text(Contact::Origin origin) {
  switch (origin) {
    case Contact::Origin::kObstacle: return "obstacle";
    case Contact::Origin::kNone: return "none";
    case Contact::Origin::kUnknown: break;
  }
  return "unknown";
}

ContactTracker::ContactTracker(const ContactConfig& config) : config_(config), lines_(kLines) {
  for (Line& line : lines_) line.places.reserve(kPlaces + 1);
  contacts_.reserve(kLines);
  from_.reserve(kPlaces);
}

// Lines --------------------------------------------------------------------------------------------------------------

void ContactTracker::hear(const PassiveBearing& heard, const ListeningPose& pose) {
  ++bearings_;
  const Pose X_WS = pose.X_WB * heard.X_BS;
  const Vector2d p_W = X_WS.translation.head<2>();
  if (place_ && !(pose.sigma_m > 0)) way_m_ += (p_W - *place_).norm();
  place_ = p_W;
  variance_m2_ = squared(pose.sigma_m);
  heading_sigma_ = pose.heading_sigma;
  const std::optional<Angle> bearing = bearing_in_world(heard, X_WS);
  Line* line = bearing ? line_of(heard, bearing->radians(), p_W) : nullptr;
  if (bearing && !line) line = new_line(heard);
  if (!line) {
    ++left_out_;
    return;
  }
  Contact& contact = line->contact;
  const double gain = std::max(kFollow, 1.0 / static_cast<double>(++contact.bearings));
  contact.frequency_hz += gain * (heard.frequency_hz - contact.frequency_hz);
  contact.snr_db = heard.snr_db;
  contact.last = heard.time;
  contact.p_W = p_W;
  line->last_bearing = bearing->radians();
  line->last_sigma = heard.sigma.radians();
  line->sigma = std::max(line->sigma, heard.sigma.radians());
  const double own_variance = std::max(1e-12, (1 - squared(config_.bias_share)) * squared(heard.sigma.radians()));
  add_place(*line,
            {p_W, bearing->radians(), 1 / own_variance, squared(kLeastOwnShare) * own_variance, variance_m2_, way_m_});
}

/// The line that this bearing follows best, by frequency and direction.
ContactTracker::Line* ContactTracker::line_of(const PassiveBearing& heard, double bearing, const Vector2d& p_W) {
  Line* best = nullptr;
  double least = std::numeric_limits<double>::infinity();
  for (Line& line : lines_) {
    if (line.contact.number == 0) continue;
    const double off_hz = std::abs(heard.frequency_hz - line.contact.frequency_hz);
    const double gate_hz = config_.gate_cells * heard.resolution_hz;
    const double off = std::abs(angle_from(line.last_bearing, bearing));
    const double gate =
        kGateSigmas * std::hypot(line.last_sigma, heard.sigma.radians()) + (p_W - line.contact.p_W).norm() / kNearest_m;
    const double distance = squared(off_hz / gate_hz) + squared(off / gate);
    if (off_hz > gate_hz || off > gate || distance >= least) continue;
    least = distance;
    best = &line;
  }
  return best;
}

/// A line that is free, or that was hardly heard and is silent; null: there is none.
ContactTracker::Line* ContactTracker::new_line(const PassiveBearing& heard) {
  auto at = std::find_if(lines_.begin(), lines_.end(), [](const Line& line) { return line.contact.number == 0; });
  if (at == lines_.end()) {
    at = std::find_if(lines_.begin(), lines_.end(), [&](const Line& line) {
      return line.contact.bearings < static_cast<std::uint64_t>(config_.min_bearings) &&
             to_seconds(heard.time - line.contact.last) > kSilent_s;
    });
  }
  if (at == lines_.end()) return nullptr;
  at->contact = {};
  at->contact.number = ++last_number_;
  at->contact.first = heard.time;
  at->sigma = 0;
  at->places.clear();
  return &*at;
}

void ContactTracker::add_place(Line& line, const Heard& heard) const {
  if (!line.places.empty() && (line.places.back().p_W - heard.p_W).norm() < config_.move_m) {
    return join(line.places.back(), heard);
  }
  line.places.push_back(heard);
  if (line.places.size() <= kPlaces) return;
  std::size_t nearest = 0;
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i + 2 < line.places.size(); ++i) {
    const double apart = (line.places[i + 1].p_W - line.places[i].p_W).norm();
    if (apart < least) nearest = i;
    least = std::min(least, apart);
  }
  join(line.places[nearest], line.places[nearest + 1]);
  line.places.erase(line.places.begin() + static_cast<std::ptrdiff_t>(nearest) + 1);
}

void ContactTracker::join(Heard& into, const Heard& other) {
  const double share = other.weight / (into.weight + other.weight);
  into.p_W += share * (other.p_W - into.p_W);
  into.bearing += share * angle_from(into.bearing, other.bearing);
  into.least_variance = std::min(into.least_variance, other.least_variance);
  into.variance_m2 += share * (other.variance_m2 - into.variance_m2);
  into.way_m += share * (other.way_m - into.way_m);
  into.weight += other.weight;
}

void ContactTracker::move(const Vector2d& by_W) {
  if (place_) *place_ += by_W;
  for (Line& line : lines_) {
    line.contact.p_W += by_W;
    for (Heard& heard : line.places) heard.p_W += by_W;
  }
}

// Origins ------------------------------------------------------------------------------------------------------------

bool ContactTracker::is_due(Time now) const {
  if (judged_ == bearings_) return false;
  return !updated_ || now < *updated_ || to_seconds(now - *updated_) >= config_.interval_s;
}

void ContactTracker::update(Time now, std::span<const RememberedObstacle> known) {
  updated_ = now;
  judged_ = bearings_;
  gather(known);
  contacts_.clear();
  for (Line& line : lines_) {
    const Contact& contact = line.contact;
    if (contact.number == 0 || contact.bearings < static_cast<std::uint64_t>(config_.min_bearings)) continue;
    judge(line);
    decide(line.contact);
    contacts_.push_back(contact);
  }
  std::sort(contacts_.begin(), contacts_.end(), [](const Contact& a, const Contact& b) { return a.number < b.number; });
}

/// The pieces of one obstacle share its number.
void ContactTracker::gather(std::span<const RememberedObstacle> known) {
  std::size_t count = 0;
  for (const RememberedObstacle& o : known) {
    const auto end = known_.begin() + static_cast<std::ptrdiff_t>(count);
    auto at = std::find_if(known_.begin(), end, [&](const Known& k) { return k.number == o.number; });
    if (at == end) {
      if (count == known_.size()) known_.emplace_back();
      at = known_.begin() + static_cast<std::ptrdiff_t>(count++);
      at->number = o.number;
      at->pieces.clear();
      at->margin_m = 0;
    }
    at->pieces.push_back(&o.outline_W);
    at->margin_m = std::max(at->margin_m, o.margin_m);
  }
  known_.resize(count);
}

/// The bearings of a line with their own errors, for the posterior. Returns the deviation that they have in common.
double ContactTracker::place_bearings(const Line& line) {
  from_.clear();
  for (const Heard& heard : line.places) {
    const double unmeasured_m = config_.drift_share * (way_m_ - heard.way_m);
    const double drift2 = std::abs(variance_m2_ - heard.variance_m2) + squared(unmeasured_m);
    const double variance = std::max(1 / heard.weight, heard.least_variance);
    from_.push_back({heard.p_W, heard.bearing, std::sqrt(variance), std::sqrt(drift2)});
  }
  return std::hypot(config_.bias_share * line.sigma, heading_sigma_);
}

void ContactTracker::judge(Line& line) {
  const double bias = place_bearings(line);
  Contact& contact = line.contact;
  contact.bearing = Angle::radians(from_.back().bearing).wrapped_positive();
  contact.sigma = Angle::radians(std::hypot(from_.back().sigma, bias));

  BearingPosterior posterior(from_, bias, config_.max_range_m);
  SoundPlace place;
  const double none = std::log(config_.prior_none) + posterior.log_evidence_of_none(place);
  double largest = none;
  evidence_.clear();
  for (const Known& obstacle : known_) {
    const double prior = (1 - config_.prior_none) / static_cast<double>(known_.size());
    const SoundRegion region{obstacle.pieces, config_.beyond_m + obstacle.margin_m};
    evidence_.push_back(std::log(prior) + posterior.log_evidence(region));
    largest = std::max(largest, evidence_.back());
  }
  double sum = std::exp(none - largest);
  for (const double e : evidence_) sum += std::exp(e - largest);
  contact.none = std::exp(none - largest) / sum;
  contact.likeliest = 0;
  contact.probability = 0;
  for (std::size_t i = 0; i < evidence_.size(); ++i) {
    const double probability = std::exp(evidence_[i] - largest) / sum;
    if (probability <= contact.probability) continue;
    contact.probability = probability;
    contact.likeliest = known_[i].number;
    contact.nearest = nearest_of(known_[i], contact.p_W);
  }
  const double half_trace = 0.5 * place.covariance.trace();
  const double larger = half_trace + std::sqrt(std::max(0.0, squared(half_trace) - place.covariance.determinant()));
  contact.place.reset();
  if (std::sqrt(larger) <= kPlaced * (place.mean - contact.p_W).norm()) contact.place = place;
}

Vector2d ContactTracker::nearest_of(const Known& obstacle, const Vector2d& p_W) {
  Vector2d nearest = p_W;
  double least = std::numeric_limits<double>::infinity();
  for (const Polygon* piece : obstacle.pieces) {
    const Vector2d point = nearest_point(*piece, p_W);
    if ((point - p_W).norm() < least) nearest = point;
    least = std::min(least, (point - p_W).norm());
  }
  return nearest;
}

void ContactTracker::decide(Contact& contact) const {
  const auto was = std::pair(contact.origin, contact.obstacle);
  contact.origin = contact.probability >= config_.level ? Contact::Origin::kObstacle
                   : contact.none >= config_.level      ? Contact::Origin::kNone
                                                        : Contact::Origin::kUnknown;
  const bool attached = contact.origin == Contact::Origin::kObstacle;
  contact.obstacle = attached ? contact.likeliest : 0;
  if (attached && contact.attached_after == 0) contact.attached_after = contact.bearings;
  if (was != std::pair(contact.origin, contact.obstacle)) ++contact.changes;
}

}  // namespace isobath
