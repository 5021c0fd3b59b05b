#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstring>
#include <isobath/base/nearest_name.hpp>
#include <isobath/sim/faults.hpp>
#include <limits>

namespace isobath {
namespace {

const std::vector<std::pair<std::string, FaultKind>>& kinds() {
  static const std::vector<std::pair<std::string, FaultKind>> kNames = {
      {"off", FaultKind::kOff},
      {"stuck", FaultKind::kStuck},
      {"garbage", FaultKind::kGarbage},
      {"wrong_scale", FaultKind::kWrongScale},
      {"wrong_gain", FaultKind::kWrongGain},
      {"slow", FaultKind::kSlow},
      {"delayed", FaultKind::kDelayed},
      {"intermittent", FaultKind::kIntermittent},
      {"drifting", FaultKind::kDrifting},
      {"jump", FaultKind::kJump},
      {"blind_side", FaultKind::kBlindSide},
      {"saturated", FaultKind::kSaturated},
      {"leak", FaultKind::kLeak},
      {"battery", FaultKind::kBattery},
      {"thruster_loss", FaultKind::kThrusterLoss},
      {"clock_jump", FaultKind::kClockJump},
  };
  return kNames;
}

enum class SourceKind : std::uint8_t {
  kUnknown,
  kSonar,
  kReading,
  kThruster,
  kVehicle,
  kAgent,
  kPlanner,
  kLink,
  kHost
};

/// The number in "sonar.2"; 0 if there is none, -1 if it is not in 1 .. 99 (1 .. VehicleFaults::kMaxThrusters).
int number_of(std::string_view source) {
  const auto dot = source.find('.');
  if (dot == std::string_view::npos) return 0;
  const std::string_view digits = source.substr(dot + 1);
  int number = -1;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), number);
  const int highest = source.starts_with("thruster") ? VehicleFaults::kMaxThrusters : 99;
  return error == std::errc() && end == digits.data() + digits.size() && number >= 1 && number <= highest ? number : -1;
}

constexpr std::string_view kAgentPrefix = "agent.";

SourceKind kind_of(std::string_view source) {
  if (source.starts_with(kAgentPrefix)) {
    return source.size() > kAgentPrefix.size() ? SourceKind::kAgent : SourceKind::kUnknown;
  }
  if (source == "planner") return SourceKind::kPlanner;
  if (source == "link") return SourceKind::kLink;
  if (source == "health" || source == "disk") return SourceKind::kHost;
  const int number = number_of(source);
  const std::string_view name = source.substr(0, source.find('.'));
  if (number < 0) return SourceKind::kUnknown;
  if (name == "sonar") return SourceKind::kSonar;
  if (name == "altimeter") return SourceKind::kReading;
  if (name == "thruster") return SourceKind::kThruster;
  if (number > 0) return SourceKind::kUnknown;
  if (name == "vehicle") return SourceKind::kVehicle;
  for (const char* known : {"compass", "ahrs", "gyro", "dvl", "depth", "gps", "lbl", "navigation"}) {
    if (name == known) return SourceKind::kReading;
  }
  return SourceKind::kUnknown;
}

bool fits(FaultKind kind, SourceKind source) {
  const bool sensor = source == SourceKind::kSonar || source == SourceKind::kReading;
  switch (kind) {
    case FaultKind::kOff:
      return sensor || source == SourceKind::kAgent || source == SourceKind::kLink || source == SourceKind::kHost;
    case FaultKind::kStuck: return sensor || source == SourceKind::kAgent;
    case FaultKind::kWrongScale: return sensor || source == SourceKind::kPlanner;
    case FaultKind::kGarbage:
    case FaultKind::kSlow:
    case FaultKind::kDelayed: return sensor;
    case FaultKind::kIntermittent: return sensor || source == SourceKind::kLink;
    case FaultKind::kDrifting:
    case FaultKind::kJump: return source == SourceKind::kReading;
    case FaultKind::kWrongGain:
    case FaultKind::kBlindSide:
    case FaultKind::kSaturated: return source == SourceKind::kSonar;
    case FaultKind::kThrusterLoss: return source == SourceKind::kThruster;
    case FaultKind::kLeak:
    case FaultKind::kBattery:
    case FaultKind::kClockJump: return source == SourceKind::kVehicle;
  }
  return false;
}

/// The allowed amounts of a kind; empty if `amount` is one of them. Kinds without an amount allow only 0.
std::string wanted_amount(FaultKind kind, double amount) {
  const double size = std::abs(amount);
  switch (kind) {
    case FaultKind::kWrongScale:
    case FaultKind::kWrongGain:
      return amount >= 0.001 && amount <= 1000 && amount != 1 ? "" : "a factor 0.001 .. 1000, not 1";
    case FaultKind::kDelayed: return amount > 0 && amount <= 3600 ? "" : "seconds above 0, up to 3600";
    case FaultKind::kIntermittent:
    case FaultKind::kBattery:
    case FaultKind::kThrusterLoss: return amount > 0 && amount <= 1 ? "" : "a share above 0, up to 1";
    case FaultKind::kDrifting: return size > 0 && size <= 1000 ? "" : "-1000 .. 1000 a second, not 0";
    case FaultKind::kJump: return size > 0 && size <= 1e6 ? "" : "-1e6 .. 1e6, not 0";
    case FaultKind::kBlindSide: return size == 1 ? "" : "-1 (port) or 1 (starboard)";
    case FaultKind::kClockJump: return size > 0 && size <= 1e9 ? "" : "seconds, -1e9 .. 1e9, not 0";
    default: return amount == 0 ? "" : "none with this kind";
  }
}

void check_fault(const FaultConfig& f) {
  const auto at = [&](const char* key) {
    Place place = f.place;
    place.key = std::string("fault.") + key;
    return place;
  };
  const SourceKind source = kind_of(f.source);
  if (source == SourceKind::kUnknown) {
    throw Error("unknown source \"" + f.source + "\"", at("source"),
                "sonar, sonar.2 .., altimeter, altimeter.2 .., compass, ahrs, gyro, dvl, depth, gps, lbl, navigation, "
                "thruster, thruster.1 .. thruster.16, vehicle, agent.NAME, link, health, disk or planner",
                did_you_mean(f.source, {"sonar", "altimeter", "compass", "ahrs", "gyro", "dvl", "depth", "gps", "lbl",
                                        "navigation", "thruster", "vehicle", "link", "health", "disk", "planner"}));
  }
  const std::string kind = to_text(f.kind);
  if (!fits(f.kind, source)) throw Error(f.source + " cannot have the fault " + kind, at("kind"));
  if (const std::string wanted = wanted_amount(f.kind, f.amount); !wanted.empty()) {
    throw Error("invalid amount for " + kind, at("amount"), wanted);
  }
  const bool may_period =
      (f.kind == FaultKind::kIntermittent && source != SourceKind::kLink) || f.kind == FaultKind::kBattery;
  if (f.kind == FaultKind::kSlow && !(f.period_s > 0)) throw Error("slow needs a period", at("period_s"), "above 0 s");
  if (f.kind != FaultKind::kSlow && !may_period && f.period_s != 0) {
    throw Error(kind + " has no period", at("period_s"), "0");
  }
  const auto time = [](double s) { return s >= 0 && s <= 1e8; };
  if (!time(f.at_s) || !time(f.after_s) || !time(f.for_s) || !time(f.period_s)) {
    throw Error("a time is out of range", at("at_s"), "0 .. 1e8 s");
  }
  if (!f.when.empty() && f.at_s != 0) {
    throw Error("an event and a time are both given", at("at_s"), "", "use after_s to wait after the event");
  }
}

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

const char* to_text(FaultKind kind) {
  for (const auto& [name, k] : kinds()) {
    if (k == kind) return name.c_str();
  }
  return "";
}

std::vector<Field> fields(FaultConfig& c) {
  return {
      Field::text(
          "source", &c.source,
          "What fails: a sensor (sonar, sonar.2, dvl, ...), thruster.2, vehicle, agent.NAME, link, health, disk or "
          "planner."),
      Field::choice("kind", &c.kind, kinds(), "Kind of fault."),
      Field::real("at_s", &c.at_s, {0, 1e8}, "s", "Start of the fault, from the start of the run."),
      Field::text("when", &c.when, "Name of an event that starts the fault instead of at_s; empty: none."),
      Field::real("after_s", &c.after_s, {0, 1e8}, "s", "Delay after at_s or after the event."),
      Field::real("for_s", &c.for_s, {0, 1e8}, "s", "Duration; 0: to the end of the run."),
      Field::real("amount", &c.amount, {}, "",
                  "Size of the fault: a factor, a share, seconds or a rate, depending on the kind."),
      Field::real("period_s", &c.period_s, {0, 1e8}, "s",
                  "Period of a slow or intermittent fault; duration of a loss of charge."),
  };
}

SectionList section_list(std::vector<FaultConfig>& faults) {
  return {"fault", "A fault: what fails, how and when.", [&faults](const Place& place) {
            FaultConfig& fault = faults.emplace_back();
            fault.place = place;
            return fields(fault);
          }};
}

FaultSchedule::FaultSchedule(std::vector<FaultConfig> faults, std::uint64_t seed, Time start)
    : faults_(std::move(faults)), begin_(faults_.size()), seed_(seed) {
  for (std::size_t i = 0; i < faults_.size(); ++i) {
    check_fault(faults_[i]);
    if (faults_[i].when.empty()) begin_[i] = start + seconds(faults_[i].at_s) + seconds(faults_[i].after_s);
  }
}

void FaultSchedule::raise(std::string_view event, Time now) {
  for (std::size_t i = 0; i < faults_.size(); ++i) {
    if (!begin_[i] && faults_[i].when == event) begin_[i] = now + seconds(faults_[i].after_s);
  }
}

std::optional<Time> FaultSchedule::active_since(std::size_t i, Time now) const {
  const std::optional<Time>& begin = begin_[i];
  if (!begin || now < *begin) return std::nullopt;
  if (faults_[i].for_s > 0 && now >= *begin + seconds(faults_[i].for_s)) return std::nullopt;
  return begin;
}

const FaultConfig* FaultSchedule::active(std::string_view source, Time now) const {
  for (std::size_t i = 0; i < faults_.size(); ++i) {
    if (faults_[i].source == source && active_since(i, now)) return &faults_[i];
  }
  return nullptr;
}

VehicleFaults FaultSchedule::vehicle_faults(Time now) const {
  VehicleFaults all;
  all.thrust_share.fill(1);
  for (std::size_t i = 0; i < faults_.size(); ++i) {
    const FaultConfig& f = faults_[i];
    if (f.kind == FaultKind::kBattery && begin_[i] && now >= *begin_[i]) {  // lost charge stays lost
      double held = to_seconds(now - *begin_[i]);
      if (f.for_s > 0) held = std::min(held, f.for_s);
      all.battery_lost += f.amount * (f.period_s > 0 ? std::min(1.0, held / f.period_s) : 1.0);
    }
    if (!active_since(i, now)) continue;
    if (f.kind == FaultKind::kLeak) all.leak = true;
    if (f.kind == FaultKind::kClockJump) all.clock_offset += seconds(f.amount);
    if (f.kind == FaultKind::kThrusterLoss) {
      const int number = number_of(f.source);
      for (int k = 1; k <= VehicleFaults::kMaxThrusters; ++k) {
        if (number == 0 || number == k) all.thrust_share[static_cast<std::size_t>(k - 1)] *= 1 - f.amount;
      }
    }
  }
  all.battery_lost = std::min(1.0, all.battery_lost);
  return all;
}

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
