#include <algorithm>
#include <cmath>
#include <isobath/scenario/set_distance.hpp>
#include <isobath/sonar/fan_watch.hpp>
#include <isobath/studies/nearest_tracker.hpp>
#include <isobath/studies/track_study.hpp>

namespace isobath {
namespace {

using Eigen::Vector2d;

constexpr double kStillSpeed = 0.05;  // m/s: a body that its row calls still
constexpr double kMovingSpeed = 0.1;  // m/s: a track that calls it moving

/// A track at one instant, of either tracker.
struct SeenTrack {
  std::uint32_t number;
  Vector2d p_W, velocity_W;
};

/// What is known of each body from the rows before.
struct SeenBody {
  int rows = 0;
  Time last;
  Vector2d p_W = Vector2d::Zero(), velocity_W = Vector2d::Zero();
  std::uint32_t number = 0;  ///< of the track that held it

  [[nodiscard]] Vector2d at(Time now) const { return p_W + to_seconds(now - last) * velocity_W; }
};

const SeenTrack* nearest_to(const std::vector<SeenTrack>& tracks, const Vector2d& p, double within) {
  const SeenTrack* nearest = nullptr;
  for (const SeenTrack& track : tracks) {
    const double distance = (track.p_W - p).norm();
    if (distance <= within) {
      within = distance;
      nearest = &track;
    }
  }
  return nearest;
}

/// Scores the tracks of one tracker, row by row.
class TrackScorer {
 public:
  TrackScorer(const TrackRequest& request, std::size_t bodies) : request_(request), bodies_(bodies) {}

  /// Before a row is taken in.
  void ask(const PositionTable::Row& row, const std::vector<SeenTrack>& tracks) {
    if (!row.body) return;
    SeenBody& body = bodies_[*row.body];
    if (body.rows < TrackScore::kKnown) return;
    ++score_.asked;
    const SeenTrack* track = nearest_to(tracks, row.p_W, request_.within_m);
    if (track == nullptr) return;
    ++score_.held;
    score_.switches += body.number != 0 && body.number != track->number;
    body.number = track->number;
  }
  /// After it.
  void judge(const PositionTable::Row& row, const std::vector<SeenTrack>& tracks) {
    if (!row.body) return;
    SeenBody& body = bodies_[*row.body];
    ++body.rows;
    body.last = row.time;
    body.p_W = row.p_W;
    body.velocity_W = row.velocity_W.value_or(Vector2d::Zero());
    if (row.velocity_W && body.rows > TrackScore::kKnown) {
      if (const SeenTrack* track = nearest_to(tracks, row.p_W, request_.within_m)) {
        errors_.push_back((track->velocity_W - *row.velocity_W).norm());
        const bool still = row.velocity_W->norm() < kStillSpeed;
        score_.still += still;
        score_.still_moving += still && track->velocity_W.norm() > kMovingSpeed;
      }
    }
  }
  /// Once an interval.
  void compare(Time now, const std::vector<SeenTrack>& tracks) {
    if (next_ && now < *next_) return;
    next_ = now + seconds(request_.interval_s);
    ++looks_;
    std::vector<Vector2d> heard, tracked;
    for (const SeenBody& body : bodies_) {
      if (is_heard(body, now) && body.rows > TrackScore::kKnown) heard.push_back(body.at(now));
    }
    for (const SeenTrack& track : tracks) {
      false_ += is_false(track, now);
      tracked.push_back(track.p_W);
    }
    ospa_m_ += set_distance(heard, tracked, request_.within_m).ospa_m;
  }
  [[nodiscard]] TrackScore score() {
    score_.velocities = errors_.size();
    if (!errors_.empty()) {
      double squares = 0;
      for (const double e : errors_) squares += e * e;
      score_.velocity_rms = std::sqrt(squares / static_cast<double>(errors_.size()));
      score_.velocity_median = median_of(errors_);
    }
    if (looks_ > 0) {
      score_.false_tracks = static_cast<double>(false_) / static_cast<double>(looks_);
      score_.ospa_m = ospa_m_ / static_cast<double>(looks_);
    }
    return score_;
  }

 private:
  [[nodiscard]] bool is_heard(const SeenBody& body, Time now) const {
    return body.rows > 0 && to_seconds(now - body.last) <= TrackRequest::kStale * request_.interval_s;
  }
  [[nodiscard]] bool is_false(const SeenTrack& track, Time now) const {
    return std::ranges::none_of(bodies_, [&](const SeenBody& body) {
      return is_heard(body, now) &&
             (body.p_W - track.p_W).norm() <= request_.within_m + track.velocity_W.norm() * to_seconds(now - body.last);
    });
  }

  const TrackRequest& request_;
  std::vector<SeenBody> bodies_;
  std::optional<Time> next_;
  std::vector<double> errors_;
  std::uint64_t looks_ = 0, false_ = 0;
  double ospa_m_ = 0;
  TrackScore score_;
};

struct Anywhere final : BodyTracker::Coverage {
  [[nodiscard]] double detection(const Vector2d& /*p_W*/) const override { return probability; }
  double probability = 0;
};

std::vector<SeenTrack> seen_tracks(const BodyTracker& tracker, double ahead_s) {
  std::vector<SeenTrack> seen;
  for (const BodyTrack& track : tracker.tracks()) {
    if (!track.confirmed) continue;
    const MotionFilter::Vector mean = track.filter.estimate().mean;
    seen.push_back({track.number, mean.head<2>() + ahead_s * mean.segment<2>(2), mean.segment<2>(2)});
  }
  return seen;
}

std::vector<SeenTrack> seen_tracks(const NearestTracker& tracker) {
  std::vector<SeenTrack> seen;
  for (const NearestTracker::Track& track : tracker.tracks()) {
    if (track.is_confirmed()) seen.push_back({track.number, track.mean.head<2>(), track.mean.tail<2>()});
  }
  return seen;
}

BodyReading reading_of(const PositionTable::Row& row, double sigma_m) {
  BodyReading reading;
  reading.p_W = row.p_W;
  reading.covariance = sigma_m * sigma_m * Eigen::Matrix2d::Identity();
  return reading;
}

/// The courses of confirmed tracks, as they grow.
void note_courses(const BodyTracker& tracker, Time time, std::map<std::uint32_t, TrackCourse>& courses) {
  for (const BodyTrack& track : tracker.tracks()) {
    if (!track.confirmed || track.last != time) continue;
    TrackCourse& course = courses[track.number];
    const MotionFilter::Estimate estimate = track.filter.estimate();
    course.number = track.number;
    course.times.push_back(time);
    course.p_W.emplace_back(estimate.mean.head<2>());
    course.velocity_W = estimate.mean.segment<2>(2);
    course.share_still = track.filter.probability(MotionFilter::kStill);
  }
}

/// The rows of one time, from `first` on.
std::span<const PositionTable::Row> look_at(const PositionTable& table, std::size_t first) {
  std::size_t end = first + 1;
  while (end < table.rows.size() && table.rows[end].time == table.rows[first].time) ++end;
  return std::span(table.rows).subspan(first, end - first);
}

TrackScore score_nearest(const TrackRequest& request, const PositionTable& table) {
  NearestTracker tracker({.acceleration = request.motion.straight_acceleration,
                          .max_speed = request.motion.max_speed,
                          .gate = request.tracker.gate,
                          .stale_s = TrackRequest::kStale * request.interval_s});
  TrackScorer scorer(request, table.names.size());
  for (const PositionTable::Row& row : table.rows) {
    tracker.advance(row.time);
    scorer.ask(row, seen_tracks(tracker));
    tracker.take(reading_of(row, request.sigma_m));
    const std::vector<SeenTrack> seen = seen_tracks(tracker);
    scorer.judge(row, seen);
    scorer.compare(row.time, seen);
  }
  return scorer.score();
}

}  // namespace

std::vector<Section> sections(TrackRequest& r) {
  return {{"positions",
           "The table of positions, and how its rows are judged.",
           {Field::real("sigma_m", &r.sigma_m, {1e-3, 1e4}, "m", "Standard deviation of a position, on each axis."),
            Field::real("interval_s", &r.interval_s, {1e-3, 1e5}, "s", "Mean time between the rows of a body."),
            Field::real("within_m", &r.within_m, {1e-3, 1e5}, "m",
                        "A body is held where a confirmed track is predicted as near as this.")}},
          {"tracker", "Existence of bodies, and which reading is of which.", fields(r.tracker)},
          {"motion", "How bodies move.", fields(r.motion)}};
}

TrackStudy study_tracks(const TrackRequest& request) {
  TrackStudy study;
  study.table = read_positions(request.file);
  BodyTracker tracker(request.tracker, request.motion);
  TrackScorer scorer(request, study.table.names.size());
  std::map<std::uint32_t, TrackCourse> courses;
  Anywhere anywhere;
  std::optional<Time> before;
  std::vector<BodyReading> readings;
  for (std::size_t first = 0; first < study.table.rows.size(); first += readings.size()) {
    const std::span<const PositionTable::Row> look = look_at(study.table, first);
    const Time time = look.front().time;
    const double since = before ? to_seconds(time - *before) : 0;
    before = time;
    anywhere.probability = 1 - std::exp(-since / request.interval_s);
    const std::vector<SeenTrack> predicted = seen_tracks(tracker, since);
    readings.clear();
    for (const PositionTable::Row& row : look) {
      scorer.ask(row, predicted);
      readings.push_back(reading_of(row, request.sigma_m));
    }
    tracker.update(time, readings, anywhere);
    const std::vector<SeenTrack> seen = seen_tracks(tracker, 0);
    for (const PositionTable::Row& row : look) scorer.judge(row, seen);
    scorer.compare(time, seen);
    note_courses(tracker, time, courses);
  }
  study.counts = tracker.counts();
  for (auto& [number, course] : courses) study.courses.push_back(std::move(course));
  study.score = scorer.score();
  study.nearest = score_nearest(request, study.table);
  return study;
}

}  // namespace isobath
