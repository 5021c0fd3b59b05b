// file_access: why a file or a folder cannot be read or written, as one sentence with the path, the missing permission,
// the user who lacks it, and what to do. A command checks what it was given before long work begins.
//
// The checks ask for the rights of the effective user (faccessat with AT_EACCESS). check_output_folder also makes and
// removes an empty folder, because some file systems refuse what the permissions allow. All others change nothing. None
// promises that a later access succeeds: a permission can change, and a disk can fill up.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace isobath {

/// Throws Error unless the file can be read, or the folder listed and entered. Where nothing has this name: names the
/// nearest name in its folder.
void check_readable(const std::filesystem::path& path);
/// Throws Error for a pipe or a device: logs, charts and maps are read more than once, or not from their beginning.
void check_is_file_or_folder(const std::filesystem::path& path);
/// Throws Error unless files can be made in this folder, which need not exist yet. `option` is the option that names
/// another: "--out".
void check_output_folder(const std::filesystem::path& folder, const std::string& option);
/// Throws Error unless the file can be written. Its folder need not exist yet, but it must be possible to make it.
void check_output_file(const std::filesystem::path& file, const std::string& option);

/// Throws Error if the file to write is one of the inputs: the same file, under whatever name and through whatever
/// link. `option` as above.
void check_output_is_no_input(const std::filesystem::path& output, const std::vector<std::filesystem::path>& inputs,
                              const std::string& option);
/// From now on PendingFile, with which all results are written, replaces none of these files. A command protects what
/// it was given: the names of its results are not known beforehand.
void protect_inputs(const std::vector<std::filesystem::path>& files);
/// Throws Error if the file is protected, under whatever name and through whatever link.
void check_is_not_protected(const std::filesystem::path& output);
/// The files that lie in a folder, sorted; none if it cannot be listed.
std::vector<std::filesystem::path> regular_files(const std::filesystem::path& folder);
/// The input itself, and for a folder the files that lie in it, sorted.
std::vector<std::filesystem::path> files_of_input(const std::filesystem::path& input);

/// "did you mean FILE?" with the nearest name in the folder of a file that does not exist; empty if none is near.
std::string nearest_file(const std::filesystem::path& file);

}  // namespace isobath
