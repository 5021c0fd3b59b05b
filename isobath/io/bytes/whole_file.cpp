#include <fmt/format.h>
#include <fstream>
#include <isobath/base/error.hpp>
#include <isobath/io/bytes/whole_file.hpp>

namespace isobath {
namespace fs = std::filesystem;

std::vector<std::uint8_t> read_whole_file(const fs::path& file, std::uint64_t max_bytes) {
  std::error_code problem;
  const std::uintmax_t size = fs::file_size(file, problem);
  if (problem) throw Error("cannot be read: " + problem.message(), {file.string(), {}, {}, {}, {}});
  if (size > max_bytes) {
    throw Error(fmt::format("{} bytes are too many", size), {file.string(), {}, {}, {}, {}},
                fmt::format("up to {} bytes", max_bytes));
  }
  std::ifstream in(file, std::ios::binary);
  std::vector<std::uint8_t> bytes(size);
  in.read(reinterpret_cast<char*>(bytes.data()), static_cast<std::streamsize>(size));
  if (!in) throw Error("cannot be read", {file.string(), {}, {}, {}, {}});
  return bytes;
}

}  // namespace isobath
