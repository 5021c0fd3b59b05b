#include <algorithm>
#include <cmath>
#include <Eigen/LU>
#include <isobath/perception/tracking/motion_filter.hpp>
#include <numbers>

namespace isobath {
namespace {

using Vector = MotionFilter::Vector;
using Matrix = MotionFilter::Matrix;
using Estimate = MotionFilter::Estimate;
using Probabilities = std::array<double, MotionFilter::kMotions>;

constexpr double kAlmostStill = 0.02;     // m/s: deviation of the velocity of a body that lies still
constexpr double kAlmostStraight = 0.01;  // rad/s: deviation of the turn rate of a body that does not turn
constexpr double kTurn = 0.2;             // rad/s: deviation of the turn rate of a body of which nothing is known
constexpr double kSmallTurn = 1e-4;       // rad: below it the series of the turn is exact to rounding
constexpr double kLeast = 1e-6;           // probability that a motion keeps, so that it can come back
constexpr int kPieces = 4;                // of a long step: the motion may change within it

/// Adds the moments of `one` about `mean`, with weight `w`.
void add_moments(const Estimate& one, double w, const Vector& mean, Matrix& covariance) {
  const Vector off = one.mean - mean;
  covariance += w * (one.covariance + off * off.transpose());
}

/// Mixture of estimates by moments.
template <class Range>
Estimate mixture(const Range& estimates, const Probabilities& weights) {
  Estimate out;
  for (int i = 0; i < MotionFilter::kMotions; ++i) out.mean += weights[i] * estimates[i].mean;
  for (int i = 0; i < MotionFilter::kMotions; ++i) add_moments(estimates[i], weights[i], out.mean, out.covariance);
  return out;
}

/// White acceleration of deviation `a` at 1 Hz over `t` seconds, on both axes.
void add_acceleration(Matrix& q, double a, double t) {
  for (int i = 0; i < 2; ++i) {
    q(i, i) += a * a * t * t * t / 3;
    q(i, i + 2) += a * a * t * t / 2;
    q(i + 2, i) += a * a * t * t / 2;
    q(i + 2, i + 2) += a * a * t;
  }
}

void advance_still(const MotionFilterConfig& config, double t, Estimate& e) {
  e.mean.tail<3>().setZero();
  e.covariance.rightCols<3>().setZero();
  e.covariance.bottomRows<3>().setZero();
  e.covariance.diagonal().head<2>().array() += config.still_walk * config.still_walk * t;
  e.covariance.diagonal().segment<2>(2).setConstant(kAlmostStill * kAlmostStill);
  e.covariance(4, 4) = kAlmostStraight * kAlmostStraight;
}

void advance_straight(const MotionFilterConfig& config, double t, Estimate& e) {
  Matrix f = Matrix::Identity();
  f(0, 2) = f(1, 3) = t;
  f(4, 4) = 0;
  e.mean = f * e.mean;
  Matrix q = Matrix::Zero();
  add_acceleration(q, config.straight_acceleration, t);
  q(4, 4) = kAlmostStraight * kAlmostStraight;
  e.covariance = f * e.covariance * f.transpose() + q;
}

void advance_turn(const MotionFilterConfig& config, double t, Estimate& e) {
  const double w = e.mean[4], turn = w * t;
  const double c = std::cos(turn), s = std::sin(turn);
  const bool small = std::abs(turn) < kSmallTurn;
  const double along = small ? t : s / w;  // of the chord
  const double aside = small ? w * t * t / 2 : (1 - c) / w;
  const double d_along = small ? -w * t * t * t / 3 : (t * c - along) / w;
  const double d_aside = small ? t * t / 2 : (t * s - aside) / w;
  const double n = e.mean[2], east = e.mean[3];
  Matrix f = Matrix::Identity();
  f.block<2, 2>(0, 2) << along, -aside, aside, along;
  f.block<2, 2>(2, 2) << c, -s, s, c;
  f.col(4).head<4>() << d_along * n - d_aside * east, d_aside * n + d_along * east, -t * (s * n + c * east),
      t * (c * n - s * east);
  const Vector before = e.mean;
  e.mean.head<2>() += f.block<2, 2>(0, 2) * before.segment<2>(2);
  e.mean.segment<2>(2) = f.block<2, 2>(2, 2) * before.segment<2>(2);
  Matrix q = Matrix::Zero();
  add_acceleration(q, config.manoeuvre_acceleration, t);
  q(4, 4) = config.turn_walk * config.turn_walk * t;
  e.covariance = f * e.covariance * f.transpose() + q;
}

/// Where a body that leaves motion `from` goes: a body that starts or ends a motion is as likely to turn as not.
constexpr std::array<Probabilities, MotionFilter::kMotions> kNext = {{{0, 0.5, 0.5}, {0.5, 0, 0.5}, {0.2, 0.8, 0}}};

}  // namespace

std::vector<Field> fields(MotionFilterConfig& c) {
  return {
      Field::real(
          "still_walk", &c.still_walk, {0, 10}, "m",
          "How far the readings of a body that lies still wander in a second, for instance with its visible side."),
      Field::real("straight_acceleration", &c.straight_acceleration, {0, 10}, "m/s2",
                  "Changes of velocity within a second of a body on a straight course, standard deviation."),
      Field::real("manoeuvre_acceleration", &c.manoeuvre_acceleration, {0, 10}, "m/s2",
                  "The same of a body that manoeuvres."),
      Field::real("turn_walk", &c.turn_walk, {0, 10}, "rad/s",
                  "Changes of the turn rate within a second of a body that manoeuvres, standard deviation."),
      Field::real("still_s", &c.still_s, {0.1, 1e6}, "s", "Mean time for which a body lies still."),
      Field::real("straight_s", &c.straight_s, {0.1, 1e6}, "s", "Mean time for which a body keeps its velocity."),
      Field::real("manoeuvre_s", &c.manoeuvre_s, {0.1, 1e6}, "s", "Mean time of a manoeuvre."),
      Field::real("max_speed", &c.max_speed, {0.01, 100}, "m/s", "Speed that a body hardly exceeds."),
  };
}

MotionFilter::MotionFilter(const MotionFilterConfig& config, const Eigen::Vector2d& p_W,
                           const Eigen::Matrix2d& covariance, double share_still)
    : probability_{share_still, (1 - share_still) / 2, (1 - share_still) / 2} {
  const double sigma = config.max_speed / 2;
  for (int i = 0; i < kMotions; ++i) {
    Estimate& e = motions_[i];
    e.mean.head<2>() = p_W;
    e.covariance.topLeftCorner<2, 2>() = covariance;
    e.covariance.diagonal().segment<2>(2).setConstant(i == kStill ? kAlmostStill * kAlmostStill : sigma * sigma);
    e.covariance(4, 4) = i == kManoeuvre ? kTurn * kTurn : kAlmostStraight * kAlmostStraight;
  }
}

void MotionFilter::advance(const MotionFilterConfig& config, double seconds) {
  if (!(seconds > 0)) return;
  const std::array<double, kMotions> rate = {1 / config.still_s, 1 / config.straight_s, 1 / config.manoeuvre_s};
  const double fastest = *std::ranges::max_element(rate);
  const int pieces = seconds * fastest > 0.1 ? kPieces : 1;
  const double t = seconds / pieces, start = config.max_speed / 2;
  for (int piece = 0; piece < pieces; ++piece) {
    // Probabilities of leaving within t; a motion that is left is taken to change once.
    Probabilities after{};
    std::array<Probabilities, kMotions> from{};  // from[to][i]: joint probability
    for (int i = 0; i < kMotions; ++i) {
      const double stays = std::exp(-rate[i] * t);
      for (int to = 0; to < kMotions; ++to) {
        from[to][i] = probability_[i] * (to == i ? stays : (1 - stays) * kNext[i][to]);
        after[to] += from[to][i];
      }
    }
    std::array<Estimate, kMotions> mixed;
    for (int to = 0; to < kMotions; ++to) {
      for (double& w : from[to]) w /= std::max(after[to], 1e-300);
      mixed[to] = mixture(motions_, from[to]);
      // Where a body that begins to move will go, and how it will turn, is not known.
      const double starts = from[to][kStill], turns = from[to][kStill] + from[to][kStraight];
      if (to != kStill) mixed[to].covariance.diagonal().segment<2>(2).array() += starts * start * start;
      if (to == kManoeuvre) mixed[to].covariance(4, 4) += turns * kTurn * kTurn;
    }
    motions_ = mixed;
    probability_ = after;
    advance_still(config, t, motions_[kStill]);
    advance_straight(config, t, motions_[kStraight]);
    advance_turn(config, t, motions_[kManoeuvre]);
  }
}

namespace {

using Observation = Eigen::Matrix<double, 2, 5>;

/// What a reading observes of a state: the position, back along the velocity by the reading's age.
Observation observation_of(const MotionFilter::Reading& r) {
  Observation h = Observation::Zero();
  h.leftCols<2>().setIdentity();
  h.middleCols<2>(2) = -r.age_s * Eigen::Matrix2d::Identity();
  return h;
}

/// Logarithm of the density of a reading of an estimate, 1/m2.
double log_density(const Estimate& e, const Observation& h, const MotionFilter::Reading& r) {
  const Eigen::Matrix2d s = h * e.covariance * h.transpose() + r.covariance;
  const Eigen::Vector2d off = r.p_W - h * e.mean;
  return -0.5 * off.dot(s.inverse() * off) - 0.5 * std::log(s.determinant()) - std::log(2 * std::numbers::pi);
}

void correct_by(Estimate& e, const Observation& h, const MotionFilter::Reading& r) {
  const Eigen::Matrix2d s = h * e.covariance * h.transpose() + r.covariance;
  const Eigen::Matrix<double, 5, 2> gain = e.covariance * h.transpose() * s.inverse();
  e.mean += gain * (r.p_W - h * e.mean);
  const Matrix rest = Matrix::Identity() - gain * h;
  e.covariance = rest * e.covariance * rest.transpose() + gain * r.covariance * gain.transpose();
}

}  // namespace

double MotionFilter::log_likelihood(const Reading& reading) const {
  const Observation h = observation_of(reading);
  std::array<double, kMotions> l{};
  for (int i = 0; i < kMotions; ++i) l[i] = log_density(motions_[i], h, reading);
  const double most = *std::ranges::max_element(l);
  double sum = 0;
  for (int i = 0; i < kMotions; ++i) sum += probability_[i] * std::exp(l[i] - most);
  return most + std::log(std::max(sum, 1e-300));
}

void MotionFilter::correct(const Reading& reading) {
  const Observation h = observation_of(reading);
  std::array<double, kMotions> l{};
  for (int i = 0; i < kMotions; ++i) l[i] = log_density(motions_[i], h, reading);
  const double most = *std::ranges::max_element(l);
  double sum = 0;
  for (int i = 0; i < kMotions; ++i) {
    correct_by(motions_[i], h, reading);
    probability_[i] = std::max(probability_[i] * std::exp(l[i] - most), kLeast);
    sum += probability_[i];
  }
  for (double& p : probability_) p /= sum;
}

void MotionFilter::mix(std::span<const MotionFilter> others, std::span<const double> shares) {
  std::array<Estimate, kMotions> mixed;
  Probabilities probability{};
  for (int i = 0; i < kMotions; ++i) {
    for (std::size_t k = 0; k < others.size(); ++k) {
      const double w = shares[k] * others[k].probability_[i];
      probability[i] += w;
      mixed[i].mean += w * others[k].motions_[i].mean;
    }
    const double all = std::max(probability[i], 1e-300);
    mixed[i].mean /= all;
    for (std::size_t k = 0; k < others.size(); ++k) {
      add_moments(others[k].motions_[i], shares[k] * others[k].probability_[i] / all, mixed[i].mean,
                  mixed[i].covariance);
    }
  }
  motions_ = mixed;
  probability_ = probability;
}

void MotionFilter::shift(const Eigen::Vector2d& by_W) {
  for (Estimate& e : motions_) e.mean.head<2>() += by_W;
}

MotionFilter::Estimate MotionFilter::estimate() const { return mixture(motions_, probability_); }

Eigen::Vector2d MotionFilter::position() const {
  Eigen::Vector2d p = Eigen::Vector2d::Zero();
  for (int i = 0; i < kMotions; ++i) p += probability_[i] * motions_[i].mean.head<2>();
  return p;
}

}  // namespace isobath
