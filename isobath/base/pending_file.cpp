#include <fcntl.h>
#include <fmt/format.h>
#include <fstream>
#include <isobath/base/error.hpp>
#include <isobath/base/file_access.hpp>
#include <isobath/base/pending_file.hpp>
#include <unistd.h>

namespace isobath {
namespace {

namespace fs = std::filesystem;

/// The file that a link names; a link to nothing, or no link: as given.
fs::path behind_links(const fs::path& file) {
  std::error_code failed;
  fs::path named = fs::canonical(file, failed);
  return failed ? file : named;
}

bool written_in_place(const fs::path& place) {
  std::error_code ignored;
  const fs::file_status status = fs::status(place, ignored);
  if (!fs::exists(status)) return fs::is_symlink(place, ignored);  // a link to nothing: what it names is made
  if (!fs::is_regular_file(status)) return true;
  const fs::path folder = place.has_parent_path() ? place.parent_path() : fs::path(".");
  return ::faccessat(AT_FDCWD, folder.c_str(), W_OK | X_OK, AT_EACCESS) != 0;
}

/// A name that nothing has yet: what stands beside may be an input.
fs::path free_name_beside(const fs::path& place) {
  constexpr std::size_t kMaxStem = 200;  // a name may have 255 bytes
  const std::string stem = place.filename().string().substr(0, kMaxStem);
  std::error_code ignored;
  for (int number = 0;; ++number) {
    const std::string again = number == 0 ? "" : fmt::format("-{}", number);
    const fs::path beside = place.parent_path() / fmt::format("{}.{}{}.part", stem, ::getpid(), again);
    if (!fs::exists(fs::symlink_status(beside, ignored))) return beside;
  }
}

}  // namespace

PendingFile::PendingFile(const fs::path& file)
    : place_(behind_links(file)), beside_(written_in_place(place_) ? place_ : free_name_beside(place_)) {
  check_is_not_protected(place_);
}

PendingFile::~PendingFile() {
  std::error_code ignored;
  if (!done_ && beside_ != place_) fs::remove(beside_, ignored);
}

void PendingFile::complete() {
  std::error_code failed;
  if (beside_ != place_) fs::rename(beside_, place_, failed);
  if (failed) throw Error("cannot be replaced: " + failed.message(), {place_.string()});
  done_ = true;
}

void write_whole_file(const fs::path& file, std::string_view text) {
  PendingFile pending(file);
  std::ofstream out(pending.beside(), std::ios::binary | std::ios::trunc);
  out.write(text.data(), static_cast<std::streamsize>(text.size()));
  out.close();
  if (!out) throw Error("cannot be written", {file.string()}, "", "check the folder, its permissions and the space");
  pending.complete();
}

void write_whole_file(const fs::path& file, std::span<const std::uint8_t> bytes) {
  write_whole_file(file, std::string_view(reinterpret_cast<const char*>(bytes.data()), bytes.size()));
}

}  // namespace isobath
