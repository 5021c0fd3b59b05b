// What every fuzz target of missions does: a mission that is read is sound, and what is written of it reads back the
// same; what is not read is an Error of one line.
#pragma once

#include <isobath/base/error.hpp>
#include <isobath/mission/plan/mission_file.hpp>
#include <string_view>

namespace isobath::fuzz {

/// `read` makes a plan of the bytes, checked or not.
template <class Read>
int read_mission(const std::uint8_t* data, std::size_t size, Read read) {
  const std::string_view bytes(reinterpret_cast<const char*>(data), size);
  try {
    const MissionPlan plan = read(bytes);
    ISOBATH_ASSERT(plan.import.text().find('\n') == std::string::npos);
    check_mission(plan);
    for (const MissionPoint& p : plan.points) ISOBATH_ASSERT(p.north_east.allFinite());
    const std::string text = write_mission(plan);
    const MissionPlan again = parse_mission(text, "again.toml");
    ISOBATH_ASSERT(again.points.size() == plan.points.size());
    ISOBATH_ASSERT(write_mission(again) == text);
  } catch (const Error& error) {
    ISOBATH_ASSERT(std::string_view(error.what()).find('\n') == std::string_view::npos);
    ISOBATH_ASSERT(error.where().file != "again.toml");
  }
  return 0;
}

}  // namespace isobath::fuzz
