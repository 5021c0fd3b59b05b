#include <algorithm>
#include <cstdlib>
#include <fmt/format.h>
#include <isobath/base/random.hpp>
#include <tests/app/logs.hpp>
#include <tests/io/ping_frames.hpp>

namespace isobath::test {

std::vector<std::uint8_t> wall_samples(int i) {
  Random random(static_cast<std::uint64_t>(i) + 1);
  std::vector<std::uint8_t> samples;
  for (int k = 0; k < kBins; ++k) {
    const bool wall = std::abs((k + 0.5) * kBin - kWall) < 0.6 * kBin;
    samples.push_back(static_cast<std::uint8_t>(10 + random.index(20) + (wall ? 180 : 0)));
  }
  return samples;
}

std::vector<std::string> wall_csv_lines(int pings) {
  std::vector<std::string> lines{"# t_s,head_deg,bin_m,nbins,i0,i1,...\n"};
  for (int i = 0; i < pings; ++i) {
    std::string line = fmt::format("{:.1f},{:.1f},{},{}", kPingInterval * i, i % kTurn * 360.0 / kTurn, kBin, kBins);
    for (const int sample : wall_samples(i)) line += fmt::format(",{}", sample);
    lines.push_back(line + "\n");
  }
  return lines;
}

std::string joined(const std::vector<std::string>& lines) {
  std::string all;
  for (const std::string& line : lines) all += line;
  return all;
}

std::string wall_csv(int pings) { return joined(wall_csv_lines(pings)); }

std::string wall_ping_viewer_log(int pings, std::vector<std::size_t>* starts) {
  PingViewerWriter writer;
  for (int i = 0; i < pings; ++i) {
    Ping360Message message;
    message.angle = i % kTurn * 400 / kTurn;
    message.sample_period = 5333;  // 25 ns each: 0.1 m at 1500 m/s
    const auto samples = wall_samples(i);
    message.samples.assign(samples.begin(), samples.end());
    const std::size_t at = writer.add(i * 100, message.frame());
    if (starts) starts->push_back(at);
  }
  return writer.log();
}

std::string pose_csv(int fixes, double heading_deg) {
  std::string text = "t_s,lat_deg,lon_deg,depth_m,heading_deg\n";
  for (int i = 0; i < fixes; ++i) text += fmt::format("{},47.5,8.5,1,{}\n", i, heading_deg);
  return text;
}

}  // namespace isobath::test
