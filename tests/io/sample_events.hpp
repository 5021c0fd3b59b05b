// Made-up events of every kind, and their comparison bit for bit.
#pragma once

#include <algorithm>
#include <bit>
#include <isobath/base/random.hpp>
#include <isobath/event/event.hpp>

namespace isobath::test {

inline Pose sample_pose(Random& random) {
  const Eigen::Vector3d turn(random.normal(), random.normal(), random.normal());
  return {Rotation::exp(turn), Eigen::Vector3d(random.normal(), random.normal(), random.normal()) * 100};
}

/// Samples run range by range or beam by beam, forwards or backwards, as the seed says.
inline Ping sample_ping(SampleType type, int beams, std::uint64_t seed) {
  Random random(seed);
  const int bins = 3 + static_cast<int>(random.index(20));
  const std::ptrdiff_t size = type == SampleType::kU8 ? 1 : type == SampleType::kU16 ? 2 : 4;
  auto fan = std::make_shared<BeamFan>();
  for (int b = 0; b < beams; ++b) {
    fan->azimuth.push_back(Angle::radians(0.1 * b + 1e-3 / 3));
    fan->width.push_back(Angle::radians(0.1 + 1.0 / (7 * (b + 1))));
  }
  fan->height = Angle::degrees(14.0 / 3);
  auto bytes = std::make_shared<std::vector<std::uint8_t>>();
  for (int i = 0; i < beams * bins; ++i) {
    const auto value = static_cast<float>(random.normal());
    std::uint8_t raw[4];
    std::memcpy(raw, &value, 4);
    bytes->insert(bytes->end(), raw, raw + size);
  }
  const bool by_beam = random.index(2) == 0, backwards = random.index(2) == 0;
  std::ptrdiff_t beam_stride = by_beam ? bins * size : size, bin_stride = by_beam ? size : beams * size;
  const std::uint8_t* first = bytes->data();
  if (backwards) {
    first += (beams - 1) * beam_stride;
    beam_stride = -beam_stride;
  }
  Ping ping;
  ping.time = Time{Duration(static_cast<std::int64_t>(random.bits() >> 2))};
  ping.fan = std::move(fan);
  ping.window = {random.uniform(), random.uniform(0.01, 0.1), bins};
  ping.intensity = Intensities(first, type, beams, bins, beam_stride, bin_stride);
  ping.storage = bytes;
  ping.X_BS = sample_pose(random);
  ping.sound_speed = random.uniform(1400, 1600);
  ping.blanking_m = random.uniform(0, 2);
  ping.full_scale = 1.5f;
  ping.sweep = static_cast<SweepMark>(random.index(3));
  return ping;
}

inline Swath sample_swath(Random& random) {
  Swath swath;
  swath.time = Time{Duration(static_cast<std::int64_t>(random.bits()))};
  swath.frame = random.index(2) == 0 ? Swath::Frame::kBody : Swath::Frame::kLevel;
  if (random.index(2) == 0) swath.heading = Angle::radians(random.normal());
  swath.beam_width = Angle::radians(random.uniform());
  swath.beam_height = Angle::radians(random.uniform());
  swath.sound_speed = random.uniform(1400, 1600);
  const auto number = [&] { return static_cast<float>(random.normal()); };
  swath.soundings.resize(random.index(20));
  for (Sounding& s : swath.soundings) {
    s.point = {number(), number(), random.index(9) == 0 ? NAN : number()};
    s.range_m = number();
    s.sigma_m = number();
    s.beam = static_cast<std::uint16_t>(random.bits());
    s.kind = random.index(2) == 0 ? Sounding::Kind::kBottom : Sounding::Kind::kWater;
  }
  return swath;
}

inline std::vector<Event> sample_events(int count, std::uint64_t seed) {
  Random random(seed);
  std::vector<Event> events;
  for (int i = 0; i < count; ++i) {
    const auto kind = random.index(7);
    if (kind < 3) {
      events.push_back(
          sample_ping(static_cast<SampleType>(kind), 1 + static_cast<int>(random.index(8)), random.bits()));
    } else if (kind == 3) {
      Navigation fix{Time{Duration(static_cast<std::int64_t>(random.bits()))}, sample_pose(random), {}, {}};
      if (i % 2) fix.v_WB = Eigen::Vector3d(random.normal(), -0.0, 1e300);
      if (i % 3) fix.covariance = Eigen::Matrix<double, 6, 6>::NullaryExpr([&] { return random.normal(); });
      if (i % 5 == 0) fix.v_sigma = random.uniform();
      if (i % 7 == 0) fix.X_WB.translation.y() = NAN;
      events.push_back(fix);
    } else if (kind == 6) {
      events.emplace_back(sample_swath(random));
    } else if (kind == 5 && i % 3 == 0) {
      OperatorFrame frame{Time{Duration(i)}, {}};
      for (std::uint64_t size = random.index(5); size > 0; --size) {
        frame.bytes.push_back(static_cast<std::uint8_t>(random.bits()));
      }
      events.emplace_back(std::move(frame));
    } else if (kind == 5 && i % 3 == 1) {
      PassiveBearing heard{.time = Time{Duration(i)},
                           .bearing = Angle::radians(random.normal()),
                           .sigma = Angle::radians(random.uniform()),
                           .elevation = {},
                           .frequency_hz = 1000 * random.uniform(),
                           .resolution_hz = random.uniform(),
                           .snr_db = random.normal(),
                           .X_BS = sample_pose(random)};
      if (i % 2) heard.elevation = Angle::radians(random.normal());
      if (i % 5 == 0) heard.frequency_hz = NAN;
      events.emplace_back(heard);
    } else if (kind == 5) {
      Health health{Time{Duration(i)}, i % 2 ? "vehicle" : "", static_cast<HealthState>(i % 3), 0.5f, i % 5 == 0,
                    "a note"};
      events.emplace_back(std::move(health));
    } else {
      RangeReading reading{Time{Duration(i)}, {}, 50.1, Angle::degrees(i / 3.0), sample_pose(random), 0.3f};
      if (i % 2) reading.range_m = random.uniform();
      events.push_back(reading);
    }
  }
  return events;
}

inline bool same(double a, double b) { return std::bit_cast<std::uint64_t>(a) == std::bit_cast<std::uint64_t>(b); }

inline bool same(const Pose& a, const Pose& b) {
  for (int i = 0; i < 3; ++i) {
    if (!same(a.translation[i], b.translation[i])) return false;
  }
  for (int i = 0; i < 4; ++i) {
    if (!same(a.rotation.quaternion().coeffs()[i], b.rotation.quaternion().coeffs()[i])) return false;
  }
  return true;
}

inline bool same(const BeamFan& a, const BeamFan& b) {
  return a.azimuth == b.azimuth && a.width == b.width && a.height == b.height;
}

inline bool same(const Ping& a, const Ping& b) {
  if (a.time != b.time || !same(*a.fan, *b.fan) || !(a.window == b.window) || !same(a.X_BS, b.X_BS)) return false;
  if (a.sound_speed != b.sound_speed || a.full_scale != b.full_scale || a.sweep != b.sweep) return false;
  if (a.blanking_m != b.blanking_m) return false;
  if (a.intensity.type() != b.intensity.type() || a.intensity.beams() != b.intensity.beams()) return false;
  for (int i = 0; i < a.intensity.beams(); ++i) {
    for (int k = 0; k < a.intensity.bins(); ++k) {
      if (std::bit_cast<std::uint32_t>(a.intensity(i, k)) != std::bit_cast<std::uint32_t>(b.intensity(i, k)))
        return false;
    }
  }
  return true;
}

inline bool same(const Navigation& a, const Navigation& b) {
  if (a.time != b.time || !same(a.X_WB, b.X_WB) || a.v_WB.has_value() != b.v_WB.has_value()) return false;
  if ((a.v_WB && *a.v_WB != *b.v_WB) || a.v_sigma != b.v_sigma) return false;
  return a.covariance.has_value() == b.covariance.has_value() && (!a.covariance || *a.covariance == *b.covariance);
}

inline bool same(const RangeReading& a, const RangeReading& b) {
  return a.time == b.time && a.range_m == b.range_m && same(a.max_range_m, b.max_range_m) && a.width == b.width &&
         same(a.X_BS, b.X_BS) && a.confidence == b.confidence;
}

inline bool same(const Health& a, const Health& b) {
  return a.time == b.time && a.source == b.source && a.state == b.state && a.battery_share == b.battery_share &&
         a.leak == b.leak && a.note == b.note;
}

inline bool same(float a, float b) { return std::bit_cast<std::uint32_t>(a) == std::bit_cast<std::uint32_t>(b); }

inline bool same(const Sounding& a, const Sounding& b) {
  for (Eigen::Index i = 0; i < 3; ++i) {
    if (!same(a.point[i], b.point[i])) return false;
  }
  return same(a.range_m, b.range_m) && same(a.sigma_m, b.sigma_m) && a.beam == b.beam && a.kind == b.kind;
}

inline bool same(const Swath& a, const Swath& b) {
  return a.time == b.time && a.frame == b.frame && a.heading == b.heading && a.beam_width == b.beam_width &&
         a.beam_height == b.beam_height && same(a.sound_speed, b.sound_speed) &&
         std::equal(a.soundings.begin(), a.soundings.end(), b.soundings.begin(), b.soundings.end(),
                    [](const Sounding& x, const Sounding& y) { return same(x, y); });
}

inline bool same(const OperatorFrame& a, const OperatorFrame& b) { return a.time == b.time && a.bytes == b.bytes; }

inline bool same(const PassiveBearing& a, const PassiveBearing& b) {
  return a.time == b.time && a.bearing == b.bearing && a.sigma == b.sigma && a.elevation == b.elevation &&
         same(a.frequency_hz, b.frequency_hz) && a.resolution_hz == b.resolution_hz && a.snr_db == b.snr_db &&
         same(a.X_BS, b.X_BS);
}

inline bool same(const Event& a, const Event& b) {
  return a.index() == b.index() &&
         std::visit([&](const auto& x) { return same(x, std::get<std::decay_t<decltype(x)>>(b)); }, a);
}

}  // namespace isobath::test
