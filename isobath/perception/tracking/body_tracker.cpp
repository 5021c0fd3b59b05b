#include <algorithm>
#include <cmath>
#include <Eigen/LU>
#include <isobath/base/error.hpp>
#include <isobath/perception/tracking/body_tracker.hpp>

namespace isobath {
namespace {

constexpr double kLeastMissed = 1e-6;  // weight of a body that was missed although it is certain to be seen
constexpr double kExtentMemory = 200;  // echoes that an extent rests on at most: it may change
constexpr double kSame = 1;            // squared distance in deviations up to which two tracks are one body
constexpr double kHardlySeen = 0.05;   // detection at least where a reading came from: a look has no sharp edge
constexpr double kUseless = 0.25;      // of the existence with which a track begins in empty water: it is dropped

bool is_usable(const BodyReading& r) {
  if (!r.p_W.allFinite() || !r.covariance.allFinite() || !r.scatter.allFinite()) return false;
  const bool definite = r.covariance(0, 0) > 0 && r.covariance.determinant() > 0;
  return definite && std::isfinite(r.age_s) && r.age_s >= 0 && std::isfinite(r.echoes) && r.echoes > 0;
}

/// The scatter of a reading joins the extent of the track, each with the number of its echoes.
void join_extent(BodyTrack& track, const BodyReading& reading, double probability) {
  const double n = probability * reading.echoes;
  const double kept = std::min(track.extent_weight, kExtentMemory);
  if (!(n + kept > 0)) return;
  track.extent = (kept * track.extent + n * reading.scatter) / (kept + n);
  track.extent_weight = kept + n;
}

/// Whether two tracks agree in position and velocity.
bool are_same(const MotionFilter::Estimate& a, const MotionFilter::Estimate& b) {
  const Eigen::Vector4d off = (a.mean - b.mean).head<4>();
  // Each by itself as uncertain as the surer of the two: an unsure track agrees with anything.
  const MotionFilter::Matrix& surer = a.covariance.trace() < b.covariance.trace() ? a.covariance : b.covariance;
  if (off.head<2>().squaredNorm() > 2 * kSame * surer.topLeftCorner<2, 2>().trace()) return false;
  return off.dot((2 * surer.topLeftCorner<4, 4>()).inverse() * off) <= kSame;
}

}  // namespace

std::vector<Field> fields(BodyTrackerConfig& c) {
  return {
      Field::real("clutter", &c.clutter, {1e-12, 10}, "1/m2", "False readings in a look."),
      Field::real("unseen", &c.unseen, {0, 10}, "1/m2", "Bodies that no track knows yet."),
      Field::real("survival_s", &c.survival_s, {1, 1e7}, "s", "Mean time until a body leaves."),
      Field::real("gate", &c.gate, {1, 100}, "1",
                  "A reading farther from a track, in squared standard deviations, is not of its body."),
      Field::real("confirm", &c.confirm, {0.5, 1}, "1", "Probability of existence from which a track is confirmed."),
      Field::real("drop", &c.drop, {1e-6, 0.5}, "1", "Probability of existence below which a track is dropped."),
      Field::integer("max_readings", &c.max_readings, {1, 100000}, "1", "Readings of a look that are used at most."),
      Field::integer("max_tracks", &c.max_tracks, {1, 100000}, "1", "Tracks that are kept at most."),
  };
}

BodyTracker::BodyTracker(const BodyTrackerConfig& config, const MotionFilterConfig& motion)
    : config_(config), motion_(motion) {
  if (!(config.drop < config.confirm))
    throw Error("a track would be dropped before it is confirmed", {}, "below confirm");
}

bool BodyTracker::update(Time time, std::span<const BodyReading> readings, const Coverage& coverage) {
  if (time_ && time < *time_) {
    ++counts_.out_of_order;
    return false;
  }
  ++counts_.looks;
  const double seconds = time_ ? to_seconds(time - *time_) : 0;
  time_ = time;
  const double survival = std::exp(-seconds / config_.survival_s);
  for (BodyTrack& track : tracks_) {
    track.filter.advance(motion_, seconds);
    track.existence *= survival;
  }
  take(readings);
  weigh(coverage);
  association_.associate(task_);
  const std::size_t known = tracks_.size();
  for (std::size_t i = 0; i < known; ++i) correct_track(i, time);
  merge();
  begin(time, coverage);
  tidy();
  return true;
}

/// The usable readings of a look; of too many those of most echoes.
void BodyTracker::take(std::span<const BodyReading> readings) {
  readings_.clear();
  for (const BodyReading& r : readings) {
    if (is_usable(r)) {
      readings_.push_back(r);
    } else {
      ++counts_.unusable;
    }
  }
  const auto most = static_cast<std::size_t>(config_.max_readings);
  if (readings_.size() > most) {
    std::ranges::stable_sort(readings_, std::greater{}, &BodyReading::echoes);
    counts_.above_max_readings += readings_.size() - most;
    readings_.resize(most);
  }
  counts_.readings += readings_.size();
}

void BodyTracker::weigh(const Coverage& coverage) {
  task_.missed.clear();
  task_.alone.clear();
  task_.pairs.clear();
  detection_.clear();
  first_pair_.clear();
  for (std::size_t i = 0; i < tracks_.size(); ++i) {
    const BodyTrack& track = tracks_[i];
    const MotionFilter::Estimate estimate = track.filter.estimate();
    const Eigen::Vector2d at = estimate.mean.head<2>(), velocity = estimate.mean.segment<2>(2);
    const Eigen::Matrix2d spread = estimate.covariance.topLeftCorner<2, 2>();
    const double detection = coverage.detection(at);
    detection_.push_back(detection);
    task_.missed.push_back(std::max(1 - track.existence * detection, kLeastMissed));
    first_pair_.push_back(task_.pairs.size());
    for (std::size_t j = 0; j < readings_.size(); ++j) {
      const BodyReading& r = readings_[j];
      const Eigen::Vector2d off = r.p_W - (at - r.age_s * velocity);
      const Eigen::Matrix2d s = spread + r.covariance;
      if (off.squaredNorm() > config_.gate * s.trace() || off.dot(s.inverse() * off) > config_.gate) continue;
      const double seen = std::max(detection, kHardlySeen);
      const double w = track.existence * seen * std::exp(track.filter.log_likelihood(r));
      if (w > 0) task_.pairs.push_back({i, j, w});
    }
  }
  first_pair_.push_back(task_.pairs.size());
  for (const BodyReading& r : readings_) {
    task_.alone.push_back(config_.clutter + config_.unseen * coverage.detection(r.p_W));
  }
}

// The body was missed, or gave one of the readings; the filter becomes the mixture of these.
void BodyTracker::correct_track(std::size_t i, Time time) {
  BodyTrack& track = tracks_[i];
  const double missed = task_.missed_probability[i];
  const double stays = track.existence * (1 - detection_[i]) / task_.missed[i];
  double existence = missed * std::clamp(stays, 0.0, 1.0);
  mixed_.assign(1, track.filter);
  shares_.assign(1, existence);
  double read = 0;
  for (std::size_t k = first_pair_[i]; k < first_pair_[i + 1]; ++k) {
    const AssociationPair& pair = task_.pairs[k];
    const BodyReading& reading = readings_[pair.reading];
    mixed_.push_back(track.filter);
    mixed_.back().correct(reading);
    shares_.push_back(pair.probability);
    existence += pair.probability;
    read += pair.probability;
    join_extent(track, reading, pair.probability);
  }
  track.existence = std::min(existence, 1.0);
  if (!(existence > 0)) return;
  for (double& share : shares_) share /= existence;
  if (mixed_.size() > 1) track.filter.mix(mixed_, shares_);
  if (read > 0.5) {
    track.last = time;
    ++track.readings;
  }
  track.confirmed = track.confirmed || track.existence >= config_.confirm;
}

// What no track explains may be a body that is new.
void BodyTracker::begin(Time time, const Coverage& coverage) {
  for (std::size_t j = 0; j < readings_.size(); ++j) {
    const BodyReading& r = readings_[j];
    const double body = config_.unseen * coverage.detection(r.p_W);
    const double existence = task_.alone_probability[j] * body / task_.alone[j];
    if (!(existence > least_existence())) continue;
    tracks_.push_back({.number = next_number_++,
                       .existence = existence,
                       .confirmed = existence >= config_.confirm,
                       .first = time,
                       .last = time,
                       .readings = 1,
                       .filter = MotionFilter(motion_, r.p_W, r.covariance),
                       .extent = r.scatter,
                       .extent_weight = r.echoes});
  }
}

double BodyTracker::least_existence() const {
  const double seen = kHardlySeen * config_.unseen;
  return std::min(config_.drop, kUseless * seen / (seen + config_.clutter));
}

// Two tracks of one body become one: the older stays, with the probability that either of them exists.
void BodyTracker::merge() {
  estimates_.clear();
  for (const BodyTrack& track : tracks_) estimates_.push_back(track.filter.estimate());
  for (std::size_t i = 0; i < tracks_.size(); ++i) {
    BodyTrack& older = tracks_[i];
    for (std::size_t j = i + 1; j < tracks_.size(); ++j) {
      BodyTrack& younger = tracks_[j];
      if (!(older.existence > 0 && younger.existence > 0) || !are_same(estimates_[i], estimates_[j])) continue;
      older.existence = 1 - (1 - older.existence) * (1 - younger.existence);
      older.confirmed = older.confirmed || younger.confirmed;
      older.last = std::max(older.last, younger.last);
      older.merged = younger.number;
      if (estimates_[j].covariance.trace() < estimates_[i].covariance.trace()) {
        older.filter = younger.filter;
        estimates_[i] = estimates_[j];
      }
      younger.existence = 0;
    }
  }
}

// Tracks that no longer exist go, and of too many those that exist least.
void BodyTracker::tidy() {
  std::erase_if(tracks_,
                [&](const BodyTrack& t) { return !(t.existence >= (t.confirmed ? config_.drop : least_existence())); });
  const auto most = static_cast<std::size_t>(config_.max_tracks);
  if (tracks_.size() > most) {
    std::ranges::stable_sort(tracks_, std::greater{}, &BodyTrack::existence);
    counts_.above_max_tracks += tracks_.size() - most;
    tracks_.erase(tracks_.begin() + static_cast<std::ptrdiff_t>(most), tracks_.end());
    std::ranges::sort(tracks_, {}, &BodyTrack::number);
  }
}

void BodyTracker::shift(const Eigen::Vector2d& by_W) {
  for (BodyTrack& track : tracks_) track.filter.shift(by_W);
}

}  // namespace isobath
