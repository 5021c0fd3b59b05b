// BodyLooks: from the echoes of pings to looks at bodies, which BodyTracker takes (Rodin, Amin c. 1988, 2.1; ledger
// S3-04, S3-15).
//
// Echoes of neighbouring beams and ranges form clusters. A cluster of at least `min_echoes` echoes and at most
// `max_size_m` is a reading of a body: its centre, and how its echoes scatter about it. Near a scanning head, where the
// beams are close together, false echoes form clusters, too: one is left out if among so many samples, besides the
// first echo, so many false alarms are to be expected with a probability of kByChance. What is larger, or reaches
// beyond the first or last beam of the sector, is a structure, whose visible part changes with the place of the
// vehicle: it gives no reading, and hides what lies behind it. A body hides what lies behind it, too, and one that
// passes close to it merges with it into one cluster: a track there is not missed for want of a reading.
//
// The ping of a fan is one look. A scanning head gives a look for each sector of `sector_deg`; a sector ends where no
// cluster is open, so that a body is not cut in two, or after a quarter turn. A reading has the mean time of its own
// echoes: its age is the time from there to the end of the sector.
//
// The centre of a body's echoes is uncertain by the width of a beam, and, since another part echoes each time, by
// `centre_share` of the echoes' scatter. The pose of a ping adds the part of its error that is new in each look; the
// rest moves all readings alike.
//
// Frames and units: W (N, E), m, s; beams are projected to the level plane. Pings must be valid, decisions of their
// size, poses finite. Bounded: of a ping with more than kMaxRuns runs of echoes the rest is left out and counted. One
// thread. Cost: the echoes times those of the beams beside them; 8 us for a fan of 49 echoes.
#pragma once

#include <cstdint>
#include <functional>
#include <isobath/base/angle.hpp>
#include <isobath/geometry/pose.hpp>
#include <isobath/perception/tracking/body_tracker.hpp>
#include <isobath/sonar/echo_decisions.hpp>
#include <isobath/sonar/ping.hpp>
#include <vector>

namespace isobath {

struct BodyLooksConfig {
  double link_m = 1.5;
  int min_echoes = 3;
  double max_size_m = 25;
  double sector_deg = 15;
  double range_sigma_m = 0.1;
  double position_sigma_m = 0.1;
  Angle heading_sigma = Angle::degrees(0.5);
  double centre_share = 0.25;
  double detection = 0.7;
  double hidden = 0.25;
  double behind = 0.05;
};

std::vector<Field> fields(BodyLooksConfig& config);

/// One look: the readings, and the sector of the plane that was looked at.
class BodyLook final : public BodyTracker::Coverage {
 public:
  [[nodiscard]] Time time() const { return time_; }
  [[nodiscard]] std::span<const BodyReading> readings() const { return readings_; }
  [[nodiscard]] double detection(const Eigen::Vector2d& p_W) const override;

 private:
  friend class BodyLooks;
  /// What echoes from `near_m` on between two bearings from the middle of the sector, rad, and beyond `far_m` hides
  /// all.
  struct Shadow {
    double low, high, near_m, far_m;
    double beside, behind;  ///< shares of the probability of detection, up to far_m and beyond
  };
  Time time_;
  std::vector<BodyReading> readings_;
  std::vector<Shadow> shadows_;
  Eigen::Vector2d from_W_ = Eigen::Vector2d::Zero();
  Angle middle_;
  double half_rad_ = 0, near_m_ = 0, far_m_ = 0;
  double seen_ = 0;  ///< probability of detection in open water
};

/// Echoes of one beam that are of one body: azimuth in the sensor frame S, slant ranges.
struct EchoBox {
  Angle low, high;
  double near_m, far_m;
};

class BodyLooks {
 public:
  static constexpr std::size_t kMaxRuns = 4000;
  static constexpr double kByChance = 0.01;

  explicit BodyLooks(const BodyLooksConfig& config) : config_(config) {}

  /// Takes the echoes of a ping. Returns the look that is complete with it, valid until the next call; null: none.
  const BodyLook* add(const Ping& ping, const EchoDecisions& decisions, const Pose& X_WB);

  /// The echoes of the last ping that are of bodies of which an echo lies inside of a region of W. What is larger than
  /// a body is left out.
  void find_bodies(const std::function<bool(const Eigen::Vector2d&)>& is_inside, std::vector<EchoBox>& out) const;

  /// Runs of echoes that were left out.
  [[nodiscard]] std::uint64_t left_out() const { return left_out_; }

 private:
  struct Cluster {
    std::size_t joined = 0;  ///< index of the cluster that it is part of; its own: none
    double echoes = 0;
    Eigen::Vector2d sum = Eigen::Vector2d::Zero();  ///< from the sonar of the sector's first beam
    Eigen::Matrix2d squares = Eigen::Matrix2d::Zero();
    double time_s = 0;  ///< sum over echoes, from the sector's begin
    double near_m = 0, far_m = 0, low_rad = 0, high_rad = 0, width_rad = 0;
    int first_beam = 0, last_beam = 0;
    bool closed = false;
  };
  struct Run {
    int beam;
    double near_m, far_m;
    std::size_t cluster;
  };
  struct Part {  ///< of the last ping
    EchoBox box;
    Eigen::Vector2d p_W;
    std::size_t cluster;
  };
  struct Beam {
    Time time;
    Eigen::Vector2d from_W;
    Angle azimuth, width;  ///< in W
    Angle in_S;            ///< azimuth in the sensor frame
    double level_share;    ///< of a slant range, horizontally
    int gap;               ///< beams between two echoes of one body
  };
  void begin(const Ping& ping, const Beam& beam);
  void add_beam(const Ping& ping, const EchoDecisions& decisions, int index, const Beam& beam);
  void add_run(const Ping& ping, const Beam& beam, int first_bin, int last_bin, int echoes);
  [[nodiscard]] std::size_t root(std::size_t cluster) const;
  void join(std::size_t from, std::size_t to);
  void forget_runs(int gap);
  /// Ends the sector: clusters become readings and structures.
  void end(bool whole);
  void read(const Cluster& cluster);
  /// Larger than a body, or reaching beyond the first or last beam.
  [[nodiscard]] bool is_structure(const Cluster& cluster) const;
  /// Whether false alarms explain the echoes of a cluster that is no structure.
  [[nodiscard]] bool is_chance(const Cluster& cluster) const;
  [[nodiscard]] static double size_of(const Cluster& cluster);
  [[nodiscard]] bool continues(const Ping& ping, const Beam& beam) const;

  BodyLooksConfig config_;
  BodyLook look_;
  std::vector<Cluster> clusters_;
  std::vector<Run> runs_;  ///< of the last beams
  std::vector<Part> parts_;
  int beams_ = 0;  ///< of the sector
  Time begin_, last_;
  Eigen::Vector2d from_W_ = Eigen::Vector2d::Zero();
  Angle first_azimuth_, last_azimuth_;
  double turned_rad_ = 0;  ///< from the first to the last beam, positive to starboard
  double half_width_rad_ = 0;
  double level_bin_m_ = 1, false_alarm_ = 0;  ///< of the last ping
  std::uint64_t left_out_ = 0;
};

}  // namespace isobath
