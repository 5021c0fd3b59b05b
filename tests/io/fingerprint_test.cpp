#include <filesystem>
#include <gtest/gtest.h>
#include <isobath/base/pending_file.hpp>
#include <isobath/io/input/fingerprint.hpp>
#include <tests/support/data.hpp>

namespace isobath {
namespace {

namespace fs = std::filesystem;

TEST(Fingerprint, OfAFolderIsThatOfItsFilesLessThoseLeftOut) {
  const fs::path folder = test::scratch_folder();
  fs::create_directories(folder / "frames");
  write_whole_file(folder / "geometry.json", "{}");
  write_whole_file(folder / "frames" / "1.png", "first");
  const auto results = [](const fs::path& file) { return file.filename() == "report.html"; };
  const std::string before = fingerprint_of(folder, results);
  EXPECT_EQ(before, fingerprint_of(folder));
  write_whole_file(folder / "report.html", "results of a run");
  EXPECT_EQ(fingerprint_of(folder, results), before);
  EXPECT_NE(fingerprint_of(folder), before);
  write_whole_file(folder / "frames" / "2.png", "second");
  EXPECT_NE(fingerprint_of(folder, results), before);
}

}  // namespace
}  // namespace isobath
