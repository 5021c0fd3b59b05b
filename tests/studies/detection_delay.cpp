#include <fmt/format.h>
#include <tests/studies/detection_delay.hpp>

namespace isobath::test {

std::string row_of(const DetectionDelay& d) {
  return fmt::format("| {:4} | {:8} | {:5.1f} | {:14.1f} | {:13.1f} | {:15.2f} | {:9.2f} |", d.base, d.readings,
                     DelayRequest::kCycle_s * d.readings, DelayRequest::kCycle_s * d.readings_merged,
                     DelayRequest::kCycle_s * d.readings_merged_under_way, d.false_standing.mean,
                     d.false_under_way.mean);
}

std::string delay_page(const std::vector<DetectionDelay>& rows) {
  const DelayRequest request;
  std::string page = fmt::format(
      R"(# Detection delay and false obstacles of the depth map

Each pixel of the depth map has a confidence of 0 to 20. A reading that contradicts the depth takes off one unit (5 %); if the
confidence falls below the threshold of 2, the depth is replaced (Oskard, Hong and Shaffer 1990, IV-A). The initial confidence
of charted water, `confidence.base_prior`, is therefore a trade-off: a low one believes the first echoes, a high one waits. The
paper saw an obstacle after 3 to 4 readings, which corresponds to the bases 4 and 5; the default is 5.

The mapper itself produced the numbers below; `isobath delay` measures them again, also with other shares and seeds.

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
      request.wall_m, DelayRequest::kCycle_s, 100 * request.spurious_share, request.seeds, request.readings);
  for (const DetectionDelay& row : rows) page += row_of(row) + "\n";
  page += R"(
![Delay against false obstacles](images/detection-delay.png)

The band spans the seeds. Each additional reading of delay reduces the false obstacles by a factor, more under way than at rest. A reading of clear water
gives no evidence for a deep bottom, so the confidence that false echoes have taken off stays lost as long as the beam measures
the same water. The collision alarm (`[collision]`) does not wait for the map: it acts on raw ranges.

`scripts/detection-delay-page` makes this page and its picture.
)";
  return page;
}

}  // namespace isobath::test
