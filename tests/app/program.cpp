#include <array>
#include <cstdio>
#include <fcntl.h>
#include <fstream>
#include <memory>
#include <spawn.h>
#include <sstream>
#include <sys/wait.h>
#include <tests/app/program.hpp>
#include <unistd.h>

namespace isobath::test {
namespace {
namespace fs = std::filesystem;

/// A nameless file that takes what the program writes.
class Capture {
 public:
  [[nodiscard]] int descriptor() const { return fileno(file_.get()); }
  [[nodiscard]] std::string text() const {
    std::string all;
    std::rewind(file_.get());
    std::array<char, 4096> block{};
    while (const std::size_t got = std::fread(block.data(), 1, block.size(), file_.get()))
      all.append(block.data(), got);
    return all;
  }

 private:
  struct Close {
    void operator()(std::FILE* file) const { std::fclose(file); }
  };
  std::unique_ptr<std::FILE, Close> file_{std::tmpfile()};
};

}  // namespace

ProgramResult run_program(std::vector<std::string> words) {
  const Capture out, err;
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_addopen(&actions, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
  posix_spawn_file_actions_adddup2(&actions, out.descriptor(), STDOUT_FILENO);
  posix_spawn_file_actions_adddup2(&actions, err.descriptor(), STDERR_FILENO);
  std::vector<char*> argv;
  for (std::string& word : words) argv.push_back(word.data());
  argv.push_back(nullptr);
  pid_t process = 0;
  const int failed = posix_spawnp(&process, argv[0], &actions, nullptr, argv.data(), environ);
  posix_spawn_file_actions_destroy(&actions);
  EXPECT_EQ(failed, 0) << "cannot start " << words[0];
  int status = 0;
  if (failed || waitpid(process, &status, 0) != process) return {-1, {}, {}};
  return {WIFEXITED(status) ? WEXITSTATUS(status) : -WTERMSIG(status), out.text(), err.text()};
}

bool has_program(const std::string& name) {
  return run_program({"sh", "-c", "command -v \"$0\"", name}).exit_code == 0;
}

ProgramResult isobath(const std::vector<std::string>& arguments) {
  std::vector<std::string> words{ISOBATH_PROGRAM};
  words.insert(words.end(), arguments.begin(), arguments.end());
  return run_program(std::move(words));
}

ProgramResult in_bash(const std::string& script, const std::vector<std::string>& arguments) {
  std::vector<std::string> words{"bash", "-c", script, ISOBATH_PROGRAM};
  words.insert(words.end(), arguments.begin(), arguments.end());
  return run_program(std::move(words));
}

ProgramResult isobath_run(const fs::path& input, const fs::path& out, const std::vector<std::string>& more) {
  std::vector<std::string> arguments{"run", input.string(), "--out", out.string(), "--json"};
  if (input.empty()) arguments.erase(arguments.begin() + 1);
  arguments.insert(arguments.end(), more.begin(), more.end());
  return isobath(arguments);
}

std::string content_of(const fs::path& file) {
  std::ostringstream bytes;
  bytes << std::ifstream(file, std::ios::binary).rdbuf();
  return bytes.str();
}

nlohmann::json json_of(const fs::path& file) {
  nlohmann::json json = nlohmann::json::parse(content_of(file), nullptr, false);
  EXPECT_FALSE(json.is_discarded()) << file << " is not JSON";
  return json;
}

fs::path write(const fs::path& file, const std::string& bytes) {
  std::ofstream(file, std::ios::binary) << bytes;
  return file;
}

std::map<std::string, std::string> files_of(const fs::path& folder) {
  std::map<std::string, std::string> files;
  for (const auto& entry : fs::recursive_directory_iterator(folder)) {
    if (entry.is_regular_file()) files[fs::relative(entry.path(), folder).string()] = content_of(entry.path());
  }
  return files;
}

testing::Matcher<const ProgramResult&> ends_with_one_line(const testing::Matcher<const std::string&>& line) {
  using testing::AllOf, testing::Field, testing::MatchesRegex;
  return AllOf(Field("exit_code", &ProgramResult::exit_code, 2),
               Field("err", &ProgramResult::err, AllOf(MatchesRegex("isobath: [^\n]+\n"), line)));
}

}  // namespace isobath::test
