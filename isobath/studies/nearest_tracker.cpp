#include <algorithm>
#include <Eigen/LU>
#include <isobath/studies/nearest_tracker.hpp>

namespace isobath {

void NearestTracker::advance(Time time) {
  if (time_ == time) return;
  const double t = time_ ? to_seconds(time - *time_) : 0;
  time_ = time;
  Eigen::Matrix4d f = Eigen::Matrix4d::Identity();
  f(0, 2) = f(1, 3) = t;
  const double a = config_.acceleration * config_.acceleration;
  Eigen::Matrix4d q = Eigen::Matrix4d::Zero();
  for (int i = 0; i < 2; ++i) {
    q(i, i) = a * t * t * t / 3;
    q(i, i + 2) = q(i + 2, i) = a * t * t / 2;
    q(i + 2, i + 2) = a * t;
  }
  std::erase_if(tracks_, [&](const Track& track) { return to_seconds(time - track.last) > config_.stale_s; });
  for (Track& track : tracks_) {
    track.mean = f * track.mean;
    track.covariance = f * track.covariance * f.transpose() + q;
  }
}

const NearestTracker::Track& NearestTracker::take(const BodyReading& reading) {
  Track* nearest = nullptr;
  double least = config_.gate;
  for (Track& track : tracks_) {
    const Eigen::Matrix2d s = track.covariance.topLeftCorner<2, 2>() + reading.covariance;
    const Eigen::Vector2d off = reading.p_W - track.mean.head<2>();
    const double distance = off.dot(s.inverse() * off);
    if (distance < least) {
      least = distance;
      nearest = &track;
    }
  }
  if (nearest == nullptr) {
    Track& track = tracks_.emplace_back();
    track.number = next_number_++;
    track.last = *time_;
    track.mean.head<2>() = reading.p_W;
    track.covariance.topLeftCorner<2, 2>() = reading.covariance;
    track.covariance.diagonal().tail<2>().setConstant(config_.max_speed * config_.max_speed / 4);
    return track;
  }
  const Eigen::Matrix2d s = nearest->covariance.topLeftCorner<2, 2>() + reading.covariance;
  const Eigen::Matrix<double, 4, 2> gain = nearest->covariance.leftCols<2>() * s.inverse();
  nearest->mean += gain * (reading.p_W - nearest->mean.head<2>());
  Eigen::Matrix4d rest = Eigen::Matrix4d::Identity();
  rest.leftCols<2>() -= gain;
  nearest->covariance = rest * nearest->covariance * rest.transpose() + gain * reading.covariance * gain.transpose();
  nearest->last = *time_;
  ++nearest->readings;
  return *nearest;
}

}  // namespace isobath
