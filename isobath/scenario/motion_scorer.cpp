#include <algorithm>
#include <cmath>
#include <isobath/scenario/motion_scorer.hpp>
#include <isobath/scenario/set_distance.hpp>

namespace isobath {
namespace {

double share_of(std::vector<double> values, double share) {
  if (values.empty()) return 0;
  const auto at = static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), values.begin() + at, values.end());
  return values[static_cast<std::size_t>(at)];
}

}  // namespace

void MotionScorer::add(double time_s, std::span<const TrueBody> bodies, std::span<const Track> tracks) {
  std::vector<TrueBody> heard, hidden;
  for (const TrueBody& body : bodies) {
    if (body.velocity.norm() >= kLeastSpeed) (body.heard ? heard : hidden).push_back(body);
  }
  for (const TrueBody& body : heard) watched_.try_emplace(body.number, Watch{time_s, std::nullopt, 0});
  const auto is_near = [](const Track& track) {
    return [&track](const TrueBody& body) { return (body.p - track.p).norm() < kCutOff_m; };
  };
  std::vector<Track> asked;
  for (const Track& track : tracks) {
    if (std::ranges::any_of(heard, is_near(track)) || std::ranges::none_of(hidden, is_near(track))) {
      asked.push_back(track);
    }
  }
  if (heard.empty() && asked.empty()) return;
  std::vector<Eigen::Vector2d> of_bodies, of_tracks;
  for (const TrueBody& body : heard) of_bodies.push_back(body.p);
  for (const Track& track : asked) of_tracks.push_back(track.p);
  const SetDistance distance = set_distance(of_bodies, of_tracks, kCutOff_m);
  for (const auto& [i, j] : distance.pairs) {
    const TrueBody& body = heard[i];
    const Track& track = asked[j];
    ++pairs_;
    position_squares_ += (body.p - track.p).squaredNorm();
    velocity_squares_ += (body.velocity - track.velocity).squaredNorm();
    Watch& watch = watched_.at(body.number);
    if (!watch.known_s) watch.known_s = time_s;
    switches_ += watch.track != 0 && watch.track != track.number;
    watch.track = track.number;
  }
  const std::size_t held = distance.pairs.size();
  ++scans_;
  ospa_ += distance.ospa_m;
  held_ += heard.empty() ? 1 : static_cast<double>(held) / static_cast<double>(heard.size());
  false_ += static_cast<std::int64_t>(asked.size() - held);
}

MotionScore MotionScorer::score() const {
  MotionScore s;
  s.scans = scans_;
  s.bodies = static_cast<int>(watched_.size());
  s.switches = switches_;
  std::vector<double> after_s;
  for (const auto& [number, watch] : watched_) {
    if (watch.known_s) after_s.push_back(*watch.known_s - watch.first_heard_s);
  }
  s.known = static_cast<int>(after_s.size());
  s.known_after_s = share_of(after_s, 0.5);
  s.known_after_95_s = share_of(after_s, 0.95);
  if (scans_ > 0) {
    s.ospa_m = ospa_ / scans_;
    s.held_share = held_ / scans_;
    s.false_tracks = static_cast<double>(false_) / scans_;
  }
  if (pairs_ > 0) {
    s.velocity_rms = std::sqrt(velocity_squares_ / static_cast<double>(pairs_));
    s.position_rms_m = std::sqrt(position_squares_ / static_cast<double>(pairs_));
  }
  return s;
}

}  // namespace isobath
