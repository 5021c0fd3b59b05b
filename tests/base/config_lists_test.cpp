// Files with arrays of tables and lists of numbers: scenes, vehicles, missions.
#include <gmock/gmock.h>
#include <isobath/base/config.hpp>

namespace isobath {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

struct Ball {
  Place place;
  double centre[3] = {0, 0, 0};
  std::vector<double> path;
  std::string preset = "small", file;
  double radius = 1;
};

struct Scene {
  double depth = 10;
  std::vector<Ball> balls;
};

Schema schema_of(Scene& scene) {
  return {{{"water", "The water.", {Field::real("depth", &scene.depth, {0, 100}, "m", "Its depth.")}}},
          {{"ball", "A ball.", [&scene](const Place& place) {
              Ball& b = scene.balls.emplace_back();
              b.place = place;
              return std::vector{Field::named(
                                     "preset", &b.preset, {"small", "large"},
                                     [&b] { b.radius = b.preset == "large" ? 5 : 1; }, "A size to start from."),
                                 Field::numbers("centre", b.centre, 3, {-100, 100}, "m", "Where it is."),
                                 Field::rows("path", &b.path, 2, {}, "m", "Where it goes."),
                                 Field::file("file", &b.file, "A mesh."),
                                 Field::real("radius", &b.radius, {0.1, 10}, "m", "Its radius.")};
            }}}};
}

Scene read(const std::string& text) {
  Scene scene;
  Schema schema = schema_of(scene);
  read_toml(text, "folder/scene.toml", schema);
  return scene;
}

std::string problem_of(const std::string& text) {
  try {
    read(text);
  } catch (const Error& e) {
    return e.what();
  }
  return "none";
}

TEST(ConfigLists, EveryTableIsOneElementAndKnowsItsPlace) {
  const Scene scene = read("[water]\ndepth = 5\n\n[[ball]]\ncentre = [1, 2.5, 3]\n[[ball]]\npath = [[0, 1], [2, 3]]\n");
  EXPECT_EQ(scene.depth, 5);
  ASSERT_EQ(scene.balls.size(), 2u);
  EXPECT_THAT(scene.balls[0].centre, ElementsAre(1, 2.5, 3));
  EXPECT_THAT(scene.balls[1].path, ElementsAre(0, 1, 2, 3));
  EXPECT_EQ(scene.balls[1].place.line, 6u);
}

TEST(ConfigLists, APresetActsFirstWhereverItStands) {
  EXPECT_EQ(read("[[ball]]\nradius = 2\npreset = \"large\"").balls[0].radius, 2);
  EXPECT_EQ(read("[[ball]]\npreset = \"large\"").balls[0].radius, 5);
}

TEST(ConfigLists, AFileIsTakenFromTheFolderOfItsFile) {
  EXPECT_EQ(read("[[ball]]\nfile = \"a.stl\"").balls[0].file, "folder/a.stl");
  EXPECT_EQ(read("[[ball]]\nfile = \"/a.stl\"").balls[0].file, "/a.stl");
}

TEST(ConfigLists, WhatIsWrongIsSaidWithLineAndColumn) {
  EXPECT_THAT(problem_of("[[ball]]\ncentre = [1, 2]"), HasSubstr("folder/scene.toml:2:10: ball.centre: not 3 numbers"));
  EXPECT_THAT(problem_of("[[ball]]\ncentre = [1, 2, 300]"), HasSubstr("300 is out of range"));
  EXPECT_THAT(problem_of("[[ball]]\npath = [[1, 2], [3]]"), HasSubstr("a row of 1 numbers instead of 2"));
  EXPECT_THAT(problem_of("[[ball]]\nradios = 2"), HasSubstr("did you mean radius?"));
  EXPECT_THAT(problem_of("[ball]\nradius = 2"), HasSubstr("not a list of tables"));
  EXPECT_THAT(problem_of("[[bell]]\nradius = 2"), HasSubstr("did you mean ball?"));
  EXPECT_THAT(problem_of("[[ball]]\npreset = \"huge\""), HasSubstr("small or large"));
  EXPECT_THAT(problem_of("[[ball]]\nradius = [\"a\"]"), HasSubstr("neither a single value nor rows of numbers"));
}

TEST(ConfigLists, TheTemplateReadsBack) {
  Scene scene;
  const std::string page = write_template(schema_of(scene));
  EXPECT_THAT(page, HasSubstr("[[ball]]"));
  EXPECT_EQ(read(page).balls.size(), 1u);
}

}  // namespace
}  // namespace isobath
