// EchoPanorama: the newest echoes of a sonar in all directions of the body, seen from above. check_mounting: whether a
// sonar is mounted as its configuration says, from walls whose bearings the user knows.
//
// A wall gives the strongest echoes near its range. With the true bearing b, the bearing s at which the configuration
// shows it, and the configured heading h, the sonar is turned by b - s, or mirrored and turned by b - 2 h + s. One wall
// cannot tell a mirrored sonar from a turned one: then the reading with the smaller correction is proposed, mirrored
// without a turn before turned, and the verdict says so. Two walls that are not in line with the sonar decide.
#pragma once

#include <isobath/links/device_config.hpp>
#include <isobath/sonar/ping.hpp>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace isobath {

class EchoPanorama {
 public:
  static constexpr int kBearings = 360, kRanges = 200;

  void add(const Ping& ping);
  /// 0 .. 1; 0 also where nothing was heard.
  [[nodiscard]] double at(Angle bearing, double range_m) const;
  [[nodiscard]] double reach_m() const { return reach_m_; }
  /// Share of the bearings that were heard, 0 .. 1.
  [[nodiscard]] double heard() const;
  struct Echo {
    Angle bearing;  ///< from the bow to starboard
    double range_m = 0;
  };
  /// The wall whose nearest point is about this far away, within a quarter. Neighbouring bearings whose echo has at
  /// least half the strength of the strongest, and whose range does not jump, are one wall; a line through their echoes
  /// gives its nearest point. Of several the one whose range fits best counts. Empty: there is none.
  [[nodiscard]] std::optional<Echo> wall_at(double range_m) const;

 private:
  /// The mean strength of a cell and its neighbours.
  [[nodiscard]] float mean(int bearing, int range) const;

  double reach_m_ = 0;
  std::vector<float> echoes_ = std::vector<float>(static_cast<std::size_t>(kBearings) * kRanges);
  std::vector<bool> is_heard_ = std::vector<bool>(kBearings);
};

/// A wall as the user knows it: bearing of its nearest point from the bow, and its rough range.
struct KnownWall {
  Angle bearing;
  double range_m = 0;
};

struct MountingVerdict {
  enum class Kind : std::uint8_t { kRight, kMirrored, kTurned, kUnclear };
  Kind kind = Kind::kUnclear;
  DeviceConfig proposed;             ///< the configuration that fits
  std::vector<std::string> remarks;  ///< what was seen, and what it means
};
/// `seen`: by wall, where the strongest echo is; empty: there is none.
MountingVerdict check_mounting(const DeviceConfig& config, std::span<const KnownWall> walls,
                               std::span<const std::optional<EchoPanorama::Echo>> seen);

}  // namespace isobath
