#include <algorithm>
#include <cstdint>
#include <fmt/format.h>
#include <fstream>
#include <isobath/base/error.hpp>
#include <isobath/io/input/fingerprint.hpp>
#include <vector>
#include <zlib.h>

namespace isobath {
namespace {

namespace fs = std::filesystem;

struct Checksums {
  uLong crc = ::crc32(0, nullptr, 0), adler = ::adler32(0, nullptr, 0);
  std::uint64_t bytes = 0;

  void add(const char* data, std::size_t size) {
    const auto* from = reinterpret_cast<const Bytef*>(data);
    crc = ::crc32_z(crc, from, size);
    adler = ::adler32_z(adler, from, size);
    bytes += size;
  }
  void add(const fs::path& file) {
    std::ifstream in(file, std::ios::binary);
    std::vector<char> part(1U << 20);
    while (in) {
      in.read(part.data(), static_cast<std::streamsize>(part.size()));
      add(part.data(), static_cast<std::size_t>(in.gcount()));
    }
    if (!in.eof()) throw Error("cannot be read", {file.string()});
  }
};

}  // namespace

std::string fingerprint_of(const fs::path& input, const std::function<bool(const fs::path&)>& left_out) {
  Checksums sums;
  std::error_code failed;
  if (fs::is_directory(input, failed)) {
    std::vector<fs::path> files;
    for (const auto& entry : fs::recursive_directory_iterator(input)) {
      if (entry.is_regular_file() && !(left_out && left_out(entry.path()))) files.push_back(entry.path());
    }
    std::sort(files.begin(), files.end());
    for (const fs::path& file : files) {
      const std::string name = fs::relative(file, input).string();
      sums.add(name.c_str(), name.size() + 1);
      sums.add(file);
    }
  } else {
    sums.add(input);
  }
  return fmt::format("{:08x}{:08x}-{}", sums.crc, sums.adler, sums.bytes);
}

}  // namespace isobath
