#include <filesystem>
#include <fstream>
#include <functional>
#include <gmock/gmock.h>
#include <isobath/base/error.hpp>
#include <isobath/base/file_access.hpp>
#include <iterator>
#include <tests/support/data.hpp>

namespace isobath {
namespace {
namespace fs = std::filesystem;
using testing::AllOf, testing::EndsWith, testing::HasSubstr;

std::string refusal_of(const std::function<void()>& check) {
  try {
    check();
  } catch (const Error& e) {
    return e.what();
  }
  return "";
}

// Missing permissions are tested with the program (tests/app/permission_test.cpp).
TEST(FileAccess, AFileThatIsNotThereNamesTheNearest) {
  const fs::path folder = test::scratch_folder();
  std::ofstream(folder / "dive.bin") << "x";
  EXPECT_EQ(refusal_of([&] { check_readable(folder / "dive.bin"); }), "");
  EXPECT_EQ(refusal_of([&] { check_readable(folder); }), "");
  EXPECT_THAT(
      refusal_of([&] { check_readable(folder / "divve.bin"); }),
      AllOf(HasSubstr("no such file or folder"), EndsWith("did you mean " + (folder / "dive.bin").string() + "?")));
  EXPECT_THAT(refusal_of([&] { check_readable(folder / "survey.all"); }), EndsWith("no such file or folder"));
  EXPECT_EQ(nearest_file(folder / "none" / "dive.bin"), "");
}

TEST(FileAccess, AnOutputFolderIsOneOrCanBeMade) {
  const fs::path folder = test::scratch_folder();
  std::ofstream(folder / "taken") << "x";
  for (const fs::path& fine : {folder, folder / "new", folder / "new" / "below"}) {
    EXPECT_EQ(refusal_of([&] { check_output_folder(fine, "--out"); }), "") << fine;
  }
  EXPECT_FALSE(fs::exists(folder / "new")) << "a check makes nothing";
  EXPECT_EQ(std::distance(fs::directory_iterator(folder), fs::directory_iterator()), 1) << "and leaves nothing";
  EXPECT_THAT(refusal_of([&] { check_output_folder(folder / "taken", "--out"); }),
              AllOf(HasSubstr("a file has this name"), EndsWith("choose another with --out")));
  EXPECT_THAT(refusal_of([&] { check_output_folder(folder / "taken" / "below", "--out"); }),
              HasSubstr("taken is a file, not a folder"));
}

TEST(FileAccess, AnOutputFileIsNoFolderAndStandsInOne) {
  const fs::path folder = test::scratch_folder();
  std::ofstream(folder / "taken") << "x";
  for (const fs::path& fine : {folder / "taken", folder / "new.mcap", folder / "new" / "log.mcap"}) {
    EXPECT_EQ(refusal_of([&] { check_output_file(fine, "--record"); }), "") << fine;
  }
  EXPECT_THAT(refusal_of([&] { check_output_file(folder, "--record"); }),
              AllOf(HasSubstr("is a folder, not a file"), EndsWith("choose another with --record")));
  EXPECT_THAT(refusal_of([&] { check_output_file(folder / "taken" / "log.mcap", "OUT"); }),
              EndsWith("choose another OUT"));
}

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
