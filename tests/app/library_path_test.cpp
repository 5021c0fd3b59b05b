// Where the built program looks for its libraries. An empty or a relative element of that path is the current
// directory: whoever can write a file there could have it loaded.
#include <algorithm>
#include <gtest/gtest.h>
#include <sstream>
#include <tests/app/program.hpp>

namespace isobath {
namespace {
using namespace test;

/// The elements of the paths in the dynamic section, as `readelf -d` prints them: "(RUNPATH) Library runpath: [a:b]".
std::vector<std::string> library_path(const std::string& dynamic_section) {
  std::vector<std::string> elements;
  std::istringstream lines(dynamic_section);
  for (std::string line; std::getline(lines, line);) {
    if (line.find("(RUNPATH)") == std::string::npos && line.find("(RPATH)") == std::string::npos) continue;
    const auto from = line.find('[') + 1;
    const std::string path = line.substr(from, line.rfind(']') - from);
    for (std::size_t at = 0; at <= path.size();) {
      const std::size_t end = std::min(path.find(':', at), path.size());
      elements.push_back(path.substr(at, end - at));
      at = end + 1;
    }
  }
  return elements;
}

TEST(LibraryPath, HasNoEmptyAndNoRelativeElement) {
  EXPECT_EQ(library_path("(RUNPATH) Library runpath: [/a:]"), (std::vector<std::string>{"/a", ""}));
  if (!has_program("readelf")) GTEST_SKIP() << "readelf is not here";
  const ProgramResult section = in_bash("readelf -d \"$0\"");
  ASSERT_EQ(section.exit_code, 0) << section.err;
  for (const std::string& element : library_path(section.out)) {
    EXPECT_TRUE(element.starts_with("/") || element.starts_with("$ORIGIN")) << "element '" << element << "'";
  }
}

TEST(LibraryPath, AFileOfTheCurrentDirectoryIsNotLoaded) {
  const ProgramResult result = in_bash(
      "cd \"$(mktemp -d)\" && echo no library > libcairo.so.2 && \"$0\" --version; code=$?; rm -r \"$PWD\"; exit "
      "$code");
  EXPECT_EQ(result.exit_code, 0) << result.err;
}

}  // namespace
}  // namespace isobath
