// What the installation records of Kongsberg .all logs say of the ship: text, KEY=value, ... (Kongsberg 160692).
#pragma once

#include <array>
#include <Eigen/Core>
#include <isobath/io/kongsberg_water.hpp>
#include <optional>
#include <string_view>

namespace isobath {

struct AllInstallation {
  double water_line_m = 0;
  std::array<WaterMount, 3> transducers;  ///< S1, S2, S3: re the position antenna, but for the depth
  bool has_receiver = false;              ///< S2 receives what S1 transmits; else each does both
  std::optional<std::uint16_t> second_head, second_receiver;  ///< serial numbers, where there are two

  static AllInstallation read(std::string_view text);
  /// Empty: not there, no number, or beyond anything that is built.
  static std::optional<double> number(std::string_view text, std::string_view key);

  /// What transmits for the beams of a serial number.
  [[nodiscard]] const WaterMount& transmitter(std::uint16_t serial) const {
    return transducers[second_head == serial ? 1 : 0];
  }
  /// Half way between transmitter and receiver.
  [[nodiscard]] WaterMount mount(std::uint16_t serial) const;
};

}  // namespace isobath
