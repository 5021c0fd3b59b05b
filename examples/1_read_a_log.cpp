// Reads a log: what each sensor gave, and what of the file could not be used.
//
//   1_read_a_log [LOG]    any format that Isobath reads; without LOG it first records one, of a simulated vehicle
#include <cstdio>
#include <isobath/io/mcap/native_log.hpp>
#include <isobath/io/open_source.hpp>
#include <isobath/scenario/scenario.hpp>

using namespace isobath;

/// Half a minute of a vehicle in a reservoir, as its own recorder would write it.
void record(const std::filesystem::path& file) {
  SimulatedSource vehicle(open_scene(), {.duration_s = 30});
  NativeLogWriter log(file);
  log.set_details(vehicle.report().details);
  while (const auto event = vehicle.next()) log.write(*event);
  log.close();
}

int main(int argc, char** argv) try {
  const std::filesystem::path file = argc > 1 ? argv[1] : "reservoir.mcap";
  if (argc == 1) record(file);

  const std::unique_ptr<Source> log = open_source(file);  // recognises the format by the content
  int pings = 0, ranges = 0, fixes = 0, others = 0;
  std::optional<Time> first, last;
  while (const std::optional<Event> event = log->next()) {
    last = time_of(*event);
    if (!first) first = last;
    if (const auto* ping = std::get_if<Ping>(&*event)) {
      if (++pings > 1) continue;
      std::printf("first ping at %s: %d beam(s) of %d bins, to %.1f m\n", to_text(ping->time).c_str(),
                  ping->fan->beams(), ping->window.bins, ping->window.end_m());
    } else if (const auto* fix = std::get_if<Navigation>(&*event)) {
      if (++fixes > 1) continue;
      const Eigen::Vector3d& p = fix->X_WB.translation;  // north, east, depth
      std::printf("first fix: north %.1f, east %.1f, depth %.1f m, heading %.0f deg\n", p.x(), p.y(), p.z(),
                  fix->X_WB.rotation.heading().wrapped_positive().degrees());
    } else {
      ++(std::holds_alternative<RangeReading>(*event) ? ranges : others);
    }
  }
  if (!last) return std::printf("no event in %s\n", file.c_str()), 1;
  std::printf("%d pings, %d ranges, %d fixes and %d other events in %.1f s\n", pings, ranges, fixes, others,
              to_seconds(*last - *first));

  const SourceReport& report = log->report();
  std::printf("%s, %llu bytes\n", report.format.c_str(), static_cast<unsigned long long>(report.bytes_total));
  for (const auto& [what, value] : report.details) std::printf("  %s: %s\n", what.c_str(), value.c_str());
  for (const Damage& damage : report.damages) std::printf("  damaged: %s\n", damage.reason.c_str());
  for (const auto& [reason, count] : report.rejected) std::printf("  refused: %s\n", reason.c_str());
  if (argc == 1 && pings != 301) return std::printf("half a minute of this sonar has 301 pings\n"), 1;
  return 0;
} catch (const Error& error) {
  std::printf("%s\n", error.what());  // one line: what is wrong, where, and what to do
  return 1;
}
