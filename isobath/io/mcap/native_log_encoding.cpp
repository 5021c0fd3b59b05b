#include <algorithm>
#include <cstring>
#include <isobath/io/bytes/cdr.hpp>
#include <isobath/io/mcap/native_log_encoding.hpp>

namespace isobath::native {
namespace {

void put_pose(CdrWriter& w, const Pose& pose) {
  for (int i = 0; i < 3; ++i) w.number(pose.translation[i]);
  for (int i = 0; i < 4; ++i) w.number(pose.rotation.quaternion().coeffs()[i]);  // x y z w
}

template <class Values>
void put_doubles(CdrWriter& w, const Values& values, std::size_t count) {
  std::uint8_t* at = w.sequence<double>(count);
  for (std::size_t i = 0; i < count; ++i) {
    const double value = values(i);
    std::memcpy(at + 8 * i, &value, 8);
  }
}

template <std::size_t kSize>
void copy_beam_by_beam(const Intensities& samples, std::uint8_t* out) {
  for (int b = 0; b < samples.beams(); ++b) {
    const std::byte* at = samples.data() + b * samples.beam_stride();
    for (int k = 0; k < samples.bins(); ++k, at += samples.bin_stride(), out += kSize) std::memcpy(out, at, kSize);
  }
}

void put_samples(CdrWriter& w, const Intensities& samples) {
  const std::size_t count = static_cast<std::size_t>(samples.beams()) * samples.bins();
  const SampleType type = samples.type();
  std::uint8_t* u8 = w.sequence<std::uint8_t>(type == SampleType::kU8 ? count : 0);
  if (type == SampleType::kU8) copy_beam_by_beam<1>(samples, u8);
  std::uint8_t* u16 = w.sequence<std::uint16_t>(type == SampleType::kU16 ? count : 0);
  if (type == SampleType::kU16) copy_beam_by_beam<2>(samples, u16);
  std::uint8_t* f32 = w.sequence<float>(type == SampleType::kF32 ? count : 0);
  if (type == SampleType::kF32) copy_beam_by_beam<4>(samples, f32);
}

void put_ping(CdrWriter& w, const Ping& p, const Intensities& samples) {
  w.number(std::int64_t{p.time.time_since_epoch().count()});
  put_pose(w, p.X_BS);
  w.number(p.sound_speed).number(p.window.start_m).number(p.window.bin_m);
  w.number(static_cast<std::uint32_t>(p.window.bins)).number(p.full_scale).number(p.blanking_m);
  w.number(static_cast<std::uint8_t>(p.sweep));
  w.number(p.fan->height.radians());
  put_doubles(
      w, [&](std::size_t i) { return p.fan->azimuth[i].radians(); }, p.fan->azimuth.size());
  put_doubles(
      w, [&](std::size_t i) { return p.fan->width[i].radians(); }, p.fan->width.size());
  put_samples(w, samples);
  std::uint8_t* at = w.sequence<std::uint32_t>(p.sampled ? 2 * p.sampled->size() : 0);
  for (int b = 0; p.sampled && b < p.fan->beams(); ++b, at += 8) {
    const BinSpan span = sampled_bins(p, b);
    const std::uint32_t ends[] = {static_cast<std::uint32_t>(span.first), static_cast<std::uint32_t>(span.end)};
    std::memcpy(at, ends, sizeof ends);
  }
}

void put(CdrWriter& w, const Ping& p) { put_ping(w, p, p.intensity); }

void put(CdrWriter& w, const Navigation& n) {
  w.number(std::int64_t{n.time.time_since_epoch().count()});
  put_pose(w, n.X_WB);
  put_doubles(
      w, [&](std::size_t i) { return (*n.v_WB)[i]; }, n.v_WB ? 3 : 0);
  put_doubles(
      w, [&](std::size_t i) { return (*n.covariance)(i / 6, i % 6); }, n.covariance ? 36 : 0);
  put_doubles(
      w, [&](std::size_t) { return *n.v_sigma; }, n.v_sigma ? 1 : 0);
}

void put(CdrWriter& w, const RangeReading& r) {
  w.number(std::int64_t{r.time.time_since_epoch().count()});
  put_pose(w, r.X_BS);
  w.number(r.max_range_m).number(r.width.radians()).number(r.confidence);
  put_doubles(
      w, [&](std::size_t) { return *r.range_m; }, r.range_m ? 1 : 0);
}

void put(CdrWriter& w, const Health& h) {
  w.number(std::int64_t{h.time.time_since_epoch().count()}).text(h.source);
  w.number(static_cast<std::uint8_t>(h.state)).number(h.battery_share);
  w.number(static_cast<std::uint8_t>(h.leak)).text(h.note);
}

void put(CdrWriter& w, const OperatorFrame& f) {
  w.number(std::int64_t{f.time.time_since_epoch().count()});
  std::copy(f.bytes.begin(), f.bytes.end(), w.sequence<std::uint8_t>(f.bytes.size()));
}

void put(CdrWriter& w, const PassiveBearing& b) {
  w.number(std::int64_t{b.time.time_since_epoch().count()});
  put_pose(w, b.X_BS);
  w.number(b.bearing.radians()).number(b.sigma.radians());
  w.number(b.frequency_hz).number(b.resolution_hz).number(b.snr_db);
  put_doubles(
      w, [&](std::size_t) { return b.elevation->radians(); }, b.elevation ? 1 : 0);
}

/// Writes one member of every sounding as a list.
template <class Number, class Member>
void put_column(CdrWriter& w, const std::vector<Sounding>& soundings, Member member) {
  std::uint8_t* at = w.sequence<Number>(soundings.size());
  for (const Sounding& s : soundings) {
    const Number value = member(s);
    std::memcpy(at, &value, sizeof value);
    at += sizeof value;
  }
}

void put(CdrWriter& w, const Swath& s) {
  w.number(std::int64_t{s.time.time_since_epoch().count()}).number(static_cast<std::uint8_t>(s.frame));
  put_doubles(
      w, [&](std::size_t) { return s.heading->radians(); }, s.heading ? 1 : 0);
  w.number(s.beam_width.radians()).number(s.sound_speed);
  for (Eigen::Index i = 0; i < 3; ++i) {
    put_column<float>(w, s.soundings, [i](const Sounding& p) { return p.point[i]; });
  }
  put_column<float>(w, s.soundings, [](const Sounding& p) { return p.range_m; });
  put_column<float>(w, s.soundings, [](const Sounding& p) { return p.sigma_m; });
  put_column<std::uint16_t>(w, s.soundings, [](const Sounding& p) { return p.beam; });
  put_column<std::uint8_t>(w, s.soundings, [](const Sounding& p) { return static_cast<std::uint8_t>(p.kind); });
  w.number(s.beam_height.radians());
  put_column<float>(w, s.soundings, [](const Sounding& p) { return p.sigma_range_m; });
}

}  // namespace

bool writable(const Ping& p) {
  return p.fan && p.fan->beams() > 0 && p.fan->width.size() == p.fan->azimuth.size() && p.intensity.data() &&
         p.window.bins > 0 && p.intensity.beams() == p.fan->beams() && p.intensity.bins() == p.window.bins &&
         (!p.sampled || p.sampled->size() == p.fan->azimuth.size());
}

void encode(const Event& event, std::vector<std::uint8_t>& record) {
  CdrWriter w(record);
  std::visit([&](const auto& e) { put(w, e); }, event);
}

void encode_geometry(const Ping& ping, std::vector<std::uint8_t>& record) {
  CdrWriter w(record);
  put_ping(w, ping, {});
}

void encode(const TrueMotion& motion, std::vector<std::uint8_t>& record) {
  CdrWriter w(record);
  w.number(std::int64_t{motion.time.time_since_epoch().count()});
  put_pose(w, motion.state.X_WB);
  for (const Eigen::Vector3d& v : {motion.state.v_B, motion.state.w_B, motion.current_W}) {
    put_doubles(
        w, [&v](std::size_t i) { return v[static_cast<Eigen::Index>(i)]; }, 3);
  }
  put_doubles(
      w, [&](std::size_t) { return *motion.altitude_m; }, motion.altitude_m ? 1 : 0);
}

void encode(const EchoTruth& echoes, std::vector<std::uint8_t>& record) {
  CdrWriter w(record);
  w.number(std::int64_t{echoes.time.time_since_epoch().count()}).text(echoes.sonar);
  w.number(static_cast<std::uint32_t>(echoes.beams)).number(static_cast<std::uint32_t>(echoes.bins));
  std::uint8_t* out = w.sequence<std::uint16_t>(echoes.labels.size());
  for (const EchoLabel label : echoes.labels) {
    *out++ = static_cast<std::uint8_t>(label.code() & 0xff);
    *out++ = static_cast<std::uint8_t>(label.code() >> 8);
  }
}

void encode(Time time, const Setpoint& setpoint, std::vector<std::uint8_t>& record) {
  CdrWriter w(record);
  w.number(std::int64_t{time.time_since_epoch().count()}).number(setpoint.heading.radians());
  w.number(setpoint.depth).number(setpoint.speed).number(setpoint.sway_speed);
}

}  // namespace isobath::native
