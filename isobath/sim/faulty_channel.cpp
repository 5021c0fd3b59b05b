#include <algorithm>
#include <cmath>
#include <cstring>
#include <isobath/sim/faulty_channel.hpp>
#include <limits>
#include <memory>
#include <utility>
#include <variant>

namespace isobath {
namespace {

// One value of each kind of reading is scaled or shifted.
struct Scale {
  double factor;
  void operator()(CompassReading& r) const { r.heading = (r.heading * factor).wrapped(); }
  void operator()(AttitudeReading& r) const {
    r.roll = (r.roll * factor).wrapped();
    r.pitch = (r.pitch * factor).wrapped();
  }
  void operator()(GyroReading& r) const { r.w_B *= factor; }
  void operator()(VelocityReading& r) const { r.v_B *= factor; }
  void operator()(DepthReading& r) const { r.depth *= factor; }
  void operator()(GpsReading& r) const { r.north_east *= factor; }
  void operator()(LblReading& r) const { r.north_east *= factor; }
};
struct Shift {
  double by;
  void operator()(CompassReading& r) const { r.heading = (r.heading + Angle::radians(by)).wrapped(); }
  void operator()(AttitudeReading& r) const { r.roll = (r.roll + Angle::radians(by)).wrapped(); }
  void operator()(GyroReading& r) const { r.w_B.z() += by; }
  void operator()(VelocityReading& r) const { r.v_B.x() += by; }
  void operator()(DepthReading& r) const { r.depth += by; }
  void operator()(GpsReading& r) const { r.north_east.x() += by; }
  void operator()(LblReading& r) const { r.north_east.x() += by; }
};

constexpr double kNotFiniteShare = 0.125;  // share of garbage values that are not finite

double wild(Random& random, double size) {
  const double value = random.uniform(-size, size);
  return random.uniform() < kNotFiniteShare ? std::numeric_limits<double>::quiet_NaN() : value;
}
struct Garble {
  Random* random;
  [[nodiscard]] double operator[](double size) const { return wild(*random, size); }
  void operator()(CompassReading& r) const { r.heading = Angle::radians((*this)[3.14]); }
  void operator()(AttitudeReading& r) const {
    r.roll = Angle::radians((*this)[3.14]);
    r.pitch = Angle::radians((*this)[1.57]);
  }
  void operator()(GyroReading& r) const {
    for (double& w : r.w_B) w = (*this)[5];
  }
  void operator()(VelocityReading& r) const {
    for (double& v : r.v_B) v = (*this)[10];
  }
  void operator()(DepthReading& r) const { r.depth = (*this)[1000]; }
  void operator()(GpsReading& r) const {
    for (double& p : r.north_east) p = (*this)[1e5];
  }
  void operator()(LblReading& r) const {
    for (double& p : r.north_east) p = (*this)[1e5];
  }
};

void scale(NavReading& r, double factor) { std::visit(Scale{factor}, r.value); }
void scale(RangeReading& r, double factor) {
  if (r.range_m) *r.range_m *= factor;
}
void scale(Navigation& r, double factor) {
  r.X_WB.translation *= factor;
  if (r.v_WB) *r.v_WB *= factor;
}
void scale(Ping& r, double factor) {
  r.window.start_m *= factor;
  r.window.bin_m *= factor;
}

void shift(NavReading& r, double by) { std::visit(Shift{by}, r.value); }
void shift(RangeReading& r, double by) {
  if (r.range_m) r.range_m = std::max(0.0, *r.range_m + by);
}
void shift(Navigation& r, double by) { r.X_WB.translation.x() += by; }
void shift(Ping&, double) {}

void garble(NavReading& r, Random& random) { std::visit(Garble{&random}, r.value); }
void garble(RangeReading& r, Random& random) { r.range_m = std::abs(wild(random, r.max_range_m)); }
void garble(Navigation& r, Random& random) {
  for (double& p : r.X_WB.translation) p = wild(random, 1e5);
  if (r.v_WB) {
    for (double& v : *r.v_WB) v = wild(random, 10);
  }
}

float highest(const Ping& ping) {
  switch (ping.intensity.type()) {
    case SampleType::kU8: return std::min(ping.full_scale, 255.0F);
    case SampleType::kU16: return std::min(ping.full_scale, 65535.0F);
    case SampleType::kF32: return ping.full_scale;
  }
  return 0;
}

std::size_t size_of(SampleType type) { return type == SampleType::kU8 ? 1 : type == SampleType::kU16 ? 2 : 4; }

void store(std::byte* at, SampleType type, float value) {
  if (type == SampleType::kF32) {
    std::memcpy(at, &value, sizeof value);
  } else if (type == SampleType::kU16) {
    const auto whole = static_cast<std::uint16_t>(std::lround(value));
    std::memcpy(at, &whole, sizeof whole);
  } else {
    *at = static_cast<std::byte>(static_cast<std::uint8_t>(std::lround(value)));
  }
}

/// Replaces the samples of a ping by sample(beam, old value), in storage of its own; the old samples may be shared.
template <class Sample>
void replace_samples(Ping& ping, Sample sample) {
  const Intensities old = ping.intensity;
  const std::size_t width = size_of(old.type());
  const auto beams = static_cast<std::size_t>(old.beams()), bins = static_cast<std::size_t>(old.bins());
  auto samples = std::make_shared<std::vector<std::byte>>(beams * bins * width);
  std::byte* at = samples->data();
  for (int b = 0; b < old.beams(); ++b) {
    for (int k = 0; k < old.bins(); ++k, at += width) {
      store(at, old.type(), std::clamp(sample(b, old(b, k)), 0.0F, highest(ping)));
    }
  }
  ping.intensity = {samples->data(),
                    old.type(),
                    old.beams(),
                    old.bins(),
                    static_cast<std::ptrdiff_t>(bins * width),
                    static_cast<std::ptrdiff_t>(width)};
  ping.storage = std::move(samples);
}

void garble(Ping& r, Random& random) {
  replace_samples(r, [&, top = highest(r)](int, float) { return top * static_cast<float>(random.uniform()); });
}

void hurt_sonar(Ping& ping, const FaultConfig& fault) {
  const auto amount = static_cast<float>(fault.amount);
  if (fault.kind == FaultKind::kWrongGain) {
    replace_samples(ping, [&](int, float old) { return old * amount; });
  } else if (fault.kind == FaultKind::kSaturated) {
    replace_samples(ping, [top = highest(ping)](int, float) { return top; });
  } else if (fault.kind == FaultKind::kBlindSide) {
    replace_samples(ping, [&](int beam, float old) {
      return ping.fan->azimuth[static_cast<std::size_t>(beam)].radians() * fault.amount > 0 ? 0.0F : old;
    });
  }
}
template <class T>
void hurt_sonar(T&, const FaultConfig&) {}

/// Gives the present reading the content of the held one. It keeps its own time, and a ping its own direction.
template <class T>
void repeat(const T& held, T& present) {
  const Time time = present.time;
  present = held;
  present.time = time;
}
void repeat(const Ping& held, Ping& present) {
  // A scanning head keeps turning and repeats the samples. If the number of beams or bins has changed, the whole ping
  // is repeated.
  if (held.intensity.beams() != present.intensity.beams() || held.window.bins != present.window.bins) {
    const Time time = present.time;
    present = held;
    present.time = time;
    return;
  }
  present.intensity = held.intensity;
  present.storage = held.storage;
  present.full_scale = held.full_scale;
}

}  // namespace

template <class T>
FaultyChannel<T>::FaultyChannel(const FaultSchedule& schedule, const std::string& source) : schedule_(&schedule) {
  Random root(schedule.seed());
  for (std::size_t i = 0; i < schedule.faults().size(); ++i) {
    const Random own = root.fork();
    if (schedule.faults()[i].source == source) faults_.push_back({i, own});
  }
}

template <class T>
void FaultyChannel<T>::push(Time now, T reading) {
  bool sound = true, arrives = true;
  Duration delay{};
  for (Fault& fault : faults_) {
    const std::optional<Time> since = schedule_->active_since(fault.index, now);
    if (!since) {
      fault.last_passed.reset();
      fault.held.reset();
      continue;
    }
    if (sound) {
      if (!fault.held) fault.held = last_good_ ? last_good_ : reading;
    } else if (!fault.held) {
      fault.held = reading;
    }
    sound = false;
    arrives = arrives && apply(fault, *since, now, reading, delay);
  }
  if (sound && !faults_.empty()) last_good_ = reading;
  if (!arrives) return;
  const Time arrival = now + delay;
  const auto later = [](Time time, const Waiting& w) { return time < w.arrival; };
  const auto place = std::upper_bound(waiting_.begin(), waiting_.end(), arrival, later);
  waiting_.insert(place, {arrival, std::move(reading)});
}

template <class T>
std::optional<T> FaultyChannel<T>::pop(Time now) {
  if (waiting_.empty() || waiting_.front().arrival > now) return std::nullopt;
  std::optional<T> reading = std::move(waiting_.front().reading);
  waiting_.erase(waiting_.begin());
  return reading;
}

template <class T>
bool FaultyChannel<T>::apply(Fault& fault, Time since, Time now, T& reading, Duration& delay) {
  const FaultConfig& f = schedule_->faults()[fault.index];
  const double held_for = to_seconds(now - since);
  switch (f.kind) {
    case FaultKind::kOff: return false;
    case FaultKind::kStuck: repeat(*fault.held, reading); return true;
    case FaultKind::kGarbage: garble(reading, fault.random); return true;
    case FaultKind::kWrongScale: scale(reading, f.amount); return true;
    case FaultKind::kSlow:
      if (fault.last_passed && now - *fault.last_passed < seconds(f.period_s)) return false;
      fault.last_passed = now;
      return true;
    case FaultKind::kDelayed: delay += seconds(f.amount); return true;
    case FaultKind::kIntermittent:
      if (f.period_s > 0) return std::fmod(held_for, f.period_s) >= f.amount * f.period_s;
      return fault.random.uniform() >= f.amount;
    case FaultKind::kDrifting: shift(reading, f.amount * held_for); return true;
    case FaultKind::kJump: shift(reading, f.amount); return true;
    default: hurt_sonar(reading, f); return true;
  }
}

template class FaultyChannel<NavReading>;
template class FaultyChannel<RangeReading>;
template class FaultyChannel<Navigation>;
template class FaultyChannel<Ping>;

}  // namespace isobath
