// A user of the whole library: links every room and what stands behind it.
#include <cstdio>
#include <isobath/base/config.hpp>
#include <isobath/base/error.hpp>
#include <isobath/event/event.hpp>

int main() {
  isobath::SourceReport report;
  report.add_damage(100, 20, "checksum");
  report.add_damage(120, 5, "checksum");
  std::vector<isobath::Section> none;
  try {
    isobath::read_toml("[sonar]\n", "sonar.toml", none);
  } catch (const isobath::Error& error) {
    std::printf("%s\n", error.what());
    return report.damages.size() == 1 && report.bytes_skipped == 25 ? 0 : 1;
  }
  return 1;
}
