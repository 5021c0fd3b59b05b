#include <algorithm>
#include <cerrno>
#include <cstring>
#include <dirent.h>
#include <fcntl.h>
#include <fmt/format.h>
#include <isobath/map/storage/disk_file.hpp>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>
#include <utility>

namespace isobath {
namespace {

namespace fs = std::filesystem;

thread_local DiskFault disk_fault;

/// Sets errno, and returns true where a test wants the call to fail.
bool fails(DiskCall call, const fs::path& file) {
  const int code = disk_fault ? disk_fault(call, file) : 0;
  if (code != 0) errno = code;
  return code != 0;
}

int opened(const fs::path& file, int flags) {
  return fails(DiskCall::kOpen, file) ? -1 : ::open(file.c_str(), flags | O_CLOEXEC, 0644);
}

}  // namespace

DiskError::DiskError(const fs::path& file, const std::string& what, int code)
    : Error(fmt::format("{}: {}", what, std::strerror(code)), {file.string()}), code_(code) {}

void set_disk_fault(DiskFault fault) { disk_fault = std::move(fault); }

DiskFile::DiskFile(const fs::path& file, int flags) : file_(file), number_(opened(file, flags)) {
  if (number_ < 0) throw DiskError(file, "cannot be opened", errno);
}

DiskFile::~DiskFile() { ::close(number_); }

void DiskFile::write(const void* data, std::size_t size, std::size_t at) const {
  const auto* bytes = static_cast<const char*>(data);
  while (size > 0) {
    const ssize_t n = fails(DiskCall::kWrite, file_) ? -1 : ::pwrite(number_, bytes, size, static_cast<off_t>(at));
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) throw DiskError(file_, "cannot be written", n < 0 ? errno : ENOSPC);
    bytes += n, at += static_cast<std::size_t>(n), size -= static_cast<std::size_t>(n);
  }
}

std::size_t DiskFile::read(void* data, std::size_t size) const {
  std::size_t got = 0;
  while (got < size) {
    const ssize_t n = fails(DiskCall::kRead, file_)
                          ? -1
                          : ::pread(number_, static_cast<char*>(data) + got, size - got, static_cast<off_t>(got));
    if (n < 0 && errno == EINTR) continue;
    if (n < 0) throw DiskError(file_, "cannot be read", errno);
    if (n == 0) break;
    got += static_cast<std::size_t>(n);
  }
  return got;
}

std::shared_ptr<const void> DiskFile::map(std::size_t size) const {
  void* const start =
      fails(DiskCall::kMap, file_) ? MAP_FAILED : ::mmap(nullptr, size, PROT_READ, MAP_PRIVATE, number_, 0);
  if (start == MAP_FAILED) throw DiskError(file_, "cannot be mapped", errno);
  return {start, [size](const void* p) { ::munmap(const_cast<void*>(p), size); }};
}

void DiskFile::flush() const {
  if (fails(DiskCall::kFlush, file_) || ::fsync(number_) != 0) {
    throw DiskError(file_, "cannot be flushed to disk", errno);
  }
}

DiskFile new_file(const fs::path& file) {
  remove_file(file);
  return {file, O_WRONLY | O_CREAT | O_EXCL | O_NOFOLLOW};
}

std::string text_in(const fs::path& file) {
  const DiskFile in(file, O_RDONLY);
  struct stat status {};
  if (::fstat(in.number(), &status) != 0) throw DiskError(file, "cannot be read", errno);
  std::string text(static_cast<std::size_t>(std::max<off_t>(0, status.st_size)), '\0');
  text.resize(in.read(text.data(), text.size()));
  return text;
}

bool on_disk(const fs::path& file) {
  struct stat status {};
  if (!fails(DiskCall::kLook, file) && ::lstat(file.c_str(), &status) == 0) return true;
  if (errno != ENOENT && errno != ENOTDIR) throw DiskError(file, "cannot be found out about", errno);
  return false;
}

std::vector<std::string> names_in(const fs::path& folder) {
  const std::unique_ptr<DIR, int (*)(DIR*)> list(fails(DiskCall::kLook, folder) ? nullptr : ::opendir(folder.c_str()),
                                                 ::closedir);
  if (!list) throw DiskError(folder, "cannot be listed", errno);
  std::vector<std::string> names;
  for (;;) {
    errno = 0;
    const dirent* const entry = ::readdir(list.get());
    if (entry == nullptr) break;
    const std::string_view name = entry->d_name;
    if (name != "." && name != "..") names.emplace_back(name);
  }
  if (errno != 0) throw DiskError(folder, "cannot be listed", errno);
  std::ranges::sort(names);
  return names;
}

void rename_file(const fs::path& from, const fs::path& to) {
  if (fails(DiskCall::kRename, from) || ::rename(from.c_str(), to.c_str()) != 0) {
    throw DiskError(to, "cannot be replaced", errno);
  }
}

void flush_folder(const fs::path& folder) {
  DiskFile(folder.empty() ? fs::path(".") : folder, O_RDONLY | O_DIRECTORY).flush();
}

bool remove_file(const fs::path& file) {
  if (!fails(DiskCall::kRemove, file) && ::unlink(file.c_str()) == 0) return true;
  if (errno != ENOENT) throw DiskError(file, "cannot be removed", errno);
  return false;
}

void replace_file(const fs::path& file, const std::function<void(const DiskFile&)>& write) {
  const fs::path part = file.string() + ".part";
  try {
    const DiskFile out = new_file(part);
    write(out);
    out.flush();
    rename_file(part, file);
  } catch (...) {
    ::unlink(part.c_str());
    throw;
  }
  flush_folder(file.parent_path());
}

}  // namespace isobath
