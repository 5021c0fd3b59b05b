#include <algorithm>
#include <cmath>
#include <isobath/runtime/pipeline.hpp>

namespace isobath {
namespace {

constexpr std::size_t kMostWaiting = 256;  // pings held for a fix; beyond it the oldest goes on with what is known

/// Next of 1, 2, 5, 10 ... times a power of ten.
double nice_step(double value) {
  const double decade = std::pow(10, std::floor(std::log10(value)));
  for (const double step : {1.0, 2.0, 5.0}) {
    if (value <= step * decade * (1 + 1e-9)) return step * decade;
  }
  return 10 * decade;
}

std::uint64_t count_bits(const EchoDecisions& decisions, int beam) {
  std::uint64_t hits = 0;
  for (int w = 0; w < decisions.words(); ++w) {
    hits += static_cast<std::uint64_t>(std::popcount(decisions.hits(beam)[w] & decisions.usable()[w]));
  }
  return hits;
}

std::uint64_t count_usable(const EchoDecisions& decisions) {
  std::uint64_t usable = 0;
  for (int w = 0; w < decisions.words(); ++w) usable += static_cast<std::uint64_t>(std::popcount(decisions.usable()[w]));
  return usable * static_cast<std::uint64_t>(decisions.beams());
}

}  // namespace

Pipeline::Pipeline(const Configuration& configuration, ResultSink& sink)
    : configuration_(configuration),
      sink_(sink),
      gate_(configuration.gate),
      poses_(configuration.poses),
      echoes_(configuration.echoes),
      detector_(configuration.obstacles) {
  waiting_.reserve(kMostWaiting);
}

Pipeline::~Pipeline() = default;

// What happens to an event -------------------------------------------------------------------------------------------

void Pipeline::take(Event event) {
  const auto verdict = gate_.judge(event);  // finite, in order, fresh; else counted by its reason
  if (verdict == EventGate::Verdict::kRejected) return;
  if (verdict == EventGate::Verdict::kRestarted) restart();
  const Time now = time_of(event);
  if (const auto* fix = std::get_if<Navigation>(&event)) add_fix(*fix);
  if (std::holds_alternative<RangeReading>(event)) ++counts_.ranges;  // kept in the log; the depth map takes them
  if (auto* ping = std::get_if<Ping>(&event)) hold(std::move(*ping));
  release(now, false);
}

// What happens to a ping whose pose is known -------------------------------------------------------------------------

void Pipeline::map_ping(const Ping& ping, const Pose& X_WB, bool posed) {
  fit_map(ping);                                                            // a grid of the sonar's size
  carry_map_to(X_WB, ping.time, posed);                                     // belief moves with the vehicle
  echoes_.detect(ping, decisions_);                                         // intensities -> decisions
  mapper_->update(ping, decisions_, level(X_WB).inverse() * X_WB, *grid_);  // decisions -> belief
  sink_.on_ping({ping, X_WB, decisions_});
  ++counts_.pings;
  counts_.unposed += posed ? 0 : 1;
  counts_.bins += count_usable(decisions_);
  for (int b = 0; b < decisions_.beams(); ++b) counts_.hits += count_bits(decisions_, b);
  if (sweeps_.ends_scan(ping)) end_scan(ping.time, X_WB, posed);            // belief -> obstacles
}

void Pipeline::end_scan(Time time, const Pose& X_WB, bool posed) {
  const auto& obstacles = detector_.detect(*grid_, first_ping_);
  sink_.on_scan({static_cast<int>(++counts_.scans), time, X_WB, posed, *grid_, obstacles});
  sweep_open_ = false;
}

void Pipeline::finish() {
  release(Time::max(), true);
  if (sweep_open_) end_scan(last_->time, last_->X_WB, last_->posed);
}

// Poses --------------------------------------------------------------------------------------------------------------

void Pipeline::restart() {
  release(Time::max(), true);
  poses_.clear();
  last_.reset();
  if (grid_) grid_->clear();
}

void Pipeline::add_fix(const Navigation& fix) {
  poses_.add(fix);
  ++counts_.navigation;
}

void Pipeline::hold(Ping ping) {
  if (waiting_.size() == kMostWaiting) {
    place(waiting_.front());
    waiting_.erase(waiting_.begin());
  }
  waiting_.push_back(std::move(ping));
}

/// Lets go of the pings whose pose can get no better, or that have waited long enough.
void Pipeline::release(Time now, bool all) {
  const Duration patience = seconds(configuration_.poses.wait_s);
  std::size_t done = 0;
  while (done < waiting_.size() &&
         (all || poses_.settled(waiting_[done].time) || now - waiting_[done].time > patience)) {
    place(waiting_[done++]);
  }
  waiting_.erase(waiting_.begin(), waiting_.begin() + static_cast<std::ptrdiff_t>(done));
}

void Pipeline::place(const Ping& ping) {
  if (poses_.empty()) return map_ping(ping, Pose{}, false);  // no navigation at all: the vehicle is taken to stand still
  const auto X_WB = poses_.at(ping.time);
  if (!X_WB) return gate_.count(to_text(X_WB.error()));
  map_ping(ping, *X_WB, true);
}

// The map ------------------------------------------------------------------------------------------------------------

void Pipeline::fit_map(const Ping& ping) {
  const double reach = ping.window.end_m();
  BodyGridConfig& grid = configuration_.grid;
  if (configuration_.map.fit) {
    const double held = 0.5 * grid.cell_m * std::min(grid.cells_x, grid.cells_y);
    if (grid_ && reach <= held && reach > held / 4) return;
    grid.cell_m = nice_step(reach / 100);
    grid.cells_x = grid.cells_y = 2 * static_cast<int>(std::ceil(1.05 * reach / grid.cell_m)) + 1;
    grid.home_x = grid.home_y = 0.5;
  } else if (grid_) {
    return;
  }
  grid_ = std::make_unique<BodyGrid>(grid);
  mapper_ = std::make_unique<GridMapper>(configuration_.update, *grid_);
  first_ping_ = ping.time;
  last_.reset();
}

void Pipeline::carry_map_to(const Pose& X_WB, Time time, bool posed) {
  // Before the first fix the vehicle is taken to stand still, so the first fix moves nothing.
  const auto& motion = configuration_.motion;
  if (last_ && last_->posed && posed && motion.kind != MotionKind::kIgnored) {
    const Pose step = level(last_->X_WB).inverse() * level(X_WB);
    const DisplacementSource source{.position_fix = poses_.settled(time), .velocity_log = true};
    grid_->move(step.translation.head<2>(), step.rotation.heading(),
                displacement_covariance(motion, source, time - last_->time));
  }
  last_ = Placed{time, X_WB, posed};
  sweep_open_ = true;
}

}  // namespace isobath
