// Logs of ROS as a user meets them: `convert` writes a native log as a bag of each kind, and `run` makes the same map
// of the bag as of the native log, byte for byte. Bags that the library of ROS 1 wrote are in it, where that is
// installed.
#include <tests/app/program.hpp>
#include <tests/support/data.hpp>

namespace isobath::ros_bags {
namespace {

namespace fs = std::filesystem;
using namespace test;
using testing::AllOf;
using testing::Contains;
using testing::HasSubstr;
using testing::Not;

/// Twelve seconds past a pile: a fan that looks ahead, a multibeam and an altimeter below, fixes with velocities.
const std::string kScene =
    "[scene]\ntitle = \"pile\"\nduration_s = 12\nlatitude_deg = 60.1\nlongitude_deg = 10.2\n"
    "[vehicle]\nstart = [0, 0, 5]\nspeed = 0.5\n[[waypoint]]\nnorth = 18\neast = 3\ndepth = 5\n"
    "[bottom]\nkind = \"terrain\"\nmaterial = \"sand\"\ndepth = 12\nextent_m = 80\ncell_m = 2\nrelief_m = 0.4\n"
    "[[cylinder]]\nname = \"pile\"\ncentre = [12, 2, 5]\nradius = 0.4\nlength = 14\n"
    "[navigation]\nkind = \"sensors\"\n"
    "[[sonar]]\npreset = \"p450_horizontal\"\nrange_m = 20\nbins = 240\ninterval_s = 0.5\n"
    "[[sonar]]\npreset = \"multibeam_echo_sounder\"\ninterval_s = 0.5\n[[sonar]]\npreset = \"altimeter\"\n";

/// The native log of the scene.
fs::path native_dive(const fs::path& folder) {
  const ProgramResult made = test::isobath({"sim", write(folder / "dive.toml", kScene), "--out", folder / "dive.mcap"});
  EXPECT_EQ(made.exit_code, 0) << made.err;
  return folder / "dive.mcap";
}

std::string converted(const fs::path& from, const fs::path& to, const std::vector<std::string>& more = {}) {
  std::vector<std::string> words{"convert", from, to};
  words.insert(words.end(), more.begin(), more.end());
  const ProgramResult made = test::isobath(words);
  EXPECT_EQ(made.exit_code, 0) << to << made.err;
  return made.out;
}

/// All results of a run, without those that name the file that was read: manifest, report, and the titles of pictures.
std::map<std::string, std::string> results_of(const fs::path& log, const fs::path& out) {
  const ProgramResult run = isobath_run(log, out);
  EXPECT_EQ(run.exit_code, 0) << log << run.err;
  auto files = files_of(out);
  std::erase_if(files, [](const auto& file) {
    const std::string& name = file.first;
    return name == "manifest.json" || name.ends_with(".html") || name.ends_with(".png");
  });
  return files;
}

void expect_the_same_map(const std::map<std::string, std::string>& expected, const fs::path& log, const fs::path& out) {
  const auto found = results_of(log, out);
  EXPECT_EQ(found.size(), expected.size()) << log;
  EXPECT_TRUE(found.contains("depth.tif") && found.contains("voxels.ply") && found.contains("occupancy.tif")) << log;
  for (const auto& [name, bytes] : expected) {
    EXPECT_TRUE(found.contains(name) && found.at(name) == bytes) << log << ": " << name << " differs";
  }
}

TEST(RosBags, RunOfEachKindOfBagGivesTheMapOfTheNativeLogByteForByte) {
  const fs::path folder = scratch_folder(), dive = native_dive(folder);
  const auto expected = results_of(dive, folder / "native");
  ASSERT_TRUE(expected.contains("depth.tif"));
  const std::string bag = converted(dive, folder / "one.bag");
  EXPECT_THAT(bag, AllOf(HasSubstr("one.bag: ROS 1 bag"),
                         HasSubstr("/sonar/image: 25 of marine_acoustic_msgs/ProjectedSonarImage"),
                         HasSubstr("/odometry: "), Not(HasSubstr("left out"))));
  converted(dive, folder / "two.db3");
  converted(dive, folder / "two.mcap", {"--schema", "ros2"});
  for (const char* name : {"one.bag", "two.db3", "two.mcap"}) {
    expect_the_same_map(expected, folder / name, folder / (std::string(name) + ".out"));
  }
  EXPECT_THAT(content_of(folder / "metadata.yaml"), AllOf(HasSubstr("- path: \"two.db3\""), HasSubstr("/tf_static")));
}

TEST(RosBags, MessagesOfRosAloneGiveTheMapOfTheirOwnNativeLog) {
  const fs::path folder = scratch_folder(), dive = native_dive(folder);
  for (const char* name : {"one.bag", "two.db3", "two.mcap"}) {
    converted(dive, folder / name, {"--schema", std::string(name) == "two.mcap" ? "ros2" : "native", "--no-records"});
    const fs::path native = folder / (std::string(name) + ".native.mcap");
    converted(folder / name, native);
    expect_the_same_map(results_of(native, folder / (std::string(name) + ".expected")), folder / name,
                        folder / (std::string(name) + ".out"));
  }
}

TEST(RosBags, LibraryOfRosReadsOursAndWeReadItsBags) {
#ifdef ISOBATH_ROSBAG_COPY
  const fs::path folder = scratch_folder(), dive = native_dive(folder);
  const auto expected = results_of(dive, folder / "native");
  converted(dive, folder / "ours.bag");
  for (const char* compression : {"none", "bz2", "lz4"}) {
    const fs::path copy = folder / (std::string(compression) + ".bag");
    const ProgramResult made = run_program({ISOBATH_ROSBAG_COPY, folder / "ours.bag", copy, compression});
    ASSERT_EQ(made.exit_code, 0) << made.err;
    EXPECT_THAT(made.out, AllOf(HasSubstr("/odometry nav_msgs/Odometry cd5e73d190d741a2f92e81eda573aca7 "),
                                HasSubstr("/sonar/image marine_acoustic_msgs/ProjectedSonarImage "
                                          "c72fc8e29ab227a547720a36666022fd 25")));
    expect_the_same_map(expected, copy, folder / (std::string(compression) + ".out"));
  }
  const fs::path plain = folder / "plain.bag";  // without our records, as a vehicle with ROS records
  ASSERT_EQ(run_program({ISOBATH_ROSBAG_COPY, folder / "ours.bag", plain, "lz4", "/isobath"}).exit_code, 0);
  converted(plain, folder / "plain.mcap");
  expect_the_same_map(results_of(folder / "plain.mcap", folder / "plain.expected"), plain, folder / "plain.out");
#else
  GTEST_SKIP() << "librosbag_storage is not installed";
#endif
}

TEST(RosBags, MetadataOfAnotherBagIsKept) {
  const fs::path folder = scratch_folder(), dive = native_dive(folder);
  write(folder / "metadata.yaml", "rosbag2_bagfile_information:\n  files:\n    - path: other.db3\n");
  const ProgramResult made = test::isobath({"convert", dive, folder / "two.db3"});
  EXPECT_THAT(made, ends_with_one_line(AllOf(HasSubstr("metadata of another bag"), HasSubstr("two/two.db3"))));
  EXPECT_FALSE(fs::exists(folder / "two.db3"));
  EXPECT_THAT(content_of(folder / "metadata.yaml"), HasSubstr("other.db3"));
  converted(dive, folder / "two" / "two.db3");
  converted(dive, folder / "two" / "two.db3");  // its own is written again
}

TEST(RosBags, OptionsThatDoNotFitTheFileAreRefused) {
  const fs::path folder = scratch_folder(), dive = native_dive(folder);
  EXPECT_THAT(test::isobath({"convert", dive, folder / "x.bag", "--schema", "ros2"}),
              ends_with_one_line(HasSubstr("--schema is for .mcap")));
  EXPECT_THAT(test::isobath({"convert", dive, folder / "x.mcap", "--no-records"}),
              ends_with_one_line(HasSubstr("--no-records")));
  EXPECT_THAT(test::isobath({"convert", dive, dive, "--schema", "ros2"}), ends_with_one_line(HasSubstr("input")));
}

TEST(RosBags, JsonNamesEveryTopicAndWhatIsLeftOut) {
  const fs::path folder = scratch_folder(), dive = native_dive(folder);
  const auto json = nlohmann::json::parse(converted(dive, folder / "one.bag", {"--json"}));
  std::map<std::string, int> topics;
  for (const auto& t : json["topics"]) topics[t["topic"]] = t["messages"];
  EXPECT_EQ(topics["/sonar/image"], 25);
  EXPECT_EQ(topics["/isobath/ping"], 25);
  EXPECT_EQ(topics["/odometry"], topics["/fix"]);
  EXPECT_TRUE(json["left_out"].empty());
  EXPECT_EQ(json["made"], "log");
}

}  // namespace
}  // namespace isobath::ros_bags
