#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <fmt/format.h>
#include <isobath/display/display_bytes.hpp>
#include <isobath/display/sonar_display.hpp>
#include <isobath/sonar/fan_stance.hpp>
#include <nlohmann/json.hpp>
#include <numbers>

namespace isobath {
namespace {

constexpr double kTurn = 2 * std::numbers::pi;
constexpr double kLowest_db = -60;  ///< lower end of the decibel scale
constexpr int kMaxSlots = 800, kFewestSlots = 24;

int groups(int count, int each) { return (count + each - 1) / each; }

/// The mean of the first and the last of the angles from i to i + each, at most to the end of the list.
double middle(const std::vector<Angle>& angles, int i, int each) {
  const int last = std::min<int>(i + each, static_cast<int>(angles.size())) - 1;
  return 0.5 * (angles[i].radians() + angles[last].radians());
}

bool in_decibels(const Ping& ping) { return ping.intensity.type() != SampleType::kU8; }

/// The shade of a share of full scale on the decibel scale, looked up in a table by the leading bits of the share: one
/// logarithm for each of 64,000 samples takes longer than the rest of a picture. A shade is off by at most one, where
/// the exact value lies close to the border of two shades.
class DecibelShades {
 public:
  explicit DecibelShades(float full_scale) : share_(full_scale > 0 ? 1 / full_scale : 0) {}
  std::uint8_t operator()(float value) const {
    const float share = value * share_;
    if (!(share >= kMin)) return 0;
    return share < 1 ? (*table_)[place_of(share) - place_of(kMin)] : std::uint8_t{255};
  }

 private:
  static constexpr float kMin = 1.0F / 1024;  ///< -60.2 dB
  static constexpr int kBits = 11;            ///< leading bits of the mantissa in use
  static constexpr std::size_t kPlaces = std::size_t{10} << kBits;
  using Table = std::array<std::uint8_t, kPlaces>;

  static constexpr std::uint32_t place_of(float share) { return std::bit_cast<std::uint32_t>(share) >> (23 - kBits); }
  static const Table& table() {
    static const Table kTable = [] {
      Table table{};
      for (std::uint32_t i = 0; i < kPlaces; ++i) {
        const std::uint32_t middle = ((place_of(kMin) + i) << (23 - kBits)) | 1U << (22 - kBits);
        const double level = 1 - 20 * std::log10(static_cast<double>(std::bit_cast<float>(middle))) / kLowest_db;
        table[i] = static_cast<std::uint8_t>(std::lround(255 * std::clamp(level, 0.0, 1.0)));
      }
      return table;
    }();
    return kTable;
  }

  float share_;
  const Table* table_ = &table();
};

}  // namespace

SonarDisplay::Sonar& SonarDisplay::sonar_of(const Ping& ping, std::uint64_t& number) {
  const bool scanning = ping.fan->beams() == 1, vertical = !lies_flat(ping);
  for (number = 0; number < sonars_.size(); ++number) {
    Sonar& known = sonars_[number];
    if (known.scanning != scanning || known.vertical != vertical) continue;
    if (scanning || known.fan == ping.fan || known.fan->beams() == ping.fan->beams()) return known;
  }
  return sonars_.emplace_back(Sonar{scanning, vertical, nullptr, {}, 0, {}, {}, 1, 1});
}

/// Sends the geometry of the ping to the page if it has changed. Returns false while the geometry is unknown.
bool SonarDisplay::describe(Sonar& sonar, std::uint64_t number, const Ping& ping) {
  int slots = sonar.slots;
  if (sonar.scanning) {
    const double azimuth = ping.fan->azimuth[0].radians();
    const double before = sonar.azimuth.value_or(azimuth);
    sonar.azimuth = azimuth;
    const double step = std::abs(std::remainder(azimuth - before, kTurn));
    if (step > 1e-6) slots = std::clamp(static_cast<int>(std::lround(kTurn / step)), kFewestSlots, kMaxSlots);
    // a head that turns back or skips a beam makes a larger step, so the smallest step counts
    slots = std::max(slots, sonar.slots);
    if (slots == 0) return false;
  }
  if (sonar.fan && slots == sonar.slots && sonar.window == ping.window && (sonar.scanning || sonar.fan == ping.fan)) {
    return true;
  }
  sonar.slots = slots;
  sonar.fan = ping.fan;
  sonar.window = ping.window;
  sonar.beams_each = groups(ping.fan->beams(), kMaxBeams);
  sonar.bins_each = groups(ping.window.bins, kMaxBins);
  items_.set(DisplayKind::kSonar, number, ping.time, geometry(sonar, number, ping));
  return true;
}

std::string SonarDisplay::geometry(const Sonar& sonar, std::uint64_t number, const Ping& ping) const {
  nlohmann::ordered_json azimuth = nlohmann::ordered_json::array(), width = nlohmann::ordered_json::array();
  const auto add = [&](double centre, double across) {
    azimuth.push_back(std::round(1e5 * centre) / 1e5);
    width.push_back(std::round(1e5 * across) / 1e5);
  };
  if (sonar.scanning) {
    for (int i = 0; i < sonar.slots; ++i) {
      const double step = kTurn / sonar.slots;
      add(i * step, std::max(step, ping.fan->width[0].radians()));
    }
  } else {
    for (int i = 0; i < ping.fan->beams(); i += sonar.beams_each) {
      const int last = std::min(i + sonar.beams_each, ping.fan->beams()) - 1;
      add(middle(ping.fan->azimuth, i, sonar.beams_each),
          ping.fan->width[i].radians() + (ping.fan->azimuth[last].radians() - ping.fan->azimuth[i].radians()));
    }
  }
  const bool decibels = in_decibels(ping);
  const nlohmann::ordered_json scale =
      decibels ? nlohmann::ordered_json{{"unit", "dB of full scale"}, {"low", kLowest_db}, {"high", 0}}
               : nlohmann::ordered_json{{"unit", "% of full scale"}, {"low", 0}, {"high", 100}};
  const nlohmann::ordered_json text = {{"name", number == 0 ? "sonar" : fmt::format("sonar {}", number + 1)},
                                       {"scanning", sonar.scanning},
                                       {"upright", sonar.vertical},
                                       {"azimuth", azimuth},
                                       {"width", width},
                                       {"height", ping.fan->height.radians()},
                                       {"first_m", ping.window.start_m},
                                       {"bin_m", ping.window.bin_m * sonar.bins_each},
                                       {"bins", groups(ping.window.bins, sonar.bins_each)},
                                       {"scale", scale}};
  return text.dump();
}

/// Pools each group of bins of each group of beams by its maximum, at least 0.
void SonarDisplay::pool(const Sonar& sonar, const Ping& ping) {
  const auto bins = static_cast<std::size_t>(ping.window.bins), each = static_cast<std::size_t>(sonar.bins_each);
  const int beams = ping.fan->beams();
  beam_.resize(bins);
  loudest_.resize(bins);
  pooled_.clear();
  for (int first = 0; first < beams; first += sonar.beams_each) {
    std::fill(loudest_.begin(), loudest_.end(), 0.0F);
    for (int i = first; i < std::min(first + sonar.beams_each, beams); ++i) {
      ping.intensity.copy_beam(i, beam_.data());
      for (std::size_t k = 0; k < bins; ++k) loudest_[k] = std::max(loudest_[k], beam_[k]);
    }
    for (std::size_t k = 0; k < bins; k += each) {
      float most = loudest_[k];
      for (std::size_t i = k + 1; i < std::min(k + each, bins); ++i) most = std::max(most, loudest_[i]);
      pooled_.push_back(most);
    }
  }
}

/// The decided echoes, one bit per sample of the picture.
std::vector<std::uint8_t> SonarDisplay::hits(const Sonar& sonar, const EchoDecisions& decisions, int bins) const {
  std::vector<std::uint8_t> hits((pooled_.size() + 7) / 8);
  for (int i = 0; i < decisions.beams(); ++i) {
    const std::size_t row = static_cast<std::size_t>(i / sonar.beams_each) * static_cast<std::size_t>(bins);
    for (int word = 0; word < decisions.words(); ++word) {
      std::uint64_t left = decisions.hits(i)[word] & decisions.usable()[word];
      for (; left != 0; left &= left - 1) {
        const int k = 64 * word + std::countr_zero(left);
        const std::size_t at = row + static_cast<std::size_t>(k / sonar.bins_each);
        hits[at / 8] = static_cast<std::uint8_t>(hits[at / 8] | 1U << at % 8);
      }
    }
  }
  return hits;
}

std::string SonarDisplay::picture(const Sonar& sonar, const PosedPing& posed) {
  const Ping& ping = posed.ping;
  const int beams = groups(ping.fan->beams(), sonar.beams_each);
  const int bins = groups(ping.window.bins, sonar.bins_each);
  pool(sonar, ping);
  shades_.resize(pooled_.size());
  if (in_decibels(ping)) {
    const DecibelShades shade(ping.full_scale);
    std::transform(pooled_.begin(), pooled_.end(), shades_.begin(), shade);
  } else {
    const float most = ping.full_scale > 0 ? 255 / ping.full_scale : 0;
    const auto shade = [=](float value) { return static_cast<std::uint8_t>(std::min(value * most + 0.5F, 255.0F)); };
    std::transform(pooled_.begin(), pooled_.end(), shades_.begin(), shade);
  }
  const Pose X_WS = posed.X_WB * ping.X_BS;
  const Eigen::Quaterniond& q = X_WS.rotation.quaternion();
  DisplayBytes bytes;
  bytes.add(static_cast<std::uint16_t>(beams)).add(static_cast<std::uint16_t>(bins)).add(std::uint32_t{0});
  for (const double metres : {X_WS.translation.x(), X_WS.translation.y(), X_WS.translation.z()}) bytes.add(metres);
  bytes.add_floats({q.w(), q.x(), q.y(), q.z()});
  return bytes.append(shades_).pad_to(8).append(hits(sonar, posed.decisions, bins)).take();
}

void SonarDisplay::on_ping(const PosedPing& posed) {
  const Ping& ping = posed.ping;
  std::uint64_t number = 0;
  Sonar& sonar = sonar_of(ping, number);
  if (!describe(sonar, number, ping)) return;
  if (!sonar.scanning) {  // a little less than the interval, because pings have jitter
    constexpr double kInterval_s = 0.95 / kMaxPerSecond;
    if (sonar.shown && ping.time >= *sonar.shown && to_seconds(ping.time - *sonar.shown) < kInterval_s) return;
    sonar.shown = ping.time;
  }
  std::uint64_t beam = 0;
  if (sonar.scanning) {
    const double place = ping.fan->azimuth[0].wrapped_positive().radians() / kTurn * sonar.slots;
    beam = static_cast<std::uint64_t>(std::lround(place)) % static_cast<std::uint64_t>(sonar.slots);
  }
  items_.set(DisplayKind::kEchoes, number << 32 | beam, ping.time, picture(sonar, posed));
}

}  // namespace isobath
