// SuiteVariant: one combination of vehicle, sonar and group in a suite. The variants are every [[vehicle]] with every
// [[sonar]] and every [[group]] of the suite, with or without an altimeter as the suite states; the runs take them in
// turn. The run of a seed has the variant seed mod their number, so N consecutive runs cover N variants once each.
//
// A variant replaces the vehicle of the scene with its speed, and its imaging sonars. Parts that the suite does not
// list stay those of the scene. Without an altimeter means without any sonar that gives ranges. All other drawn values
// follow from the seed alone: with the same seed, two variants meet the same water.
#pragma once

#include <cstdint>
#include <isobath/base/config.hpp>
#include <isobath/scenario/scenario.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace isobath {

struct SuiteVehicle {
  Place place;
  std::string name;  ///< empty: the file name without its extension
  std::string file;
  double speed = 1.5;                       ///< m/s
  std::optional<ControlKind> control = {};  ///< empty: that of the scene
};
std::vector<Field> fields(SuiteVehicle& vehicle);

/// A group of vehicles of the scene. Which vehicle is lost and when is drawn from the seed.
struct SuiteGroup {
  Place place;
  std::string name;
  int vehicles = 2;  ///< the first ones of the scene
  double loss = 0;   ///< share of the packets that the link loses
  bool loses_vehicle = false;
};
std::vector<Field> fields(SuiteGroup& group);

enum class AltimeterChoice : std::uint8_t { kAsScene, kWith, kWithout, kBoth };

/// The lists of a suite; the variants are all their combinations.
struct VariantAxes {
  std::vector<SuiteVehicle> vehicles;
  std::vector<SonarConfig> sonars;  ///< named after their preset unless the file names them
  AltimeterChoice altimeter = AltimeterChoice::kAsScene;
  std::vector<SuiteGroup> groups;

  [[nodiscard]] bool empty() const {
    return vehicles.empty() && sonars.empty() && groups.empty() && altimeter == AltimeterChoice::kAsScene;
  }
};

struct SuiteVariant {
  std::string name;  ///< its parts, separated by /: "remus100/oculus_m750d/no-altimeter"
  std::optional<SuiteVehicle> vehicle;
  std::optional<SonarConfig> sonar;
  std::optional<bool> altimeter;
  std::optional<SuiteGroup> group;
};

/// All combinations; vehicles change fastest, the groups slowest. Empty axes give none. First sets the missing names
/// of vehicles and sonars. Throws Error with the place of an invalid vehicle, sonar or group.
std::vector<SuiteVariant> variants_of(VariantAxes& axes);

/// The variants that have every part of `name`, such as "remus100/no-altimeter". Throws Error with all names if there
/// is none.
std::vector<SuiteVariant> matching(const std::vector<SuiteVariant>& variants, std::string_view name);

void apply(const SuiteVariant& variant, Scenario& scenario);

}  // namespace isobath
