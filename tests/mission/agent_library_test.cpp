// Agents that are loaded, not compiled in.
#include <filesystem>
#include <fstream>
#include <gmock/gmock.h>
#include <isobath/mission/command/agent_library.hpp>
#include <isobath/mission/command/executor.hpp>
#include <tests/mission/scripted_agent.hpp>

namespace isobath {
namespace {

using testing::HasSubstr;

AgentFile file_of(const std::string& library) {
  return {{"mission.toml", {}, 3, 1, "agent"}, "lookout", AgentLevel::kMission, library};
}

std::string refusal(const std::string& library) {
  try {
    load_agent(file_of(library));
  } catch (const Error& e) {
    return e.what();
  }
  return "";
}

// ledger: S6-33 S6-32
TEST(AgentLibrary, AnAgentJoinsTheOthersByConfiguration) {
  std::vector<AgentFile> files;
  Schema schema;
  schema.lists.push_back(agent_list(files));
  read_toml(fmt::format("[[agent]]\nname = \"lookout\"\nlevel = \"vehicle\"\nlibrary = \"{}\"\n\n"
                        "[[agent]]\nname = \"second lookout\"\nlibrary = \"{}\"\n",
                        LOOKOUT_LIBRARY, LOOKOUT_LIBRARY),
            "mission.toml", schema);
  ASSERT_EQ(files.size(), 2u);
  EXPECT_EQ(files[1].place.line, 6u);
  std::vector<AgentSlot> all;
  for (const AgentFile& file : files) all.push_back(load_agent(file));
  EXPECT_EQ(all[0].level, AgentLevel::kVehicle);
  EXPECT_EQ(all[1].level, AgentLevel::kMission);

  std::vector<Envelope> said;  // outlives the executor, as what was said by a loaded agent may
  {
    ExecutorConfig config;
    config.arbiter.safety_officer = "";
    Executor executor(std::move(all), {}, config, [&](const Envelope& e) { said.push_back(e); });
    executor.on_message(test::call(5), test::at(0));
  }
  ASSERT_EQ(said.size(), 3u);
  EXPECT_EQ(said[1].sender, "lookout");
  EXPECT_EQ(said[2].sender, "second lookout");
  const auto* charted = std::get_if<ChartedHazards>(&said[1].message);
  ASSERT_NE(charted, nullptr);
  EXPECT_EQ(charted->hazards->size(), 5u);
}

// ledger: S6-33
TEST(AgentLibrary, SaysWhatIsWrongWithALibrary) {
  EXPECT_THAT(refusal("no/such/file.so"), HasSubstr("mission.toml:3:1: agent: no such file: 'no/such/file.so'"));
  EXPECT_THAT(refusal(std::filesystem::path(LOOKOUT_LIBRARY).parent_path().string()), HasSubstr("no such file"));
  EXPECT_THAT(refusal(NO_AGENT_LIBRARY), HasSubstr("exports no agent"));
  EXPECT_THAT(refusal(OLD_LIBRARY), HasSubstr("was built for another interface: version 0, "));
  EXPECT_THAT(refusal(FAILING_LIBRARY), HasSubstr("'lookout' could not be created: no eyes"));

  const std::filesystem::path text = std::filesystem::path(testing::TempDir()) / "isobath_no_library.so";
  std::ofstream(text) << "no library";
  EXPECT_THAT(refusal(text.string()), HasSubstr("cannot be loaded"));
  std::filesystem::remove(text);
}

}  // namespace
}  // namespace isobath
