#include <cstdlib>
#include <fstream>
#include <iterator>
#include <tests/support/data.hpp>

namespace isobath::test {
namespace fs = std::filesystem;

fs::path source_folder() { return ISOBATH_SOURCE_DIR; }

fs::path shared_data(const std::string& name) {
  const char* set = std::getenv("ISOBATH_DATA");
  const fs::path path = (set ? fs::path(set) : source_folder() / "../shared/data") / name;
  return fs::exists(path) ? fs::canonical(path) : fs::path();
}

std::string scene_text(const std::string& name) {
  std::ifstream in(source_folder() / "scenarios" / (name + ".toml"));
  const std::string text((std::istreambuf_iterator<char>(in)), {});
  return text.substr(0, text.find("\n[mission]"));
}

fs::path scratch_folder() {
  const auto* info = testing::UnitTest::GetInstance()->current_test_info();
  std::string name = std::string(info->test_suite_name()) + "." + info->name();
  for (char& c : name) {
    if (c == '/') c = '_';
  }
  const fs::path path = fs::current_path() / "scratch" / name;
  fs::remove_all(path);
  fs::create_directories(path);
  return path;
}

}  // namespace isobath::test
