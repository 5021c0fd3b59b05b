#include <algorithm>
#include <isobath/sim/faults.hpp>
#include <utility>

namespace isobath {

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
      const int number = number_of_source(f.source);
      for (int k = 1; k <= VehicleFaults::kMaxThrusters; ++k) {
        if (number == 0 || number == k) all.thrust_share[static_cast<std::size_t>(k - 1)] *= 1 - f.amount;
      }
    }
  }
  all.battery_lost = std::min(1.0, all.battery_lost);
  return all;
}

}  // namespace isobath
