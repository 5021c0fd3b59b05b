#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <isobath/base/file_access.hpp>
#include <isobath/base/nearest_name.hpp>
#include <isobath/sim/scene.hpp>
#include <iterator>

namespace isobath {
namespace {

constexpr Range kMetres{-1e5, 1e5};
constexpr Range kLength{1e-3, 1e4};
constexpr Range kDepth{-100, 12000};

std::vector<Field> about_fields(SceneConfig& c) {
  return {Field::text("title", &c.title, "Title of the scene."),
          Field::text("text", &c.text, "Description of the scene and its source."),
          Field::integer("seed", &c.seed, {0, 2147483647}, "", "Seed of all random numbers."),
          Field::real("duration_s", &c.duration_s, {0.1, 1e6}, "s", "Length of the run."),
          Field::real("latitude_deg", &c.latitude_deg, {-80, 80}, "deg",
                      "Latitude of the origin; if the longitude is 0 too: not georeferenced."),
          Field::real("longitude_deg", &c.longitude_deg, {-180, 180}, "deg", "Longitude of the origin.")};
}

std::vector<Field> material_fields(Material& m) {
  return {
      Field::text("name", &m.name, "Name by which bodies refer to it; replaces a listed material of the same name."),
      Field::real("lambert_db", &m.lambert_db, {-80, 0}, "dB", "Lambert backscatter, 10 log10 mu."),
      Field::real("reflection_db", &m.reflection_db, {-80, 0}, "dB", "Reflection at normal incidence."),
      Field::real("roughness", &m.roughness, {0.03, 1}, "rad",
                  "Root mean square slope; a larger one broadens the glint.")};
}

std::vector<Field> bottom_fields(BottomConfig& c) {
  using K = BottomKind;
  return {Field::choice("kind", &c.kind,
                        {{"none", K::kNone},
                         {"flat", K::kFlat},
                         {"terrain", K::kTerrain},
                         {"raster", K::kRaster},
                         {"mesh", K::kMesh}},
                        "Kind of bottom."),
          Field::text("material", &c.material, "Material of the bottom."),
          Field::real("depth", &c.depth, kDepth, "m",
                      "Depth of a flat bottom; mean depth of a terrain; added to the depths of a raster or mesh."),
          Field::real("extent_m", &c.extent_m, {1, 20000}, "m",
                      "Half the side of a flat bottom or a terrain, centred on the origin."),
          Field::real("cell_m", &c.cell_m, {0.05, 1000}, "m", "Cell size of a terrain."),
          Field::real("relief_m", &c.relief_m, {0, 1000}, "m", "Root mean square height of a terrain."),
          Field::real("wavelength_m", &c.wavelength_m, {0.5, 10000}, "m", "Longest wavelength of a terrain."),
          Field::numbers("slope", c.slope.data(), 2, {-2, 2}, "1",
                         "Terrain: increase of depth per metre to the north and to the east."),
          Field::integer("seed", &c.seed, {0, 2147483647}, "", "Seed of a terrain."),
          Field::file("file", &c.file, "Raster (GeoTIFF, BAG, ...) or mesh (.dae, .stl, .obj, .ply)."),
          Field::flag("elevation", &c.elevation, "Whether raster values are heights; false: depths."),
          Field::flag("centred", &c.centred, "Whether the scene's origin is the middle of the raster or mesh."),
          Field::numbers("origin", c.origin.data(), 2, {-1e9, 1e9}, "m or deg",
                         "If not centred: easting and northing (or longitude and latitude) of the scene's origin."),
          Field::real("scale", &c.scale, {1e-6, 1e6}, "1", "Scale of a mesh."),
          Field::flag("allow_holes", &c.allow_holes, "Whether a bottom with holes is accepted.")};
}

Field lost_field(double& lost_s) {
  return Field::real("lost_s", &lost_s, {0, 1e6}, "s",
                     "Time from which the vehicle of a group neither moves nor speaks; 0: never.");
}

std::vector<Field> vehicle_fields(VehicleConfig& c) {
  return {
      Field::text("name", &c.name, "Name of the vehicle in a group."),
      Field::file("file", &c.file, "Vehicle file; empty: a point that follows the way-points exactly."),
      Field::flag("dynamic", &c.dynamic,
                  "Whether the vehicle has six degrees of freedom; false: it follows its set-points within limits."),
      control_field(c.control, "Control of a dynamic vehicle; file: as its file has it."),
      Field::numbers("start", c.start.data(), 3, kMetres, "m", "Start position: north, east, depth."),
      Field::degrees("heading_deg", &c.heading, {-360, 360}, "Heading at the start."),
      Field::real("speed", &c.speed, {0, 10}, "m/s", "Speed through the water."),
      Field::real("dive_amplitude", &c.dive_amplitude, {0, 1000}, "m",
                  "Amplitude of a sine that is added to the depth of the way-points."),
      Field::real("dive_period_s", &c.dive_period_s, {1, 1e5}, "s", "Period of this sine."),
      Field::real("dive_noise", &c.dive_noise, {0, 100}, "m",
                  "Root mean square of slow noise that is added to the depth."),
      Field::real("endurance_h", &c.endurance_h, {0.01, 1e4}, "h", "Endurance on a full battery."),
      lost_field(c.lost_s)};
}

std::vector<Field> group_vehicle_fields(GroupVehicle& c) {
  return {Field::text("name", &c.name, "Name of the vehicle."),
          Field::numbers("start", c.start.data(), 3, kMetres, "m", "Start position: north, east, depth."),
          Field::degrees("heading_deg", &c.heading, {-360, 360}, "Heading at the start."), lost_field(c.lost_s)};
}

std::vector<Field> waypoint_fields(WaypointConfig& c) {
  return {Field::real("north", &c.north, kMetres, "m", "North."), Field::real("east", &c.east, kMetres, "m", "East."),
          Field::real("depth", &c.depth, {0, 12000}, "m", "Depth."),
          Field::real("speed", &c.speed, {0, 10}, "m/s", "Speed; 0: the vehicle's speed.")};
}

std::vector<Field> shape_fields(Cylinder& s) {
  return {Field::numbers("centre", s.centre.data(), 3, kMetres, "m", "North, east, depth of the middle."),
          Field::numbers("axis", s.axis.data(), 3, {-1, 1}, "1", "Direction of the axis."),
          Field::real("radius", &s.radius, kLength, "m", "Radius."),
          Field::real("length", &s.length, kLength, "m", "Length.")};
}
std::vector<Field> shape_fields(Sphere& s) {
  return {Field::numbers("centre", s.centre.data(), 3, kMetres, "m", "North, east, depth of the middle."),
          Field::real("radius", &s.radius, kLength, "m", "Radius.")};
}
std::vector<Field> shape_fields(Box& s) {
  return {Field::numbers("centre", s.centre.data(), 3, kMetres, "m", "North, east, depth of the middle."),
          Field::numbers("size", s.size.data(), 3, kLength, "m", "Length, breadth, height."),
          Field::degrees("heading_deg", &s.heading, {-360, 360}, "Heading."),
          Field::degrees("pitch_deg", &s.pitch, {-90, 90}, "Pitch."),
          Field::degrees("roll_deg", &s.roll, {-180, 180}, "Roll.")};
}
std::vector<Field> shape_fields(Wall& s) {
  return {Field::rows("line", &s.line, 2, kMetres, "m", "Corners: north, east."),
          Field::real("top", &s.top, kDepth, "m", "Depth of the top."),
          Field::real("bottom", &s.bottom, kDepth, "m", "Depth of the foot."),
          Field::degrees("batter_deg", &s.batter, {-80, 80},
                         "Slope against the vertical; the foot is offset to the right, seen along the line.")};
}
std::vector<Field> shape_fields(Prism& s) {
  return {Field::rows("lines", &s.lines, 4, kMetres, "m", "Segments: north, east, north, east."),
          Field::rows("arcs", &s.arcs, 5, kMetres, "m and deg",
                      "Arcs: north, east, radius, first and last direction clockwise from north."),
          Field::real("top", &s.top, kDepth, "m", "Depth of the top."),
          Field::real("bottom", &s.bottom, kDepth, "m", "Depth of the foot."),
          Field::real("bottom_scale", &s.bottom_scale, {0.01, 100}, "1",
                      "Scale of the foot against the top, about the middle.")};
}
std::vector<Field> shape_fields(Pylons& s) {
  return {Field::numbers("first", s.first.data(), 2, kMetres, "m", "North, east of the first pylon."),
          Field::numbers("step", s.step.data(), 2, kMetres, "m", "Offset to the next pylon."),
          Field::integer("count", &s.count, {1, 1000}, "", "Number of pylons."),
          Field::real("radius", &s.radius, kLength, "m", "Radius."),
          Field::real("top", &s.top, kDepth, "m", "Depth of the top."),
          Field::real("bottom", &s.bottom, kDepth, "m", "Depth of the foot.")};
}
std::vector<Field> shape_fields(Mesh& s) {
  return {Field::file("file", &s.file, "Mesh: .dae, .stl, .obj, .ply."),
          Field::numbers("position", s.position.data(), 3, kMetres, "m", "North, east, depth of its origin."),
          Field::degrees("heading_deg", &s.heading, {-360, 360}, "Heading."),
          Field::degrees("pitch_deg", &s.pitch, {-90, 90}, "Pitch."),
          Field::degrees("roll_deg", &s.roll, {-180, 180}, "Roll."),
          Field::real("scale", &s.scale, {1e-6, 1e6}, "1", "Metres per unit of the file."),
          Field::flag("z_up", &s.z_up, "Whether the axes of the file are east, north, up; false: north, east, down.")};
}

template <class Shape>
SectionList body_list(Scene& scene, std::string name, std::string sentence) {
  return {name, std::move(sentence), [&scene, name](const Place& place) {
            Body& body = scene.bodies.emplace_back();
            body.place = place;
            const auto like = [](const Body& b) { return std::holds_alternative<Shape>(b.shape); };
            body.shape = Shape{};
            body.name = fmt::format("{} {}", name, std::count_if(scene.bodies.begin(), scene.bodies.end(), like));
            std::vector<Field> all = shape_fields(std::get<Shape>(body.shape));
            all.insert(all.begin(), Field::text("name", &body.name, "Name in reports."));
            all.push_back(Field::text("material", &body.material, "Material: a listed one, or one of this file."));
            all.push_back(Field::rows("path", &body.path, 4, {-1e6, 1e6}, "s, m, m, m",
                                      "Path of a moving body: time, north, east, depth of its reference point."));
            return all;
          }};
}

/// Checks that concern several fields.
[[noreturn]] void refuse(Place place, const std::string& key, const std::string& problem, const std::string& allowed,
                         const std::string& advice = {}) {
  place.key += (place.key.empty() ? "" : ".") + key;  // a scene made in code has no places
  throw Error(problem, place, allowed, advice);
}

void check_file(const std::string& file, const Place& place, const std::string& key) {
  if (file.empty()) refuse(place, key, "is missing", "a file");
  if (!std::filesystem::is_regular_file(file)) {
    refuse(place, key, "no such file: " + file, "a file", nearest_file(file));
  }
}

void check_materials(const Scene& scene) {
  std::vector<std::string> names;
  for (const Material& m : scene.materials) names.push_back(m.name);
  const auto check = [&](const Place& place, const std::string& material) {
    if (scene.material(material)) return;
    refuse(place, "material", "unknown material " + material, fmt::format("{}", fmt::join(names, ", ")),
           did_you_mean(material, names));
  };
  for (const Body& b : scene.bodies) check(b.place, b.material);
  check(scene.bottom.place, scene.bottom.material);
}

void check_span(const Body& b, double top, double bottom) {
  if (bottom <= top)
    refuse(b.place, "bottom", fmt::format("{} does not lie below top {}", bottom, top), "more than top");
}

void check_body(const Body& b) {
  if (const auto* c = std::get_if<Cylinder>(&b.shape); c && c->axis.norm() < 1e-6) {
    refuse(b.place, "axis", "has no direction", "a vector that is not 0");
  }
  if (const auto* w = std::get_if<Wall>(&b.shape)) {
    if (w->line.size() < 4) refuse(b.place, "line", "fewer than two corners", "two rows and more");
    check_span(b, w->top, w->bottom);
  }
  if (const auto* p = std::get_if<Prism>(&b.shape)) {
    if (p->lines.empty() && p->arcs.empty()) refuse(b.place, "lines", "neither lines nor arcs", "at least one row");
    for (std::size_t i = 2; i < p->arcs.size(); i += 5) {
      if (p->arcs[i] <= 0) refuse(b.place, "arcs", "a radius that is not positive", "more than 0 m");
    }
    check_span(b, p->top, p->bottom);
  }
  if (const auto* p = std::get_if<Pylons>(&b.shape)) check_span(b, p->top, p->bottom);
  if (const auto* m = std::get_if<Mesh>(&b.shape)) check_file(m->file, b.place, "file");
  for (std::size_t i = 4; i + 3 < b.path.size(); i += 4) {
    if (b.path[i] <= b.path[i - 4]) refuse(b.place, "path", "times that do not increase", "rows by increasing time");
  }
}

/// The last of each name: a material of the file replaces the listed one.
void drop_replaced(std::vector<Material>& materials) {
  std::vector<Material> kept;
  for (Material& m : materials) {
    std::erase_if(kept, [&m](const Material& before) { return before.name == m.name; });
    kept.push_back(std::move(m));
  }
  materials = std::move(kept);
}

/// The results of a vehicle go into a folder of its name.
void check_vehicle_name(const std::string& name, const Place& place) {
  constexpr std::size_t kMax = 40;
  const auto allowed = [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '-' || c == '_' ||
           c == ' ';
  };
  if (!name.empty() && name.size() <= kMax && std::ranges::all_of(name, allowed)) return;
  refuse(place, "name", "not the name of a vehicle", "1 to 40 letters, digits, -, _ and spaces");
}

void check_group(const Scene& scene) {
  std::vector<std::string> names = {scene.vehicle.name};
  if (scene.group.size() >= kMaxGroup) {
    refuse(scene.group.back().place, "name", fmt::format("{} vehicles in a group", scene.group.size() + 1),
           fmt::format("up to {}", kMaxGroup));
  }
  if (!scene.group.empty()) check_vehicle_name(scene.vehicle.name, scene.vehicle.place);
  for (const GroupVehicle& vehicle : scene.group) {
    check_vehicle_name(vehicle.name, vehicle.place);
    if (std::ranges::find(names, vehicle.name) != names.end()) {
      refuse(vehicle.place, "name", "two vehicles have this name: " + vehicle.name, "another name");
    }
    names.push_back(vehicle.name);
  }
}

void check_names(const std::vector<SonarConfig>& sonars) {
  for (std::size_t i = 0; i < sonars.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      if (sonars[i].name != sonars[j].name) continue;
      refuse(sonars[i].place, "name", "two sonars have this name: " + sonars[i].name, "another name");
    }
  }
}

}  // namespace

void check(const Scene& scene) {
  check_materials(scene);
  for (const Body& b : scene.bodies) check_body(b);
  (void)Water(scene.water, scene.water_place);
  if (scene.bottom.kind == BottomKind::kRaster || scene.bottom.kind == BottomKind::kMesh) {
    check_file(scene.bottom.file, scene.bottom.place, "file");
  }
  if (!scene.vehicle.file.empty()) check_file(scene.vehicle.file, scene.vehicle.place, "file");
  const bool differs = scene.plant != PlantDifference{} || scene.control_model != PlantDifference{};
  if (!scene.vehicle.dynamic && differs) {
    refuse(scene.vehicle.place, "dynamic",
           "[plant] and [control_model] have no effect on a vehicle that follows its set-points", "true");
  }
  if (scene.vehicle.dynamic && scene.vehicle.file.empty()) {
    refuse(scene.vehicle.place, "file", "a dynamic vehicle needs its file", "a vehicle file");
  }
  check_group(scene);
  for (const FaultConfig& fault : scene.faults) check_fault(fault);
  for (const SonarConfig& sonar : scene.sonars) check(sonar);
  for (const CameraPairConfig& camera : scene.cameras) check(camera);
  std::vector<std::string> bodies;
  for (const Body& b : scene.bodies) bodies.push_back(b.name);
  check(scene.hydrophones, scene.sounds, bodies, {.file = scene.file});
}

void check_length(const Scene& scene, double duration_s) {
  double per_second = scene.navigator.rate_hz;
  const auto add = [&](const auto& sensor) { per_second += sensor.on ? sensor.rate_hz : 0; };
  const NavigationSensorsConfig& n = scene.navigation;
  add(n.compass);
  add(n.ahrs);
  add(n.gyro);
  add(n.dvl);
  add(n.depth);
  add(n.gps);
  add(n.lbl);
  for (const SonarConfig& sonar : scene.sonars) {
    if (sonar.on) per_second += 1 / ping_interval_s(sonar);
  }
  for (const CameraPairConfig& camera : scene.cameras) {
    if (camera.on) per_second += camera.rate_hz;
  }
  if (scene.hydrophones.on) {
    per_second += static_cast<double>(scene.sounds.size()) / scene.hydrophones.interval_s;
  }
  if (per_second * duration_s <= kMaxSceneEvents) return;
  throw Error(fmt::format("{:g} s of this scene are {:.0f} million pings and readings", duration_s,
                          per_second * duration_s / 1e6),
              {}, fmt::format("up to {:.0f} million", kMaxSceneEvents / 1e6), "shorten scene.duration_s or --duration");
}

const std::vector<Material>& listed_materials() {
  static const std::vector<Material> kListed{
      {"rock", -10, -6, 0.35},   {"gravel", -16, -8, 0.25},  {"sand", -22, -9, 0.15},  {"mud", -31, -18, 0.1},
      {"coral", -14, -8, 0.5},   {"concrete", -20, -4, 0.1}, {"steel", -26, -1, 0.05}, {"wood", -20, -12, 0.15},
      {"plastic", -26, -3, 0.1}, {"rubber", -30, -20, 0.1},
  };
  return kListed;
}

const Material* Scene::material(const std::string& name) const {
  const auto found =
      std::find_if(materials.begin(), materials.end(), [&](const Material& m) { return m.name == name; });
  return found == materials.end() ? nullptr : &*found;
}

std::optional<GeoOrigin> Scene::origin() const {
  if (about.latitude_deg == 0 && about.longitude_deg == 0) return std::nullopt;
  return GeoOrigin{about.latitude_deg, about.longitude_deg};
}

void switch_off(Scene& scene, const std::string& sonar) {
  std::vector<std::string> names;
  bool found = false;
  for (SonarConfig& s : scene.sonars) {
    names.push_back(s.name);
    if (s.name != sonar) continue;
    s.on = false;
    found = true;
  }
  if (found) return;
  throw Error("the scene has no sonar named " + sonar, {.file = scene.file}, fmt::format("{}", fmt::join(names, ", ")),
              did_you_mean(sonar, names));
}

std::vector<std::string> fault_names(const std::vector<SonarConfig>& sonars) {
  std::vector<std::string> names;
  int images = 0, ranges = 0;
  for (const SonarConfig& sonar : sonars) {
    const bool image = sonar.kind != SonarKind::kRanges;
    const int number = image ? ++images : ++ranges;
    names.push_back((image ? "sonar" : "altimeter") + (number > 1 ? fmt::format(".{}", number) : ""));
  }
  return names;
}

Schema schema(Scene& s) {
  Schema all;
  all.sections = {{"scene", "The scene.", about_fields(s.about)},
                  {"water", "The water and its acoustic properties.", fields(s.water)},
                  {"bottom", "The bottom.", bottom_fields(s.bottom)},
                  {"vehicle", "The vehicle that carries the sonars.", vehicle_fields(s.vehicle)},
                  {"plant", "How a dynamic vehicle differs from its file, which its control has.", fields(s.plant)},
                  {"control_model", "How what its control takes it for differs from its file.",
                   control_model_fields(s.control_model)},
                  {"navigation", "The navigator of the vehicle.", fields(s.navigator)},
                  {"hydrophones", "The passive array of the vehicle.", fields(s.hydrophones)},
                  {"acoustic_link", "The modems of the vehicles of a group.", fields(s.link)}};
  for (Section& section : sections(s.navigation)) all.sections.push_back(std::move(section));
  all.lists = {{"material", "A material defined by the scene.",
                [&s](const Place&) { return material_fields(s.materials.emplace_back()); }},
               body_list<Cylinder>(s, "cylinder", "A cylinder."),
               body_list<Sphere>(s, "sphere", "A sphere."),
               body_list<Box>(s, "box", "A box."),
               body_list<Wall>(s, "wall", "A wall along a polyline."),
               body_list<Prism>(s, "prism", "Upright sheets along segments and arcs."),
               body_list<Pylons>(s, "pylons", "A row of upright cylinders."),
               body_list<Mesh>(s, "mesh", "A mesh from a file."),
               {"group_vehicle", "A further vehicle, like [vehicle], in a group that has one mission.",
                [&s](const Place& place) {
                  GroupVehicle& vehicle = s.group.emplace_back();
                  vehicle.place = place;
                  vehicle.name = fmt::format("vehicle {}", s.group.size() + 1);
                  return group_vehicle_fields(vehicle);
                }},
               {"waypoint", "A way-point of the vehicle; it visits them in order.",
                [&s](const Place&) { return waypoint_fields(s.waypoints.emplace_back()); }},
               {"sonar", "A sonar of the vehicle.",
                [&s](const Place& place) {
                  SonarConfig& sonar = s.sonars.emplace_back();
                  sonar.place = place;
                  if (s.sonars.size() > 1) sonar.name = fmt::format("sonar {}", s.sonars.size());
                  return fields(sonar);
                }},
               {"camera", "A pair of cameras of the vehicle, whose pictures become ranges during the run.",
                [&s](const Place& place) {
                  CameraPairConfig& camera = s.cameras.emplace_back();
                  camera.place = place;
                  if (s.cameras.size() > 1) camera.name = fmt::format("cameras {}", s.cameras.size());
                  return fields(camera);
                }},
               {"sound", "A machine that sounds at one frequency, for the passive array.",
                [&s](const Place& place) {
                  SoundConfig& sound = s.sounds.emplace_back();
                  sound.place = place;
                  sound.name = fmt::format("sound {}", s.sounds.size());
                  return fields(sound);
                }},
               section_list(s.faults)};
  return all;
}

Scene parse_scene(std::string_view text, const std::string& file) {
  Schema nothing_else;
  return parse_scene(text, file, nothing_else);
}

Scene parse_scene(std::string_view text, const std::string& file, Schema& more) {
  Scene scene;
  scene.file = file;
  Schema all = schema(scene);
  const auto own = static_cast<std::ptrdiff_t>(all.sections.size());
  std::move(more.sections.begin(), more.sections.end(), std::back_inserter(all.sections));
  std::move(more.lists.begin(), more.lists.end(), std::back_inserter(all.lists));
  read_toml(text, file, all);
  more.sections.assign(all.sections.begin() + own, all.sections.end());  // now with their positions in the file
  scene.water_place = all.sections[1].place;
  scene.bottom.place = all.sections[2].place;
  scene.vehicle.place = all.sections[3].place;
  drop_replaced(scene.materials);
  check(scene);
  check_names(scene.sonars);
  return scene;
}

Scene load_scene(const std::string& file) { return parse_scene(text_of_file(file), file); }

bool looks_like_scene(std::string_view head) {
  return head.starts_with("[scene]") || head.find("\n[scene]") != std::string_view::npos;
}

Eigen::Vector3d displacement(const Body& body, double t_s) {
  const std::vector<double>& p = body.path;
  if (p.size() < 8 || t_s <= p[0]) return Eigen::Vector3d::Zero();
  const Eigen::Vector3d first(p[1], p[2], p[3]);
  for (std::size_t i = 4; i + 3 < p.size(); i += 4) {
    if (t_s > p[i]) continue;
    const double share = (t_s - p[i - 4]) / (p[i] - p[i - 4]);
    const Eigen::Vector3d a(p[i - 3], p[i - 2], p[i - 1]), b(p[i + 1], p[i + 2], p[i + 3]);
    return a + share * (b - a) - first;
  }
  const std::size_t n = p.size();
  return Eigen::Vector3d(p[n - 3], p[n - 2], p[n - 1]) - first;
}

}  // namespace isobath
