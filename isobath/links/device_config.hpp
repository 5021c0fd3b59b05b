// DeviceConfig: one device of a vehicle file, [[device]]: what it is, where it is mounted, how it is to look.
#pragma once

#include <Eigen/Core>
#include <isobath/base/angle.hpp>
#include <isobath/base/config.hpp>
#include <isobath/io/input/input_config.hpp>
#include <isobath/sonar/scan_command.hpp>
#include <string>
#include <vector>

namespace isobath {

enum class DeviceKind : std::uint8_t { kPing360, kPing1D, kMicron, kOculus, kDvlA50, kNmea };
/// All of them.
inline constexpr DeviceKind kDeviceKinds[] = {DeviceKind::kPing360, DeviceKind::kPing1D, DeviceKind::kMicron,
                                              DeviceKind::kOculus,  DeviceKind::kDvlA50, DeviceKind::kNmea};
const char* to_text(DeviceKind kind);

/// Where an echo sounder looks; usual: down.
enum class DeviceLooks : std::uint8_t { kUsual, kAhead, kDown };

struct DeviceConfig {
  Place place = {};
  std::string name;  ///< empty: its kind
  DeviceKind kind = DeviceKind::kPing360;
  std::string link;                            ///< link_address.hpp
  double position_m[3] = {};                   ///< forward, starboard, down of the navigation's reference point
  Angle heading;                               ///< direction of its zero bearing in the body
  Angle pitch, roll;                           ///< of a multibeam sonar
  DeviceLooks looks = DeviceLooks::kUsual;     ///< of a Ping1D
  bool upside_down = false;                    ///< a scanning head whose bearings then grow counter-clockwise
  double sound_speed = 1500;                   ///< m/s
  double range_m = 20;                         ///< as commanded
  Angle sector = Angle::degrees(360), middle;  ///< that a scanning head sweeps
  Angle step = Angle::degrees(2.7);
  int samples = 500;  ///< a line of a scanning head
  int frequency_khz = 750;
  int gain = -1;            ///< of a Ping360: 0 low, 1 normal, 2 high; of others: percent; -1: 1, or 50 percent
  double interval_s = 0.1;  ///< between the requests to a Ping1D
  bool navigation = false;  ///< whether a DVL or NMEA 0183 gives the vehicle's navigation

  [[nodiscard]] std::string called() const { return name.empty() ? to_text(kind) : name; }
  [[nodiscard]] int gain_in_use() const;
  /// Whether a command can turn its beam: a scanning head.
  [[nodiscard]] bool scans() const { return kind == DeviceKind::kPing360 || kind == DeviceKind::kMicron; }
  /// Whether it gives pings.
  [[nodiscard]] bool images() const { return scans() || kind == DeviceKind::kOculus; }
  /// Place of the device's origin in the body, m.
  [[nodiscard]] Eigen::Vector3d position() const { return {position_m[0], position_m[1], position_m[2]}; }
  /// Looks as a command has it; what it leaves open stays. `configured`: as in the vehicle file.
  void take(const ScanCommand& command, const DeviceConfig& configured);
  /// What the decoder of the device's messages needs.
  [[nodiscard]] InputConfig input() const;
};
std::vector<Field> fields(DeviceConfig& config);
/// [[device]]: appends to `devices`, which must outlive the schema.
SectionList device_list(std::vector<DeviceConfig>& devices);

}  // namespace isobath
