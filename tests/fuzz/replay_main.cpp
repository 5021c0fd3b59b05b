// fuzz_replay <target> <folder> <places>: runs a fuzz target over every file of a folder, each also cut short and with
// a byte changed at so many places. So the corpus is a test.
#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

using FuzzTarget = int (*)(const std::uint8_t* data, std::size_t size);
#define ISOBATH_FUZZ_TARGET(name) extern "C" int isobath_fuzz_##name(const std::uint8_t* data, std::size_t size);
#include "fuzz_targets.inc"
#undef ISOBATH_FUZZ_TARGET

namespace {

FuzzTarget find_target(const std::string& wanted) {
#define ISOBATH_FUZZ_TARGET(name) \
  if (wanted == #name) return isobath_fuzz_##name;
#include "fuzz_targets.inc"
#undef ISOBATH_FUZZ_TARGET
  return nullptr;
}

void run(FuzzTarget target, const std::string& bytes) {
  // Exactly as long as the input: a sanitizer sees the first byte read beyond it.
  const std::vector<std::uint8_t> copy(bytes.begin(), bytes.end());
  target(copy.data(), copy.size());
}

void run_with_neighbours(FuzzTarget target, const std::string& bytes, std::size_t places) {
  run(target, bytes);
  const std::size_t step = std::max<std::size_t>(1, bytes.size() / places);
  for (std::size_t i = 0; i < bytes.size(); i += step) {
    run(target, bytes.substr(0, i));
    std::string changed = bytes;
    changed[i] = static_cast<char>(~changed[i]);
    run(target, changed);
  }
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 4) return 2;
  const FuzzTarget target = find_target(argv[1]);
  const std::size_t places = std::strtoul(argv[3], nullptr, 10);
  if (target == nullptr || places == 0) return 2;
  std::vector<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::directory_iterator(argv[2])) files.push_back(entry.path());
  std::ranges::sort(files);
  for (const auto& file : files) {
    std::ifstream stream(file, std::ios::binary);
    run_with_neighbours(target, {std::istreambuf_iterator<char>(stream), {}}, places);
  }
  std::printf("%zu seeds\n", files.size());
  return files.empty() ? 1 : 0;
}
