// Small logs of a scene that is easy to check: a scanning sonar at rest, one wall all round it at 3 m.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace isobath::test {

constexpr int kTurn = 50;     ///< pings a turn, 7.2 degrees apart
constexpr double kBin = 0.1;  ///< m
constexpr int kBins = 60;
constexpr double kWall = 3;            ///< m, where the echo is
constexpr double kPingInterval = 0.1;  ///< s

/// The samples of ping i: noise of a fixed seed, and the wall.
std::vector<std::uint8_t> wall_samples(int i);

/// One line a ping, the heading first; a line ends with its line feed.
std::vector<std::string> wall_csv_lines(int pings);
std::string wall_csv(int pings);
/// The same pings (4 of 400 gradians apart) as Ping Viewer records them; `starts` gets the place of every record.
std::string wall_ping_viewer_log(int pings, std::vector<std::size_t>* starts = nullptr);

/// A vehicle at rest on the globe: fixes every second from 0, rows of `t_s,lat_deg,lon_deg,depth_m,heading_deg`.
std::string pose_csv(int fixes, double heading_deg = 0);

std::string joined(const std::vector<std::string>& lines);

}  // namespace isobath::test
