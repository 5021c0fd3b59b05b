// isobath setup beside isobath stand-in: two processes, joined by sockets of this machine and a pseudo-terminal.
#include <gmock/gmock.h>
#include <tests/app/logs.hpp>
#include <tests/app/program.hpp>
#include <tests/support/data.hpp>

namespace isobath {
namespace {
namespace fs = std::filesystem;
using namespace test;
using testing::AllOf;
using testing::HasSubstr;

/// scenarios/aboard.toml with two walls near the start: 12 m away at 40 degrees, and 8 m away at -100 degrees.
std::string scene_with_walls() {
  std::string text = content_of(source_folder() / "scenarios/aboard.toml");
  const std::string folder = "../vehicles/";
  text.replace(text.find(folder), folder.size(), (source_folder() / "vehicles/").string());
  return text + R"(
[[wall]]
name = "quay"
line = [[13.05, 3.11], [5.33, 12.31]]
top = -1
bottom = 9
material = "rock"

[[wall]]
name = "pier"
line = [[-5.3, -7.2], [2.5, -8.5]]
top = -1
bottom = 9
material = "rock"
)";
}

/// Starts the stand-ins at free ports, then `script`, in which `port KIND` is the port of a device.
ProgramResult beside_stand_ins(const fs::path& folder, const std::string& script) {
  write(folder / "scene.toml", scene_with_walls());
  return in_bash(R"(
    cd "$1"
    timeout 100 "$0" stand-in scene.toml --json --speed 4 --stay --autopilot udp-server:0 --device ping360=udp-server:0 \
      --device ping1d=udp-server:0 --device micron=pty:micron > stand_in.jsonl & stand_in=$!
    until [ -s stand_in.jsonl ] || ! kill -0 $stand_in 2> /dev/null; do sleep 0.05; done
    port() { sed -n "1s/.*\"$1\": *\([0-9]*\).*/\1/p" stand_in.jsonl; }
    setup() {
      timeout 90 "$0" setup vehicle.toml --speed 4 --no-usual --try udp:127.0.0.1:$(port autopilot) "$@"
    }
)" + script + R"(
    code=$?
    kill -INT $stand_in; wait $stand_in
    exit $code)",
                 {folder.string()});
}

TEST(Setup, FindsDevicesChecksTheirMountingAndWritesAFileThatIsAccepted) {
  const fs::path folder = scratch_folder();
  const ProgramResult result = beside_stand_ins(folder, R"(
    setup --try udp:127.0.0.1:$(port ping360) --try udp:127.0.0.1:$(port ping1d) --yes --wall 40,12 --wall -100,8 \
      --answer ping360.upside_down=true --answer ping360.position_m=0.25,0,-0.1 --answer vehicle.title=Ours || kill -INT $stand_in
    timeout 60 "$0" aboard vehicle.toml --speed 4 --dry-run --no-page --json --out out > aboard.jsonl & aboard=$!
    until [ -s aboard.jsonl ] || ! kill -0 $aboard 2> /dev/null; do sleep 0.05; done
    sleep 2
    kill -INT $aboard
    wait $aboard)");
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_THAT(result.out, AllOf(HasSubstr("ArduPilot autopilot, system 1"), HasSubstr("Ping360 at udp:127.0.0.1:"),
                                HasSubstr("Ping1D at udp:127.0.0.1:"), HasSubstr(" pings a second, range 20.0 m"),
                                HasSubstr(" ranges a second")));
  EXPECT_THAT(result.out, AllOf(HasSubstr("it is mirrored: upside_down = false, heading_deg = 0"),
                                HasSubstr("isobath aboard vehicle.toml --dry-run")));
  const std::string file = content_of(folder / "vehicle.toml");
  EXPECT_THAT(file, AllOf(HasSubstr("title = \"Ours\""), HasSubstr("position_m = [0.25, 0.0, -0.1]"),
                          HasSubstr("kind = \"ping360\""), HasSubstr("from = \"autopilot\""),
                          testing::Not(HasSubstr("upside_down"))));
  EXPECT_THAT(content_of(folder / "aboard.jsonl"), HasSubstr("\"aboard\"")) << "the file is accepted";
}

TEST(Setup, FindsASerialHeadAndItsTurn) {
  const fs::path folder = scratch_folder();
  const ProgramResult result = beside_stand_ins(folder, R"(
    setup --try serial:$PWD/micron:115200 --yes --wall 40,12 --wall -100,8 --answer micron.heading_deg=90)");
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_THAT(result.out, AllOf(HasSubstr("Tritech imaging head at serial:"), HasSubstr("it is turned by -")));
  EXPECT_THAT(content_of(folder / "vehicle.toml"), HasSubstr("kind = \"micron\""));
}

TEST(Setup, AsksNothingThatIsNotAnsweredAndReplacesNoFile) {
  const fs::path folder = scratch_folder();
  const ProgramResult unanswered =
      beside_stand_ins(folder, "setup --try udp:127.0.0.1:$(port ping1d) --search 2 < /dev/null");
  EXPECT_THAT(unanswered, ends_with_one_line(HasSubstr("--answer vehicle.title=VALUE")));
  EXPECT_FALSE(fs::exists(folder / "vehicle.toml"));
  const std::string file = write(folder / "there.toml", "[vehicle]\n").string();
  EXPECT_THAT(isobath({"setup", file}), ends_with_one_line(HasSubstr("--overwrite")));
  EXPECT_THAT(isobath({"setup", (folder / "a.toml").string(), "--wall", "north"}),
              ends_with_one_line(HasSubstr("north")));
  EXPECT_THAT(isobath({"setup", (folder / "a.toml").string(), "--answer", "x"}),
              ends_with_one_line(HasSubstr("KEY=VALUE")));
  EXPECT_THAT(isobath({"setup", (folder / "a.toml").string(), "--no-usual"}),
              ends_with_one_line(HasSubstr("no link to look at")));
  const ProgramResult nothing =
      isobath({"setup", (folder / "a.toml").string(), "--no-usual", "--try", "udp:127.0.0.1:9", "--search", "0.5"});
  EXPECT_EQ(nothing.exit_code, 1);
  EXPECT_THAT(nothing.out, HasSubstr("no device was heard"));
}

}  // namespace
}  // namespace isobath
