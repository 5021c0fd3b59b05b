#include <cmath>
#include <fmt/format.h>
#include <isobath/mission/plan/timing_table.hpp>
#include <utility>

namespace isobath {

namespace {

constexpr double kLeastRatio = 3, kMostRatio = 6.5;  // S2-E03
constexpr double kTolerance = 0.1;                   // of the horizon
constexpr double kRounding = 1e-9;

}  // namespace

const char* to_text(CommandLevel level) {
  switch (level) {
    case CommandLevel::kMission: return "mission";
    case CommandLevel::kGroup: return "group";
    case CommandLevel::kVehicle: return "vehicle";
    case CommandLevel::kMove: return "move";
    case CommandLevel::kPrimitive: return "primitive";
    case CommandLevel::kServo: return "servo";
  }
  return "";
}

double TimingTable::input_s(CommandLevel level) const {
  const auto at = static_cast<std::size_t>(level);
  return levels[at > 0 ? at - 1 : 0].replan_s;
}

std::vector<Field> fields(TimingTable& table) {
  std::vector<Field> all;
  for (std::size_t i = 0; i < kCommandLevels; ++i) {
    const std::string name = to_text(static_cast<CommandLevel>(i));
    LevelTiming& level = table.levels[i];
    all.push_back(Field::real(name + "_replan_s", &level.replan_s, {0.1, 1e6}, "s",
                              fmt::format("Longest time between two plans of the {} level.", name)));
    all.push_back(Field::real(name + "_horizon_s", &level.horizon_s, {0.1, 1e7}, "s",
                              fmt::format("How far ahead a plan of the {} level is to reach.", name)));
  }
  return all;
}

std::vector<std::string> check_timing(const TimingTable& table) {
  std::vector<std::string> departures;
  for (std::size_t i = 0; i < kCommandLevels; ++i) {
    const auto level = static_cast<CommandLevel>(i);
    const LevelTiming& own = table.levels[i];
    const double input_s = table.input_s(level);
    const std::string name = to_text(level);
    if (own.horizon_s < input_s * (1 - kRounding)) {
      throw Error(
          fmt::format("a plan of the {} level ends after {:g} s, before the next command comes", name, own.horizon_s),
          {}, fmt::format("at least {:g} s", input_s), fmt::format("set timing.{}_horizon_s", name));
    }
    const double wanted_s = (i > 0 ? 2 : 4) * input_s;
    if (std::abs(own.horizon_s / wanted_s - 1) > kTolerance) {
      departures.push_back(
          fmt::format("plans of the {} level reach {:g} s ahead, {:g} s by the rule", name, own.horizon_s, wanted_s));
    }
    if (i == 0) continue;
    const double ratio = input_s / own.replan_s;
    const std::string above = to_text(static_cast<CommandLevel>(i - 1));
    if (ratio <= 1) {
      throw Error(fmt::format("the {} level plans every {:g} s, no more often than the {} level above it", name,
                              own.replan_s, above),
                  {}, fmt::format("below {:g} s", input_s), fmt::format("set timing.{}_replan_s", name));
    }
    if (ratio < kLeastRatio * (1 - kRounding) || ratio > kMostRatio * (1 + kRounding)) {
      departures.push_back(
          fmt::format("the {} level plans {:.3g} times as often as the {} level, {:g} to {:g} by the rule", name, ratio,
                      above, kLeastRatio, kMostRatio));
    }
  }
  return departures;
}

}  // namespace isobath
