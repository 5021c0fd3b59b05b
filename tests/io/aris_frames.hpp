// ARIS recordings built field by field after the maker's description of the format.
#pragma once

#include <tests/io/survey_datagrams.hpp>

namespace isobath::test {

struct ArisFrame {
  std::uint64_t time_us = 1'371'217'171'000'000;
  std::uint32_t mode = 1, samples = 2, delay_us = 4000, period_us = 10, cycle_us = 33'000;
  std::uint32_t system = 2, telephoto = 0, high_frequency = 1, transmits = 1, ordered = 1;
  float sound_speed = 1450;
  std::string image = {};  ///< row after row; empty: counts up from 1

  [[nodiscard]] std::size_t beams() const { return mode <= 2 ? 48u : mode <= 5 ? 96u : mode <= 8 ? 64u : 128u; }
  [[nodiscard]] std::string bytes() const {
    Record r(std::endian::little, 1024);
    r.put(4, time_us).text(12, "DDF\x05").put(436, mode).put(440, high_frequency).put(448, cycle_us);
    r.put(452, period_us).put(456, transmits).put(464, sound_speed).put(468, samples).put(476, delay_us);
    r.put(480, telephoto).put(484, system).put(516, ordered);
    std::string rows = image;
    for (std::size_t i = 0; rows.size() < beams() * samples; ++i) rows += static_cast<char>(1 + i % 250);
    return r.bytes() + rows;
  }
};

inline std::string aris_header() { return "DDF\x05" + std::string(1020, '\0'); }

}  // namespace isobath::test
