#include <algorithm>
#include <array>
#include <cmath>
#include <condition_variable>
#include <isobath/base/error.hpp>
#include <isobath/perception/depth_mapper.hpp>
#include <isobath/perception/depth_update.hpp>
#include <isobath/perception/revisit_check.hpp>
#include <isobath/sonar/sensor_table.hpp>
#include <mutex>
#include <optional>
#include <thread>
#include <utility>

namespace isobath {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr std::size_t kLongestQueue = 65536;  // maximum number of looks queued during a shift
constexpr std::size_t kCaughtUp = 4;          // queued looks applied to the new window with each new look

/// Runs one shift at a time in a thread of its own.
class ShiftWorker {
 public:
  ShiftWorker() : thread_([this] { work(); }) {}
  ~ShiftWorker() {
    {
      const std::scoped_lock guard(lock_);
      quit_ = true;
    }
    wake_.notify_all();
    thread_.join();
  }
  /// Must not be set while a shift runs.
  std::function<void()> before;
  void start(DepthMap::Shift* shift) {
    {
      const std::scoped_lock guard(lock_);
      job_ = shift;
      done_ = false;
    }
    wake_.notify_all();
  }
  bool done() {
    const std::scoped_lock guard(lock_);
    return done_;
  }
  void wait() {
    std::unique_lock guard(lock_);
    wake_.wait(guard, [this] { return done_; });
  }

 private:
  void work() {
    std::unique_lock guard(lock_);
    for (;;) {
      wake_.wait(guard, [this] { return quit_ || job_ != nullptr; });
      if (quit_) return;
      DepthMap::Shift* const job = std::exchange(job_, nullptr);
      guard.unlock();
      if (before) before();
      job->run();
      guard.lock();
      done_ = true;
      wake_.notify_all();
    }
  }
  std::mutex lock_;
  std::condition_variable wake_;
  DepthMap::Shift* job_ = nullptr;
  bool done_ = true, quit_ = false;
  std::thread thread_;
};

}  // namespace

const char* to_text(DepthRefusal why) {
  switch (why) {
    case DepthRefusal::kHeldAlone: return "depth that nothing around it supports (quarantined)";
    case DepthRefusal::kBeamAlone: return "beam of a swath whose neighbours contradict it (quarantined)";
    case DepthRefusal::kImpossible: return "depth that cannot be in these waters";
    case DepthRefusal::kUseless: return "reading of no use: not finite, upwards, or a cone too wide";
    case DepthRefusal::kTooWeak:
      return "reading too unsure to confirm a depth; where nothing else is known, no path relies on it";
    case DepthRefusal::kManySensors: return "reading of a sensor beyond the 64th";
    case DepthRefusal::kTooFar:
      return "echo from beyond evidence.range_cap_m or its sonar's reach, which counts as none";
  }
  return "";
}

struct DepthMapper::Work {
  Work(DepthMap& depth_map, const DepthMapperParts& all, Time from, DepthCounts& count)
      : map(depth_map),
        config(all.mapper),
        accept_after(static_cast<std::size_t>(all.gate.accept_after)),
        epoch(from),
        counts(count),
        update(all, depth_map.grid()),
        gate(all.gate),
        prefilter(all.prefilter),
        revisits(depth_map.grid(), all.evidence.margin_m, all.evidence.margin_share) {
    merged.reserve(2 * SoundingGate::kSensors);
    if (config.background) {
      queue.reserve(kLongestQueue);
      worker = std::make_unique<ShiftWorker>();
    }
  }
  ~Work() { catch_up(true); }

  [[nodiscard]] std::uint32_t minute_of(Time time) const { return DepthMapper::minute_of(time, epoch); }
  void refuse(DepthRefusal why, std::uint64_t n = 1) { counts.refused[static_cast<std::size_t>(why)] += n; }
  /// Evenly spread over 0 .. 1 in each part of the sequence: multiples of the golden ratio.
  double draw_lot() { return 0x1p-32 * (lots += 0x9e3779b9U); }
  void admit(const MergedReading& one, double sigma_m);
  void use(const DepthLook& look);
  void decide(DepthWindow& window, const DepthLook& look);
  void revisit(const DepthWindow& window, const DepthLook& look);
  void count(const DepthLook& look, const UpdateOutcome& outcome);
  void begin_shift(Pixel target);
  void catch_up(bool wait);

  DepthMap& map;
  DepthMapperConfig config;
  std::size_t accept_after;
  Time epoch;
  DepthCounts& counts;
  DepthUpdate update;
  SoundingGate gate;
  ReadingPrefilter prefilter;
  RevisitCheck revisits;
  static_assert(SensorTable::kMax == SoundingGate::kSensors);
  SensorTable sensors;
  std::array<std::vector<DepthLook>, SoundingGate::kSensors> held;
  std::vector<MergedReading> merged;
  double last_sigma_m = 0;
  std::uint32_t lots = 0;
  std::vector<Vector3d> points;
  std::vector<std::uint8_t> believed;
  std::optional<Vector2d> last_place;
  std::unique_ptr<DepthMap::Shift> shift;
  std::unique_ptr<ShiftWorker> worker;
  std::vector<DepthLook> queue;  ///< looks since the shift began; the first `caught_up` are in the new window
  std::size_t caught_up = 0;
  DepthUpdate::Listener listener;
};

// Readings -----------------------------------------------------------------------------------------------------------

void DepthMapper::update(const RangeReading& reading, const Pose& X_WB, double sigma_m) {
  Work& w = *work_;
  ++counts_.readings;
  w.last_sigma_m = sigma_m;
  if (!w.update.cone(reading, X_WB)) return w.refuse(DepthRefusal::kUseless);
  const auto known = w.sensors.index_of(reading.X_BS);
  if (!known) return w.refuse(DepthRefusal::kManySensors);
  const int sensor = static_cast<int>(*known);
  if (!w.config.prefilter) return w.admit({.sensor = sensor, .reading = reading, .X_WB = X_WB}, sigma_m);
  w.merged.clear();
  w.prefilter.flush_due(reading.time, w.merged);
  w.prefilter.add(sensor, reading, X_WB, w.merged);
  for (const MergedReading& one : w.merged) w.admit(one, sigma_m);
}

/// Quarantines depths; other readings pass.
void DepthMapper::Work::admit(const MergedReading& one, double sigma_m) {
  counts.merged += static_cast<std::uint64_t>(one.count - 1);
  const std::optional<BeamCone> cone = update.cone(one.reading, one.X_WB);
  if (!cone) return refuse(DepthRefusal::kUseless);
  DepthLook look;
  look.reading = one.reading;
  look.X_WB = one.X_WB;
  look.count = one.count;
  look.sigma_m = sigma_m;
  look.lot = draw_lot();
  look.minute = minute_of(one.reading.time);
  look.depth_sonar = update.is_depth_sonar(*cone);
  if (!config.quarantine || !look.depth_sonar || !update.is_echo(look.reading, true)) return use(look);
  std::vector<DepthLook>& aside = held[static_cast<std::size_t>(one.sensor)];
  switch (gate.judge(one.sensor, cone->apex() + *look.reading.range_m * cone->axis())) {
    case SoundingGate::Verdict::kImpossible: return refuse(DepthRefusal::kImpossible);
    case SoundingGate::Verdict::kHeld:
      if (aside.size() == accept_after) {
        refuse(DepthRefusal::kHeldAlone);
        aside.erase(aside.begin());
      }
      aside.push_back(look);
      return;
    case SoundingGate::Verdict::kConfirmed: {
      // Confirms only the last held readings, those that agree; the gate counts this reading as one of them.
      const std::size_t row = std::min(aside.size(), accept_after - 1);
      refuse(DepthRefusal::kHeldAlone, aside.size() - row);
      for (std::size_t i = aside.size() - row; i < aside.size(); ++i) use(aside[i]);
      aside.clear();
      return use(look);
    }
    case SoundingGate::Verdict::kBelieved:
      refuse(DepthRefusal::kHeldAlone, aside.size());
      aside.clear();
      return use(look);
  }
}

/// Applies a look to the window at once. During a shift it is also queued for the new window, which then decides on
/// counts and reported changes.
void DepthMapper::Work::use(const DepthLook& look) {
  catch_up(false);
  if (shift && queue.size() == kLongestQueue) {
    ++counts.waited;
    catch_up(true);
  }
  if (!shift) return decide(map.window(), look);
  const UpdateOutcome outcome = update.apply(map.window(), look, nullptr);
  if (!config.queue_all && !outcome.changed) {
    // A look within both windows finds the same pixels in both, and changes none in either.
    const PixelWindow reach = update.reach(look);
    if (overlap(reach, map.window().extent()) == reach && overlap(reach, shift->extent()) == reach) {
      ++counts.spared;
      revisit(map.window(), look);
      return count(look, outcome);
    }
  }
  ++counts.queued;
  queue.push_back(look);
}

/// Applies a look to the window that decides on counts and reported changes.
void DepthMapper::Work::decide(DepthWindow& window, const DepthLook& look) {
  revisit(window, look);
  count(look, update.apply(window, look, &listener));
}

/// Compares a depth sounding with the map of an earlier pass.
void DepthMapper::Work::revisit(const DepthWindow& window, const DepthLook& look) {
  if (const auto bottom = update.bottom_of(look)) revisits.sounding(window, bottom->p_W, bottom->radius_m, look.minute);
}

std::uint64_t DepthCounts::lost() const {
  std::uint64_t known = merged + applied + silent;
  for (std::size_t i = 0; i < kDepthRefusals; ++i) {
    if (static_cast<DepthRefusal>(i) != DepthRefusal::kTooWeak) known += refused[i];  // weak ones are applied as well
  }
  return readings + soundings - known;
}

std::uint32_t DepthMapper::minute_of(Time time, Time epoch) {
  const auto minutes = std::chrono::duration_cast<std::chrono::minutes>(time - epoch).count();
  return static_cast<std::uint32_t>(std::clamp<std::int64_t>(minutes, 0, DepthPixel::kLastMinute));
}

void DepthMapper::Work::count(const DepthLook& look, const UpdateOutcome& outcome) {
  if (look.kind == DepthLook::Kind::kTrack) return;
  if (outcome.useless) {
    const bool echo = look.kind == DepthLook::Kind::kSounding || look.reading.range_m;
    const bool too_far = look.kind == DepthLook::Kind::kRange && echo && std::isfinite(*look.reading.range_m) &&
                         !update.is_echo(look.reading, look.depth_sonar);
    if (!echo) ++counts.silent;
    if (echo) refuse(too_far ? DepthRefusal::kTooFar : DepthRefusal::kUseless);
    return;
  }
  ++counts.applied;
  counts.outside += outcome.outside;
  counts.explained += outcome.explained;
  if (outcome.weak) refuse(DepthRefusal::kTooWeak);
  counts.examined += outcome.examined;
  counts.affirmed += outcome.affirmed;
  counts.conflicted += outcome.conflicted;
  counts.replaced += outcome.replaced;
}

void DepthMapper::update(const Swath& swath, const Pose& X_WB, double sigma_m) {
  Work& w = *work_;
  counts_.soundings += swath.soundings.size();
  const Pose X_WF = frame_in_world(swath, X_WB);
  w.points.clear();
  for (const Sounding& s : swath.soundings) w.points.push_back(X_WF * s.point.cast<double>());
  w.believed.assign(w.points.size(), 1);
  if (w.config.quarantine) w.gate.judge_swath(w.points, w.believed);
  DepthLook look;
  look.kind = DepthLook::Kind::kSounding;
  look.sigma_m = sigma_m;
  look.minute = w.minute_of(swath.time);
  look.half_angle = swath.beam_width / 2;
  for (std::size_t i = 0; i < w.points.size(); ++i) {
    const Sounding& s = swath.soundings[i];
    if (s.kind == Sounding::Kind::kBottom && w.believed[i] == 0) {
      w.refuse(DepthRefusal::kBeamAlone);
      continue;
    }
    look.p = w.points[i];
    look.in_water = s.kind != Sounding::Kind::kBottom;
    look.lot = w.draw_lot();
    const Vector3d ray = look.p - X_WF.translation;
    look.u = ray.norm() > 0 ? Vector3d(ray.normalized()) : Vector3d::UnitZ();
    look.range_m = static_cast<double>(s.range_m);
    look.depth_sigma_m = static_cast<double>(s.sigma_m > 0 ? s.sigma_m : s.sigma_range_m);
    w.use(look);
  }
}

void DepthMapper::passed(Time time, const Pose& X_WB) {
  Work& w = *work_;
  const Vector2d place = X_WB.translation.head<2>();
  if (!w.update.has_pixels(place)) return;
  const bool near = w.last_place && (place - *w.last_place).norm() < kTrackBreak;
  DepthLook look;
  look.kind = DepthLook::Kind::kTrack;
  look.minute = w.minute_of(time);
  look.q = place;
  look.p.head<2>() = near ? *w.last_place : place;
  w.last_place = place;
  w.use(look);
  const auto target = w.map.wanted(place, w.shift.get());
  if (!target) return;
  if (w.shift) {  // the last shift has not ended: complete it first, so that the map is that of instantaneous shifts
    ++counts_.waited;
    w.catch_up(true);
  }
  const double gap_s = to_seconds(time - counts_.last_shift);
  if (counts_.shifts == 0) counts_.first_shift = time;
  if (counts_.shifts == 1 || (counts_.shifts > 1 && gap_s < counts_.least_shift_gap_s))
    counts_.least_shift_gap_s = gap_s;
  counts_.last_shift = time;
  w.begin_shift(*target);
}

void DepthMapper::finish() {
  Work& w = *work_;
  w.merged.clear();
  w.prefilter.flush(w.merged);
  for (const MergedReading& one : w.merged) w.admit(one, w.last_sigma_m);
  for (auto& aside : w.held) {
    w.refuse(DepthRefusal::kHeldAlone, aside.size());
    aside.clear();
  }
  w.catch_up(true);
}

// Shifts -------------------------------------------------------------------------------------------------------------

void DepthMapper::Work::begin_shift(Pixel target) {
  ++counts.shifts;
  shift = map.begin_shift(target);
  if (worker) return worker->start(shift.get());
  shift->run();
  map.finish_shift(*shift);
  shift.reset();
}

/// Once the new window is ready: applies queued looks to it, a few per call so that no call takes long, and installs it
/// when none is left.
void DepthMapper::Work::catch_up(bool wait) {
  if (!shift) return;
  if (wait) worker->wait();
  if (!worker->done()) return;
  const std::size_t end = wait ? queue.size() : std::min(queue.size(), caught_up + kCaughtUp);
  for (; caught_up < end; ++caught_up) {
    decide(shift->window(), queue[caught_up]);
  }
  if (caught_up < queue.size()) return;
  queue.clear();
  caught_up = 0;
  map.finish_shift(*shift);
  shift.reset();
}

DepthMapper::DepthMapper(DepthMap& map, const DepthMapperParts& parts, Time epoch)
    : work_(std::make_unique<Work>(map, parts, epoch, counts_)) {
  parts.rules.check();
}

DepthMapper::~DepthMapper() = default;

const RevisitRecord& DepthMapper::revisits() const { return work_->revisits.record(); }

void DepthMapper::before_shift(std::function<void()> wait) {
  ISOBATH_ASSERT(work_->worker && !work_->shift);
  work_->worker->before = std::move(wait);
}

void DepthMapper::on_change(std::function<void(const PixelChange&)> listener) { work_->listener = std::move(listener); }

}  // namespace isobath
