// The built program as a user meets it: started with arguments, seen through its exit code, its output and its files.
#pragma once

#include <filesystem>
#include <gmock/gmock.h>
#include <map>
#include <nlohmann/json.hpp>
#include <ostream>
#include <string>
#include <vector>

namespace isobath::test {

struct ProgramResult {
  int exit_code = 0;  ///< minus the signal where one ended it
  std::string out, err;
};
inline void PrintTo(const ProgramResult& r, std::ostream* to) { *to << "exit " << r.exit_code << ", " << r.err; }

/// Runs a program, which is looked for in PATH, in the current folder. Its outputs are no terminal.
ProgramResult run_program(std::vector<std::string> words);
/// Whether a program is in PATH, or the file that may be run is there.
bool has_program(const std::string& name);
/// Runs Isobath.
ProgramResult isobath(const std::vector<std::string>& arguments);
/// Runs a script of bash; within it, $0 is Isobath, and $1 .. are the arguments.
ProgramResult in_bash(const std::string& script, const std::vector<std::string>& arguments = {});

/// `isobath run INPUT --out OUT --json ...`
ProgramResult isobath_run(const std::filesystem::path& input, const std::filesystem::path& out,
                          const std::vector<std::string>& more = {});

std::string content_of(const std::filesystem::path& file);
nlohmann::json json_of(const std::filesystem::path& file);
std::filesystem::path write(const std::filesystem::path& file, const std::string& bytes);

/// Path below the folder -> bytes, of every file in it.
std::map<std::string, std::string> files_of(const std::filesystem::path& folder);

/// The law for wrong input: exit code 2, and one line on standard error that begins with the program's name.
testing::Matcher<const ProgramResult&> ends_with_one_line(const testing::Matcher<const std::string&>& line);

}  // namespace isobath::test
