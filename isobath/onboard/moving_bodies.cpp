#include <algorithm>
#include <cmath>
#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <isobath/geometry/deviation.hpp>
#include <isobath/onboard/moving_bodies.hpp>
#include <numbers>

namespace isobath {
namespace {

constexpr double kSigmas = 2;       // of echoes about the centre and of the position, that a place holds
constexpr double kProbably = 0.5;   // probability of lying still from which a body no longer moves
constexpr double kSignificant = 3;  // standard deviations of the speed, above zero
constexpr std::size_t kMaxHeads = 16;
constexpr std::uint32_t kDoubtReadings = 6;  // before that, nothing is known of its motion
constexpr double kFast = 1.1;                // of the speed that a body hardly exceeds
constexpr double kHalf = 0.5;
constexpr double kOften_s = 2;     // between the readings of a body, on average
constexpr double kThinnest = 0.2;  // m: half of the least side of an outline
constexpr double kEven = 1.732;  // half of a line over the standard deviation of echoes that are spread evenly over it
constexpr int kCorners = 8;      // of an outline about the ellipse
// The uncertainty of its position lets an outline grow by at most this. Bodies out of view mostly keep their velocity;
// outlines that grow with all that they could do leave no water among many of them.
constexpr double kMostGrowth_m = 1.5;
// Where the position of a body is less certain, echoes there are those of an obstacle like any other.
constexpr double kSure_m = 3;

double position_sigma(const BodyTrack& track) {
  return greatest_deviation(track.filter.estimate().covariance.topLeftCorner<2, 2>());
}

Eigen::Vector2d level_body(const Pose& X_LW, const Eigen::Vector2d& p_W) {
  return (X_LW * Eigen::Vector3d(p_W.x(), p_W.y(), 0)).head<2>();
}

/// Whether an edge of the fan's sector cuts the disc: the look shows a part of a body only, which is no reading of it.
bool is_cut(const Ping& ping, const Pose& X_WB, const Eigen::Vector2d& centre_W, double radius_m) {
  const Pose X_WS = X_WB * ping.X_BS;
  const Eigen::Vector3d centre(centre_W.x(), centre_W.y(), X_WS.translation.z());
  const Eigen::Vector2d to_S = (X_WS.inverse() * centre).head<2>();
  const Angle azimuth = Angle::radians(std::atan2(to_S.y(), to_S.x()));
  const double half = std::atan2(radius_m, to_S.norm());
  const auto is_within = [&](Angle edge) { return std::abs((azimuth - edge).wrapped().radians()) <= half; };
  return is_within(ping.fan->azimuth.front()) || is_within(ping.fan->azimuth.back());
}

}  // namespace

std::vector<Field> fields(MovingBodiesConfig& c) {
  std::vector<Field> all = {
      Field::flag("on", &c.on, "Whether bodies are tracked, and those that move kept out of the maps."),
      Field::real("min_speed", &c.min_speed, {0.01, 10}, "m/s", "A slower body is taken to lie still."),
      Field::real("max_still", &c.max_still, {1e-6, 0.5}, "1",
                  "A body moves only if it lies still with less than this probability."),
      Field::real("max_speed_sigma", &c.max_speed_sigma, {0.01, 10}, "m/s",
                  "A body is found to move only if the standard deviation of its speed is at most this."),
      Field::integer("min_readings", &c.min_readings, {2, 1000}, "1", "Readings before a body may be found to move."),
      Field::real("may_move", &c.may_move, {0, 0.5}, "1",
                  "A body that lies still with less than this probability is not remembered when it leaves the view."),
      Field::real("margin_m", &c.margin_m, {0, 20}, "m",
                  "How far echoes may lie outside of the place of a moving body and still be its own."),
      Field::real("max_sigma_m", &c.max_sigma_m, {0.1, 100}, "m",
                  "A moving body whose position is less certain, standard deviation, is no obstacle any more."),
      Field::integer(
          "max_readings", &c.tracker.max_readings, {1, 100000}, "1",
          "Readings of a look that are tracked at most, so that its time is bounded; the others are counted."),
  };
  for (Field& field : fields(c.looks)) all.push_back(std::move(field));
  return all;
}

MovingBodies::MovingBodies(const MovingBodiesConfig& config)
    : config_(config), tracker_(config.tracker, config.motion) {}

BodyLooks& MovingBodies::looks_of(const Ping& ping) {
  const auto same = [&](const Head& head) {
    return head.X_BS.translation == ping.X_BS.translation &&
           head.X_BS.rotation.quaternion().coeffs() == ping.X_BS.rotation.quaternion().coeffs();
  };
  const auto head = std::find_if(heads_.begin(), heads_.end(), same);
  if (head != heads_.end()) return head->looks;
  if (heads_.size() == kMaxHeads) heads_.erase(heads_.begin());  // a mount that turns is a new one in each ping
  return heads_.emplace_back(Head{ping.X_BS, BodyLooks(config_.looks)}).looks;
}

void MovingBodies::look(const Ping& ping, const EchoDecisions& decisions, const Pose& X_WB,
                        const std::optional<Water>& water) {
  if (!config_.on) return;
  own_W_ = X_WB.translation.head<2>();
  BodyLooks& looks = looks_of(ping);
  const BodyLook* look = looks.add(ping, decisions, X_WB);
  if (look && tracker_.update(look->time(), look->readings(), *look)) {
    time_ = look->time();
    judge(water);
  }
  boxes_.clear();
  for_each_moving(std::min(kSure_m, config_.max_sigma_m), [&](const BodyTrack& track) {
    const Place place = place_of(track, ping.time);
    if (!is_heard(track, ping) && !is_cut(ping, X_WB, place.centre_W, greatest_deviation(place.shape))) return;
    looks.find_bodies([&](const Eigen::Vector2d& p_W) { return place.contains(p_W); }, boxes_);
  });
}

MovingBodies::Place MovingBodies::place_of(const BodyTrack& track, Time time) const {
  const MotionFilter::Estimate e = track.filter.estimate();
  const double ahead_s = to_seconds(time - time_);
  const double grown = config_.margin_m + kSigmas * std::min(position_sigma(track), kSure_m);
  return {e.mean.head<2>() + ahead_s * e.mean.segment<2>(2),
          kSigmas * kSigmas * track.extent + grown * grown * Eigen::Matrix2d::Identity(), own_W_};
}

std::optional<Cell> MovingBodies::Water::cell_at(const Eigen::Vector2d& p_W) const {
  return grid.cell_at(level_body(level(X_WB).inverse(), p_W));
}

bool MovingBodies::Water::is_free(const Eigen::Vector2d& p_W) const {
  const auto cell = cell_at(p_W);
  return cell && grid.is_free(*cell);
}

bool MovingBodies::Water::is_unoccupied(const Eigen::Vector2d& p_W) const {
  const auto cell = cell_at(p_W);
  return cell && grid.log_odds()[grid.cells().index(*cell)] <= grid.log_odds_prior();
}

/// On a surface that lies still, flat or convex, a glint slides by the part of the vehicle's way that lies along the
/// surface, or less. All these ways end on a disc whose diameter is the way of the vehicle.
bool MovingBodies::may_be_glint(const Eigen::Vector2d& moved_W, const Eigen::Vector2d& own_way_W, double sigma) const {
  const double off = (moved_W - own_way_W / 2).norm();
  return off <= own_way_W.norm() / 2 + config_.margin_m + kSigmas * sigma;
}

bool MovingBodies::begins_to_move(const BodyTrack& track, const Body& body, const Water& water) const {
  if (static_cast<int>(track.readings) < config_.min_readings || body.trail.empty()) return false;
  if (track.filter.probability(MotionFilter::kStill) > config_.max_still) return false;
  const MotionFilter::Estimate e = track.filter.estimate();
  const Eigen::Vector2d velocity = e.mean.segment<2>(2);
  const double sigma = greatest_deviation(e.covariance.block<2, 2>(2, 2));
  if (sigma > config_.max_speed_sigma || velocity.norm() < std::max(config_.min_speed, kSignificant * sigma))
    return false;
  const Place& then = body.trail.front();
  const Eigen::Vector2d now_W = e.mean.head<2>();
  const bool glint = may_be_glint(now_W - then.centre_W, own_W_ - then.own_W, position_sigma(track));
  const Eigen::Vector2d along = velocity.normalized();
  const double half = kSigmas * std::sqrt(std::max(along.dot(track.extent * along), 0.0));
  const Eigen::Vector2d ahead_W = now_W + (half + config_.margin_m + water.grid.cells().cell_m) * along;
  const bool free = water.is_free(ahead_W);
  // Far away the grid learns late that water is free. A track of rare looks may join several things that lie still.
  const bool often = to_seconds(track.last - track.first) < kOften_s * track.readings;
  if (!free && (glint || !often || !water.is_unoccupied(ahead_W))) return false;
  // It must have left its place, which far away is as large as a beam is wide; half of it, if the water ahead is free.
  const double scale = glint || !free ? 1 : kHalf;
  return !then.contains(now_W, scale) && !then.contains(now_W - own_W_ + then.own_W, scale);
}

bool MovingBodies::lies_still(const BodyTrack& track) const {
  return track.filter.probability(MotionFilter::kStill) > kProbably ||
         track.filter.estimate().mean.segment<2>(2).norm() < config_.min_speed / 2;
}

void MovingBodies::add_to(Counts& counts, const Body& body) {
  ++counts.confirmed;
  counts.slow += body.speed < kSlow ? 1 : 0;
}

MovingBodies::Counts MovingBodies::counts() const {
  Counts all = ended_;
  for (const auto& [number, body] : bodies_) add_to(all, body);
  all.left_out += tracker_.counts().above_max_readings + tracker_.counts().above_max_tracks;
  return all;
}

/// Which tracks move now.
void MovingBodies::judge(const std::optional<Water>& water) {
  const auto tracks = tracker_.tracks();
  for (const BodyTrack& track : tracks) take_over(track);
  const auto number = [](const BodyTrack& track) { return track.number; };
  for (auto body = bodies_.begin(); body != bodies_.end();) {
    if (std::ranges::binary_search(tracks, body->first, {}, number)) {
      ++body;
      continue;
    }
    add_to(ended_, body->second);
    if (body->second.may_move) leave_all(body->second);
    body = bodies_.erase(body);
  }
  for (const BodyTrack& track : tracks) {
    if (!track.confirmed) continue;
    Body& body = bodies_[track.number];
    body.trail.reserve(kTrail);
    if (track.last == time_) {
      if (body.trail.size() == kTrail) body.trail.erase(body.trail.begin());
      body.trail.push_back(place_of(track, time_));
      body.speed = track.filter.estimate().mean.segment<2>(2).norm();
      body.may_move = may_move(track);
    }
    // A track that jumps from one body to another is not known to move.
    body.moves = body.moves && body.speed <= kFast * config_.motion.max_speed;
    if (body.moves) {
      if (!lies_still(track)) body.moved = time_;
      body.moves = to_seconds(time_ - body.moved) < kStopped_s;
    } else if (water && begins_to_move(track, body, *water)) {
      body.moves = true;
      body.moved = time_;
      ++ended_.moving;
    }
    if (body.moves) {
      moved_ = time_;
      leave_trail(body, track);
    } else if (body.may_move && to_seconds(time_ - track.last) > kForgotten_s) {
      leave_all(body);
    }
  }
}

/// Two tracks were one body: what is known of the younger one holds for the other.
void MovingBodies::take_over(const BodyTrack& track) {
  const auto younger = track.confirmed ? bodies_.find(track.merged) : bodies_.end();
  if (younger == bodies_.end() || !younger->second.moves) return;
  Body& body = bodies_[track.number];
  body.moves = true;
  body.moved = std::max(body.moved, younger->second.moved);
  body.trail.insert(body.trail.begin(), younger->second.trail.begin(), younger->second.trail.end());
  younger->second.trail.clear();
  younger->second.moves = false;
}

bool MovingBodies::may_move(const BodyTrack& track) const {
  return moved_ && to_seconds(time_ - *moved_) < kTraffic_s && track.readings >= kDoubtReadings &&
         track.filter.probability(MotionFilter::kStill) < config_.may_move;
}

void MovingBodies::leave_all(Body& body) {
  for (const Place& place : body.trail) wakes_.push_back({place, time_});
  body.trail.clear();
  if (wakes_.size() > kWakes) wakes_.erase(wakes_.begin(), wakes_.end() - static_cast<std::ptrdiff_t>(kWakes));
}

/// What the body has left was water: the maps took in part of the body there.
void MovingBodies::leave_trail(Body& body, const BodyTrack& track) {
  const Eigen::Vector2d now = track.filter.position();
  const auto left = std::stable_partition(body.trail.begin(), body.trail.end(),
                                          [&](const Place& place) { return place.contains(now); });
  for (auto place = left; place != body.trail.end(); ++place) wakes_.push_back({*place, time_});
  if (wakes_.size() > kWakes) wakes_.erase(wakes_.begin(), wakes_.end() - static_cast<std::ptrdiff_t>(kWakes));
  body.trail.erase(left, body.trail.end());
}

void MovingBodies::Place::move(const Eigen::Vector2d& by_W) {
  centre_W += by_W;
  own_W += by_W;
}

bool MovingBodies::Place::contains(const Eigen::Vector2d& p_W, double scale) const {
  const Eigen::Vector2d off = p_W - centre_W;
  return off.dot(shape.inverse() * off) <= scale * scale;
}

/// A fan that shows nothing of a body hears another one in its place. A scanning head knows only when its sector ends.
bool MovingBodies::is_heard(const BodyTrack& track, const Ping& ping) const {
  return ping.fan->beams() == 1 || track.last == ping.time;
}

template <class Use>
void MovingBodies::for_each_moving(double max_sigma_m, Use use) const {
  for (const BodyTrack& track : tracker_.tracks()) {
    const auto body = bodies_.find(track.number);
    if (body != bodies_.end() && body->second.moves && position_sigma(track) <= max_sigma_m) use(track);
  }
}

int MovingBodies::withhold_box(const Ping& ping, const EchoBox& box, EchoDecisions& decisions) {
  const auto bin_at = [&](double range_m) {
    return static_cast<int>(
        std::clamp<double>((range_m - ping.window.start_m) / ping.window.bin_m, 0, ping.window.bins));
  };
  const int first = bin_at(box.near_m), end = bin_at(box.far_m);
  const std::vector<Angle>& azimuth = ping.fan->azimuth;
  const auto low = std::lower_bound(azimuth.begin(), azimuth.end(), box.low);
  int withheld = 0;
  for (auto beam = low; beam != azimuth.end() && *beam <= box.high; ++beam) {
    const int b = static_cast<int>(beam - azimuth.begin());
    for (int bin = first; bin < end; ++bin) {
      if (!decisions.usable(bin) || !decisions.hit(b, bin)) continue;
      decisions.set_blind(b, bin);
      ++withheld;
    }
  }
  return withheld;
}

int MovingBodies::withhold(const Ping& ping, const Pose& X_WB, EchoDecisions& decisions) const {
  int withheld = 0;
  for (const EchoBox& box : boxes_) withheld += withhold_box(ping, box, decisions);
  const Pose X_WS = X_WB * ping.X_BS;
  for_each_moving(std::min(kSure_m, config_.max_sigma_m), [&](const BodyTrack& track) {
    const Place place = place_of(track, ping.time);
    if (!is_heard(track, ping) && !is_cut(ping, X_WB, place.centre_W, greatest_deviation(place.shape))) return;
    const Eigen::Matrix2d inverse = place.shape.inverse();
    const Eigen::Vector2d to = place.centre_W - X_WS.translation.head<2>();
    for (int b = 0; b < decisions.beams(); ++b) {
      const Angle a = ping.fan->azimuth[b];
      const Eigen::Vector2d u = (X_WS.rotation * Eigen::Vector3d(cos(a), sin(a), 0)).head<2>();
      // Slant ranges s at which s u lies in the ellipse: (s u - to)' inverse (s u - to) <= 1.
      const double uu = u.dot(inverse * u), ut = u.dot(inverse * to), tt = to.dot(inverse * to);
      const double root2 = ut * ut - uu * (tt - 1);
      if (!(root2 > 0) || !(uu > 0)) continue;
      const double root = std::sqrt(root2);
      withheld += withhold_box(ping, {a, a, (ut - root) / uu, (ut + root) / uu + ping.window.bin_m}, decisions);
    }
  });
  return withheld;
}

void MovingBodies::clear_trails(BodyGrid& grid, Time time, const Pose& X_WB) {
  std::erase_if(wakes_, [&](const Wake& wake) { return to_seconds(time - wake.left) > kWake_s; });
  const Pose X_LW = level(X_WB).inverse();
  const Eigen::Rotation2Dd R_WG((X_WB.rotation.heading() - grid.heading()).radians());
  const Time forgotten = time - seconds(kForgotten_s);
  const std::span<double> log_odds = grid.log_odds();
  const CartesianGrid& cells = grid.cells();
  for (Wake& wake : wakes_) {
    const Eigen::Vector2d centre = grid.from_level_body(level_body(X_LW, wake.place.centre_W));
    const Eigen::Matrix2d inverse = wake.place.shape.inverse();
    const double reach = greatest_deviation(wake.place.shape);
    const auto cell_at = [&](double at, int count) {
      return static_cast<int>(std::clamp<double>(std::floor(at / cells.cell_m), 0, count));
    };
    const int x_end = cell_at(centre.x() + reach + cells.cell_m, cells.cells_x);
    const int y_end = cell_at(centre.y() + reach + cells.cell_m, cells.cells_y);
    for (int x = cell_at(centre.x() - reach, cells.cells_x); x < x_end; ++x) {
      for (int y = cell_at(centre.y() - reach, cells.cells_y); y < y_end; ++y) {
        const std::size_t i = cells.index({x, y});
        const Eigen::Vector2d off = R_WG * (cells.centre({x, y}) - centre);
        if (off.dot(inverse * off) > 1) continue;
        if (wake.is_new || grid.hits(i) == 0 || grid.last_hit(i) < forgotten)
          log_odds[i] = std::min(log_odds[i], grid.log_odds_prior());
      }
    }
    wake.is_new = false;
  }
}

void MovingBodies::mark_doubtful(Time time, const Pose& X_WB, std::vector<Obstacle>& obstacles) const {
  const Pose X_WL = level(X_WB);
  for (const BodyTrack& track : tracker_.tracks()) {
    const auto body = bodies_.find(track.number);
    if (body == bodies_.end() || body->second.moves || !body->second.may_move) continue;
    const Place place = place_of(track, time);
    const MotionFilter::Estimate e = track.filter.estimate();
    for (Obstacle& o : obstacles) {
      const Eigen::Vector3d centre_W = X_WL * Eigen::Vector3d(o.centre.x(), o.centre.y(), 0);
      if (o.may_move || !place.contains(centre_W.head<2>())) continue;
      o.may_move = true;
      o.motion = {e.mean.segment<2>(2), e.covariance.topLeftCorner<2, 2>(), e.covariance.block<2, 2>(2, 2), 0};
    }
  }
}

std::vector<Obstacle> MovingBodies::obstacles(Time time, const Pose& X_WB) const {
  std::vector<Obstacle> out;
  const Pose X_WL = level(X_WB), X_LW = X_WL.inverse();
  const Angle heading = X_WB.rotation.heading();
  const Eigen::Matrix2d R_LW = Eigen::Rotation2Dd(-heading.radians()).toRotationMatrix();
  for_each_moving(config_.max_sigma_m, [&](const BodyTrack& track) {
    const MotionFilter::Estimate e = track.filter.estimate();
    const Eigen::Matrix2d position = e.covariance.topLeftCorner<2, 2>();
    const double grown_m = std::min(position_sigma(track), kMostGrowth_m);
    const Eigen::Vector2d velocity = e.mean.segment<2>(2);
    const Eigen::Vector2d centre = level_body(X_LW, e.mean.head<2>() + to_seconds(time - time_) * velocity);
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> axes(track.extent);
    Obstacle o;
    std::vector<Eigen::Vector2d> corners;
    const auto half = [&](int i) {
      return std::max(kThinnest, kEven * std::sqrt(std::max(axes.eigenvalues()[i], 0.0))) + grown_m;
    };
    for (int i = 0; i < kCorners; ++i) {
      const double angle = (2 * i + 1) * std::numbers::pi / kCorners, grown = 1 / std::cos(std::numbers::pi / kCorners);
      corners.emplace_back(centre + grown * (R_LW * (std::cos(angle) * half(0) * axes.eigenvectors().col(0) +
                                                     std::sin(angle) * half(1) * axes.eigenvectors().col(1))));
    }
    o.outline = convex_hull(std::move(corners));
    o.nearest = nearest_point(o.outline, Eigen::Vector2d::Zero());
    o.range_m = o.nearest.norm();
    o.bearing = Angle::radians(std::atan2(o.nearest.y(), o.nearest.x())).wrapped_positive();
    o.existence = track.existence;
    o.centre = centre;
    o.covariance = R_LW * track.extent * R_LW.transpose();
    o.hits = static_cast<std::uint32_t>(track.extent_weight);
    o.last_hit = track.last;
    o.motion = {velocity, position, e.covariance.block<2, 2>(2, 2), track.number};
    out.push_back(std::move(o));
  });
  return out;
}

void MovingBodies::shift(const Eigen::Vector2d& by_W) {
  tracker_.shift(by_W);
  for (auto& [number, body] : bodies_) {
    for (Place& place : body.trail) place.move(by_W);
  }
  for (Wake& wake : wakes_) wake.place.move(by_W);
}

void MovingBodies::restart() {
  ended_ = counts();
  heads_.clear();
  bodies_.clear();
  wakes_.clear();
  moved_.reset();
  tracker_ = BodyTracker(config_.tracker, config_.motion);
}

}  // namespace isobath
