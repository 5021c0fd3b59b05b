// PendingFile: a file that is written beside its place, and takes the place when it is complete. Until then what stood
// there stays, and where the writer fails nothing new remains.
//
//   PendingFile pending(file);
//   ... write pending.beside() ...
//   pending.complete();
//
// Through a link the file that it names is replaced, not the link. What is no plain file (a device, a pipe), and a file
// in a folder in which nothing can be made, is written in its place. An input of the command (file_access.hpp,
// protect_inputs) is not replaced. A program that is killed leaves the file beside:
// NAME.<number of the process>.part.
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string_view>

namespace isobath {

class PendingFile {
 public:
  /// Throws Error for a protected input.
  explicit PendingFile(const std::filesystem::path& file);
  /// Removes the file beside, unless it is complete.
  ~PendingFile();
  PendingFile(const PendingFile&) = delete;
  PendingFile& operator=(const PendingFile&) = delete;

  /// The file to write.
  [[nodiscard]] const std::filesystem::path& beside() const { return beside_; }
  /// Puts it into its place, once it is closed. Throws Error if that fails.
  void complete();

 private:
  std::filesystem::path place_, beside_;
  bool done_ = false;
};

/// A file whose bytes all are here. Throws Error.
void write_whole_file(const std::filesystem::path& file, std::string_view text);
void write_whole_file(const std::filesystem::path& file, std::span<const std::uint8_t> bytes);

}  // namespace isobath
