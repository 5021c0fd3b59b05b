// isobath aboard beside isobath stand-in: two processes, joined by sockets of this machine.
#include <gmock/gmock.h>
#include <nlohmann/json.hpp>
#include <sstream>
#include <tests/app/json_page.hpp>
#include <tests/app/logs.hpp>
#include <tests/app/program.hpp>
#include <tests/support/data.hpp>

namespace isobath {
namespace {
namespace fs = std::filesystem;
using namespace test;
using nlohmann::json;

/// scenarios/aboard.toml with one mission point, 24 m ahead.
std::string short_scene() {
  std::string text = content_of(source_folder() / "scenarios/aboard.toml");
  const auto replace = [&text](const std::string& what, const std::string& by) {
    text.replace(text.find(what), what.size(), by);
  };
  replace("../vehicles/", (source_folder() / "vehicles/").string());
  replace("north = 68", "north = 24");
  replace("preset = \"ping360\"\n",
          "preset = \"ping360\"\nspurious_share = 0\nnoise_level = 4\n");  // the timing differs
  const std::size_t second = text.find("[[mission_point]]\nname = \"B\"");
  text.erase(second, text.find("# Where it goes") - second);
  return text;
}

/// Lines of JSON, by process.
struct Joined {
  ProgramResult result;
  std::vector<json> stand_in, aboard;
};

std::vector<json> lines_of(const fs::path& file) {
  std::vector<json> lines;
  std::istringstream text(content_of(file));
  for (std::string line; std::getline(text, line);) lines.push_back(json::parse(line, nullptr, false));
  return lines;
}

Joined run(const std::string& script, const fs::path& folder) {
  Joined joined;
  joined.result = in_bash(script, {folder.string()});
  joined.stand_in = lines_of(folder / "stand_in.jsonl");
  joined.aboard = lines_of(folder / "aboard.jsonl");
  return joined;
}

/// Starts the stand-ins at free ports, then `isobath aboard` with a vehicle file that names them.
Joined join(const fs::path& folder, const std::string& stand_in, const std::string& aboard,
            const std::string& autopilot = "") {
  write(folder / "scene.toml", short_scene());
  // On a machine that does much else, a thread that waits is no agent that hangs.
  write(folder / "patient.toml", "[executor]\nmissed_ticks = 100\n");
  const std::string script =
      R"(
    cd "$1"
    timeout 120 "$0" stand-in scene.toml --json --speed 2 --autopilot udp-server:0 --device ping360=udp-server:0 \
      --device ping1d=udp-server:0 --device dvl-a50=tcp-server:0 )" +
      stand_in + R"( > stand_in.jsonl & stand_in=$!
    until [ -s stand_in.jsonl ] || ! kill -0 $stand_in 2> /dev/null; do sleep 0.05; done
    port() { sed -n "1s/.*\"$1\": *\([0-9]*\).*/\1/p" stand_in.jsonl; }
    printf '[autopilot]\nlink = "udp:127.0.0.1:%s"\ndvl_motion = true\n)" +
      autopilot +
      R"([[device]]\nkind = "ping360"\nlink = "udp:127.0.0.1:%s"\nsector_deg = 120\n[[device]]\nkind = "ping1d"\nlink = "udp:127.0.0.1:%s"\n[[device]]\nkind = "dvl-a50"\nlink = "tcp:127.0.0.1:%s"\n' \
      $(port autopilot) $(port ping360) $(port ping1d) $(port dvl-a50) > vehicle.toml
    timeout 100 "$0" aboard vehicle.toml --json --speed 2 --until-done --no-page --out out --config patient.toml )" +
      aboard + R"( > aboard.jsonl
    code=$?
    kill -INT $stand_in; wait $stand_in
    exit $code)";
  return run(script, folder);
}

/// Both processes ended well, with JSON as documented: the vehicle sailed its mission without a contact.
void expect_sailed(const fs::path& folder, const Joined& joined) {
  ASSERT_EQ(joined.aboard.size(), 2u) << joined.result.err;
  ASSERT_EQ(joined.stand_in.size(), 2u) << joined.result.err;
  EXPECT_EQ(joined.result.exit_code, 0) << joined.result.err;
  JsonPage page;
  page.compare("aboard, after the run", joined.aboard[1]);
  page.compare("stand-in, at the end", joined.stand_in[1]);
  EXPECT_EQ(joined.stand_in[1]["contact_s"], -1);
  EXPECT_GT(joined.stand_in[1]["length_m"], 20);
  EXPECT_GT(joined.stand_in[1]["setpoints"], 50);
  EXPECT_TRUE(fs::exists(folder / "out/recording.mcap"));
}

TEST(Aboard, SailsTheMissionOfTheAutopilot) {
  const fs::path folder = scratch_folder();
  const Joined joined = join(folder, "", "");
  expect_sailed(folder, joined);
  if (HasFatalFailure()) return;
  JsonPage page;
  page.compare("aboard, at the start", joined.aboard[0]);
  page.compare("stand-in, at the start", joined.stand_in[0]);
  EXPECT_GT(joined.stand_in[1]["rings"], 10);
  EXPECT_NEAR(joined.stand_in[1]["moved_m"], joined.stand_in[1]["length_m"], 3)
      << "the DVL heard a second or two later";
  EXPECT_TRUE(fs::exists(folder / "out/autopilot.plan"));
  const ProgramResult again = isobath({"info", (folder / "out/recording.mcap").string()});
  EXPECT_EQ(again.exit_code, 0) << again.err;
}

TEST(Aboard, CommandsNothingInADryRun) {
  const Joined joined = join(scratch_folder(), "--guided-after 0", "--dry-run & sleep 12; kill -INT $!; wait $!; true",
                             "obstacle_points = true\\n");
  ASSERT_EQ(joined.stand_in.size(), 2u) << joined.result.err;
  EXPECT_EQ(joined.stand_in[1]["setpoints"], 0);
  EXPECT_EQ(joined.stand_in[1]["refused"], 0);
  EXPECT_LT(joined.stand_in[1]["length_m"], 2);
  EXPECT_EQ(joined.stand_in[1]["rings"], 0);
}

/// The same beside a MOOSDB: the vehicle file of the example at the ports of the stand-ins, its mission with one point.
Joined join_moos(const fs::path& folder) {
  write(folder / "scene.toml", short_scene());
  write(folder / "patient.toml", "[executor]\nmissed_ticks = 100\n");
  std::string mission = content_of(source_folder() / "examples/aboard/moos-mission.toml");
  mission.replace(mission.find("north = 68"), 10, "north = 24");
  mission.erase(mission.find("[[mission_point]]\nname = \"B\""));
  write(folder / "moos-mission.toml", mission);
  write(folder / "moos.toml", content_of(source_folder() / "examples/aboard/moos.toml"));
  const std::string script =
      R"(
    cd "$1"
    timeout 120 "$0" stand-in scene.toml --json --speed 2 --front-seat moos --autopilot tcp-server:0 \
      --device ping360=udp-server:0 --device ping1d=udp-server:0 > stand_in.jsonl & stand_in=$!
    until [ -s stand_in.jsonl ] || ! kill -0 $stand_in 2> /dev/null; do sleep 0.05; done
    port() { sed -n "1s/.*\"$1\": *\([0-9]*\).*/\1/p" stand_in.jsonl; }
    sed "s/:9000\"/:$(port autopilot)\"/; s/:9092\"/:$(port ping360)\"/; s/:9090\"/:$(port ping1d)\"/" moos.toml > vehicle.toml
    timeout 100 "$0" aboard vehicle.toml --json --speed 2 --until-done --no-page --out out --config patient.toml \
      > aboard.jsonl
    code=$?
    kill -INT $stand_in; wait $stand_in
    exit $code)";
  return run(script, folder);
}

TEST(Aboard, SailsAMissionInAMoosCommunity) {
  const fs::path folder = scratch_folder();
  const Joined joined = join_moos(folder);
  expect_sailed(folder, joined);
  if (HasFatalFailure()) return;
  EXPECT_EQ(joined.stand_in[1]["malformed"], 0);
  EXPECT_GT(joined.stand_in[1]["texts"], 0);
}

TEST(Aboard, SaysWhatIsWrongWithAVehicleFile) {
  const fs::path folder = scratch_folder();
  write(folder / "vehicle.toml", "[[device]]\nkind = \"ping360\"\nlink = \"upd:somewhere:1\"\n");
  EXPECT_THAT(isobath({"aboard", (folder / "vehicle.toml").string()}),
              ends_with_one_line(testing::HasSubstr("no such kind of link")));
  EXPECT_THAT(isobath({"aboard"}), ends_with_one_line(testing::HasSubstr("no vehicle file")));
  write(folder / "moos.toml", "[autopilot]\nkind = \"moos\"\nlink = \"tcp:127.0.0.1:9000\"\n");
  EXPECT_THAT(isobath({"aboard", (folder / "moos.toml").string()}),
              ends_with_one_line(testing::HasSubstr("a MOOS community holds no mission")));
  EXPECT_THAT(isobath({"stand-in", "--device", "sonar=udp-server:1"}),
              ends_with_one_line(testing::HasSubstr("not a device with its link")));
  const ProgramResult format = isobath({"aboard", "--format"});
  EXPECT_EQ(format.exit_code, 0);
  write(folder / "again.toml", format.out);
}

}  // namespace
}  // namespace isobath
