// The kinds of values that options take. Each kind is a validator of CLI11. It checks a value when the command line is
// parsed, and its description tells the help, the man page and the completion what may be given. Paths are checked
// after that, by check_paths, so that --help works beside a wrong path.
//
//   command.add_option("--threads", n, "Number of threads")->check(whole(1, 64));
//   command.add_option("--config", file, "TOML file with settings")->check(reads())->type_name("FILE");
#pragma once

#include <CLI/CLI.hpp>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

namespace isobath::app {

CLI::Validator reads();          ///< a file or a folder that exists
CLI::Validator reads_folder();   ///< a folder that exists
CLI::Validator writes();         ///< a file or a folder to write
CLI::Validator writes_file();    ///< a file to write
CLI::Validator writes_folder();  ///< a folder to write into
CLI::Validator one_of(const std::vector<std::string>& names);
/// Any value; the completion offers these. `files`: and files.
CLI::Validator such_as(std::function<std::vector<std::string>()> names, bool files = false);
CLI::Validator whole(int low, int high);         ///< a whole number
CLI::Validator number(double low, double high);  ///< infinite: no limit

/// The option for the folder of the results, whose default is the value of `out`.
void add_output_folder(CLI::App& command, std::filesystem::path& out, const std::string& text,
                       const std::string& names = "--out");

/// What an option takes, as its validators describe it.
struct ValueKind {
  enum class Path { kNone, kReads, kReadsFolder, kWrites, kWritesFile, kWritesFolder };
  Path path = Path::kNone;
  std::vector<std::string> choices;
  bool others = false;  ///< values beside the choices are allowed
  std::string range;    ///< "1 .. 64"; empty: any
};
ValueKind kind_of(const CLI::Option& option);

/// Throws Error if a path among the given values cannot be read or written, or if a file to write is one to read.
void check_paths(const CLI::App& command);
/// Makes the folder of a file that is to be written. Throws Error where that is impossible.
void make_parent(const std::filesystem::path& file);

}  // namespace isobath::app
