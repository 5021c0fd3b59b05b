// ByteWindow: an input of any size, seen through a window that slides forward over it.
//
// A file is read in blocks of about a megabyte, each owned by a shared pointer: a ping points into its block and keeps
// just that block alive, so nothing is copied and a log larger than the memory is no problem. Files are not mapped: one
// that shrinks while it is read ends early here, where a mapping would end the program. What it then owes is missing().
// Not for several threads at once.
#pragma once

#include <cstdio>
#include <filesystem>
#include <isobath/base/error.hpp>
#include <isobath/io/bytes.hpp>
#include <memory>
#include <string>

namespace isobath {

class ByteWindow {
 public:
  /// Throws Error: not there, a folder, not readable, empty.
  static ByteWindow open(const std::filesystem::path& file);
  /// Over bytes in memory that `owner` keeps alive.
  ByteWindow(std::string name, Bytes bytes, std::shared_ptr<const void> owner);

  [[nodiscard]] const std::string& name() const { return name_; }
  /// Bytes in all, as they were when it was opened; 0: unknown (a pipe).
  [[nodiscard]] std::uint64_t size() const { return size_; }
  [[nodiscard]] std::uint64_t position() const { return position_; }

  /// The next bytes from the position on: at least `count`, fewer only where the input ends, more where they are at
  /// hand. The view lives as long as the owner() of this moment does. `count` must have been checked: it may be
  /// allocated.
  Bytes want(std::size_t count);
  /// Slides on by up to what want() has given.
  void advance(std::size_t count);
  [[nodiscard]] const std::shared_ptr<const void>& owner() const { return owner_; }
  /// How many of size() bytes the file did not give after all, known at its end.
  [[nodiscard]] std::uint64_t missing() const { return ended_ && size_ > position_ ? size_ - position_ : 0; }

 private:
  struct CloseFile {
    void operator()(std::FILE* file) const { std::fclose(file); }
  };
  void refill(std::size_t count);

  std::string name_;
  std::uint64_t size_ = 0;
  std::uint64_t position_ = 0;
  std::unique_ptr<std::FILE, CloseFile> file_;  ///< null: all of it is in view_
  Bytes view_;                                  ///< what is at hand from the position on
  std::shared_ptr<const void> owner_;
  bool ended_ = false;
};

}  // namespace isobath
