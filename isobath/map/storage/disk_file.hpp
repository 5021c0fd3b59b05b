// DiskFile and the calls beside it: the one place where the files of a stored depth map are opened, read, mapped,
// written, flushed, renamed and removed.
//
// Errors: each call that the system refuses throws DiskError with the path and the error number, so that a caller can
// tell a file that is absent (ENOENT) from one that cannot be read now (EIO, EMFILE, EACCES, ENOMEM). New files are
// made beside the file that they replace; no link is followed when a file is written.
//
// Tests make any of the calls fail: set_disk_fault. Threads: any, on different files; a fault is one of its thread.
#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <isobath/base/error.hpp>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

namespace isobath {

/// The system refused a call.
class DiskError : public Error {
 public:
  DiskError(const std::filesystem::path& file, const std::string& what, int code);
  [[nodiscard]] int code() const { return code_; }  ///< errno

 private:
  int code_;
};

enum class DiskCall { kLook, kOpen, kRead, kMap, kWrite, kFlush, kRename, kRemove };
/// Is asked before each call. 0: the call is made; else the call fails with this error number.
using DiskFault = std::function<int(DiskCall call, const std::filesystem::path& file)>;
/// For tests: the faults of this thread from now on; an empty function ends them.
void set_disk_fault(DiskFault fault);

/// An open file or folder; the destructor closes it.
class DiskFile {
 public:
  /// `flags`: those of open(2).
  DiskFile(const std::filesystem::path& file, int flags);
  DiskFile(const DiskFile&) = delete;
  DiskFile& operator=(const DiskFile&) = delete;
  ~DiskFile();

  [[nodiscard]] int number() const { return number_; }
  void write(const void* data, std::size_t size, std::size_t at) const;
  /// Returns the bytes read: fewer than requested where the file ends.
  std::size_t read(void* data, std::size_t size) const;
  /// The first `size` bytes, mapped read-only as long as the result exists.
  [[nodiscard]] std::shared_ptr<const void> map(std::size_t size) const;
  void flush() const;

 private:
  std::filesystem::path file_;
  int number_;
};

/// Removes what has this name, and opens a new file for writing.
DiskFile new_file(const std::filesystem::path& file);
std::string text_in(const std::filesystem::path& file);
/// Whether anything has this name, a broken link included.
bool on_disk(const std::filesystem::path& file);
/// The names in a folder, sorted.
std::vector<std::string> names_in(const std::filesystem::path& folder);
/// Replaces `to` in one step. Both in one folder.
void rename_file(const std::filesystem::path& from, const std::filesystem::path& to);
/// Makes new names and removed names in this folder last. An empty path is the working directory.
void flush_folder(const std::filesystem::path& folder);
/// Returns whether there was such a file.
bool remove_file(const std::filesystem::path& file);
/// Replaces the whole file or nothing, and makes it last: writes `file`.part, flushes it, renames it, flushes the
/// folder. If it throws before the rename, the file is the old one, and no .part stays.
void replace_file(const std::filesystem::path& file, const std::function<void(const DiskFile&)>& write);

}  // namespace isobath
