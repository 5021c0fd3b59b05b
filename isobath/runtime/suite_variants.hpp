// SuiteVariants: the vehicles and sonars that a suite's runs are made with in turn: every [[vehicle]] with every
// [[sonar]] of the suite, with and without an altimeter as the suite says. The run of a seed has variant seed mod their
// number, so that as many runs on end as there are variants have each once.
//
// A variant replaces the scene's vehicle with its speed, and its imaging sonars; what the suite does not list stays the
// scene's own. Without an altimeter means without any sonar that gives ranges.
// What else is drawn for a run follows from its seed alone: two variants of one seed meet the same water.
#pragma once

#include <cstdint>
#include <isobath/base/config.hpp>
#include <isobath/runtime/scenario.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace isobath {

struct SuiteVehicle {
  Place place;
  std::string name;  ///< empty: of the file, without its ending
  std::string file;
  double speed = 1.5;  ///< m/s
};
std::vector<Field> fields(SuiteVehicle& vehicle);

enum class AltimeterChoice : std::uint8_t { kAsScene, kWith, kWithout, kBoth };

/// What a suite lists; the variants are all its combinations.
struct VariantAxes {
  std::vector<SuiteVehicle> vehicles;
  std::vector<SonarConfig> sonars;  ///< named as their preset unless the file says otherwise
  AltimeterChoice altimeter = AltimeterChoice::kAsScene;

  [[nodiscard]] bool empty() const {
    return vehicles.empty() && sonars.empty() && altimeter == AltimeterChoice::kAsScene;
  }
};

struct SuiteVariant {
  std::string name;  ///< its parts with / between: "remus100/oculus_m750d/no-altimeter"
  std::optional<SuiteVehicle> vehicle;
  std::optional<SonarConfig> sonar;
  std::optional<bool> altimeter;
};

/// All combinations, vehicles changing fastest and the altimeter slowest; none for empty axes. Gives vehicles and
/// sonars their names first. Throws Error with the place of a vehicle or a sonar that makes no sense.
std::vector<SuiteVariant> variants_of(VariantAxes& axes);

/// Those that have every part of `name`: "remus100/no-altimeter". Throws Error, with the names, where none has.
std::vector<SuiteVariant> matching(const std::vector<SuiteVariant>& variants, std::string_view name);

void apply(const SuiteVariant& variant, Scenario& scenario);

}  // namespace isobath
