#include <algorithm>
#include <filesystem>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <isobath/base/file_access.hpp>
#include <isobath/base/nearest_name.hpp>
#include <isobath/evaluation/suite_variants.hpp>

namespace isobath {
namespace {

constexpr const char *kWithAltimeter = "altimeter", *kWithoutAltimeter = "no-altimeter";

[[noreturn]] void refuse(Place place, const std::string& key, const std::string& problem, const std::string& allowed,
                         const std::string& advice = {}) {
  place.key = key;
  throw Error(problem, place, allowed, advice);
}

/// Names are parts of a variant's name, which the command line splits at each /.
template <class Part>
void check_names(const std::vector<Part>& parts, const std::string& section) {
  std::vector<std::string> seen{kWithAltimeter, kWithoutAltimeter};
  for (const Part& part : parts) {
    if (part.name.empty() || part.name.find_first_of("/ ") != std::string::npos) {
      refuse(part.place, section + ".name", fmt::format("\"{}\" cannot be part of a variant's name", part.name),
             "a word without / and spaces");
    }
    if (std::find(seen.begin(), seen.end(), part.name) != seen.end()) {
      refuse(part.place, section + ".name", part.name + " is used twice, or is reserved", "another name");
    }
    seen.push_back(part.name);
  }
}

void check_vehicle_file(const SuiteVehicle& vehicle) {
  if (vehicle.file.empty()) refuse(vehicle.place, "vehicle.file", "is missing", "a vehicle file");
  if (!std::filesystem::is_regular_file(vehicle.file)) {
    refuse(vehicle.place, "vehicle.file", "no such file: " + vehicle.file, "a vehicle file",
           nearest_file(vehicle.file));
  }
}

std::vector<std::string> parts_of(std::string_view name) {
  std::vector<std::string> parts;
  for (std::size_t from = 0; from <= name.size();) {
    const std::size_t to = std::min(name.find('/', from), name.size());
    if (to > from) parts.emplace_back(name.substr(from, to - from));
    from = to + 1;
  }
  return parts;
}

/// At least one element: a part that the suite does not list has one choice, that of the scene.
template <class Part>
std::vector<std::optional<Part>> choices_of(const std::vector<Part>& parts) {
  if (parts.empty()) return {std::nullopt};
  return {parts.begin(), parts.end()};
}

std::vector<std::optional<bool>> choices_of(AltimeterChoice altimeter) {
  switch (altimeter) {
    case AltimeterChoice::kAsScene: return {std::nullopt};
    case AltimeterChoice::kWith: return {true};
    case AltimeterChoice::kWithout: return {false};
    case AltimeterChoice::kBoth: return {true, false};
  }
  return {};
}

/// "did you mean NAME?", with the parts that no variant has replaced by the nearest ones.
std::string nearest_variant(const std::vector<std::string>& variants, std::vector<std::string> wanted) {
  std::vector<std::string> known;
  for (const std::string& variant : variants) {
    for (const std::string& part : parts_of(variant)) known.push_back(part);
  }
  for (std::string& part : wanted) {
    part = nearest_name(part, known);
    if (part.empty()) return {};
  }
  return fmt::format("did you mean {}?", fmt::join(wanted, "/"));
}

}  // namespace

std::vector<Field> fields(SuiteVehicle& v) {
  return {Field::text("name", &v.name, "The part of a variant's name that stands for this vehicle; empty: file name."),
          Field::file("file", &v.file, "Vehicle file."),
          Field::real("speed", &v.speed, {0.01, 30}, "m/s", "Speed of its missions."),
          control_field(v.control, "Control of the vehicle; file: as the scene has it.")};
}

std::vector<Field> fields(SuiteGroup& g) {
  return {Field::text("name", &g.name, "The part of a variant's name that stands for this group."),
          Field::integer("vehicles", &g.vehicles, {1, static_cast<int>(kMaxGroup)}, "",
                         "Number of vehicles: the first ones of the scene."),
          Field::real("loss", &g.loss, {0, 1}, "1", "Share of the packets that the acoustic link loses."),
          Field::flag("loses_vehicle", &g.loses_vehicle,
                      "Whether one vehicle, drawn from the seed, is lost at a time that is drawn, too.")};
}

std::vector<SuiteVariant> variants_of(VariantAxes& axes) {
  for (SuiteVehicle& vehicle : axes.vehicles) {
    check_vehicle_file(vehicle);
    if (vehicle.name.empty()) vehicle.name = std::filesystem::path(vehicle.file).stem().string();
  }
  const std::string unnamed = SonarConfig{}.name;
  for (SonarConfig& sonar : axes.sonars) {
    check(sonar);
    if (sonar.name == unnamed && sonar.preset != "none") sonar.name = sonar.preset;
  }
  check_names(axes.vehicles, "vehicle");
  check_names(axes.sonars, "sonar");
  check_names(axes.groups, "group");
  std::vector<SuiteVariant> variants;
  if (axes.empty()) return variants;
  for (const auto& group : choices_of(axes.groups)) {
    for (const auto& altimeter : choices_of(axes.altimeter)) {
      for (const auto& sonar : choices_of(axes.sonars)) {
        for (const auto& vehicle : choices_of(axes.vehicles)) {
          std::vector<std::string> parts;
          if (vehicle) parts.push_back(vehicle->name);
          if (sonar) parts.push_back(sonar->name);
          if (altimeter) parts.emplace_back(*altimeter ? kWithAltimeter : kWithoutAltimeter);
          if (group) parts.push_back(group->name);
          variants.push_back({fmt::format("{}", fmt::join(parts, "/")), vehicle, sonar, altimeter, group});
        }
      }
    }
  }
  return variants;
}

std::vector<SuiteVariant> matching(const std::vector<SuiteVariant>& variants, std::string_view name) {
  const std::vector<std::string> wanted = parts_of(name);
  std::vector<SuiteVariant> found;
  std::vector<std::string> names;
  for (const SuiteVariant& variant : variants) {
    const std::vector<std::string> parts = parts_of(variant.name);
    names.push_back(variant.name);
    const bool all = std::all_of(wanted.begin(), wanted.end(), [&parts](const std::string& part) {
      return std::find(parts.begin(), parts.end(), part) != parts.end();
    });
    if (all && !wanted.empty()) found.push_back(variant);
  }
  if (names.empty()) throw Error("the suite has no variants");
  if (found.empty()) {
    throw Error(fmt::format("no variant of the suite is called {}", name), {},
                fmt::format("one of {}, or parts of it", fmt::join(names, ", ")), nearest_variant(names, wanted));
  }
  return found;
}

void apply(const SuiteVariant& variant, Scenario& scenario) {
  Scene& scene = scenario.scene;
  if (variant.vehicle) {
    scene.vehicle.file = variant.vehicle->file;
    if (variant.vehicle->control) scene.vehicle.control = variant.vehicle->control;
    scene.vehicle.speed = scenario.mission.speed = variant.vehicle->speed;
  }
  if (variant.group) {
    const auto vehicles = static_cast<std::size_t>(variant.group->vehicles);
    if (vehicles > scene.group.size() + 1) {
      refuse(variant.group->place, "group.vehicles",
             fmt::format("{} vehicles, and the scene has {}", vehicles, scene.group.size() + 1),
             "at most as many as the scene has");
    }
    scenario.keep_vehicles(vehicles);
    scene.link.loss = variant.group->loss;
  }
  const auto ranges = [](const SonarConfig& sonar) { return sonar.kind == SonarKind::kRanges; };
  if (variant.sonar) {
    std::erase_if(scene.sonars, [&](const SonarConfig& sonar) { return !ranges(sonar); });
    scene.sonars.insert(scene.sonars.begin(), *variant.sonar);
  }
  if (!variant.altimeter) return;
  if (!*variant.altimeter) {
    std::erase_if(scene.sonars, ranges);
  } else if (std::none_of(scene.sonars.begin(), scene.sonars.end(), ranges)) {
    scene.sonars.push_back(sonar_preset("altimeter"));
    scene.sonars.back().name = "altimeter";
  }
}

}  // namespace isobath
