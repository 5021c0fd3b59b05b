#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <isobath/io/formats/kongsberg/kongsberg_water.hpp>
#include <optional>

namespace isobath {
namespace {

constexpr std::size_t kMaxCells = std::size_t{1} << 24;  // in one ping: 64 MiB
constexpr std::size_t kMaxSparse = 16;                   // cells per recorded sample
constexpr std::size_t kMaxColumnBins = std::size_t{1} << 17;

/// Amplitude for each value of a sample byte.
const std::array<float, 256>& amplitudes() {
  static const std::array<float, 256> table = [] {
    std::array<float, 256> made{};
    for (int i = 0; i < 256; ++i) {
      const double db = 0.5 * static_cast<std::int8_t>(i);
      made[static_cast<std::size_t>(i)] = static_cast<float>(std::pow(10, db / 20));
    }
    return made;
  }();
  return table;
}

/// Samples [first, end) that at least one beam has. Sample 0 is the transmission and gets no bin.
struct SampleReach {
  std::size_t first = kMaxColumnBins, end = 0, samples = 0;
};
SampleReach reach_of(const std::vector<WaterBeam>& beams) {
  SampleReach reach;
  for (const WaterBeam& beam : beams) {
    if (beam.samples.empty()) continue;
    reach.first = std::min(reach.first, std::max<std::size_t>(1, beam.first));
    reach.end = std::max(reach.end, beam.first + beam.samples.size());
    reach.samples += beam.samples.size();
  }
  return reach;
}

/// For an array that is mounted backwards, heading and pitch are converted to those of the same array turned by 180
/// degrees.
Rotation rotation_of(const WaterMount& mount, double tilt_deg) {
  const double heading = Angle::degrees(mount.heading_deg).wrapped().degrees();
  const bool backwards = std::abs(heading) > 90;
  const double turn = backwards ? heading - std::copysign(180.0, heading) : heading;
  const double forward = (backwards ? -1 : 1) * (mount.pitch_deg + tilt_deg);
  return Rotation::from_heading_pitch_roll(Angle::degrees(turn), Angle::degrees(forward - 90), {});
}

struct Tilts {
  double mean_deg = 0, spread_deg = 0;
};
/// The tilts of the beams; empty if the angles are impossible or the beams do not run from port to starboard.
std::optional<Tilts> tilts_of(const std::vector<WaterBeam>& beams) {
  double sum = 0, least = beams[0].tilt_deg, most = least;
  for (std::size_t i = 0; i < beams.size(); ++i) {
    const WaterBeam& beam = beams[i];
    const bool aims = std::abs(beam.to_port_deg) <= 90 && std::abs(beam.tilt_deg) <= 45;
    if (!aims || (i > 0 && !(beam.to_port_deg < beams[i - 1].to_port_deg))) return std::nullopt;
    sum += beam.tilt_deg;
    least = std::min(least, beam.tilt_deg);
    most = std::max(most, beam.tilt_deg);
  }
  return Tilts{sum / static_cast<double>(beams.size()), most - least};
}

}  // namespace

std::string water_setting(int gain, int offset_db, std::size_t beams) {
  return fmt::format("{} beams, half decibels, with a gain of {} log r {:+d} dB", beams, gain, offset_db);
}

const char* to_text(WaterFault fault) {
  switch (fault) {
    case WaterFault::kNoSamples: return "water column without samples";
    case WaterFault::kBadRate: return "water column whose sample rate is impossible";
    case WaterFault::kBadSoundSpeed: return "water column whose sound speed is impossible";
    case WaterFault::kBadSizes: return "water column whose sizes contradict each other";
    case WaterFault::kBadBeams: return "water column whose beams are out of order or point nowhere";
  }
  return "unknown";
}

Result<Ping, WaterFault> WaterPings::ping(const WaterRecord& record) {
  const std::vector<WaterBeam>& beams = record.beams;
  const SampleReach reach = reach_of(beams);
  if (reach.first >= reach.end) return tl::unexpected(WaterFault::kNoSamples);
  if (!(record.sample_hz >= 10 && record.sample_hz <= 1e6)) return tl::unexpected(WaterFault::kBadRate);
  const bool water = record.sound_speed > 1000 && record.sound_speed < 2000;
  if (!water) return tl::unexpected(WaterFault::kBadSoundSpeed);
  const std::size_t span = reach.end - reach.first, bins = (span + kBinStep - 1) / kBinStep * kBinStep;
  const bool sparse = beams.size() * span > kMaxSparse * reach.samples;
  if (bins > kMaxColumnBins || beams.size() * bins > kMaxCells || sparse) return tl::unexpected(WaterFault::kBadSizes);
  const auto tilts = tilts_of(beams);
  if (!tilts) return tl::unexpected(WaterFault::kBadBeams);

  Ping ping;
  ping.time = record.time;
  ping.sound_speed = record.sound_speed;
  ping.fan = fan_of(record, record.height + Angle::degrees(tilts->spread_deg));
  const double bin_m = bin_of(record.sound_speed / (2 * record.sample_hz));
  ping.window = {(static_cast<double>(reach.first) - 0.5) * bin_m, bin_m, static_cast<int>(bins)};
  ping.X_BS = {rotation_of(record.mount, tilts->mean_deg), record.mount.p_BS};
  ping.full_scale = amplitudes()[127];
  take_samples(record, reach.first, ping);
  return ping;
}

/// Bin 0 is sample `first`.
void WaterPings::take_samples(const WaterRecord& record, std::size_t first, Ping& ping) {
  const std::size_t row = static_cast<std::size_t>(ping.window.bins) * sizeof(float);
  const std::size_t size = record.beams.size() * row;
  std::byte* const cells = arena_.take(size);
  std::fill_n(cells, size, std::byte{0});
  auto sampled = std::make_shared<std::vector<BinSpan>>();
  std::byte* line = cells;
  for (const WaterBeam& beam : record.beams) {
    const std::size_t before = std::min(first - std::min(first, beam.first), beam.samples.size());
    const Bytes samples = beam.samples.subspan(before);
    const std::size_t bin = samples.empty() ? 0 : beam.first + before - first;
    std::byte* at = line + bin * sizeof(float);
    for (const std::byte sample : samples) {
      const float amplitude = amplitudes()[static_cast<std::uint8_t>(sample)];
      std::memcpy(at, &amplitude, sizeof amplitude);
      at += sizeof amplitude;
    }
    sampled->push_back({static_cast<int>(bin), static_cast<int>(bin + samples.size())});
    line += row;
  }
  ping.intensity = Intensities(cells, SampleType::kF32, ping.fan->beams(), ping.window.bins,
                               static_cast<std::ptrdiff_t>(row), sizeof(float));
  ping.storage = arena_.owner();
  ping.sampled = std::move(sampled);
}

std::shared_ptr<const BeamFan> WaterPings::fan_of(const WaterRecord& record, Angle height) {
  const std::vector<WaterBeam>& beams = record.beams;
  const auto azimuth = [&](std::size_t i) { return Angle::degrees(-beams[i].to_port_deg); };
  const auto near = [](Angle a, Angle b) { return std::abs((a - b).radians()) < kSameAngle.radians(); };
  const auto same = [&](const std::shared_ptr<const BeamFan>& fan) {
    if (fan->azimuth.size() != beams.size() || !near(fan->height, height) || !near(fan->width[0], record.width)) {
      return false;
    }
    for (std::size_t i = 0; i < beams.size(); ++i) {
      if (!near(fan->azimuth[i], azimuth(i))) return false;
    }
    return true;
  };
  const auto known = std::find_if(fans_.begin(), fans_.end(), same);
  if (known != fans_.end()) {
    std::rotate(fans_.begin(), known, known + 1);  // most recently used first
    return fans_.front();
  }
  BeamFan fan;
  fan.width.assign(beams.size(), record.width);
  fan.height = height;
  for (std::size_t i = 0; i < beams.size(); ++i) fan.azimuth.push_back(azimuth(i));
  if (fans_.size() == kKept) fans_.pop_back();
  fans_.insert(fans_.begin(), std::make_shared<const BeamFan>(std::move(fan)));
  return fans_.front();
}

double WaterPings::bin_of(double exact_m) {
  const auto same = [&](double known) { return std::abs(known / exact_m - 1) < kSameBin; };
  const auto known = std::find_if(bins_m_.begin(), bins_m_.end(), same);
  if (known != bins_m_.end()) return *known;
  if (bins_m_.size() == kKept) bins_m_.erase(bins_m_.begin());
  bins_m_.push_back(exact_m);
  return exact_m;
}

}  // namespace isobath
