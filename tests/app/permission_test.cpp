// Folders and files without permission: one sentence says which one, which permission is missing, and what to do.
#include <fmt/format.h>
#include <tests/app/logs.hpp>
#include <tests/app/program.hpp>
#include <tests/support/data.hpp>
#include <unistd.h>

namespace isobath {
namespace {
namespace fs = std::filesystem;
using namespace test;
using testing::AllOf, testing::HasSubstr;

constexpr fs::perms kNoWriting =
    fs::perms::owner_read | fs::perms::owner_exec | fs::perms::others_read | fs::perms::others_exec;

/// Runs the program as a user without special rights. A test that is run by root needs setpriv, and a user who may run
/// the program.
class Permission : public testing::Test {
 protected:
  void SetUp() override {
    if (::geteuid() == 0 && has_program("setpriv")) {
      user_ = {"setpriv", "--reuid=65534", "--regid=65534", "--clear-groups"};
    }
    // Below TMPDIR, which every user may enter.
    folder_ = fs::path(testing::TempDir()) / fmt::format("isobath-permission-{}", ::getpid());
    fs::create_directories(folder_ / "closed");
    write(folder_ / "wall.csv", wall_csv(50));
    write(folder_ / "other.csv", wall_csv(50));
    if (::geteuid() == 0 && (user_.empty() || as_user({"info", folder_ / "wall.csv"}).exit_code != 0)) {
      GTEST_SKIP() << "the test runs as root, and no other user can run the program here";
    }
  }
  void TearDown() override {
    permit(folder_ / "closed", fs::perms::owner_all);
    fs::remove_all(folder_);
  }
  static void permit(const fs::path& path, fs::perms permissions) {
    std::error_code ignored;
    fs::permissions(path, permissions, ignored);
  }
  ProgramResult as_user(const std::vector<std::string>& arguments) const {
    std::vector<std::string> words = user_;
    words.emplace_back("bash");
    words.insert(words.end(), {"-c", "cd \"$1\" && shift && exec \"$0\" \"$@\"", ISOBATH_PROGRAM, here_});
    words.insert(words.end(), arguments.begin(), arguments.end());
    return run_program(words);
  }
  /// `letter`: the missing permission.
  static auto refusal(const fs::path& path, const char* letter, const std::string& advice) {
    return ends_with_one_line(AllOf(HasSubstr(path.string()),
                                    HasSubstr(fmt::format("permission {} is missing", letter)), HasSubstr("user "),
                                    HasSubstr(advice)));
  }

  std::vector<std::string> user_;
  fs::path folder_;
  std::string here_ = "/";
};

TEST_F(Permission, OfFoldersToWriteInto) {
  const fs::path closed = folder_ / "closed", log = folder_ / "wall.csv";
  permit(closed, kNoWriting);
  for (const fs::path& out : {closed, closed / "new", closed / "new" / "below"}) {
    EXPECT_THAT(as_user({"run", log, "--out", out}), refusal(closed, "w", "choose another with --out")) << out;
  }
  EXPECT_THAT(as_user({"run", log, "--map", closed / "map"}), refusal(closed, "w", "choose another with --map"));
  EXPECT_THAT(as_user({"run", log, "--record", closed / "run.mcap"}), refusal(closed, "w", "with --record"));
  EXPECT_THAT(as_user({"sim", "--out", closed / "log.mcap"}), refusal(closed, "w", "choose another with --out"));
  EXPECT_THAT(as_user({"convert", log, closed / "log.mcap"}), refusal(closed, "w", "choose another OUT"));
  EXPECT_THAT(as_user({"compare", log, log, "--out", closed / "x"}), refusal(closed, "w", "with --out"));
  EXPECT_TRUE(fs::is_empty(closed));
}

TEST_F(Permission, OfTheDefaultFolder) {
  permit(folder_ / "closed", kNoWriting);
  here_ = folder_ / "closed";
  for (const std::vector<std::string>& command : std::vector<std::vector<std::string>>{
           {"run"}, {"calibrate", folder_ / "wall.csv"}, {"helix"}, {"eval", "pandan"}}) {
    EXPECT_THAT(as_user(command), refusal(here_, "w", "choose another with --out")) << command[0];
  }
}

TEST_F(Permission, OfFilesToRead) {
  const fs::path log = folder_ / "wall.csv", closed = folder_ / "closed", open = folder_ / "open";
  fs::copy_file(log, closed / "wall.csv");
  fs::create_directory(open);
  permit(open, fs::perms::all);
  permit(log, fs::perms::none);
  for (const std::string command : {"run", "info", "serve", "calibrate"}) {
    EXPECT_THAT(as_user({command, log}), refusal(log, "r", "chmod")) << command;
  }
  EXPECT_THAT(as_user({"run", "--config", log}), refusal(log, "r", "chmod"));
  EXPECT_THAT(
      as_user({"run", folder_ / "other.csv", "--out", open / "out", "--set", "input.navigation=" + log.string()}),
      ends_with_one_line(HasSubstr(log.string())));
  permit(closed, fs::perms::owner_read | fs::perms::others_read);
  EXPECT_THAT(as_user({"info", closed / "wall.csv"}), refusal(closed, "x", "chmod"));
}

TEST(WithoutPermission, NothingIsWrittenBelowAFileOrIntoAFolderOfTheSystem) {
  const fs::path folder = scratch_folder(), taken = write(folder / "taken", "a file");
  EXPECT_THAT(isobath::test::isobath({"run", "--out", taken / "below"}),
              ends_with_one_line(AllOf(HasSubstr(taken.string() + " is a file, not a folder"), HasSubstr("--out"))));
  EXPECT_THAT(isobath::test::isobath({"run", "--record", taken / "run.mcap"}),
              ends_with_one_line(AllOf(HasSubstr(taken.string() + " is a file, not a folder"), HasSubstr("--record"))));
  EXPECT_THAT(isobath::test::isobath({"run", "--out", "/proc/isobath"}),
              ends_with_one_line(AllOf(HasSubstr("/proc"), HasSubstr("choose another with --out"))));
  EXPECT_THAT(isobath::test::isobath({"info", taken / "log.bin"}),
              ends_with_one_line(HasSubstr(taken.string() + " is a file, not a folder")));
}

}  // namespace
}  // namespace isobath
