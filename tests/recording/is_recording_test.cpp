#include <filesystem>
#include <fstream>
#include <gtest/gtest.h>
#include <isobath/io/mcap/native_log.hpp>
#include <isobath/recording/recorded_display.hpp>
#include <isobath/recording/run_recorder.hpp>
#include <tests/support/data.hpp>

namespace isobath {
namespace {
namespace fs = std::filesystem;

TEST(IsRecording, IsDecidedByTheContentNotByTheName) {
  const fs::path folder = test::scratch_folder();
  for (const char* name : {"run.mcap", "run.bin"}) {
    NativeLogWriter log(folder / name);
    const auto display =
        log.add_channel(kDisplayTopic, "isobath.display", {0, "isobath.Display", "text", "records"}, 1);
    log.write(display, Time{}, "record");
    log.close();
    EXPECT_TRUE(is_recording(folder / name)) << name;
  }
  NativeLogWriter(folder / "log.mcap").close();
  EXPECT_FALSE(is_recording(folder / "log.mcap")) << "no display in it";
  std::ofstream(folder / "notes.mcap") << "notes";
  EXPECT_FALSE(is_recording(folder / "notes.mcap"));
  EXPECT_FALSE(is_recording(folder));
  EXPECT_FALSE(is_recording(folder / "absent.mcap"));
}

}  // namespace
}  // namespace isobath
