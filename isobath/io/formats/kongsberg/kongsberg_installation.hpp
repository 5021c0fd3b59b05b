// AllInstallation: the ship's dimensions from the installation records of Kongsberg .all logs (Kongsberg 160692). The
// records are text: KEY=value, ...
#pragma once

#include <array>
#include <Eigen/Core>
#include <isobath/io/formats/kongsberg/kongsberg_water.hpp>
#include <optional>
#include <string_view>

namespace isobath {

struct AllInstallation {
  double water_line_m = 0;
  std::array<WaterMount, 3> transducers;  ///< S1, S2, S3: x, y relative to the position antenna; z as recorded
  bool has_receiver = false;              ///< S1 transmits, S2 receives; else each transducer does both
  std::optional<std::uint16_t> second_head, second_receiver;  ///< serial numbers, if there are two

  static AllInstallation read(std::string_view text);
  /// The value of a key; empty if it is missing, not a number, or 1e4 or more.
  static std::optional<double> number(std::string_view text, std::string_view key);

  /// The transducer that transmits for the beams of a serial number.
  [[nodiscard]] const WaterMount& transmitter(std::uint16_t serial) const {
    return transducers[second_head == serial ? 1 : 0];
  }
  /// The point half way between transmitter and receiver.
  [[nodiscard]] WaterMount mount(std::uint16_t serial) const;
};

}  // namespace isobath
