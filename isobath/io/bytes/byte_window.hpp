// ByteWindow: a window that slides forward over an input of any size.
//
// ByteWindow reads a file in blocks of about a megabyte, each owned by a shared pointer. A ping points into its block
// and keeps only that block alive, so nothing is copied, and a log may be larger than the memory. Files are not mapped:
// if a file shrinks while it is read, ByteWindow ends early, where a mapping would crash the program. missing() then
// gives the number of bytes that were not read. One thread at a time.
#pragma once

#include <cstdio>
#include <filesystem>
#include <isobath/base/error.hpp>
#include <isobath/io/bytes/bytes.hpp>
#include <memory>
#include <string>

namespace isobath {

class ByteWindow {
 public:
  /// Throws Error if the file does not exist, is a folder, a pipe or a device, cannot be read or is empty.
  static ByteWindow open(const std::filesystem::path& file);
  /// A window over bytes in memory that `owner` keeps alive.
  ByteWindow(std::string name, Bytes bytes, std::shared_ptr<const void> owner);

  [[nodiscard]] const std::string& name() const { return name_; }
  /// Size of the input when it was opened, bytes; 0: unknown.
  [[nodiscard]] std::uint64_t size() const { return size_; }
  [[nodiscard]] std::uint64_t position() const { return position_; }

  /// The next bytes from the position on: at least `count`, fewer only at the end of the input, more if they are
  /// already in memory. The view is valid as long as the current owner() lives. The caller must have checked `count`,
  /// since that many bytes may be allocated.
  Bytes want(std::size_t count);
  /// Moves forward by `count` bytes, at most the size of the last view.
  void advance(std::size_t count);
  [[nodiscard]] const std::shared_ptr<const void>& owner() const { return owner_; }
  /// The part of size() that the file did not deliver; known at its end.
  [[nodiscard]] std::uint64_t missing() const { return ended_ && size_ > position_ ? size_ - position_ : 0; }

 private:
  struct CloseFile {
    void operator()(std::FILE* file) const { std::fclose(file); }
  };
  void refill(std::size_t count);

  std::string name_;
  std::uint64_t size_ = 0;
  std::uint64_t position_ = 0;
  std::unique_ptr<std::FILE, CloseFile> file_;  ///< null: view_ holds the whole input
  Bytes view_;                                  ///< bytes in memory from the position on
  std::shared_ptr<const void> owner_;
  bool ended_ = false;
};

}  // namespace isobath
