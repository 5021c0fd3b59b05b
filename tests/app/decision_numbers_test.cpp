// A decision has one number everywhere: on the terminal, in decisions.json, in the run of the report, in the recording.
#include <isobath/display/live_page.hpp>
#include <isobath/io/mcap/native_log.hpp>
#include <isobath/recording/recorded_display.hpp>
#include <regex>
#include <sstream>
#include <tests/app/program.hpp>
#include <tests/support/data.hpp>
#include <tests/support/embedded_run.hpp>
#include <unistd.h>

namespace isobath {
namespace {
namespace fs = std::filesystem;
using nlohmann::json;
using test::Record;

/// By its number: what was decided, by which agent, and why.
using Told = std::map<std::uint64_t, std::string>;

std::string told(const json& decision) {
  return decision["agent"].get<std::string>() + ": " + decision["what"].get<std::string>() + ": " +
         decision["reason"].get<std::string>();
}

Told told_in_file(const fs::path& folder) {
  Told all;
  const json file = test::json_of(folder / "decisions.json");
  for (const json& d : file["decisions"]) all[d["number"]] = told(d);
  return all;
}

/// Lines such as "   5   22.300 s  navigator: replan: leg 1 would ...".
Told told_on_terminal(const std::string& out) {
  Told all;
  std::istringstream lines(out);
  const std::regex form(R"(^ +([0-9]+) +[0-9.]+ s  (.*: .*: .*)$)");
  std::smatch found;
  for (std::string line; std::getline(lines, line);) {
    if (std::regex_match(line, found, form)) all[std::stoull(found[1])] = found[2];
  }
  return all;
}

/// The numbers of the items and those in their payloads must agree.
Told told_by(const std::vector<Record>& records) {
  Told all;
  for (const Record& r : test::of_kind(records, DisplayKind::kDecision)) {
    const json decision = json::parse(r.payload);
    EXPECT_EQ(decision["number"], r.number);
    all[r.number] = told(decision);
  }
  return all;
}

Told told_in_report(const fs::path& folder) {
  Told all;
  for (const test::Block& block : test::run_in_report(test::content_of(folder / "report.html"))) {
    for (const auto& [number, text] : told_by(block.records)) all[number] = text;
  }
  return all;
}

Told told_in_table(const fs::path& folder) {
  Told all;
  const std::string report = test::content_of(folder / "report.html");
  const std::size_t from = report.find("<h2>Decisions</h2>");
  const std::string table = report.substr(from, report.find("</table>", from) - from);
  const std::regex row("<tr><td>([0-9]+)</td><td>[^<]*</td><td>([^<]*)</td><td>([^<]*)</td>");
  for (std::sregex_iterator at(table.begin(), table.end(), row), end; at != end; ++at) {
    all[std::stoull((*at)[1])] = std::string((*at)[2]) + ": " + std::string((*at)[3]);
  }
  return all;
}

class DecisionNumbers : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ =
        fs::current_path() / "scratch" / ("DecisionNumbers." + std::to_string(getpid()));  // tests run side by side
    fs::remove_all(folder_);
    fs::create_directories(folder_);
    const fs::path scenario = test::source_folder() / "scenarios" / "simulated_mission_1.toml";
    const auto result = test::isobath({"run", scenario, "--out", folder_ / "out", "--record", folder_ / "run.mcap"});
    ASSERT_EQ(result.exit_code, 0) << result.err;
    terminal_ = result.out;
    in_file_ = told_in_file(folder_ / "out");
  }
  static void TearDownTestSuite() { fs::remove_all(folder_); }
  static inline fs::path folder_;
  static inline std::string terminal_;
  static inline Told in_file_;
};

TEST_F(DecisionNumbers, CountFromOneWithoutAGap) {
  ASSERT_GT(in_file_.size(), 4u);
  EXPECT_EQ(in_file_.begin()->first, 1u);
  EXPECT_EQ(in_file_.rbegin()->first, in_file_.size());
}

TEST_F(DecisionNumbers, AreThoseOfTheTerminal) {
  const Told terminal = told_on_terminal(terminal_);
  ASSERT_GT(terminal.size(), 1u) << terminal_;
  for (const auto& [number, text] : terminal) EXPECT_EQ(in_file_[number], text);
}

TEST_F(DecisionNumbers, AreThoseOfTheRunInTheReportAndOfItsTable) {
  if (!live_page().empty()) {
    EXPECT_EQ(told_in_report(folder_ / "out"), in_file_);
  }
  const Told table = told_in_table(folder_ / "out");
  ASSERT_EQ(table.size(), in_file_.size());
  for (const auto& [number, text] : table) EXPECT_EQ(in_file_[number].find(text), 0u) << text;
}

TEST_F(DecisionNumbers, AreThoseOfTheRecordingAndOfThePageThatShowsIt) {
  Told channel;
  for (const std::string& line : decisions_in(folder_ / "run.mcap")) {
    const json decision = json::parse(line);
    channel[decision["number"]] = told(decision);
  }
  EXPECT_EQ(channel, in_file_);
  RecordedDisplay recorded(folder_ / "run.mcap");
  DisplayState items;
  recorded.seek(recorded.span()->last, items);
  EXPECT_EQ(told_by(test::records_of(items.changes_after(0).records)), in_file_);
}

}  // namespace
}  // namespace isobath
