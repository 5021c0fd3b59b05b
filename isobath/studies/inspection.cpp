#include <algorithm>
#include <isobath/studies/inspection.hpp>
#include <limits>

namespace isobath {
namespace {

/// Collects the times of one stream. Intervals are kept as floats: an hour at 100 Hz takes 1.4 MB.
class StreamCount {
 public:
  explicit StreamCount(std::string name) { facts_.name = std::move(name); }

  void add(Time time) {
    if (facts_.events++ == 0) {
      facts_.first = facts_.last = time;
      return;
    }
    const double interval = to_seconds(time - facts_.last);
    if (interval < 0) ++facts_.backwards;
    intervals_.push_back(static_cast<float>(interval));
    if (interval > facts_.longest_gap_s) {
      facts_.longest_gap_s = interval;
      facts_.longest_gap_at = facts_.last;
    }
    facts_.last = time;
  }

  StreamFacts finish() {
    if (!intervals_.empty()) {
      std::vector<float> sorted = intervals_;
      const auto middle = sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() / 2);
      std::nth_element(sorted.begin(), middle, sorted.end());
      facts_.median_interval_s = static_cast<double>(*middle);
      const double limit = 5 * facts_.median_interval_s;
      facts_.gaps = static_cast<std::uint64_t>(std::count_if(intervals_.begin(), intervals_.end(), [limit](float i) {
        return limit > 0 && static_cast<double>(i) > limit;
      }));
    }
    return facts_;
  }

 private:
  StreamFacts facts_;
  std::vector<float> intervals_;
};

void count_geometry(Inspection& facts, const Ping& ping) {
  const auto same = [&](const PingGeometry& g) {
    return g.beams == ping.fan->beams() && g.bins == ping.window.bins && g.start_m == ping.window.start_m &&
           g.end_m == ping.window.end_m();
  };
  auto at = std::find_if(facts.geometries.begin(), facts.geometries.end(), same);
  if (at == facts.geometries.end()) {
    if (facts.geometries.size() == Inspection::kMaxGeometries) return;
    facts.geometries.push_back({ping.fan->beams(), ping.window.bins, ping.window.start_m, ping.window.end_m(), 0});
    at = facts.geometries.end() - 1;
  }
  ++at->pings;
}

void count_samples(Inspection& facts, const Ping& ping, std::vector<float>& profile) {
  profile.resize(static_cast<std::size_t>(ping.window.bins));
  for (int b = 0; b < ping.fan->beams(); ++b) {
    ping.intensity.copy_beam(b, profile.data());
    const auto [low, high] = std::minmax_element(profile.begin(), profile.end());
    facts.intensity_min = std::min(facts.intensity_min, *low);
    facts.intensity_max = std::max(facts.intensity_max, *high);
  }
  facts.azimuth_min_deg = std::min(facts.azimuth_min_deg, ping.fan->azimuth.front().degrees());
  facts.azimuth_max_deg = std::max(facts.azimuth_max_deg, ping.fan->azimuth.back().degrees());
  facts.beam_width_deg = ping.fan->width.front().degrees();
  facts.beam_height_deg = ping.fan->height.degrees();
  facts.full_scale = ping.full_scale;
}

void count_soundings(SwathFacts& facts, const Swath& swath) {
  const std::size_t beams = swath.soundings.size();
  const bool first = facts.swaths++ == 0;
  facts.beams_min = first ? beams : std::min(facts.beams_min, beams);
  facts.beams_max = std::max(facts.beams_max, beams);
  facts.level = swath.frame == Swath::Frame::kLevel;
  if (swath.sound_speed > 0) {
    const bool unset = facts.sound_speed_max == 0;
    facts.sound_speed_min = unset ? swath.sound_speed : std::min(facts.sound_speed_min, swath.sound_speed);
    facts.sound_speed_max = std::max(facts.sound_speed_max, swath.sound_speed);
  }
  for (const Sounding& s : swath.soundings) {
    const bool unset = facts.soundings++ == 0;
    facts.depth_min_m = unset ? s.point.z() : std::min(facts.depth_min_m, s.point.z());
    facts.depth_max_m = unset ? s.point.z() : std::max(facts.depth_max_m, s.point.z());
    if (s.kind == Sounding::Kind::kWater) ++facts.in_water;
  }
}

}  // namespace

double StreamFacts::rate() const {
  const double span = to_seconds(last - first);
  return events > 1 && span > 0 ? static_cast<double>(events - 1) / span : 0;
}

Inspection inspect(Source& source, const std::function<void(std::uint64_t)>& progress) {
  Inspection facts;
  facts.intensity_min = std::numeric_limits<float>::max();
  facts.intensity_max = std::numeric_limits<float>::lowest();
  facts.azimuth_min_deg = 360;
  facts.azimuth_max_deg = -360;
  StreamCount streams[] = {StreamCount("pings"),   StreamCount("ranges"), StreamCount("navigation"),
                           StreamCount("health"),  StreamCount("swaths"), StreamCount("operator"),
                           StreamCount("bearings")};
  static_assert(std::variant_size_v<Event> == std::size(streams));
  std::vector<float> profile;
  std::uint64_t events = 0;
  while (const auto event = source.next()) {
    streams[event->index()].add(time_of(*event));
    if (const auto* ping = std::get_if<Ping>(&*event)) {
      if (check(*ping) == PingFault::kNone) {
        count_geometry(facts, *ping);
        count_samples(facts, *ping, profile);
      } else {
        ++facts.bad_pings;
      }
    }
    if (const auto* swath = std::get_if<Swath>(&*event)) {
      if (check(*swath) == SwathFault::kNone) {
        count_soundings(facts.swaths, *swath);
      } else {
        ++facts.bad_swaths;
      }
    }
    if (progress && ++events % 64 == 0) progress(events);
  }
  for (StreamCount& s : streams) {
    StreamFacts f = s.finish();
    if (f.events > 0) facts.streams.push_back(f);
  }
  return facts;
}

}  // namespace isobath
