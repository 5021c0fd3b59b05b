#include <filesystem>
#include <fstream>
#include <gmock/gmock.h>
#include <isobath/base/pending_file.hpp>
#include <iterator>
#include <sstream>
#include <tests/support/data.hpp>

namespace isobath {
namespace {
namespace fs = std::filesystem;

std::string text_in(const fs::path& file) {
  std::ostringstream text;
  text << std::ifstream(file).rdbuf();
  return text.str();
}
void put(const fs::path& file, const std::string& text) { std::ofstream(file) << text; }
std::ptrdiff_t files_in(const fs::path& folder) {
  return std::distance(fs::directory_iterator(folder), fs::directory_iterator());
}

TEST(PendingFile, TakesItsPlaceWhenItIsComplete) {
  const fs::path folder = test::scratch_folder(), file = folder / "a";
  put(file, "old");
  PendingFile pending(file);
  put(pending.beside(), "new");
  EXPECT_EQ(text_in(file), "old") << "until then what stood there stays";
  pending.complete();
  EXPECT_EQ(text_in(file), "new");
  EXPECT_EQ(files_in(folder), 1);
}

TEST(PendingFile, LeavesNothingNewWhereItsWriterFails) {
  const fs::path folder = test::scratch_folder(), file = folder / "a";
  {
    const PendingFile pending(file);
    put(pending.beside(), "half");
  }
  EXPECT_EQ(files_in(folder), 0);
}

TEST(PendingFile, OverwritesNothingThatStandsBeside) {
  const fs::path folder = test::scratch_folder(), file = folder / "a";
  const PendingFile first(file);
  put(first.beside(), "first");
  EXPECT_NE(PendingFile(file).beside(), first.beside());
}

TEST(PendingFile, ReplacesWhatALinkNames) {
  const fs::path folder = test::scratch_folder(), file = folder / "a", link = folder / "link";
  put(file, "old");
  fs::create_symlink("a", link);
  PendingFile pending(link);
  put(pending.beside(), "new");
  pending.complete();
  EXPECT_TRUE(fs::is_symlink(link));
  EXPECT_EQ(text_in(file), "new");
}

TEST(PendingFile, WritesADeviceInItsPlace) { EXPECT_EQ(PendingFile("/dev/null").beside(), "/dev/null"); }

}  // namespace
}  // namespace isobath
