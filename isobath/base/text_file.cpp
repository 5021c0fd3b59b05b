#include <array>
#include <cerrno>
#include <cstring>
#include <fcntl.h>
#include <filesystem>
#include <fmt/format.h>
#include <isobath/base/error.hpp>
#include <isobath/base/file_access.hpp>
#include <isobath/base/text_file.hpp>
#include <poll.h>
#include <sys/stat.h>
#include <unistd.h>

namespace isobath {
namespace {

class Descriptor {
 public:
  // Without a writer the opening of a pipe would wait for one.
  explicit Descriptor(const std::string& file) : number_(::open(file.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK)) {}
  ~Descriptor() {
    if (number_ >= 0) ::close(number_);
  }
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
  [[nodiscard]] int number() const { return number_; }

 private:
  int number_;
};

/// The number of bytes read, 0 at the end; -1: failed.
ssize_t read_some(int from, char* to, std::size_t count) {
  for (;;) {
    const ssize_t got = ::read(from, to, count);
    if (got >= 0) return got;
    if (errno != EAGAIN && errno != EINTR) return -1;
    pollfd ready{from, POLLIN, 0};
    if (errno == EAGAIN) (void)::poll(&ready, 1, -1);
  }
}

}  // namespace

std::string text_of_file(const std::string& file, std::size_t max_mib) {
  std::error_code ignored;
  if (std::filesystem::is_directory(file, ignored)) throw Error("is a folder, not a file", {file});
  const Descriptor input(file);
  if (input.number() < 0) {
    check_readable(file);  // says why
    throw Error("cannot be read", {file});
  }
  std::string text;
  std::array<char, 1 << 16> block{};
  while (const ssize_t got = read_some(input.number(), block.data(), block.size())) {
    if (got < 0) throw Error(fmt::format("cannot be read: {}", std::strerror(errno)), {file});
    text.append(block.data(), static_cast<std::size_t>(got));
    if (text.size() > max_mib << 20) throw Error("is too large", {file}, fmt::format("up to {} MiB", max_mib));
  }
  if (text.empty() && std::filesystem::is_fifo(file, ignored)) {
    throw Error("is a pipe that no program writes to", {file}, "", "give a file");
  }
  return text;
}

}  // namespace isobath
