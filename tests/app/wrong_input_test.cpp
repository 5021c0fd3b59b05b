// Wrong input ends in one clear line on standard error and exit code 2. What could be used was used and is written.
#include <fmt/format.h>
#include <isobath/io/mcap/native_log.hpp>
#include <tests/app/logs.hpp>
#include <tests/app/program.hpp>
#include <tests/support/data.hpp>

namespace isobath {
namespace {
namespace fs = std::filesystem;
using namespace test;
using testing::AllOf, testing::HasSubstr;

class WrongInput : public testing::Test {
 protected:
  fs::path file(const std::string& name, const std::string& bytes) { return write(folder_ / name, bytes); }
  fs::path out() { return folder_ / "out"; }
  ProgramResult run(const fs::path& input, const std::vector<std::string>& more = {}) {
    return isobath_run(input, out(), more);
  }
  /// Nothing could be used: one line, the same as an object on standard output, and no folder of results.
  void refuses(const fs::path& input, const std::string& words) {
    const ProgramResult result = run(input);
    EXPECT_THAT(result, ends_with_one_line(AllOf(HasSubstr(input.string()), HasSubstr(words))));
    EXPECT_EQ("isobath: " + nlohmann::json::parse(result.out)["error"]["problem"].get<std::string>() + "\n",
              result.err);
    EXPECT_FALSE(fs::exists(out())) << "no results of nothing";
  }
  /// Something is wrong, but not with all of it: one line, and the results of the rest.
  /// A cut log fails (1); a few bad events of many are a warning (0).
  void maps_the_rest(const ProgramResult& result, const testing::Matcher<int>& pings, const std::string& words,
                     int exit_code = 1) {
    EXPECT_EQ(result.exit_code, exit_code);
    EXPECT_THAT(result.err, testing::MatchesRegex("isobath: [^\n]+\n"));
    EXPECT_THAT(result.err, HasSubstr(words));
    const std::string field = exit_code == 0 ? "warning" : "problem";
    const auto json = nlohmann::json::parse(result.out);
    EXPECT_THAT(json["counts"]["pings"].get<int>(), pings);
    EXPECT_THAT(json[field].get<std::string>(), HasSubstr(words));
    for (const std::string file : json["files"]) EXPECT_TRUE(fs::exists(file)) << file;
    EXPECT_THAT(content_of(out() / "report.html"), HasSubstr(words));
    EXPECT_THAT(json_of(out() / "manifest.json")[field].get<std::string>(), HasSubstr(words));
  }
  /// The poses as a native log beside the pings: what a recorder may have written.
  fs::path native_log_with(const std::function<void(std::vector<Event>&)>& spoil);

  fs::path folder_ = scratch_folder();
};

TEST_F(WrongInput, FilesThatAreNoLogs) {
  refuses(folder_ / "absent.bin", "no such file");
  refuses(file("empty.bin", ""), "is empty");
  refuses(file("notes.bin", "Dive 3.\nAll went well.\n"), "looks like text");
  refuses(file("noise.bin", std::string("\x01\x00\x00\x00\x02", 5)), "not a known format");
  fs::create_directory(folder_ / "no-frames");
  refuses(folder_ / "no-frames", "a folder");
  file("no-frames/readme.txt", "nothing here");
  refuses(folder_ / "no-frames", "a folder");
}

TEST_F(WrongInput, InfoAndConvertRefuseThemInTheSameWords) {
  const fs::path notes = file("notes.bin", "Dive 3.\nAll went well.\n");
  const std::string words = run(notes).err;
  EXPECT_EQ(isobath({"info", notes}).err, words);
  EXPECT_EQ(isobath({"info", notes, "--json"}).err, words);
  const ProgramResult converted = isobath({"convert", notes, folder_ / "notes.mcap"});
  EXPECT_THAT(converted, ends_with_one_line(words));
  EXPECT_FALSE(fs::exists(folder_ / "notes.mcap"));
}

TEST_F(WrongInput, LogsThatEndWithTheirHeader) {
  std::vector<std::size_t> starts;
  const std::string log = wall_ping_viewer_log(3, &starts);
  refuses(file("header.bin", log.substr(0, starts[0])), "nothing was recorded");
  refuses(file("half-header.bin", log.substr(0, starts[0] / 2)), "ends within its header");
  refuses(file("heading.csv", wall_csv_lines(0)[0]), "nothing follows the heading");
}

TEST_F(WrongInput, HeaderThatPromisesTwoToThe31Bins) {
  refuses(file("greedy.csv", "# t_s,head_deg,bin_m,nbins,i0,i1,...\n0.0,0.0,0.1,2147483648,1,2,3\n"),
          "2147483648 bins");
}

TEST_F(WrongInput, LogCutAfterSomeRecordsIsJustAShorterLog) {
  std::vector<std::size_t> starts;
  const std::string log = wall_ping_viewer_log(200, &starts);
  const ProgramResult result = run(file("short.bin", log.substr(0, starts[150])));
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_EQ(nlohmann::json::parse(result.out)["counts"]["pings"], 150);
}

TEST_F(WrongInput, LogCutInTheMiddleOfARecord) {
  std::vector<std::size_t> starts;
  const std::string log = wall_ping_viewer_log(200, &starts);
  const std::size_t record = starts[151] - starts[150];
  for (const std::size_t kept : {std::size_t{3}, record - 1}) {
    const ProgramResult result = run(file("cut.bin", log.substr(0, starts[150] + kept)));
    maps_the_rest(result, 150, "the log is cut off");
    const auto skipped = json_of(out() / "manifest.json")["skipped"];
    ASSERT_EQ(skipped.size(), 1u) << "cut after " << kept << " bytes of a record";
    EXPECT_GE(skipped[0]["offset"], starts[150]);
    EXPECT_THAT(result.err, HasSubstr(fmt::format("from byte {}", skipped[0]["offset"].get<std::size_t>())));
  }
}

TEST_F(WrongInput, TextLogCutInTheMiddleOfALine) {
  const auto lines = wall_csv_lines(200);
  std::string log = joined({lines.begin(), lines.begin() + 151});
  const std::size_t cut = log.size();
  log += lines[151].substr(0, lines[151].size() / 2);
  maps_the_rest(run(file("cut.csv", log)), 150, fmt::format("from byte {}", cut));
}

TEST_F(WrongInput, CutLogWithAPoseTrackBesideIt) {
  const auto lines = wall_csv_lines(200);
  const std::string log = joined(lines);
  const fs::path poses = file("poses.csv", pose_csv(25));
  const ProgramResult result =
      run(file("cut.csv", log.substr(0, log.size() - 100)), {"--set", "input.navigation=" + poses.string()});
  maps_the_rest(result, 199, fmt::format("from byte {}", log.size() - lines.back().size()));
}

TEST_F(WrongInput, NativeLogCutInTheMiddle) {
  const fs::path whole = folder_ / "whole.mcap";
  ASSERT_EQ(isobath({"convert", file("wall.csv", wall_csv(200)), whole}).exit_code, 0);
  const std::string bytes = content_of(whole);
  const ProgramResult result = run(file("cut.mcap", bytes.substr(0, bytes.size() * 2 / 3)));
  EXPECT_EQ(result.exit_code, 1);
  EXPECT_THAT(result.err, AllOf(HasSubstr("cut.mcap"), HasSubstr("the log is cut off")));
}

fs::path WrongInput::native_log_with(const std::function<void(std::vector<Event>&)>& spoil) {
  const fs::path plain = folder_ / "plain.mcap", spoilt = folder_ / "spoilt.mcap";
  const fs::path poses = file("plain.poses.csv", pose_csv(25));
  const auto made =
      isobath({"convert", file("wall.csv", wall_csv(200)), plain, "--set", "input.navigation=" + poses.string()});
  EXPECT_EQ(made.exit_code, 0) << made.err;
  std::vector<Event> events;
  const auto source = open_native_log(plain, {});
  while (auto event = source->next()) events.push_back(std::move(*event));
  spoil(events);
  NativeLogWriter log(spoilt);
  for (const Event& event : events) log.write(event);
  log.close();
  return spoilt;
}

TEST_F(WrongInput, PosesThatAreNoNumbers) {
  const auto kMaxPings = testing::AllOf(testing::Ge(190), testing::Le(200));  // some have no pose now
  const fs::path log = file("wall.csv", wall_csv(200));
  const std::string good = pose_csv(25);
  std::string bad = good;
  bad.replace(bad.find("3,47.5"), 6, "3,nan");
  maps_the_rest(run(log, {"--set", "input.navigation=" + file("poses.csv", bad).string()}), kMaxPings,
                "missing or impossible value: 1 of ", 0);
  const ProgramResult recorded = run(native_log_with([](std::vector<Event>& events) {
    for (Event& event : events) {
      auto* fix = std::get_if<Navigation>(&event);
      if (fix && fix->time == Time(seconds(3))) fix->X_WB.translation.x() = NAN;
    }
  }));
  maps_the_rest(recorded, kMaxPings, "navigation not finite: 1 of ", 0);
}

TEST_F(WrongInput, PosesThatAreAllNoNumbers) {
  std::string bad = "t_s,north_m,east_m,depth_m,heading_deg\n";
  for (int i = 0; i < 25; ++i) bad += fmt::format("{},nan,0,1,0\n", i);
  const ProgramResult result =
      run(file("wall.csv", wall_csv(200)), {"--set", "input.navigation=" + file("poses.csv", bad).string()});
  EXPECT_THAT(result, ends_with_one_line(HasSubstr("25 of ")));
}

TEST_F(WrongInput, TimeThatRunsBackwards) {
  auto lines = wall_csv_lines(200);
  std::swap(lines[100], lines[105]);
  const ProgramResult result = run(file("swapped.csv", joined(lines)));
  EXPECT_THAT(result, ends_with_one_line(HasSubstr("time runs backwards")));
  EXPECT_GE(nlohmann::json::parse(result.out)["counts"]["pings"], 194);
  std::vector<std::string> reversed{lines[0]};
  for (int i = 200; i > 0; --i) reversed.push_back(wall_csv_lines(200)[i]);
  EXPECT_THAT(run(file("reversed.csv", joined(reversed))), ends_with_one_line(HasSubstr("time runs backwards")));
}

TEST_F(WrongInput, TwoThingsThatAreWrongAreBothTold) {
  std::string bad = pose_csv(25);
  bad.replace(bad.find("3,47.5"), 6, "3,nan");
  bad.replace(bad.find("\n5,47.5"), 7, "\n1,47.5");
  const ProgramResult result =
      run(file("wall.csv", wall_csv(200)), {"--set", "input.navigation=" + file("poses.csv", bad).string()});
  EXPECT_EQ(result.exit_code, 0) << "two of 222 events";
  EXPECT_THAT(result.err, AllOf(HasSubstr("missing or impossible value: 1 of "), HasSubstr("back in time")));
}

TEST_F(WrongInput, PoseTrackWhoseTimeRunsBackwards) {
  std::string bad = pose_csv(25);
  bad.replace(bad.find("\n3,47.5"), 7, "\n1,47.5");
  const ProgramResult result =
      run(file("wall.csv", wall_csv(200)), {"--set", "input.navigation=" + file("poses.csv", bad).string()});
  EXPECT_EQ(result.exit_code, 0) << "one of 222 events";
  EXPECT_THAT(result.err, AllOf(HasSubstr("isobath: warning: "), HasSubstr("back in time")));
}

TEST_F(WrongInput, PoseTracksThatCannotBeOne) {
  const fs::path log = file("wall.csv", wall_csv(50));
  for (const auto& [text, words] :
       std::vector<std::pair<std::string, std::string>>{{"", "no line of column names"},
                                                        {"a,b,c\n1,2,3\n", "no column of time"},
                                                        {"t_s,north_m,depth_m,heading_deg\n0,0,0,0\n", "east_m"}}) {
    const fs::path poses = file("poses.csv", text);
    EXPECT_THAT(run(log, {"--set", "input.navigation=" + poses.string()}),
                ends_with_one_line(AllOf(HasSubstr("poses.csv"), HasSubstr(words))));
  }
  EXPECT_THAT(run(log, {"--set", "input.navigation=" + (folder_ / "absent.csv").string()}),
              ends_with_one_line(HasSubstr("absent.csv")));
}

TEST_F(WrongInput, OptionsAndCommandsThatDoNotExist) {
  EXPECT_THAT(isobath({}), ends_with_one_line(HasSubstr("--help")));
  EXPECT_THAT(isobath({"swim"}), ends_with_one_line(HasSubstr("--help")));
  EXPECT_THAT(run(file("wall.csv", wall_csv(3)), {"--depth", "3"}), ends_with_one_line(HasSubstr("--depth")));
  EXPECT_THAT(run(file("wall.csv", wall_csv(3)), {"--threads", "0"}), ends_with_one_line(HasSubstr("--threads")));
  EXPECT_THAT(isobath({"info"}), ends_with_one_line(HasSubstr("FILE")));
  EXPECT_THAT(isobath({"convert", file("wall.csv", wall_csv(3)), out() / "out.txt"}),
              ends_with_one_line(HasSubstr(".mcap")));
}

TEST_F(WrongInput, ConfigurationsThatCannotBeReadSayWhere) {
  const auto refused = [&](const std::string& toml) {
    return isobath({"run", "--out", out(), "--config", file("sea.toml", toml)});
  };
  EXPECT_THAT(refused("[echoes]\nfalse_alarms = 0.01\n"),
              ends_with_one_line(AllOf(HasSubstr("sea.toml:2:1"), HasSubstr("false_alarm"))));
  EXPECT_THAT(refused("\n[echo]\nfalse_alarm = 0.01\n"),
              ends_with_one_line(AllOf(HasSubstr("sea.toml:2:"), HasSubstr("echoes"))));
  EXPECT_THAT(refused("[echoes]\n  false_alarm = 7\n"),
              ends_with_one_line(AllOf(HasSubstr("sea.toml:2:"), HasSubstr("allowed"))));
  EXPECT_THAT(refused("[echoes\n"), ends_with_one_line(HasSubstr("sea.toml:1:")));
  EXPECT_THAT(isobath({"run", "--config", folder_ / "absent.toml"}), ends_with_one_line(HasSubstr("absent.toml")));
  EXPECT_THAT(isobath({"run", "--config", folder_}), ends_with_one_line(HasSubstr(folder_.string())));
}

TEST_F(WrongInput, SettingsThatCannotBe) {
  const auto refused = [&](const std::string& setting) { return isobath({"run", "--out", out(), "--set", setting}); };
  EXPECT_THAT(refused("echoes.false_alarm=2"),
              ends_with_one_line(AllOf(HasSubstr("false_alarm"), HasSubstr("allowed"))));
  EXPECT_THAT(refused("echoes.false_alarm=high"), ends_with_one_line(HasSubstr("false_alarm")));
  EXPECT_THAT(refused("echoes.alarm=0.1"), ends_with_one_line(HasSubstr("alarm")));
  EXPECT_THAT(refused("sound_speed"), ends_with_one_line(HasSubstr("sound_speed")));
  EXPECT_FALSE(fs::exists(out()));
  EXPECT_THAT(refused("sensor.model=absent.json"), ends_with_one_line(HasSubstr("absent.json")));
  EXPECT_THAT(refused("grid.prior=0.3"), ends_with_one_line(HasSubstr("prior")));
}

TEST_F(WrongInput, FolderThatCannotBeMade) {
  const fs::path log = file("wall.csv", wall_csv(3)), in_the_way = file("taken", "a file");
  EXPECT_THAT(isobath_run(log, in_the_way), ends_with_one_line(HasSubstr("cannot make the output folder")));
  EXPECT_THAT(isobath_run(log, in_the_way / "below"), ends_with_one_line(HasSubstr("cannot make the output folder")));
  EXPECT_EQ(content_of(in_the_way), "a file");
  EXPECT_THAT(isobath({"convert", log, in_the_way / "below.mcap"}), ends_with_one_line(HasSubstr("below.mcap")));
}

}  // namespace
}  // namespace isobath
