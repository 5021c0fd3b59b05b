// Scenes as files: what is wrong is said with file, line and column; presets; the template.
#include <fmt/format.h>
#include <fstream>
#include <gmock/gmock.h>
#include <isobath/sim/simulator.hpp>
#include <isobath/sim/triangle_mesh.hpp>
#include <set>
#include <tests/sim/worlds.hpp>
#include <tests/support/data.hpp>

namespace isobath {
namespace {

using namespace test;

std::string refusal(const std::string& toml) {
  try {
    const Scene scene = parse_scene("[scene]\n" + toml, "lake.toml");
    const World world(scene);
  } catch (const Error& error) {
    EXPECT_TRUE(error.where().line && error.where().column) << error.what();
    return error.what();
  }
  return "no error";
}

struct Wrong {
  const char* toml;  ///< its first line is line 2 of the file
  const char* place;
  const char* words;
};

const Wrong kWrong[] = {
    // Keys, sections, values.
    {"titel = \"a\"\n", "2:1: scene.titel", "unknown key"},
    {"[watter]\n", "2:2: watter", "unknown section"},
    {"[[cylinders]]\n", "2:3: cylinders", "unknown section"},
    {"[cylinder]\nradius = 1\n", "2:1: cylinder", "not a list of tables"},
    {"[[sphere]]\nradius = -1\n", "3:10: sphere.radius", "allowed"},
    {"[[sphere]]\nradius = \"big\"\n", "3:10: sphere.radius", "number"},
    {"[[sphere]]\ncentre = [1, 2]\n", "3:10: sphere.centre", "3 numbers"},
    {"[[sphere]]\nradius = nan\n", "3:10: sphere.radius", "allowed"},
    {"[[sphere]]\nradius 1\n", "3:8", ""},
    {"duration_s = 0\n", "2:14: scene.duration_s", "allowed"},
    // Files that are not there.
    {"[[mesh]]\nname = \"wreck\"\n", "2:1: mesh.file", "is missing"},
    {"[[mesh]]\nfile = \"none.obj\"\n", "2:1: mesh.file", "no such file"},
    {"[bottom]\nkind = \"mesh\"\n", "2:1: bottom.file", "is missing"},
    {"[bottom]\nkind = \"mesh\"\nfile = \"none.dae\"\n", "2:1: bottom.file", "no such file"},
    {"[bottom]\nkind = \"raster\"\nfile = \"none.tif\"\n", "2:1: bottom.file", "no such file"},
    {"[vehicle]\nfile = \"none.toml\"\n", "2:1: vehicle.file", "no such file"},
    {"[vehicle]\ndynamic = true\n", "2:1: vehicle.file", "needs its file"},
    // Materials.
    {"[[box]]\nmaterial = \"cheese\"\n", "2:1: box.material", "unknown material cheese"},
    {"[bottom]\nkind = \"flat\"\nmaterial = \"cheese\"\n", "2:1: bottom.material", "unknown material cheese"},
    {"[[material]]\nname = \"oak\"\nlambert_db = 3\n", "4:14: material.lambert_db", "-80 .. 0"},
    // Shapes.
    {"[[wall]]\nline = [[1, 2]]\n", "2:1: wall.line", "fewer than two corners"},
    {"[[wall]]\n", "2:1: wall.line", "fewer than two corners"},
    {"[[wall]]\nline = [[1, 2], [3, 4]]\ntop = 5\nbottom = 4\n", "2:1: wall.bottom", "does not lie below"},
    {"[[wall]]\nline = [[1, 2], [3]]\n", "3:8: wall.line", "2 numbers"},
    {"[[prism]]\n", "2:1: prism.lines", "neither lines nor arcs"},
    {"[[prism]]\narcs = [[0, 0, 0, 0, 90]]\n", "2:1: prism.arcs", "radius"},
    {"[[prism]]\narcs = [[0, 0, 1, 0, 90]]\ntop = 5\nbottom = 5\n", "2:1: prism.bottom", "does not lie below"},
    {"[[cylinder]]\naxis = [0, 0, 0]\n", "2:1: cylinder.axis", "no direction"},
    {"[[pylons]]\ncount = 0\n", "3:9: pylons.count", "allowed"},
    {"[[pylons]]\ntop = 5\nbottom = 1\n", "2:1: pylons.bottom", "does not lie below"},
    {"[[box]]\npath = [[0, 0, 0, 5], [10, 1, 0, 5], [9, 2, 0, 5]]\n", "2:1: box.path", "times that do not increase"},
    {"[bottom]\nkind = \"terrain\"\nextent_m = 20000\ncell_m = 0.1\n", "2:1: bottom.cell_m", "too many"},
    // Water.
    {"[water]\nsound_speed = [[0, 1500], [10, 1490], [5, 1480]]\n", "2:1: water.sound_speed", "does not lie below"},
    {"[water]\nsound_speed = [[0, 340]]\n", "2:1: water.sound_speed", "out of range"},
    {"[water]\ncurrent = [[3, 0, 0], [3, 1, 0]]\n", "2:1: water.current", "does not lie below"},
    // Sonars.
    {"[[sonar]]\ninterval_s = 1e-320\n", "2:1: sonar.interval_s", "too short"},
    {"[[sonar]]\nbeams = 0\n", "3:9: sonar.beams", "1 .. 4096"},
    {"[[sonar]]\nrange_m = 0\n", "3:11: sonar.range_m", "0.1 .. 2000 m"},
    {"[[sonar]]\npreset = \"sonar2000\"\n", "3:10: sonar.preset", "oculus_m1200d"},
    {"[[sonar]]\nsector_deg = 0\n", "2:1: sonar.sector_deg", "the same direction"},
    {"[[sonar]]\nsector_deg = 360\n", "2:1: sonar.sector_deg", "cannot span a full turn"},
    {"[[sonar]]\nblanking_m = 50\n", "2:1: sonar.blanking_m", "blind over its whole range"},
    {"[[sonar]]\nname = \"\"\n", "2:1: sonar.name", "empty"},
    {"[[sonar]]\nname = \"a\"\n[[sonar]]\nname = \"a\"\n", "4:1: sonar.name", "two sonars have this name"},
    {"[[sonar]]\nnoise_by_range = [[0, 1]]\n", "2:1: sonar.noise_by_range", "one row"},
    {"[[sonar]]\nnoise_by_bearing = [[0, 1]]\n", "2:1: sonar.noise_by_bearing", "one row"},
    {"[[sonar]]\nnoise_by_range = [[0, 1], [20, 2], [10, 1]]\n", "2:1: sonar.noise_by_range", "not in order"},
    {"[[sonar]]\nnoise_by_bearing = [[0, 1], [0, 2]]\n", "2:1: sonar.noise_by_bearing", "not in order"},
};
TEST(WrongScenes, AreRefusedWithFileLineAndColumn) {
  for (const Wrong& wrong : kWrong) {
    const std::string what = refusal(wrong.toml);
    EXPECT_EQ(what.find(std::string("lake.toml:") + wrong.place), 0u) << wrong.toml << what;
    EXPECT_NE(what.find(wrong.words), std::string::npos) << wrong.toml << what;
    EXPECT_EQ(what.find('\n'), std::string::npos) << what;
  }
}

// Files that are there but cannot be used ----------------------------------------------------------------------------

std::string with_file(const char* head, const std::string& name, const std::string& content) {
  const auto file = scratch_folder() / name;
  std::ofstream(file, std::ios::binary) << content;
  return refusal(std::string(head) + "file = \"" + file.string() + "\"\n");
}

TEST(UnusableFiles, AreRefusedWithThePlaceOfTheSectionThatNamesThem) {
  const auto starts = [](const std::string& what, const char* with) { return what.rfind(with, 0) == 0; };
  const std::string junk = "neither a mesh nor a raster";
  std::string what = with_file("[[mesh]]\n", "junk.obj", junk);
  EXPECT_TRUE(starts(what, "lake.toml:2:1: mesh.file: ")) << what;
  what = with_file("[[mesh]]\n", "junk.dae", junk);
  EXPECT_TRUE(starts(what, "lake.toml:2:1: mesh.file: no readable mesh")) << what;
  what = with_file("[[mesh]]\n", "points.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\n");
  EXPECT_TRUE(starts(what, "lake.toml:2:1: mesh.file: ")) << what;
  what = with_file("[[mesh]]\n", "empty.stl", "");
  EXPECT_TRUE(starts(what, "lake.toml:2:1: mesh.file: no readable mesh")) << what;
  what = with_file("[bottom]\nkind = \"mesh\"\n", "junk.stl", junk);
  EXPECT_TRUE(starts(what, "lake.toml:2:1: bottom.file: no readable mesh")) << what;
  what = with_file("[bottom]\nkind = \"raster\"\n", "junk.tif", junk);
  EXPECT_TRUE(starts(what, "lake.toml:2:1: bottom.file: GDAL cannot read a raster")) << what;
}

/// A level sheet of cells x cells squares of 10 m, less one in its middle.
std::string sheet(int cells, bool hole) {
  std::string obj;
  for (int r = 0; r <= cells; ++r) {
    for (int c = 0; c <= cells; ++c) obj += fmt::format("v {} {} -15\n", 10 * c, 10 * r);
  }
  for (int r = 0; r < cells; ++r) {
    for (int c = 0; c < cells; ++c) {
      const int a = r * (cells + 1) + c + 1;
      if (!(hole && r == cells / 2 && c == cells / 2))
        obj += fmt::format("f {} {} {} {}\n", a, a + 1, a + cells + 2, a + cells + 1);
    }
  }
  return obj;
}

TEST(Holes, InABottomOfTriangles) {
  const std::string what = with_file("[bottom]\nkind = \"mesh\"\n", "hole.obj", sheet(5, true));
  EXPECT_EQ(what.find("lake.toml:2:1: bottom.file: the bottom has holes: 1 border lines"), 0u) << what;
  EXPECT_EQ(with_file("[bottom]\nkind = \"mesh\"\n", "whole.obj", sheet(5, false)), "no error");
  EXPECT_EQ(with_file("[bottom]\nkind = \"mesh\"\nallow_holes = true\n", "hole.obj", sheet(5, true)), "no error");
}

TEST(Holes, AreCountedByTheBorderLinesWithinTheOutermost) {
  TriangleMesh mesh;
  for (int r = 0; r < 6; ++r) {
    for (int c = 0; c < 6; ++c) mesh.vertices.emplace_back(static_cast<float>(r), static_cast<float>(c), 0.f);
  }
  for (int r = 0; r < 5; ++r) {
    for (int c = 0; c < 5; ++c) {
      if ((r == 1 && c == 1) || (r == 3 && c == 3)) continue;
      const int a = r * 6 + c;
      mesh.triangles.push_back({a, a + 1, a + 7});
      mesh.triangles.push_back({a, a + 7, a + 6});
    }
  }
  EXPECT_EQ(holes(mesh), 2);
  mesh.vertices.emplace_back(2.5f, 2.5f, 1.f);
  mesh.triangles.push_back({13, 14, 36});  // a fin on an edge: no hole
  EXPECT_EQ(holes(mesh), 2);
}

// Reading -----------------------------------------------------------------------------------------------------------

TEST(Scenes, AreRecognisedByTheirFirstBytes) {
  EXPECT_TRUE(looks_like_scene("[scene]\ntitle = \"a\""));
  EXPECT_TRUE(looks_like_scene("# a lake\n[scene]\n"));
  EXPECT_FALSE(looks_like_scene("[vehicle]\nmass = 3\n"));
  EXPECT_FALSE(looks_like_scene("\x89MCAP0\r\n"));
}

TEST(Scenes, ReadFromAFileTakeOtherFilesFromItsFolder) {
  const auto folder = scratch_folder();
  std::ofstream(folder / "post.obj") << sheet(1, false);
  std::ofstream(folder / "lake.toml") << "[scene]\ntitle = \"lake\"\n[[mesh]]\nfile = \"post.obj\"\n";
  const Scene scene = load_scene((folder / "lake.toml").string());
  EXPECT_EQ(scene.about.title, "lake");
  EXPECT_EQ(std::get<Mesh>(scene.bodies.at(0).shape).file, (folder / "post.obj").string());
  EXPECT_NO_THROW(World{scene});
  EXPECT_THROW((void)load_scene((folder / "pond.toml").string()), Error);
}

TEST(Scenes, KeepListedMaterialsAndReplaceThoseOfTheSameName) {
  const Scene scene = parse_scene("[scene]\n[[material]]\nname = \"rock\"\nlambert_db = -5\n", "lake.toml");
  EXPECT_EQ(scene.materials.size(), listed_materials().size());
  EXPECT_EQ(scene.material("rock")->lambert_db, -5);
  EXPECT_EQ(scene.material("sand")->lambert_db, -22);
  EXPECT_EQ(scene.material("cheese"), nullptr);
}

TEST(Scenes, MadeInCodeAreThoseOfAFile) {
  Scene scene;
  scene.about.duration_s = 2;
  scene.bottom = {.kind = BottomKind::kFlat, .depth = 12};
  scene.vehicle = {.start = {0, 0, 5}, .speed = 1};
  scene.bodies = {{.name = "pile", .material = "steel", .shape = Cylinder{.centre = {18, 4, 6}, .length = 12}}};
  scene.sonars = {sonar_preset("micron")};
  const Scene read = parse_scene(
      "[scene]\nduration_s = 2\n[bottom]\nkind = \"flat\"\ndepth = 12\n[vehicle]\nstart = [0, 0, 5]\nspeed = 1\n"
      "[[cylinder]]\nname = \"pile\"\nmaterial = \"steel\"\ncentre = [18, 4, 6]\nlength = 12\n"
      "[[sonar]]\npreset = \"micron\"\n",
      "pile.toml");
  Simulator made(scene), loaded(read);
  int pings = 0;
  while (const auto event = made.next()) {
    const auto other = loaded.next();
    ASSERT_TRUE(other);
    ASSERT_EQ(event->index(), other->index());
    const auto* ping = std::get_if<Ping>(&*event);
    if (!ping) continue;
    ++pings;
    for (int bin = 0; bin < ping->window.bins; ++bin)
      ASSERT_EQ(ping->intensity(0, bin), std::get<Ping>(*other).intensity(0, bin)) << pings << ", " << bin;
  }
  EXPECT_GT(pings, 15);
  EXPECT_FALSE(loaded.next());
}

TEST(Scenes, MadeInCodeAreCheckedBeforeTheyRun) {
  const auto problem = [](const Scene& scene) {
    try {
      Simulator simulator(scene);
    } catch (const Error& error) {
      return std::string(error.what());
    }
    return std::string("none");
  };
  Scene scene;
  EXPECT_EQ(problem(scene), "none");
  scene.bodies = {{.material = "cheese"}};
  EXPECT_NE(problem(scene).find("material: unknown material cheese"), std::string::npos) << problem(scene);
  scene.bodies = {{.shape = Wall{}}};
  EXPECT_NE(problem(scene).find("line: fewer than two corners"), std::string::npos) << problem(scene);
  scene = {};
  scene.vehicle.dynamic = true;
  EXPECT_NE(problem(scene).find("file: a dynamic vehicle needs its file"), std::string::npos) << problem(scene);
}

// ledger: S7-08 S7-13
TEST(Scenes, SayHowThePlantDiffersAndWhichControlItHas) {
  const std::string vehicle = "[vehicle]\nfile = \"" + (test::source_folder() / "vehicles/bluerov2.toml").string() +
                              "\"\nstart = [0, 0, 5]\nspeed = 0.5\n";
  const auto scene_of = [&](const std::string& more) {
    Scene scene = parse_scene("[scene]\nduration_s = 8\n[water]\ndensity = 1000\n" + vehicle + more, "box.toml");
    check(scene);
    return scene;
  };
  EXPECT_FALSE(scene_of("").vehicle.control);
  const Scene scene = scene_of("dynamic = true\ncontrol = \"adaptive\"\n[plant]\nbuoyancy = -20\nmass = 1.2\n");
  EXPECT_EQ(vehicle_model_of(scene).autopilot.control, ControlKind::kAdaptive);
  EXPECT_EQ(scene.plant, (PlantDifference{.mass = 1.2, .buoyancy = -20}));
  const auto deepest = [](const Scene& of) {
    Simulator simulator(of);
    double depth = 0;
    while (simulator.next()) depth = std::max(depth, simulator.state().X_WB.translation.z());
    return depth;
  };
  Scene as_filed = scene, by_model = scene;
  as_filed.plant = {};
  by_model.vehicle.control = ControlKind::kModel;
  EXPECT_LT(deepest(as_filed), 5.02);
  EXPECT_GT(deepest(scene), 5.05) << "the control does not know of the plant";
  EXPECT_GT(deepest(by_model), deepest(scene) + 0.1);
  Scene wrong = as_filed;
  wrong.control_model = scene_of("dynamic = true\n[control_model]\nbuoyancy = 20\n").control_model;
  EXPECT_EQ(wrong.control_model.buoyancy, 20);
  EXPECT_GT(deepest(wrong), 5.05) << "it takes the vehicle for lighter than it is";
  EXPECT_THROW(scene_of("dynamic = true\n[control_model]\ntether_m = 5\n"), Error) << "no control knows of a tether";
  try {
    scene_of("[plant]\nmass = 2\n");
    FAIL();
  } catch (const Error& e) {
    EXPECT_NE(std::string(e.what()).find("vehicle.dynamic: [plant] and [control_model] have no effect"),
              std::string::npos)
        << e.what();
  }
}

TEST(Scenes, MoveBodiesStraightBetweenTheRowsOfTheirPaths) {
  Body body;
  EXPECT_TRUE(displacement(body, 5).isZero());
  body.path = {10, 1, 2, 3, 20, 11, 2, 3, 40, 11, 22, 5};
  EXPECT_TRUE(displacement(body, 0).isZero());
  EXPECT_TRUE(displacement(body, 15).isApprox(Eigen::Vector3d(5, 0, 0)));
  EXPECT_TRUE(displacement(body, 30).isApprox(Eigen::Vector3d(10, 10, 1)));
  EXPECT_TRUE(displacement(body, 99).isApprox(Eigen::Vector3d(10, 20, 2)));
}

TEST(Template, ReadsBackAndNamesEverySectionAndList) {
  Scene scene;
  const std::string text = write_template(schema(scene));
  for (const char* name : {"[scene]", "[water]", "[bottom]", "[vehicle]", "[[material]]", "[[cylinder]]", "[[sphere]]",
                           "[[box]]", "[[wall]]", "[[prism]]", "[[pylons]]", "[[mesh]]", "[[waypoint]]", "[[sonar]]"}) {
    EXPECT_NE(text.find(std::string(name) + "\n"), std::string::npos) << name;
  }
  Scene back;
  Schema all = schema(back);
  EXPECT_NO_THROW(read_toml(text, "template.toml", all));
  EXPECT_EQ(back.bodies.size(), 7u);
  EXPECT_EQ(back.sonars.size(), 1u);
  EXPECT_EQ(back.sonars[0].range_m, SonarConfig{}.range_m);
}

// Presets -----------------------------------------------------------------------------------------------------------

TEST(Presets, LoadPassTheirCheckAndPing) {
  const Tank tank("[bottom]\nkind = \"flat\"\ndepth = 12\n");
  EXPECT_EQ(sonar_presets().size(), 12u);
  for (const std::string& name : sonar_presets()) {
    const Scene scene = parse_scene("[scene]\n[[sonar]]\npreset = \"" + name + "\"\n", "lake.toml");
    SonarConfig sonar = scene.sonars.at(0);
    EXPECT_EQ(sonar.preset, name);
    EXPECT_NO_THROW(check(sonar)) << name;
    sonar.beams = std::min(sonar.beams, 8);  // quicker
    SimulatedSonar device(sonar, *tank.world, *tank.water, 1, 1);
    const auto out = device.ping(Time{}, at_depth(5), 0);
    EXPECT_TRUE(out.ping ? check(*out.ping) == PingFault::kNone : !out.ranges.empty()) << name;
  }
  EXPECT_THROW((void)sonar_preset("sonar2000"), Error);
}

// ledger: S6-01 S5-03
TEST(Presets, AreTheDevicesThatTheyAreNamedAfter) {
  const SonarConfig micron = sonar_preset("micron");
  EXPECT_EQ(micron.kind, SonarKind::kScanning);
  EXPECT_EQ(micron.bins, 44);
  EXPECT_EQ(micron.range_m, 50);
  EXPECT_NEAR(micron.width.degrees(), 3, 1e-12);
  EXPECT_NEAR(micron.height.degrees(), 35, 1e-12);
  const SonarConfig oculus = sonar_preset("oculus_m1200d");
  EXPECT_EQ(oculus.beams, 512);
  EXPECT_EQ(oculus.frequency, 1.2e6);
  EXPECT_NEAR(oculus.sector.degrees(), 130, 1e-12);
  const SonarConfig blazed = sonar_preset("p450_horizontal");
  EXPECT_EQ(blazed.frequency, 450e3);
  EXPECT_EQ(blazed.range_m, 90);
  EXPECT_NEAR(blazed.height.degrees(), 15, 1e-12);
  EXPECT_EQ(blazed.height_pattern, PatternKind::kIdeal);
  EXPECT_NEAR(sonar_preset("p450_vertical").roll.degrees(), 90, 1e-12);
  EXPECT_NEAR(sonar_preset("altimeter").pitch.degrees(), -90, 1e-12);
}

TEST(Presets, ActBeforeEveryOtherKeyWhereverTheyStand) {
  const Scene scene =
      parse_scene("[scene]\n[[sonar]]\nrange_m = 33\nname = \"bow\"\npreset = \"didson\"\nbeams = 48\n", "lake.toml");
  EXPECT_EQ(scene.sonars.at(0).range_m, 33);
  EXPECT_EQ(scene.sonars.at(0).beams, 48);
  EXPECT_EQ(scene.sonars.at(0).name, "bow");
  EXPECT_EQ(scene.sonars.at(0).frequency, 1.8e6);
}

TEST(Scene, HasABoundOnTheNumberOfItsPingsAndReadings) {
  Scene scene;
  scene.sonars.resize(1);
  scene.sonars[0].interval_s = 0.1;
  EXPECT_NO_THROW(check_length(scene, 86'400)) << "a day";
  EXPECT_THAT([&] { check_length(scene, 1e6); },
              testing::ThrowsMessage<Error>(testing::HasSubstr("allowed: up to 20 million")));
  scene.sonars[0].interval_s = kLeastPingInterval;
  EXPECT_THROW(check_length(scene, 86'400), Error);
  scene.sonars[0].on = false;
  EXPECT_NO_THROW(check_length(scene, 86'400));
}

}  // namespace
}  // namespace isobath
