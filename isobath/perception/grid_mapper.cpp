#include <algorithm>
#include <bit>
#include <cmath>
#include <isobath/base/error.hpp>
#include <isobath/perception/grid_mapper.hpp>

namespace isobath {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

int reach_of(const BodyGridConfig& c) { return static_cast<int>(std::hypot(c.cells_x, c.cells_y)) + 2; }

Vector2d turned(const Vector2d& v, Angle a) {
  return {cos(a) * v.x() - sin(a) * v.y(), sin(a) * v.x() + cos(a) * v.y()};
}

template <class T>
void prefetch(std::span<const T> block) {
  const auto* bytes = reinterpret_cast<const std::byte*>(block.data());
  for (std::size_t i = 0; i < block.size_bytes(); i += 64) __builtin_prefetch(bytes + i);
}

}  // namespace

// Where row cells lie in the grid, as index arithmetic; a cell may be outside.
struct GridMapper::Placed {
  explicit Placed(const OverlapTable::Row& row, const CartesianGrid& grid) : row_(row), grid_(grid) {
    const Cell a = row.cell(row.low);
    const Cell b = row.cell(row.high);
    inside = grid.contains(a) && grid.contains(b);
    base = static_cast<std::ptrdiff_t>(row.x) * grid.cells_y + row.y;
    step_u = static_cast<std::ptrdiff_t>(row.x_u) * grid.cells_y + row.y_u;
    step_v = static_cast<std::ptrdiff_t>(row.x_v) * grid.cells_y + row.y_v;
  }
  [[nodiscard]] std::ptrdiff_t operator()(OverlapTable::CellOffset c) const {
    return base + c.u * step_u + c.v * step_v;
  }
  /// -1 outside.
  [[nodiscard]] std::ptrdiff_t checked(OverlapTable::CellOffset c) const {
    return inside || grid_.contains(row_.cell(c)) ? (*this)(c) : -1;
  }

  bool inside;
  std::ptrdiff_t base, step_u, step_v;

 private:
  const OverlapTable::Row& row_;
  const CartesianGrid& grid_;
};

double GridMapper::gain_of(float p_detect) const {
  const double p = std::min<double>(p_detect, 1.0);
  return p > false_alarm_ ? Likelihood{p, false_alarm_}.gain() : 0;
}

std::vector<Field> fields(GridMapperConfig& c) {
  using U = GridMapperConfig::Update;
  return {
      Field::choice("update", &c.update, {{"bin", U::kBin}, {"printed", U::kPrinted}, {"any_target", U::kAnyTarget}},
                    "Reading of the measurement update; bin is the corrected one."),
      Field::integer("block", &c.block, {1, 99}, "cells", "Edge of the neighbourhood of a bin in the printed update."),
  };
}

GridMapper::GridMapper(const BodyGridConfig& grid, const GridMapperConfig& config)
    : config_(config), grid_(grid), table_(config.table, grid.cell_m, reach_of(grid)) {
  if (config.block < 1 || config.block > 99) {
    Place place;
    place.key = "block";
    throw Error("out of range", place, "1 .. 99 cells");
  }
}

void GridMapper::advance(Time time, const Pose& X_WB, const DisplacementSource& source) {
  ISOBATH_ASSERT(X_WB.is_finite());
  const double turn_variance = turn_variance_.since_last(config_.motion, source);
  if (last_X_WB_ && motion_kind(config_.motion, source) != MotionKind::kIgnored) {
    const Vector3d moved = X_WB.translation - last_X_WB_->translation;
    const Angle before = last_X_WB_->rotation.heading();
    grid_.move(turned(moved.head<2>(), -before), (X_WB.rotation.heading() - before).wrapped(),
               displacement_covariance(config_.motion, source, time - time_), turn_variance);
  }
  last_X_WB_ = X_WB;
  time_ = time;
}

void GridMapper::update(const Ping& ping, const EchoDecisions& decisions, const Pose& X_WB,
                        const DisplacementSource& source) {
  ISOBATH_ASSERT(decisions.beams() == ping.fan->beams() && decisions.bins() == ping.window.bins);
  advance(ping.time, X_WB, source);
  // Level body frame: heading removed, roll and pitch kept in the directions.
  const Rotation R_LB = Rotation::from_heading(-X_WB.rotation.heading()) * X_WB.rotation;
  const Rotation R_LS = R_LB * ping.X_BS.rotation;
  take_tilt(R_LS * Vector3d::UnitX());
  take_sensor(ping, decisions);
  weight_ = double{decisions.weight};
  echo_weight_ = double{std::min(decisions.weight, decisions.max_echo_weight)};
  const int beams = decisions.beams();
  const bool shares = decisions.max_echo_weight < 1 && beams > 1;
  beam_step_ = shares ? (ping.fan->azimuth.back() - ping.fan->azimuth.front()).radians() / (beams - 1) : 0;
  const Vector2d sensor = grid_.from_level_body((R_LB * ping.X_BS.translation).head<2>());
  for (int b = 0; b < decisions.beams(); ++b) {
    const Angle a = ping.fan->azimuth[b];
    const Vector3d u_L = R_LS * Vector3d(cos(a), sin(a), 0);
    const Angle azimuth = Angle::radians(std::atan2(u_L.y(), u_L.x())) + grid_.heading();
    update_beam(table_.row(b, azimuth, sensor), decisions, b);
  }
}

/// A new scale costs all rows of the table: only what tilts for good, or far, is worth one.
void GridMapper::take_tilt(const Vector3d& ahead_L) {
  constexpr double kStep = 0.02;
  const double level = ahead_L.head<2>().norm();
  if (std::abs(level - level_share_) > 0.75 * kStep) level_share_ = std::max(kStep, std::round(level / kStep) * kStep);
}

void GridMapper::take_sensor(const Ping& ping, const EchoDecisions& decisions) {
  const bool same = bins_ == decisions.bins() && false_alarm_ == decisions.false_alarm &&
                    p_detect_ == decisions.p_detect && std::equal(usable_.begin(), usable_.end(), decisions.usable());
  if (!same) {
    bins_ = decisions.bins();
    false_alarm_ = decisions.false_alarm;
    p_detect_ = decisions.p_detect;
    ISOBATH_ASSERT(false_alarm_ > 0 && false_alarm_ < 1);
    usable_.assign(decisions.usable(), decisions.usable() + decisions.words());
    gain_.assign(static_cast<std::size_t>(bins_), 0.0);
    for (int k = 0; k < bins_; ++k) {
      if (decisions.usable(k)) gain_[k] = gain_of(p_detect_[k]);
    }
  }
  start_m_ = level_share_ * ping.window.start_m;
  bin_m_ = level_share_ * ping.window.bin_m;
  table_.prepare(*ping.fan, {start_m_, bin_m_, ping.window.bins}, gain_);
}

void GridMapper::update_beam(const OverlapTable::Row& row, const EchoDecisions& decisions, int beam) {
  const Placed placed(row, grid_.cells());
  if (config_.update == GridMapperConfig::Update::kAnyTarget) {
    gather(row, placed, decisions, beam, true);
    apply_looks(row, false);
  } else {
    gather(row, placed, decisions, beam, false);
    lift_looks();
    apply_clears(row, placed);
    apply_dim_clears();
  }
  apply_looks(row, true);
}

// Collects the cells of all bins that do not go with the pool (those with an echo, dim ones, and clear ones too where
// each counts by itself) before anything is computed from them. Rows lie scattered in
// a table larger than the caches, and how many cells a bin has cannot be predicted: first all is asked for, then read.
void GridMapper::gather(const OverlapTable::Row& row, const Placed& placed, const EchoDecisions& decisions, int beam,
                        bool clears) {
  if (touches_.size() < row.entries.size()) {
    touches_.resize(2 * row.entries.size());
    looks_.reserve(static_cast<std::size_t>(bins_) + 1);
  }
  prefetch(row.cells);
  prefetch(row.first_entry);
  looks_.clear();
  const std::uint64_t* hits = decisions.hits(beam);
  const std::uint64_t* dim = decisions.dim(beam);
  for (std::size_t w = 0; w < usable_.size(); ++w) {
    const std::uint64_t dims = dim ? dim[w] : 0;
    for (std::uint64_t bits = (clears ? usable_[w] : hits[w] | dims) & usable_[w]; bits != 0; bits &= bits - 1) {
      const int k = static_cast<int>(w) * 64 + std::countr_zero(bits);
      if (!(gain_[k] > 0)) continue;
      __builtin_prefetch(row.entries.data() + row.first_entry[k]);
      const std::uint64_t bit = bits & -bits;
      const double gain = (dims & bit) != 0 ? gain_of(decisions.p_dim(beam, k)) : gain_[k];
      looks_.push_back({k, (hits[w] & bit) != 0, gain, 0});
    }
  }
  Touch* touch = touches_.data();
  for (Look& look : looks_) {
    look.first = static_cast<std::size_t>(touch - touches_.data());
    for (const OverlapTable::Entry& e : row.bin(look.bin)) {
      const OverlapTable::CellOffset cell = row.cells[e.cell];
      *touch++ = {placed.checked(cell), e.share, cell};
    }
  }
  looks_.push_back({bins_, false, 0, static_cast<std::size_t>(touch - touches_.data())});
}

// Takes the share of these bins out of the pooled clearance that follows.
void GridMapper::lift_looks() {
  double* log_odds = grid_.log_odds().data();
  for (std::size_t i = 0; i + 1 < looks_.size(); ++i) {
    const double gain = gain_[looks_[i].bin];
    for (std::size_t t = looks_[i].first; t < looks_[i + 1].first; ++t) {
      const Touch& touch = touches_[t];
      if (touch.index >= 0) log_odds[touch.index] -= weight_ * clear_increment(gain, double(touch.share));
    }
  }
}

void GridMapper::apply_clears(const OverlapTable::Row& row, const Placed& placed) {
  double* log_odds = grid_.log_odds().data();
  const double least = grid_.log_odds_min();
  const std::size_t n = row.cells.size();
  if (placed.inside) {
    for (std::size_t c = 0; c < n; ++c) {
      double& l = log_odds[placed(row.cells[c])];
      l = std::max(l + weight_ * row.clear[c], least);
    }
    return;
  }
  for (std::size_t c = 0; c < n; ++c) {
    const std::ptrdiff_t i = placed.checked(row.cells[c]);
    if (i >= 0) log_odds[i] = std::max(log_odds[i] + weight_ * row.clear[c], least);
  }
}

// What dim bins without an echo say of free water: less than the others.
void GridMapper::apply_dim_clears() {
  double* log_odds = grid_.log_odds().data();
  const double least = grid_.log_odds_min();
  for (std::size_t i = 0; i + 1 < looks_.size(); ++i) {
    if (looks_[i].hit || !(looks_[i].gain > 0)) continue;
    for (std::size_t t = looks_[i].first; t < looks_[i + 1].first; ++t) {
      const Touch& touch = touches_[t];
      if (touch.index < 0) continue;
      double& l = log_odds[touch.index];
      l = std::max(l + weight_ * clear_increment(looks_[i].gain, double(touch.share)), least);
    }
  }
}

void GridMapper::apply_looks(const OverlapTable::Row& row, bool hit) {
  for (std::size_t i = 0; i + 1 < looks_.size(); ++i) {
    if (looks_[i].hit == hit && looks_[i].gain > 0) apply_look(row, looks_[i], looks_[i + 1].first, hit);
  }
}

/// The beams of a fan that one map cell spans are one look at it together: by how much each of them counts.
double GridMapper::share_of_look(int bin) const {
  if (beam_step_ == 0) return 1;
  return std::min(1.0, (start_m_ + (bin + 0.5) * bin_m_) * beam_step_ / grid_.cells().cell_m);
}

void GridMapper::apply_look(const OverlapTable::Row& row, const Look& look, std::size_t end, bool hit) {
  using Update = GridMapperConfig::Update;
  const std::span<double> log_odds = grid_.log_odds();
  if (index_.size() < end - look.first) {
    index_.resize(end - look.first);
    log_odds_.resize(end - look.first);
    share_.resize(end - look.first);
    scratch_.resize(2 * (end - look.first));
  }
  // The printed form knows the cells of a block round the bin only.
  const bool printed = config_.update == Update::kPrinted;
  const double range = (start_m_ + (look.bin + 0.5) * bin_m_) / grid_.cells().cell_m;
  const Vector2d centre = row.sensor + range * row.direction;
  const int middle_x = static_cast<int>(std::floor(centre.x()));
  const int middle_y = static_cast<int>(std::floor(centre.y()));
  std::size_t n = 0;
  for (std::size_t t = look.first; t < end; ++t) {
    const Touch& touch = touches_[t];
    if (printed) {
      const Cell c = row.cell(touch.cell);
      if (2 * std::abs(c.x - middle_x) > config_.block || 2 * std::abs(c.y - middle_y) > config_.block) continue;
    }
    index_[n] = touch.index;
    log_odds_[n] = touch.index >= 0 ? log_odds[touch.index] : grid_.log_odds_prior();
    share_[n++] = double(touch.share);
  }
  const std::span<double> l(log_odds_.data(), n);
  const std::span<const double> a(share_.data(), n);
  const Likelihood sensor{false_alarm_ + (1 - false_alarm_) * look.gain, false_alarm_};
  if (config_.update == Update::kAnyTarget) {
    update_any_target(hit, l, a, sensor, scratch_);
  } else if (printed) {
    update_hit_printed(l, a, sensor, config_.block * config_.block, scratch_);
  } else {
    update_hit(l, a, sensor, scratch_);
  }
  // The echo is noted for the cell whose odds it raised most.
  const double weight = hit ? echo_weight_ * share_of_look(look.bin) : weight_;
  std::ptrdiff_t best = -1;
  double most = 0;
  for (std::size_t i = 0; i < n; ++i) {
    if (index_[i] < 0) continue;
    double& cell = log_odds[index_[i]];
    if (l[i] - cell > most) {
      most = l[i] - cell;
      best = index_[i];
    }
    const double raised = weight == 1 ? l[i] : cell + weight * (l[i] - cell);
    cell = std::clamp(raised, grid_.log_odds_min(), grid_.log_odds_max());
  }
  if (hit && best >= 0) grid_.note_hit(static_cast<std::size_t>(best), time_);
}

}  // namespace isobath
