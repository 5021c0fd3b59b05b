#include <algorithm>
#include <cmath>
#include <isobath/base/error.hpp>
#include <isobath/scenario/motion_scorer.hpp>
#include <limits>

namespace isobath {
namespace {

double share_of(std::vector<double> values, double share) {
  if (values.empty()) return 0;
  const auto at = static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), values.begin() + at, values.end());
  return values[static_cast<std::size_t>(at)];
}

}  // namespace

std::vector<std::size_t> least_assignment(const Eigen::MatrixXd& cost) {
  const auto rows = static_cast<std::size_t>(cost.rows()), columns = static_cast<std::size_t>(cost.cols());
  ISOBATH_ASSERT(rows <= columns);
  constexpr std::size_t kNone = std::numeric_limits<std::size_t>::max();
  const auto at = [&](std::size_t row, std::size_t column) {
    return cost(static_cast<Eigen::Index>(row), static_cast<Eigen::Index>(column));
  };
  // Potentials of rows and columns; the last column is where each row begins.
  std::vector<double> row_price(rows, 0), column_price(columns + 1, 0);
  std::vector<std::size_t> row_of(columns + 1, kNone);
  for (std::size_t row = 0; row < rows; ++row) {
    std::vector<double> least(columns, std::numeric_limits<double>::infinity());
    std::vector<std::size_t> from(columns, columns);
    std::vector<bool> used(columns + 1, false);
    std::size_t column = columns;
    row_of[column] = row;
    while (row_of[column] != kNone) {
      used[column] = true;
      std::size_t next = columns;
      double step = std::numeric_limits<double>::infinity();
      for (std::size_t j = 0; j < columns; ++j) {
        if (used[j]) continue;
        const double reduced = at(row_of[column], j) - row_price[row_of[column]] - column_price[j];
        if (reduced < least[j]) {
          least[j] = reduced;
          from[j] = column;
        }
        if (least[j] < step) {
          step = least[j];
          next = j;
        }
      }
      for (std::size_t j = 0; j <= columns; ++j) {
        if (used[j]) {
          row_price[row_of[j]] += step;
          column_price[j] -= step;
        } else if (j < columns) {
          least[j] -= step;
        }
      }
      column = next;
    }
    while (column != columns) {
      row_of[column] = row_of[from[column]];
      column = from[column];
    }
  }
  std::vector<std::size_t> column_of(rows, 0);
  for (std::size_t j = 0; j < columns; ++j) {
    if (row_of[j] != kNone) column_of[row_of[j]] = j;
  }
  return column_of;
}

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
  const bool by_body = heard.size() <= asked.size();
  const std::size_t few = std::min(heard.size(), asked.size()), many = std::max(heard.size(), asked.size());
  if (many == 0) return;
  const auto pair_of = [&](std::size_t row, std::size_t column) {
    return std::pair(by_body ? row : column, by_body ? column : row);
  };
  Eigen::MatrixXd cost(static_cast<Eigen::Index>(few), static_cast<Eigen::Index>(many));
  for (std::size_t i = 0; i < few; ++i) {
    for (std::size_t j = 0; j < many; ++j) {
      const auto [body, track] = pair_of(i, j);
      cost(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j)) =
          std::min(kCutOff_m, (heard[body].p - asked[track].p).norm());
    }
  }
  const std::vector<std::size_t> assigned = least_assignment(cost);
  double sum = kCutOff_m * static_cast<double>(many - few);
  std::size_t held = 0;
  for (std::size_t i = 0; i < few; ++i) {
    const auto [body, track] = pair_of(i, assigned[i]);
    const double apart = (heard[body].p - asked[track].p).norm();
    sum += std::min(kCutOff_m, apart);
    if (apart >= kCutOff_m) continue;
    ++held;
    ++pairs_;
    position_squares_ += apart * apart;
    velocity_squares_ += (heard[body].velocity - asked[track].velocity).squaredNorm();
    Watch& watch = watched_.at(heard[body].number);
    if (!watch.known_s) watch.known_s = time_s;
    switches_ += watch.track != 0 && watch.track != asked[track].number;
    watch.track = asked[track].number;
  }
  ++scans_;
  ospa_ += sum / static_cast<double>(many);
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
