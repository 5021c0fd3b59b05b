#include <cmath>
#include <fmt/format.h>
#include <isobath/base/random.hpp>
#include <isobath/report/plot/picture.hpp>
#include <tests/perception/mapper_rig.hpp>
#include <tests/studies/detection_delay.hpp>

namespace isobath::test {
namespace {

constexpr double kWall = 20;    // m ahead
constexpr double kSpeed = 1.5;  // m/s

void prepare(Rig& rig, int base, double area_m) {
  rig.charted_m = 30;
  rig.map_config.area_m = area_m;
  rig.map_config.window_pixels = 256;
  rig.parts.rules.base_prior = base;
  rig.parts.rules.base_sensor = base + 1;
}

int readings_until_seen(int base, bool prefilter, double speed) {
  Rig rig;
  prepare(rig, base, 128);
  rig.parts.mapper.prefilter = prefilter;
  rig.build();
  const auto world = [](double north, double) { return north >= kWall ? 0.0 : 30.0; };
  const Pixel behind = rig.map->grid().at({kWall + 0.25, 0.1});
  int readings = 0;
  while (rig.map->window().at(behind).depth_m() > 10 && readings < 1000) {
    const double time_s = kCycle_s * readings++;
    const Pose X_WB = at(speed * time_s, 0, 5);
    rig.mapper->update(heard(world, looking(0, 6), X_WB, time_s), X_WB, 0);
  }
  return readings;
}

/// Readings that put an obstacle into empty water, for 1000 readings.
double false_obstacles(int base, bool under_way) {
  int bad = 0;
  for (int seed = 1; seed <= kSeeds; ++seed) {
    Rig rig;
    prepare(rig, base, under_way ? 2048 : 128);
    rig.start = {under_way ? -500.0 : 0.0, 0};
    rig.build();
    bool raised = false;
    rig.mapper->on_change([&](const PixelChange& c) { raised |= c.after.depth_cm() < c.before.depth_cm(); });
    Random random(static_cast<std::uint64_t>(seed));
    for (int i = 0; i < kWatched; ++i) {
      const double time_s = kCycle_s * i;
      const Pose X_WB = at(rig.start.x() + (under_way ? kSpeed * time_s : 0), 0, 5);
      if (under_way) rig.mapper->passed(Time{} + seconds(time_s), X_WB);
      std::optional<double> echo;
      if (random.uniform() < kSpuriousShare) echo = random.uniform(5, 45);
      raised = false;
      rig.mapper->update(with_range(looking(0, 6), echo, time_s), X_WB, 0);
      bad += raised;
    }
  }
  return 1000.0 * bad / (kSeeds * kWatched);
}

}  // namespace

DetectionDelay measure_delay(int base) {
  return {base,
          readings_until_seen(base, false, 0),
          readings_until_seen(base, true, 0),
          readings_until_seen(base, true, kSpeed),
          false_obstacles(base, false),
          false_obstacles(base, true)};
}

std::string row_of(const DetectionDelay& d) {
  return fmt::format("| {:4} | {:8} | {:5.1f} | {:14.1f} | {:13.1f} | {:15.2f} | {:9.2f} |", d.base, d.readings,
                     kCycle_s * d.readings, kCycle_s * d.readings_merged, kCycle_s * d.readings_merged_under_way,
                     d.false_standing, d.false_under_way);
}

std::string delay_page(const std::vector<DetectionDelay>& rows) {
  std::string page = fmt::format(
      R"(# Detection delay and false obstacles of the depth map

Each pixel of the depth map has a confidence of 0 to 20. A reading that contradicts the depth takes off one unit (5 %); if the
confidence falls below the threshold of 2, the depth is replaced (Oskard, Hong and Shaffer 1990, IV-A). The initial confidence
of charted water, `confidence.base_prior`, is therefore a trade-off: a low one believes the first echoes, a high one waits. The
paper saw an obstacle after 3 to 4 readings, which corresponds to the bases 4 and 5; the default is 5.

The mapper itself produced the numbers below.

- *Delay*: a level beam of 6 degrees looks at a wall {:.0f} m ahead that is not in the chart, with a reading every {:.1f} s.
- *Prefiltered*: similar readings are merged before mapping, as by default. A group counts for 2 at most and is mapped when it
  is full, so a vehicle at rest waits longer.
- *Under way*: the same at 1.5 m/s towards the wall, where no two readings are similar.
- *False obstacles*: in empty water 30 m deep, {:.0f} % of the readings are false echoes at 5 to 45 m. The number is that of the
  readings that put an obstacle into the map, per 1000 readings (mean of {} runs of {} readings), for a vehicle that stands
  still, so that its beam measures the same water again and again, and for a vehicle at 1.5 m/s.

`confidence.base_sensor` is one above the base throughout.

| base | readings | s     | prefiltered, s | under way, s  | false: standing | under way |
| ---: | -------: | ----: | -------------: | ------------: | --------------: | --------: |
)",
      kWall, kCycle_s, 100 * kSpuriousShare, kSeeds, kWatched);
  for (const DetectionDelay& row : rows) page += row_of(row) + "\n";
  page += R"(
![Delay against false obstacles](images/detection-delay.png)

Each additional reading of delay reduces the false obstacles by a factor, more under way than at rest. A reading of clear water
gives no evidence for a deep bottom, so the confidence that false echoes have taken off stays lost as long as the beam measures
the same water. The collision alarm (`[collision]`) does not wait for the map: it acts on raw ranges.

`scripts/detection-delay-page` makes this page and its picture.
)";
  return page;
}

std::string delay_picture(const std::vector<DetectionDelay>& rows) {
  ChartPicture picture(720, 440, "Base confidence 2 .. 15: delay against false obstacles",
                       {"until a wall stands in the map (s)", 0, 5, false},
                       {"false obstacles for 1000 readings", 0.1, 100, true});
  const auto curve = [&](double DetectionDelay::*share, Colour colour, const std::string& name) {
    std::vector<double> x, y;
    for (const DetectionDelay& row : rows) {
      if (row.*share < 0.1) continue;  // no place on a logarithmic axis
      x.push_back(kCycle_s * row.readings);
      y.push_back(row.*share);
    }
    picture.curve(x, y, {colour, 2, false}, name);
    picture.points(x, y, colour, "");
  };
  curve(&DetectionDelay::false_standing, palette::kObstacle, "standing still");
  curve(&DetectionDelay::false_under_way, palette::kTrack, "at 1.5 m/s");
  picture.finish();
  return picture.png();
}

}  // namespace isobath::test
