// Datagrams of survey logs, built field by field after the descriptions of their formats: Kongsberg .all and .kmall,
// XTF with R2Sonic bathymetry.
#pragma once

#include <bit>
#include <cstring>
#include <string>
#include <tests/io/bytes_by_hand.hpp>
#include <vector>

namespace isobath::test {

/// Bytes with numbers put at their offsets; grows as needed, zero between.
class Record {
 public:
  explicit Record(std::endian order = std::endian::little, std::size_t size = 0) : order_(order), bytes_(size, '\0') {}

  template <class T>
  Record& put(std::size_t at, T value) {
    std::string raw(sizeof value, '\0');
    std::memcpy(raw.data(), &value, sizeof value);
    if (order_ != std::endian::native) raw = {raw.rbegin(), raw.rend()};
    return text(at, raw);
  }
  Record& text(std::size_t at, const std::string& value) {
    if (bytes_.size() < at + value.size()) bytes_.resize(at + value.size());
    bytes_.replace(at, value.size(), value);
    return *this;
  }
  [[nodiscard]] const std::string& bytes() const { return bytes_; }

 private:
  std::endian order_;
  std::string bytes_;
};

/// A datagram of .all: the common fields, then whatever `fields` has been given by offset from the length field.
struct AllDatagram {
  char type = 'X';
  std::uint32_t date = 20200912, ms = 1000;
  std::uint16_t model = 2040, counter = 1, serial = 213;
  std::endian order = std::endian::little;
  Record fields{order};

  [[nodiscard]] std::string bytes() const {
    std::string body = fields.bytes();
    body.resize(std::max<std::size_t>(body.size(), 20));
    Record r(order);
    r.text(0, body).put(0, static_cast<std::uint32_t>(body.size() - 4 + 3)).put<std::uint8_t>(4, 2).put(5, type);
    r.put(6, model).put(8, date).put(12, ms).put(16, counter).put(18, serial).put<std::uint8_t>(body.size(), 3);
    std::uint16_t sum = 0;
    for (std::size_t i = 5; i < body.size(); ++i) {
      sum = static_cast<std::uint16_t>(sum + static_cast<std::uint8_t>(r.bytes()[i]));
    }
    return r.put(body.size() + 1, sum).bytes();
  }
};

struct AllBeam {
  float z = 20, y = 0, x = 0;
  std::uint8_t quality = 0, detection = 0;
  std::int8_t cleaning = 0;
};

/// X: ping of beams. `heading_deg` 90 looks east.
inline AllDatagram all_ping(std::uint32_t ms, const std::vector<AllBeam>& beams, double heading_deg = 0,
                            float transducer_m = 1.5F, std::endian order = std::endian::little) {
  AllDatagram d{.type = 'X', .ms = ms, .order = order, .fields = Record(order)};
  const auto count = static_cast<std::uint16_t>(beams.size());
  d.fields.put(20, static_cast<std::uint16_t>(std::lround(100 * heading_deg))).put<std::uint16_t>(22, 15000);
  d.fields.put(24, transducer_m).put(28, count).put(30, count).put(32, 10000.0F).put<std::uint32_t>(36, 0);
  for (std::size_t i = 0; i < beams.size(); ++i) {
    const std::size_t at = 40 + 20 * i;
    const AllBeam& b = beams[i];
    d.fields.put(at, b.z).put(at + 4, b.y).put(at + 8, b.x).put<std::uint16_t>(at + 12, 10).put(at + 14, b.quality);
    d.fields.put<std::int8_t>(at + 15, 0).put(at + 16, b.detection).put(at + 17, b.cleaning);
    d.fields.put<std::int16_t>(at + 18, -250);
  }
  d.fields.put<std::uint8_t>(40 + 20 * beams.size(), 0);
  return d;
}

/// P: position, speed 1 m/s to the north, heading 90 degrees, fix quality 50 cm.
inline AllDatagram all_position(std::uint32_t ms, double latitude, double longitude, std::uint8_t system = 0x81,
                                std::endian order = std::endian::little) {
  AllDatagram d{.type = 'P', .ms = ms, .order = order, .fields = Record(order)};
  d.fields.put(20, static_cast<std::int32_t>(std::lround(latitude * 2e7)));
  d.fields.put(24, static_cast<std::int32_t>(std::lround(longitude * 1e7)));
  d.fields.put<std::uint16_t>(28, 50).put<std::uint16_t>(30, 100).put<std::uint16_t>(32, 0);
  d.fields.put<std::uint16_t>(34, 9000).put(36, system).put<std::uint8_t>(37, 0);
  return d;
}

struct AllMotion {
  std::uint16_t after_ms = 0;
  double roll_deg = 0, pitch_deg = 0, heave_m = 0, heading_deg = 90;
  std::uint16_t status = 0x9090;
};

/// A: attitude.
inline AllDatagram all_attitude(std::uint32_t ms, const std::vector<AllMotion>& samples, std::uint8_t sensor = 0x01,
                                std::endian order = std::endian::little) {
  AllDatagram d{.type = 'A', .ms = ms, .order = order, .fields = Record(order)};
  d.fields.put(20, static_cast<std::uint16_t>(samples.size()));
  std::size_t at = 22;
  const auto hundredths = [](double value) { return static_cast<std::int16_t>(std::lround(100 * value)); };
  for (const AllMotion& m : samples) {
    d.fields.put(at, m.after_ms).put(at + 2, m.status).put(at + 4, hundredths(m.roll_deg));
    d.fields.put(at + 6, hundredths(m.pitch_deg)).put(at + 8, hundredths(m.heave_m));
    d.fields.put(at + 10, static_cast<std::uint16_t>(std::lround(100 * m.heading_deg)));
    at += 12;
  }
  d.fields.put(at, sensor);
  return d;
}

inline AllDatagram all_installation(const std::string& text) {
  AllDatagram d{.type = 'I'};
  d.fields.put<std::uint16_t>(20, 0).text(22, text);
  return d;
}

/// A datagram of .kmall from what stands behind its header; time in seconds since 1970 (exact in quarters).
inline std::string kmall_datagram(const char* type, double time_s, const std::string& body, std::uint8_t version = 0) {
  Record r;
  const auto length = static_cast<std::uint32_t>(20 + body.size() + 4);
  const auto whole = static_cast<std::uint32_t>(time_s);
  r.put(0, length).text(4, type).put(8, version).put<std::uint8_t>(9, 0).put<std::uint16_t>(10, 2040).put(12, whole);
  r.put(16, static_cast<std::uint32_t>(std::lround((time_s - whole) * 1e9))).text(20, body);
  return r.put(20 + body.size(), length).bytes();
}

struct KmallSounding {
  float z = 10, y = 0, x = 0;
  std::uint8_t type = 0;
  float two_way_s = 0.02F, uncertainty_m = 0.1F;
};

struct KmallPing {
  double time_s = 1600000000;
  double latitude = 47.5, longitude = -122.25, heading_deg = 90;
  float water_level_m = 0.5F;
  std::uint8_t version = 3, position_status = 0;
  std::uint16_t info_bytes = 152, sector_bytes = 48, stride = 120, parts = 1, common_bytes = 12, receiver_bytes = 32;
  std::uint16_t extra = 0;  ///< how many of the soundings are counted as extra detections
  std::vector<KmallSounding> soundings = {};

  [[nodiscard]] std::string bytes() const {
    Record r;
    r.put(0, parts).put<std::uint16_t>(2, 1).put(4, common_bytes).put<std::uint16_t>(6, 17);
    std::size_t at = 4 + std::size_t{common_bytes};
    r.put(at, info_bytes).put(at + 72, 1.0F).put(at + 76, 2.0F).put<std::uint16_t>(at + 92, 1);
    r.put(at + 94, sector_bytes).put(at + 96, static_cast<float>(heading_deg)).put(at + 100, 1500.0F);
    r.put(at + 104, 1.0F).put(at + 108, water_level_m).put(at + 121, position_status).put(at + 124, latitude);
    r.put(at + 132, longitude).put(at + 140, 0.0F);
    at += info_bytes + std::size_t{sector_bytes};
    const auto count = static_cast<std::uint16_t>(soundings.size());
    r.put(at, receiver_bytes).put(at + 2, static_cast<std::uint16_t>(count - extra)).put(at + 4, count);
    r.put(at + 6, stride).put(at + 26, extra).put<std::uint16_t>(at + 28, 1).put<std::uint16_t>(at + 30, 6);
    at += receiver_bytes + std::size_t{6};
    for (std::size_t i = 0; i < soundings.size(); ++i, at += stride) {
      const KmallSounding& s = soundings[i];
      r.put(at, static_cast<std::uint16_t>(i)).put(at + 3, s.type).put(at + 20, s.uncertainty_m);
      r.put(at + 80, s.two_way_s).put(at + 96, s.z).put(at + 100, s.y).put(at + 104, s.x);
      if (stride > 108) r.put<std::uint8_t>(at + stride - 1, 0);
    }
    return kmall_datagram("#MRZ", time_s, r.bytes(), version);
  }
};

inline std::string kmall_position(double time_s, double latitude, double longitude, std::uint16_t status = 1) {
  Record r;
  const auto whole = static_cast<std::uint32_t>(time_s);
  r.put<std::uint16_t>(0, 8).put<std::uint16_t>(2, 0).put(4, status).put(8, whole);
  r.put(12, static_cast<std::uint32_t>(std::lround((time_s - whole) * 1e9))).put(16, 0.5F).put(20, latitude);
  r.put(28, longitude).put(36, 2.0F).put(40, 0.0F).put(44, -20.0F).text(48, "$GPGGA");
  return kmall_datagram("#SPO", time_s, r.bytes());
}

struct KmallMotion {
  double time_s = 1600000000;
  float roll_deg = 0, pitch_deg = 0, heading_deg = 90, heave_m = 0;
  std::uint32_t status = 0;
};

inline std::string kmall_attitude(const std::vector<KmallMotion>& samples, std::uint8_t status = 1) {
  Record r;
  r.put<std::uint16_t>(0, 12).put<std::uint8_t>(2, 0).put(3, status).put<std::uint16_t>(4, 1);
  r.put(6, static_cast<std::uint16_t>(samples.size())).put<std::uint16_t>(8, 132).put<std::uint16_t>(10, 127);
  std::size_t at = 12;
  for (const KmallMotion& m : samples) {
    const auto whole = static_cast<std::uint32_t>(m.time_s);
    r.text(at, "#KMB").put<std::uint16_t>(at + 4, 120).put(at + 8, whole);
    r.put(at + 12, static_cast<std::uint32_t>(std::lround((m.time_s - whole) * 1e9))).put(at + 16, m.status);
    r.put(at + 40, m.roll_deg).put(at + 44, m.pitch_deg).put(at + 48, m.heading_deg).put(at + 52, m.heave_m);
    r.put(at + 92, 0.02F).put(at + 96, 0.03F).put(at + 100, 0.2F).put(at + 104, 0.05F).put(at + 128, 0.0F);
    at += 132;
  }
  return kmall_datagram("#SKM", samples.empty() ? 0 : samples[0].time_s, r.bytes());
}

// Water columns
// --------------------------------------------------------------------------------------------------------

struct WaterBeamBytes {
  double to_port_deg = 0;
  std::vector<std::int8_t> samples = {0, 20, -40};  ///< half decibels
  std::uint16_t first = 1;
  std::uint8_t sector = 0;
};

/// #MWC with 1500 m/s and 30 kHz: a sample every 25 mm.
struct KmallWater {
  double time_s = 1600000000;
  std::vector<WaterBeamBytes> beams = {{60}, {0}, {-60}};
  std::vector<float> tilts_deg = {0};
  std::uint16_t parts = 1, transmit_bytes = 12, sector_bytes = 16, receiver_bytes = 16;
  std::uint8_t entry_bytes = 16, phase = 0;
  float sample_hz = 30000, sound_speed = 1500, along_deg = 1;

  [[nodiscard]] std::string bytes() const {
    Record r;
    r.put(0, parts).put<std::uint16_t>(2, 1).put<std::uint16_t>(4, 12).put<std::uint16_t>(6, 17).put<std::uint8_t>(15,
                                                                                                                   0);
    std::size_t at = 16;
    r.put(at, transmit_bytes).put(at + 2, static_cast<std::uint16_t>(tilts_deg.size())).put(at + 4, sector_bytes);
    r.put(at + transmit_bytes - 1, '\0');
    at += transmit_bytes;
    for (const float tilt : tilts_deg) {
      r.put(at, tilt).put(at + 4, 300e3F).put(at + 8, along_deg).put(at + sector_bytes - 1, '\0');
      at += sector_bytes;
    }
    r.put(at, receiver_bytes).put(at + 2, static_cast<std::uint16_t>(beams.size())).put(at + 4, entry_bytes);
    r.put(at + 5, phase).put<std::uint8_t>(at + 6, 30).put<std::int8_t>(at + 7, 20).put(at + 8, sample_hz);
    r.put(at + receiver_bytes - 4, 0.0F).put(at + 12, sound_speed);
    at += receiver_bytes;
    for (const WaterBeamBytes& beam : beams) {
      const auto count = static_cast<std::uint16_t>(beam.samples.size());
      r.put(at, static_cast<float>(beam.to_port_deg)).put(at + 4, beam.first).put<std::uint16_t>(at + 6, 0);
      r.put<std::uint16_t>(at + 8, beam.sector).put(at + 10, count).put(at + entry_bytes - 1, '\0');
      at += entry_bytes;
      for (const std::int8_t sample : beam.samples) r.put(at++, sample);
      for (std::size_t i = 0; i < std::size_t{count} * phase; ++i) r.put(at++, '\x55');
    }
    return kmall_datagram("#MWC", time_s, r.bytes(), 2);
  }
};

inline std::string kmall_installation(const std::string& text) {
  Record r;
  r.put<std::uint16_t>(0, static_cast<std::uint16_t>(6 + text.size()))
      .put<std::uint16_t>(2, 0)
      .put<std::uint16_t>(4, 0);
  return kmall_datagram("#IIP", 1600000000, r.text(6, text).bytes());
}

/// k: a part of a ping's water column, with 1500 m/s and 30 kHz.
inline AllDatagram all_water(std::uint32_t ms, const std::vector<WaterBeamBytes>& beams, int part = 1, int parts = 1,
                             const std::vector<double>& tilts_deg = {0}, std::endian order = std::endian::little) {
  AllDatagram d{.type = 'k', .ms = ms, .order = order, .fields = Record(order)};
  d.fields.put(20, static_cast<std::uint16_t>(parts)).put(22, static_cast<std::uint16_t>(part));
  d.fields.put(24, static_cast<std::uint16_t>(tilts_deg.size())).put<std::uint16_t>(26, 256);
  d.fields.put(28, static_cast<std::uint16_t>(beams.size())).put<std::uint16_t>(30, 15000);
  d.fields.put<std::uint32_t>(32, 3'000'000)
      .put<std::int16_t>(36, 0)
      .put<std::uint8_t>(38, 30)
      .put<std::int8_t>(39, 20);
  std::size_t at = 44;
  for (std::size_t i = 0; i < tilts_deg.size(); ++i, at += 6) {
    d.fields.put(at, static_cast<std::int16_t>(std::lround(100 * tilts_deg[i]))).put<std::uint16_t>(at + 2, 30000);
    d.fields.put(at + 4, static_cast<std::uint8_t>(i)).put<std::uint8_t>(at + 5, 0);
  }
  for (const WaterBeamBytes& beam : beams) {
    d.fields.put(at, static_cast<std::int16_t>(std::lround(100 * beam.to_port_deg))).put(at + 2, beam.first);
    d.fields.put(at + 4, static_cast<std::uint16_t>(beam.samples.size())).put<std::uint16_t>(at + 6, 0);
    d.fields.put(at + 8, beam.sector).put<std::uint8_t>(at + 9, 0);
    at += 10;
    for (const std::int8_t sample : beam.samples) d.fields.put(at++, sample);
  }
  return d;
}

/// R: widths of a beam along and across, 0.1 degrees.
inline AllDatagram all_widths(int along, int across) {
  AllDatagram d{.type = 'R'};
  d.fields.put(34, static_cast<std::uint16_t>(along))
      .put(37, static_cast<std::uint8_t>(across))
      .put<std::uint8_t>(48, 0);
  return d;
}

// XTF
// ------------------------------------------------------------------------------------------------------------------

inline std::string xtf_header(std::uint16_t units = 3) {
  return Record(std::endian::little, 1024).put<std::uint8_t>(0, 123).put<std::uint8_t>(1, 1).put(164, units).bytes();
}

inline std::string xtf_packet(std::uint8_t type, Record packet) {
  const std::size_t size = (packet.bytes().size() + 63) / 64 * 64;
  packet.put<std::uint16_t>(0, 0xFACE).put(2, type).put(10, static_cast<std::uint32_t>(size));
  std::string bytes = packet.bytes();
  bytes.resize(size);
  return bytes;
}

/// 2015-07-08T23:52:(15 + s), s < 40.
inline void put_xtf_date(Record& r, std::size_t at, double s) {
  r.put<std::uint16_t>(at, 2015).put<std::uint8_t>(at + 2, 7).put<std::uint8_t>(at + 3, 8).put<std::uint8_t>(at + 4,
                                                                                                             23);
  r.put<std::uint8_t>(at + 5, 52).put(at + 6, static_cast<std::uint8_t>(15 + static_cast<int>(s)));
}
inline constexpr std::uint32_t kXtfEpoch = 1436399535;  ///< of s = 0

inline std::string xtf_attitude(double s, float pitch_deg, float roll_deg, float heave_up_m, float heading_deg) {
  Record r(std::endian::little, 64);
  put_xtf_date(r, 54, s);
  r.put(30, pitch_deg).put(34, roll_deg).put(38, heave_up_m).put(50, heading_deg);
  r.put(61, static_cast<std::uint16_t>(std::lround((s - static_cast<int>(s)) * 1e3)));
  return xtf_packet(3, r);
}

inline std::string xtf_position(double s, double latitude, double longitude) {
  Record r(std::endian::little, 64);
  put_xtf_date(r, 14, s);
  r.put(21, static_cast<std::uint16_t>(std::lround((s - static_cast<int>(s)) * 1e4))).put(23, latitude);
  return xtf_packet(107, r.put(31, longitude).put(39, 2.0));
}

struct R2SonicPing {
  double s = 0;
  float sound_speed = 1500, first_angle = -0.5F, angle_unit = 1e-4F, range_unit = 1e-6F;
  std::vector<std::uint16_t> ranges{20000, 16000, 20000}, steps{0, 5000, 5000};
  std::vector<std::uint8_t> flags{8, 4, 8};  ///< phase, magnitude
  bool even_angles = false;

  [[nodiscard]] std::string bytes() const {
    const auto section = [](const char* name, Record r) {
      std::string bytes = r.bytes();
      bytes.resize((bytes.size() + 3) / 4 * 4);
      return Record(std::endian::big)
          .text(0, bytes)
          .text(0, name)
          .put(2, static_cast<std::uint16_t>(bytes.size()))
          .bytes();
    };
    Record h(std::endian::big, 116);
    h.text(4, "2026").put(28, kXtfEpoch + static_cast<std::uint32_t>(s));
    h.put(32, static_cast<std::uint32_t>(std::lround((s - static_cast<int>(s)) * 1e9))).put<std::uint32_t>(36, 7);
    h.put(44, sound_speed).put(48, 400000.0F).put(60, 0.0175F).put(64, 0.00873F);
    h.put(114, static_cast<std::uint16_t>(ranges.size()));
    Record r(std::endian::big), a(std::endian::big), q(std::endian::big);
    r.put(4, range_unit);
    for (std::size_t i = 0; i < ranges.size(); ++i) r.put(8 + 2 * i, ranges[i]);
    a.put(4, first_angle).put(8, even_angles ? -first_angle : angle_unit).put(32, 0.0F);
    for (std::size_t i = 0; i < steps.size() && !even_angles; ++i) a.put(36 + 2 * i, steps[i]);
    for (std::size_t i = 0; i < flags.size(); i += 2) {
      const int low = i + 1 < flags.size() ? flags[i + 1] : 0;
      q.put(4 + i / 2, static_cast<std::uint8_t>(flags[i] << 4 | low));
    }
    std::string block = std::string(12, '\0') + section("H0", h) + section("R0", r) +
                        section(even_angles ? "A0" : "A2", a) + (flags.empty() ? "" : section("Q0", q));
    block = Record(std::endian::big)
                .text(0, block)
                .text(0, "BTH0")
                .put(4, static_cast<std::uint32_t>(block.size()))
                .bytes();
    Record packet(std::endian::little, 256);
    put_xtf_date(packet, 14, s);
    packet.put(21, static_cast<std::uint8_t>(std::lround((s - static_cast<int>(s)) * 100))).text(256, block);
    return xtf_packet(65, packet);
  }
};

}  // namespace isobath::test
