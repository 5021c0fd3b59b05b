// Swath: the soundings of one transmission of a multibeam echo sounder, one detected range per beam.
//
// A pair of cameras gives a Swath, too: its soundings are points on whatever the cameras see, all of class kWater, each
// with the standard deviation of its range (ledger S8-07).
//
// A Ping carries undecided echoes. A Swath carries points that the sonar's own software has detected: on the bottom, or
// on an object in the water (class kWater, the most important ones for an obstacle map).
//
// Frames: kBody, points p_BQ in the body frame of the transmit time, before roll, pitch and heave are removed. kLevel,
// points p_LQ that the recorder has already corrected for motion: x forward, y starboard of the point whose position
// Navigation states, z the depth below the water surface; only north, east and heading of the pose are used.
//
// An imaging fan resolves range and bearing, not elevation: the swath of its detections states the height of its beams,
// and its points lie in the plane of the fan (`is_flat`). Such points are obstacles of the plan view only; maps with
// depths or heights leave them out.
#pragma once

#include <cstddef>
#include <cstdint>
#include <Eigen/Core>
#include <isobath/base/angle.hpp>
#include <isobath/base/time.hpp>
#include <isobath/geometry/pose.hpp>
#include <optional>
#include <vector>

namespace isobath {

struct Sounding {
  enum class Kind : std::uint8_t { kBottom, kWater };

  Eigen::Vector3f point = Eigen::Vector3f::Zero();  ///< p_BQ or p_LQ, m
  float range_m = 0;                                ///< slant range from the transducer
  float sigma_m = 0;  ///< standard deviation of the depth as the sonar states it; 0: not stated
  std::uint16_t beam = 0;
  Kind kind = Kind::kBottom;
  float sigma_range_m = 0;  ///< standard deviation of the range, along the ray; 0: not stated
};

struct Swath {
  enum class Frame : std::uint8_t { kBody, kLevel };
  static constexpr std::size_t kMaxSoundings = 65536;  ///< the range of beam numbers

  Time time;
  Frame frame = Frame::kBody;
  std::optional<Angle> heading;  ///< for kLevel: heading of the ping as the recorder states it; empty: that of the pose
  Angle beam_width;              ///< full width of one beam, for the footprint; 0: not known
  Angle beam_height;             ///< full height of the beams in which elevation is not resolved; 0: it is known
  double sound_speed = 0;        ///< m/s at the transducer, as the recorder states it; 0: not stated
  std::vector<Sounding> soundings;

  /// Whether the points are detections of a fan that does not resolve elevation.
  [[nodiscard]] bool is_flat() const { return beam_height.radians() > 0; }
};

/// X_WF of the frame F of the points: the body frame, or the level frame at the water surface.
Pose frame_in_world(const Swath& swath, const Pose& X_WB);

/// Faults of a swath: a number that is not finite, a negative range or deviation, more soundings than beam numbers.
enum class SwathFault : std::uint8_t { kNone, kNotFinite, kTooMany };
SwathFault check(const Swath& swath);
const char* to_text(SwathFault fault);

}  // namespace isobath
