// Event: one input of the program, with its time. Source: what produces events (device, log, simulator).
#pragma once

#include <cstdint>
#include <isobath/sonar/passive_bearing.hpp>
#include <isobath/sonar/ping.hpp>
#include <isobath/sonar/range_reading.hpp>
#include <isobath/sonar/swath.hpp>
#include <isobath/vehicle/health.hpp>
#include <isobath/vehicle/navigation.hpp>
#include <isobath/vehicle/operator_frame.hpp>
#include <map>
#include <optional>
#include <string>
#include <variant>
#include <vector>

namespace isobath {

using Event = std::variant<Ping, RangeReading, Navigation, Health, Swath, OperatorFrame, PassiveBearing>;

inline Time time_of(const Event& event) {
  return std::visit([](const auto& e) { return e.time; }, event);
}

/// A stretch of input that no reader could use.
struct Damage {
  std::uint64_t offset = 0;  ///< bytes from the start
  std::uint64_t bytes = 0;
  std::string reason;
};

/// What a source reports about itself while it is read; complete at its end.
struct SourceReport {
  static constexpr std::size_t kMaxDamages = 1000;

  std::string format;                             ///< "Ping Viewer log", "MCAP", ...
  std::uint64_t bytes_total = 0;                  ///< 0: unknown (a device)
  std::uint64_t bytes_read = 0;                   ///< position, for a progress display
  std::uint64_t bytes_skipped = 0;                ///< sum over all damage
  std::vector<Damage> damages;                    ///< first kMaxDamages stretches; adjacent ones are joined
  std::map<std::string, std::uint64_t> rejected;  ///< complete records that the source refused, by reason
  std::map<std::string, std::string> details;     ///< "sonar" -> "Ping360, 750 kHz, gain 1", ...
  std::optional<GeoOrigin> origin;

  void add_damage(std::uint64_t offset, std::uint64_t bytes, const std::string& reason);
  /// Adds a device setting to the details: its last value, marked if earlier values differ.
  void note_setting(const std::string& key, const std::string& value);
};

class Source {
 public:
  virtual ~Source() = default;
  /// The next event in the order of the input; empty at the end. Throws nothing: the source skips and reports damage.
  virtual std::optional<Event> next() = 0;
  [[nodiscard]] virtual const SourceReport& report() const = 0;
};

}  // namespace isobath
