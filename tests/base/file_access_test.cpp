#include <filesystem>
#include <fstream>
#include <gmock/gmock.h>
#include <isobath/base/error.hpp>
#include <isobath/base/file_access.hpp>
#include <tests/support/data.hpp>

namespace isobath {
namespace {
namespace fs = std::filesystem;

TEST(FileAccess, AnOutputIsNoInputUnderWhateverName) {
  const fs::path folder = test::scratch_folder(), input = folder / "a", other = folder / "b";
  std::ofstream(input) << "a";
  std::ofstream(other) << "b";
  fs::create_symlink(input, folder / "soft");
  fs::create_hard_link(input, folder / "hard");
  for (const char* name : {"a", "./a", "soft", "hard"}) {
    EXPECT_THROW(check_output_is_no_input(folder / name, {other, input}, "OUT"), Error) << name;
  }
  for (const char* name : {"b", "absent"}) {
    EXPECT_NO_THROW(check_output_is_no_input(folder / name, {"", input, folder / "absent"}, "OUT")) << name;
  }
}

TEST(FileAccess, AFolderAsInputStandsForTheFilesInIt) {
  const fs::path folder = test::scratch_folder();
  std::ofstream(folder / "b") << "b";
  std::ofstream(folder / "a") << "a";
  fs::create_directory(folder / "c");
  EXPECT_THAT(files_of_input(folder), testing::ElementsAre(folder, folder / "a", folder / "b"));
  EXPECT_THAT(files_of_input(folder / "a"), testing::ElementsAre(folder / "a"));
}

}  // namespace
}  // namespace isobath
