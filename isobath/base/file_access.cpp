#include <algorithm>
#include <cerrno>
#include <cstring>
#include <fcntl.h>
#include <fmt/format.h>
#include <isobath/base/error.hpp>
#include <isobath/base/file_access.hpp>
#include <isobath/base/nearest_name.hpp>
#include <mutex>
#include <pwd.h>
#include <sys/stat.h>
#include <unistd.h>
#include <vector>

namespace isobath {
namespace {

namespace fs = std::filesystem;

std::string user_name(uid_t id) {
  const passwd* const user = ::getpwuid(id);
  return user != nullptr ? user->pw_name : fmt::format("number {}", id);
}

/// 0, or the error number.
int denied(const fs::path& path, int rights) {
  return ::faccessat(AT_FDCWD, path.c_str(), rights, AT_EACCESS) == 0 ? 0 : errno;
}

/// "user nobody may not write to /data (permission w is missing, it belongs to root)".
std::string missing_permission(const fs::path& path, char letter) {
  struct stat facts {};
  const bool others = ::stat(path.c_str(), &facts) == 0 && facts.st_uid != ::geteuid();
  const char* const verb = letter == 'r' ? "read" : letter == 'w' ? "write to" : "enter";
  return fmt::format("user {} may not {} {} (permission {} is missing{})", user_name(::geteuid()), verb, path.string(),
                     letter, others ? ", it belongs to " + user_name(facts.st_uid) : "");
}

/// What to do about it: the owner can give the permission, others ask the owner.
std::string how_to_permit(const fs::path& path, const char* letters) {
  struct stat facts {};
  const bool others = ::stat(path.c_str(), &facts) == 0 && facts.st_uid != ::geteuid();
  return others ? fmt::format("ask {} for: chmod o+{} {}", user_name(facts.st_uid), letters, path.string())
                : fmt::format("give it with: chmod u+{} {}", letters, path.string());
}

/// "" or why this path cannot be reached: the first folder on the way that is none, or may not be entered. `at` is set
/// to it.
std::string barrier(const fs::path& path, fs::path& at) {
  at.clear();
  for (const fs::path& part : path.parent_path()) {
    at /= part;
    std::error_code failed;
    const fs::file_status status = fs::status(at, failed);
    if (status.type() == fs::file_type::not_found) return {};
    if (fs::exists(status) && !fs::is_directory(status)) return at.string() + " is a file, not a folder";
    if (denied(at, X_OK) == EACCES) return missing_permission(at, 'x');
  }
  return {};
}

/// The longest part of the path that exists.
fs::path existing_part(fs::path path) {
  std::error_code ignored;
  while (!path.empty() && !fs::exists(path, ignored)) path = path.parent_path();
  return path.empty() ? fs::current_path(ignored) : path;
}

/// "" or why nothing can be made in a folder that exists.
std::string no_room_in(const fs::path& folder) {
  const int number = denied(folder, W_OK | X_OK);
  if (number == EACCES) return missing_permission(folder, denied(folder, W_OK) == EACCES ? 'w' : 'x');
  if (number != 0) return fmt::format("{}: {}", folder.string(), std::strerror(number));
  const fs::path probe = folder / fmt::format(".isobath-{}", ::getpid());
  if (::mkdir(probe.c_str(), 0700) != 0) {
    const int why = errno;  // ENOENT where the file system takes nothing new, such as /proc
    return fmt::format("nothing can be made in {}{}", folder.string(),
                       why == ENOENT ? "" : fmt::format(": {}", std::strerror(why)));
  }
  ::rmdir(probe.c_str());
  return {};
}

/// Throws Error unless something can be made at `path`, which does not exist; `what` says what.
void check_can_be_made(const fs::path& path, const std::string& what, const std::string& advice) {
  fs::path at;
  std::string why = barrier(path, at);
  if (why.empty()) {
    const fs::path above = existing_part(path);
    std::error_code ignored;
    why = fs::is_directory(above, ignored) ? no_room_in(above) : above.string() + " is a file, not a folder";
  }
  if (!why.empty()) throw Error(fmt::format("cannot make the {}: {}", what, why), {path.string()}, "", advice);
}

std::string another(const std::string& option) {
  return option.starts_with("-") ? "choose another with " + option : "choose another " + option;
}

std::mutex protected_lock;
std::vector<fs::path> protected_files;

}  // namespace

std::string nearest_file(const fs::path& file) {
  std::error_code ignored;
  const fs::path folder = file.parent_path();
  std::vector<std::string> names;
  for (const auto& entry : fs::directory_iterator(folder.empty() ? "." : folder, ignored)) {
    names.push_back(entry.path().filename().string());
  }
  std::sort(names.begin(), names.end());
  const std::string name = nearest_name(file.filename().string(), names);
  return name.empty() ? "" : fmt::format("did you mean {}?", (folder / name).string());
}

void check_readable(const fs::path& path) {
  fs::path at;
  if (const std::string why = barrier(path, at); !why.empty()) {
    throw Error("cannot be read: " + why, {path.string()}, "",
                fs::is_directory(at) ? how_to_permit(at, "x") : "check the path");
  }
  std::error_code ignored;
  const fs::file_status status = fs::status(path, ignored);
  if (!fs::exists(status)) throw Error("no such file or folder", {path.string()}, "", nearest_file(path));
  const bool folder = fs::is_directory(status);
  if (denied(path, R_OK) == EACCES) {
    throw Error("cannot be read: " + missing_permission(path, 'r'), {path.string()}, "",
                how_to_permit(path, folder ? "rx" : "r"));
  }
  if (folder && denied(path, X_OK) == EACCES) {
    throw Error("cannot be read: " + missing_permission(path, 'x'), {path.string()}, "", how_to_permit(path, "rx"));
  }
}

void check_is_file_or_folder(const fs::path& path) {
  std::error_code ignored;
  const fs::file_status status = fs::status(path, ignored);
  if (!fs::exists(status) || fs::is_regular_file(status) || fs::is_directory(status)) return;
  throw Error(fs::is_fifo(status) || fs::is_socket(status) ? "is a pipe, which can be read only once"
                                                           : "is a device, not a file",
              {path.string()}, "", "write it into a file first");
}

void check_output_folder(const fs::path& folder, const std::string& option) {
  std::error_code ignored;
  const fs::file_status status = fs::status(folder, ignored);
  if (!fs::exists(status)) return check_can_be_made(folder, "output folder", another(option));
  if (!fs::is_directory(status)) {
    throw Error("cannot make the output folder: a file has this name", {folder.string()}, "", another(option));
  }
  if (const std::string why = no_room_in(folder); !why.empty()) {
    throw Error("cannot write into the output folder: " + why, {folder.string()}, "", another(option));
  }
}

void check_output_file(const fs::path& file, const std::string& option) {
  std::error_code ignored;
  const fs::file_status status = fs::status(file, ignored);
  if (!fs::exists(status)) return check_can_be_made(file, "file", another(option));
  if (fs::is_directory(status)) throw Error("is a folder, not a file", {file.string()}, "", another(option));
  if (const int number = denied(file, W_OK); number != 0) {
    const std::string why = number == EACCES ? missing_permission(file, 'w') : std::strerror(number);
    throw Error("cannot be written: " + why, {file.string()}, "", another(option));
  }
}

void check_output_is_no_input(const fs::path& output, const std::vector<fs::path>& inputs, const std::string& option) {
  for (const fs::path& input : inputs) {
    std::error_code ignored;  // what cannot be examined is no file that could be overwritten
    if (input.empty() || !fs::equivalent(output, input, ignored) || ignored) continue;
    const std::string same = input == output ? "" : fmt::format(" (it is the same file as {})", input.string());
    throw Error("is an input, which would be overwritten" + same, {output.string()}, "", another(option));
  }
}

void protect_inputs(const std::vector<fs::path>& files) {
  const std::scoped_lock held(protected_lock);
  protected_files.insert(protected_files.end(), files.begin(), files.end());
}

void check_is_not_protected(const fs::path& output) {
  const std::scoped_lock held(protected_lock);
  check_output_is_no_input(output, protected_files, "--out");
}

std::vector<fs::path> regular_files(const fs::path& folder) {
  std::vector<fs::path> files;
  std::error_code problem;
  for (fs::directory_iterator at(folder, problem), end; !problem && at != end; at.increment(problem)) {
    std::error_code unknown;
    if (at->is_regular_file(unknown)) files.push_back(at->path());
  }
  std::sort(files.begin(), files.end());
  return files;
}

std::vector<fs::path> files_of_input(const fs::path& input) {
  std::vector<fs::path> files = regular_files(input);
  files.insert(files.begin(), input);
  return files;
}

}  // namespace isobath
