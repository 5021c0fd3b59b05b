#include <algorithm>
#include <array>
#include <cmath>
#include <Eigen/Core>
#include <fmt/format.h>
#include <isobath/links/mounting_check.hpp>
#include <numbers>

namespace isobath {
namespace {

constexpr double kTolerance_deg = 10, kRangeShare = 0.25, kJumpShare = 0.15, kOffLine = 0.1;
constexpr float kOfStrongest = 0.5F, kLeastEcho = 0.05F;
constexpr int kAcross = 2, kAlong = 1;       // neighbours that a mean takes in, bearings and ranges: echoes flicker
constexpr double kLeastHalfWidth_deg = 1.5;  // so that no bearing stays empty between the lines of a scanning head

int bearing_bin(double degrees) {
  const int bin = static_cast<int>(std::lround(degrees)) % EchoPanorama::kBearings;
  return (bin + EchoPanorama::kBearings) % EchoPanorama::kBearings;
}

/// The strongest echo in a bearing.
struct Peak {
  float strength = 0;
  double range_m = 0;
};
using Peaks = std::array<Peak, EchoPanorama::kBearings>;

/// Bearings first .. last, which may be above a turn.
struct Stretch {
  std::size_t first = 0, last = 0;
};

Angle middle_of(const Stretch& stretch) {
  return Angle::degrees(static_cast<double>(stretch.first + stretch.last) / 2);
}

/// Neighbouring bearings with strong echoes at about the same range.
std::vector<Stretch> stretches_of(const Peaks& peaks, float least) {
  const auto at = [&](std::size_t i) -> const Peak& { return peaks[i % peaks.size()]; };
  const auto goes_on = [&](std::size_t i) {  // from the bearing before
    const double before = at(i + peaks.size() - 1).range_m;
    return at(i + peaks.size() - 1).strength >= least && std::abs(at(i).range_m - before) <= kJumpShare * before;
  };
  std::size_t begin = 0;
  while (begin < peaks.size() && at(begin).strength >= least && goes_on(begin)) ++begin;
  if (begin == peaks.size()) return {{0, peaks.size() - 1}};  // all around
  std::vector<Stretch> stretches;
  for (std::size_t i = begin; i < begin + peaks.size(); ++i) {
    if (at(i).strength < least) continue;
    if (!stretches.empty() && stretches.back().last + 1 == i && goes_on(i)) {
      stretches.back().last = i;
    } else {
      stretches.push_back({i, i});
    }
  }
  return stretches;
}

/// The point of the flat wall through the echoes that is nearest to the sonar, from 1 / range = n . direction by least
/// squares, once more without the echoes that are off by over a tenth. Empty: too few echoes for a line, or the wall
/// was not seen there.
std::optional<EchoPanorama::Echo> foot_of(const Peaks& peaks, const Stretch& stretch) {
  constexpr std::size_t kLeastWide = 8;
  if (stretch.last - stretch.first < kLeastWide) return std::nullopt;
  Eigen::Vector2d n = Eigen::Vector2d::Zero();
  for (int pass = 0; pass < 2; ++pass) {
    Eigen::Matrix2d A = Eigen::Matrix2d::Zero();
    Eigen::Vector2d b = Eigen::Vector2d::Zero();
    for (std::size_t i = stretch.first; i <= stretch.last; ++i) {
      const Angle bearing = Angle::degrees(static_cast<double>(i));
      const Eigen::Vector2d direction(cos(bearing), sin(bearing));
      const double inverse = 1 / peaks[i % peaks.size()].range_m;
      if (pass > 0 && std::abs(n.dot(direction) - inverse) > kOffLine * inverse) continue;
      A += direction * direction.transpose();
      b += direction * inverse;
    }
    if (A.determinant() < 1e-6) return std::nullopt;
    n = A.inverse() * b;
  }
  const Angle bearing = Angle::radians(std::atan2(n.y(), n.x())), middle = middle_of(stretch);
  const double half_deg = static_cast<double>(stretch.last - stretch.first) / 2;
  if (std::abs((bearing - middle).wrapped().degrees()) > half_deg + kTolerance_deg) return std::nullopt;
  return EchoPanorama::Echo{bearing, 1 / n.norm()};
}

/// Where a wall is nearest: its foot, or the middle of a body that is no wall.
EchoPanorama::Echo nearest_of(const Peaks& peaks, const Stretch& stretch) {
  if (const auto foot = foot_of(peaks, stretch)) return *foot;
  double nearest = peaks[stretch.first % peaks.size()].range_m;
  for (std::size_t i = stretch.first; i <= stretch.last; ++i)
    nearest = std::min(nearest, peaks[i % peaks.size()].range_m);
  return {middle_of(stretch).wrapped(), nearest};
}

/// The mean of turns, and how far the furthest is from it, degrees.
struct Turns {
  double mean_deg = 0, spread_deg = 0;
};
Turns turns_of(const std::vector<Angle>& turns) {
  double x = 0, y = 0;
  for (const Angle turn : turns) {
    x += cos(turn);
    y += sin(turn);
  }
  const Angle mean = Angle::radians(std::atan2(y, x));
  Turns result{mean.degrees(), 0};
  for (const Angle turn : turns)
    result.spread_deg = std::max(result.spread_deg, std::abs((turn - mean).wrapped().degrees()));
  return result;
}

DeviceConfig corrected(DeviceConfig config, bool mirrored, double turn_deg) {
  if (mirrored && config.scans()) config.upside_down = !config.upside_down;
  if (mirrored && !config.scans()) config.roll = (config.roll + Angle::degrees(180)).wrapped();
  config.heading = Angle::degrees(std::round((config.heading + Angle::degrees(turn_deg)).wrapped().degrees()));
  return config;
}

std::string setting_text(const DeviceConfig& config) {
  const std::string heading = fmt::format("heading_deg = {:g}", config.heading.degrees());
  if (config.scans()) return fmt::format("upside_down = {}, {}", config.upside_down, heading);
  return fmt::format("roll_deg = {:g}, {}", config.roll.degrees(), heading);
}

}  // namespace

void EchoPanorama::add(const Ping& ping) {
  if (ping.window.end_m() != reach_m_) *this = EchoPanorama();
  reach_m_ = ping.window.end_m();
  for (int beam = 0; beam < ping.fan->beams(); ++beam) {
    const auto i = static_cast<std::size_t>(beam);
    const Angle azimuth = ping.fan->azimuth[i];
    const Eigen::Vector3d towards = ping.X_BS.rotation * Eigen::Vector3d(cos(azimuth), sin(azimuth), 0);
    const double bearing = Angle::radians(std::atan2(towards.y(), towards.x())).degrees();
    std::vector<float> line(kRanges);
    for (int bin = 0; bin < ping.window.bins; ++bin) {
      const double share = ping.window.centre(bin) / reach_m_;
      float& cell = line[static_cast<std::size_t>(std::clamp(share * kRanges, 0.0, kRanges - 1.0))];
      cell = std::max(cell, ping.intensity(beam, bin) / ping.full_scale);
    }
    const double half = std::max(ping.fan->width[i].degrees() / 2, kLeastHalfWidth_deg);
    for (double at = bearing - half; at <= bearing + half; at += 0.5) {
      const auto row = static_cast<std::size_t>(bearing_bin(at));
      std::ranges::copy(line, echoes_.begin() + static_cast<std::ptrdiff_t>(row * kRanges));
      is_heard_[row] = true;
    }
  }
}

double EchoPanorama::at(Angle bearing, double range_m) const {
  if (!(range_m >= 0 && range_m < reach_m_)) return 0;
  const auto range = static_cast<std::size_t>(range_m / reach_m_ * kRanges);
  return echoes_[static_cast<std::size_t>(bearing_bin(bearing.degrees())) * kRanges + range];
}

double EchoPanorama::heard() const {
  return static_cast<double>(std::ranges::count(is_heard_, true)) / static_cast<double>(kBearings);
}

float EchoPanorama::mean(int bearing, int range) const {
  float sum = 0;
  int count = 0;
  for (int b = bearing - kAcross; b <= bearing + kAcross; ++b) {
    const int row = (b + kBearings) % kBearings;
    for (int r = std::max(0, range - kAlong); r <= std::min(kRanges - 1, range + kAlong); ++r) {
      sum += echoes_[static_cast<std::size_t>(row) * kRanges + static_cast<std::size_t>(r)];
      ++count;
    }
  }
  return sum / static_cast<float>(count);
}

std::optional<EchoPanorama::Echo> EchoPanorama::wall_at(double range_m) const {
  const auto bin = [this](double range) {
    return static_cast<int>(std::clamp(range / reach_m_ * kRanges, 0.0, double{kRanges}));
  };
  if (reach_m_ <= 0 || bin(0.5 * range_m) >= bin(1.5 * range_m)) return std::nullopt;
  std::array<Peak, kBearings> peaks;
  float best = kLeastEcho;
  for (std::size_t bearing = 0; bearing < kBearings; ++bearing) {
    for (int range = bin(0.5 * range_m); range < bin(1.5 * range_m); ++range) {
      const float here = mean(static_cast<int>(bearing), range);
      if (here > peaks[bearing].strength) peaks[bearing] = {here, (range + 0.5) * reach_m_ / kRanges};
    }
    const Peak& peak = peaks[bearing];
    if (std::abs(peak.range_m - range_m) <= kRangeShare * range_m) best = std::max(best, peak.strength);
  }
  std::optional<Echo> wall;
  for (const Stretch& stretch : stretches_of(peaks, kOfStrongest * best)) {
    const auto echo = nearest_of(peaks, stretch);
    const double off = std::abs(echo.range_m - range_m);
    if (off <= kRangeShare * range_m && (!wall || off < std::abs(wall->range_m - range_m))) wall = echo;
  }
  return wall;
}

MountingVerdict check_mounting(const DeviceConfig& config, std::span<const KnownWall> walls,
                               std::span<const std::optional<EchoPanorama::Echo>> seen) {
  using Kind = MountingVerdict::Kind;
  MountingVerdict verdict;
  verdict.proposed = config;
  std::vector<Angle> direct, mirrored;
  bool aside = false;  // a wall that is not in line with the sonar
  for (std::size_t i = 0; i < walls.size(); ++i) {
    const double bearing = walls[i].bearing.wrapped().degrees();
    if (!seen[i]) {
      verdict.remarks.push_back(
          fmt::format("no echo at {:.0f} m, where the wall at {:.0f} degrees is", walls[i].range_m, bearing));
      continue;
    }
    verdict.remarks.push_back(
        fmt::format("the wall at {:.0f} degrees and {:.0f} m is seen at {:.0f} degrees and {:.1f} m", bearing,
                    walls[i].range_m, seen[i]->bearing.degrees(), seen[i]->range_m));
    direct.push_back((walls[i].bearing - seen[i]->bearing).wrapped());
    mirrored.push_back((walls[i].bearing - config.heading - config.heading + seen[i]->bearing).wrapped());
    aside = aside ||
            std::abs(sin(walls[i].bearing - config.heading)) > std::sin(1.5 * kTolerance_deg * std::numbers::pi / 180);
  }
  if (direct.empty()) return verdict;
  const Turns turned = turns_of(direct), turned_mirror = turns_of(mirrored);
  const bool fits = turned.spread_deg <= kTolerance_deg, fits_mirrored = turned_mirror.spread_deg <= kTolerance_deg;
  const bool small = std::abs(turned.mean_deg) <= kTolerance_deg;
  const bool small_mirrored = std::abs(turned_mirror.mean_deg) <= kTolerance_deg;
  if (fits && small) {
    verdict.kind = Kind::kRight;
    verdict.remarks.emplace_back("the mounting is right");
    if (!aside) verdict.remarks.emplace_back("a wall to one side would also show whether it is mirrored");
    return verdict;
  }
  if (!fits && !fits_mirrored) {
    verdict.remarks.emplace_back("neither a turned nor a mirrored sonar shows the walls so: look for other walls");
    return verdict;
  }
  const bool is_mirrored = fits_mirrored && (!fits || small_mirrored);
  verdict.kind = is_mirrored ? Kind::kMirrored : Kind::kTurned;
  double turn = is_mirrored ? turned_mirror.mean_deg : turned.mean_deg;
  if (is_mirrored && small_mirrored) turn = 0;
  verdict.proposed = corrected(config, is_mirrored, turn);
  std::string what = is_mirrored ? "it is mirrored" : fmt::format("it is turned by {:.0f} degrees", turn);
  if (is_mirrored && turn != 0) what += fmt::format(" and turned by {:.0f} degrees", turn);
  verdict.remarks.push_back(what + ": " + setting_text(verdict.proposed));
  if (fits && fits_mirrored) {
    verdict.remarks.push_back(
        "or " + setting_text(corrected(config, !is_mirrored, is_mirrored ? turned.mean_deg : turned_mirror.mean_deg)) +
        ": a second wall in another direction would tell");
  }
  return verdict;
}

}  // namespace isobath
