// Where tests find real recordings, and a folder of their own to write in.
#pragma once

#include <filesystem>
#include <gtest/gtest.h>
#include <string>

namespace isobath::test {

/// ../shared/data/<name> beside the project (or $ISOBATH_DATA/<name>); empty where it is absent.
std::filesystem::path shared_data(const std::string& name);

/// An empty folder for the running test, removed by the next run of the same test.
std::filesystem::path scratch_folder();

/// The project's own folder.
std::filesystem::path source_folder();

/// Of scenarios/<name>.toml the scene alone: what stands after it, a mission, is left out.
std::string scene_text(const std::string& name);

}  // namespace isobath::test

/// Skips the test with a notice where the recordings are absent.
#define ISOBATH_NEEDS_DATA(variable, name)                                 \
  const std::filesystem::path variable = isobath::test::shared_data(name); \
  if ((variable).empty()) GTEST_SKIP() << "no recordings here: ../shared/data/" << (name) << " is absent"
