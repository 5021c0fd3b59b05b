#include <algorithm>
#include <isobath/base/error.hpp>
#include <isobath/map/spherical/spherical_grid.hpp>

namespace isobath {
namespace {

using Eigen::Vector3d;

double logit(double p) { return std::log(p / (1 - p)); }

void check_spherical(const SphericalGridConfig& c) {
  const auto refuse = [](const char* key, const char* problem, const char* allowed) {
    throw Error(problem, {{}, {}, {}, {}, key}, allowed);
  };
  if (!(c.min_layer_m > 0) || !std::isfinite(c.min_layer_m)) refuse("min_layer_m", "no thickness", "above 0 m");
  if (!(c.range_m > c.min_layer_m) || !std::isfinite(c.range_m)) refuse("range_m", "no room", "above min_layer_m");
  if (!(c.prior > 0 && c.prior < c.occupied && c.occupied < 1)) {
    refuse("occupied", "unseen water would be an obstacle", "above prior, below 1");
  }
  if (!(c.max_log_odds > std::abs(logit(c.occupied)))) refuse("max_log_odds", "no cell could be occupied", "");
  if (!(c.rebin_at > 0 && c.rebin_at <= 2)) refuse("rebin_at", "out of range", "above 0, up to 2 layers");
}

/// Turns a vector about the polar axis; azimuth grows.
Vector3d turned_about_pole(const Vector3d& v, Angle by) {
  const double c = cos(by), s = sin(by);
  return {c * v.x() - s * v.y(), s * v.x() + c * v.y(), v.z()};
}

}  // namespace

std::vector<Field> fields(SphericalGridConfig& c) {
  using Merging = SphericalGridConfig::Merging;
  return {
      Field::real("min_layer_m", &c.min_layer_m, {0.01, 10}, "m",
                  "Thickness of the nearest layers: the sonar's resolution.")
          .was("finest_m"),
      Field::degrees("bucket_deg", &c.bucket, {0.25, 30}, "Width of a direction; a divisor of 180."),
      Field::real("range_m", &c.range_m, {1, 2000}, "m", "Cells farther from the vehicle are dropped."),
      Field::real("prior", &c.prior, {1e-6, 0.4}, "1", "Probability that an unseen cell is occupied."),
      Field::real("occupied", &c.occupied, {1e-3, 0.999}, "1", "A cell of at least this probability is an obstacle."),
      Field::real("max_log_odds", &c.max_log_odds, {1, 15}, "1", "Maximum magnitude of a cell's log-odds.")
          .was("most_log_odds"),
      Field::choice("merging", &c.merging, {{"largest", Merging::kLargest}, {"density", Merging::kDensity}},
                    "Log-odds of merged cells: the largest, or from summed expected numbers, which a split halves."),
      Field::real("rebin_at", &c.rebin_at, {0.01, 2}, "1", "Travel, in finest layers, before cells are re-binned."),
      Field::integer("lock_echoes", &c.lock_echoes, {0, 1000000}, "echoes", "Echoes that lock a cell; 0: none do."),
      Field::integer("lock_scans", &c.lock_scans, {1, 1000000}, "scans", "Scans with echoes that lock a cell."),
      Field::real("lock_state", &c.lock_state, {0.01, 1}, "1", "Minimum probability of a locked cell."),
      Field::integer("views", &c.views, {1, 1000}, "views", "Places from which clear water is remembered."),
      Field::real("view_apart_m", &c.view_apart_m, {0, 100}, "m", "Minimum distance between these places."),
  };
}

SphericalGrid::SphericalGrid(const SphericalGridConfig& config)
    : config_((check_spherical(config), config)),
      layers_(config.min_layer_m, config.bucket, config.range_m),
      buckets_(config.bucket),
      prior_(logit(config.prior)),
      occupied_(logit(config.occupied)),
      cells_(buckets_.azimuths(), buckets_.elevations(), layers_.count()),
      views_(buckets_, config.views, config.view_apart_m) {
  for (int i = 0; i < layers_.count(); ++i) {
    const double thickness = layers_.thickness(i);
    room_of_layer_.push_back(static_cast<float>(thickness * thickness));
  }
}

Vector3d SphericalGrid::to_table(const Vector3d& p_G) const { return turned_about_pole(p_G, -turned_) + offset_; }
Vector3d SphericalGrid::from_table(const Vector3d& p_T) const { return turned_about_pole(p_T - offset_, turned_); }

std::optional<SphericalPlace> SphericalGrid::place_at(const Vector3d& p_T) const {
  const double range = p_T.norm();
  if (!(range > 0 && range <= config_.range_m)) return {};
  return SphericalPlace{turned(buckets_.at(p_T)), layers_.layer_at(range)};
}

SphericalDirection SphericalGrid::direction_of(const Vector3d& u_G) const {
  return turned(buckets_.at(turned_about_pole(u_G, -turned_)));
}

double SphericalGrid::log_odds(const SphericalPlace& place) const {
  const SphericalCell* cell = cells_.find(place.direction, place.layer);
  return cell ? static_cast<double>(cell->log_odds) : prior_;
}

double SphericalGrid::probability(const SphericalCell& cell) {
  return 1 / (1 + std::exp(-static_cast<double>(cell.log_odds)));
}

double SphericalGrid::clamped(double log_odds) const {
  return std::clamp(log_odds, -config_.max_log_odds, config_.max_log_odds);
}

// A content of which nothing is known but its cell.
void SphericalGrid::fill(SphericalCell& cell, const SphericalPlace& place) const {
  constexpr float kHardly = 1e-3f;  // any echo outweighs it
  const Vector3d u = axis_in_table(place.direction), p = layers_.middle(place.layer) * u;
  const double thickness = layers_.thickness(place.layer),
               edge = layers_.middle(place.layer) * config_.bucket.radians();
  const Eigen::Matrix3d along = u * u.transpose();
  const Eigen::Matrix3d spread =
      (edge * edge / 12) * (Eigen::Matrix3d::Identity() - along) + (thickness * thickness / 12) * along;
  for (std::size_t i = 0; i < 3; ++i) cell.mean[i] = static_cast<float>(p[static_cast<Eigen::Index>(i)]);
  cell.spread = {static_cast<float>(spread(0, 0)), static_cast<float>(spread(0, 1)), static_cast<float>(spread(0, 2)),
                 static_cast<float>(spread(1, 1)), static_cast<float>(spread(1, 2)), static_cast<float>(spread(2, 2))};
  cell.weight = kHardly;
  cell.log_odds = static_cast<float>(prior_);
}

std::optional<SphericalPlace> SphericalGrid::add_echo(const Vector3d& p_G, double sigma_m, Time time) {
  const Vector3d p = to_table(p_G);
  const auto place = place_at(p);
  if (!place) return {};
  bool made = false;
  SphericalCell& cell = cells_.at(place->direction, place->layer, made);
  if (made) fill(cell, *place);
  // Across the beam an echo fills its bucket; along the beam it extends as far as its range is uncertain.
  const double range = p.norm(), edge = range * config_.bucket.radians();
  const Vector3d u = p / range;
  const double along = std::min(sigma_m * sigma_m, std::pow(layers_.thickness(place->layer), 2) / 12);
  const Eigen::Matrix3d spread =
      edge * edge / 12 * Eigen::Matrix3d::Identity() + (along - edge * edge / 12) * (u * u.transpose());
  const std::array<double, 6> entries{spread(0, 0), spread(0, 1), spread(0, 2),
                                      spread(1, 1), spread(1, 2), spread(2, 2)};
  const float share = 1 / (1 + cell.weight);
  for (std::size_t i = 0; i < 3; ++i) {
    cell.mean[i] += share * (static_cast<float>(p[static_cast<Eigen::Index>(i)]) - cell.mean[i]);
  }
  for (std::size_t i = 0; i < 6; ++i) cell.spread[i] += share * (static_cast<float>(entries[i]) - cell.spread[i]);
  cell.weight += 1;
  if (cell.echoes++ == 0) cell.first_echo = time;
  cell.last_echo = time;
  if (cell.scans == 0 || cell.last_scan != scan_) ++cell.scans;
  cell.last_scan = scan_;
  maybe_lock(cell);
  return place;
}

void SphericalGrid::maybe_lock(SphericalCell& cell) const {
  if (config_.lock_echoes == 0 || cell.echoes < static_cast<std::uint32_t>(config_.lock_echoes)) return;
  if (cell.scans < static_cast<std::uint32_t>(config_.lock_scans)) return;
  if (probability(cell) >= config_.lock_state) cell.locked = true;
}

void SphericalGrid::set_log_odds(const SphericalPlace& place, double log_odds) {
  bool made = false;
  SphericalCell& cell = cells_.at(place.direction, place.layer, made);
  if (made) fill(cell, place);
  if (cell.locked) return;
  cell.log_odds = static_cast<float>(clamped(log_odds));
  cells_.mark_occupied(place.direction, place.layer, static_cast<double>(cell.log_odds) >= occupied_);
  maybe_lock(cell);
}

void SphericalGrid::add_known(const Vector3d& p_G, double edge_m) {
  const Vector3d p = to_table(p_G);
  const auto place = place_at(p);
  if (!place) return;
  bool made = false;
  SphericalCell& cell = cells_.at(place->direction, place->layer, made);
  if (made) fill(cell, *place);
  const auto variance = static_cast<float>(edge_m * edge_m / 12);
  SphericalCell known;
  known.mean = {static_cast<float>(p.x()), static_cast<float>(p.y()), static_cast<float>(p.z())};
  known.spread = {variance, 0, 0, variance, 0, variance};
  known.weight = 1;
  known.log_odds = cell.log_odds;
  merge(cell, known);
  cell.log_odds = static_cast<float>(config_.max_log_odds);
  cell.locked = cell.prior = true;
  cells_.mark_occupied(place->direction, place->layer, true);
}

void SphericalGrid::add_clear(const Vector3d& from_G, const Vector3d& u_G, Angle half_width,
                              const ClearViews::Stretch& clear, Time time) {
  views_.look(to_table(from_G), turned_about_pole(u_G, -turned_), half_width,
              {clear.from_m, std::min(clear.to_m, config_.range_m)}, time);
}

void SphericalGrid::decay(Duration elapsed, Duration tau, Time now) {
  const double keep = std::exp(-to_seconds(elapsed) / to_seconds(tau));
  const auto prior = static_cast<float>(prior_), kept = static_cast<float>(keep);
  const auto occupied = static_cast<float>(occupied_);
  constexpr float kHardlyAbove = 0.1f;
  cells_.change_all([&](SphericalCell& cell) {
    if (!cell.locked) cell.log_odds = prior + (cell.log_odds - prior) * kept;
    return cell.log_odds >= occupied;
  });
  cells_.erase_all([&](const SphericalCell& cell) { return !cell.locked && cell.log_odds < prior + kHardlyAbove; });
  views_.forget_before(now - tau);
}

void SphericalGrid::copy_from(const SphericalGrid& other) {
  ISOBATH_ASSERT(buckets_.count() == other.buckets_.count() && layers_.count() == other.layers_.count());
  cells_ = other.cells_;
  views_.copy_from(other.views_);
  scan_ = other.scan_;
  turned_ = other.turned_;
  offset_ = other.offset_;
}

void SphericalGrid::translate(const Vector3d& displacement_G) {
  offset_ += turned_about_pole(displacement_G, -turned_);
  const double most = config_.rebin_at * config_.min_layer_m;
  if (offset_.squaredNorm() >= most * most) rebin(-offset_);
}

void SphericalGrid::turn(Angle turn) {
  turned_ = (turned_ + turn).wrapped();
  const int wanted = static_cast<int>(std::lround(turned_.radians() / config_.bucket.radians()));
  cells_.turn(wanted - cells_.directions().turned());
}

Angle SphericalGrid::remainder() const { return (turned_ - config_.bucket * cells_.directions().turned()).wrapped(); }

}  // namespace isobath
