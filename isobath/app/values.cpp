#include <charconv>
#include <cmath>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <isobath/app/values.hpp>
#include <isobath/base/file_access.hpp>
#include <isobath/base/nearest_name.hpp>
#include <isobath/report/html_report.hpp>

namespace isobath::app {
namespace {

// Descriptions. CLI11 joins them with the name of the type: "FILE:reads".
constexpr const char *kReads = "reads", *kReadsFolder = "reads folder", *kWrites = "writes",
                     *kWritesFile = "writes file", *kWritesFolder = "writes folder", *kOthers = "others",
                     *kFiles = "files";

/// A validator that makes its description when it is asked for it.
class Described : public CLI::Validator {
 public:
  explicit Described(std::function<std::string()> text) { desc_function_ = std::move(text); }
};

std::string in_braces(const std::vector<std::string>& names) { return fmt::format("{{{}}}", fmt::join(names, ",")); }

template <class Number>
CLI::Validator limited(Number low, Number high, const char* what) {
  const bool any = std::isinf(static_cast<double>(low)) && std::isinf(static_cast<double>(high));
  const std::string range = any ? "" : fmt::format("{} .. {}", low, high);
  const auto check = [=](const std::string& text) {
    Number value{};
    const auto [end, failed] = std::from_chars(text.data(), text.data() + text.size(), value);
    const std::string allowed = any ? "" : "; allowed: " + range;
    if (failed != std::errc() || end != text.data() + text.size()) {
      return fmt::format("{} is not {}{}", text, what, allowed);
    }
    return value < low || value > high ? fmt::format("{} is out of range{}", text, allowed) : std::string();
  };
  return {check, range};
}

std::vector<std::string> parts_of(const std::string& text, char separator) {
  return CLI::detail::split(text, separator);
}

}  // namespace

CLI::Validator reads() { return CLI::Validator(kReads); }
CLI::Validator reads_folder() { return CLI::Validator(kReadsFolder); }
CLI::Validator writes() { return CLI::Validator(kWrites); }
CLI::Validator writes_file() { return CLI::Validator(kWritesFile); }
CLI::Validator writes_folder() { return CLI::Validator(kWritesFolder); }

void add_output_folder(CLI::App& command, std::filesystem::path& out, const std::string& text,
                       const std::string& names) {
  command.add_option(names, out, text)
      ->type_name("FOLDER")
      ->check(writes_folder())
      ->capture_default_str()
      ->group("Output");
}

CLI::Validator one_of(const std::vector<std::string>& names) {
  const auto check = [names](const std::string& text) {
    if (std::find(names.begin(), names.end(), text) != names.end()) return std::string();
    const std::string near = did_you_mean(text, names);
    return fmt::format("{} is not one of the choices; allowed: {}{}{}", text, fmt::join(names, ", "),
                       near.empty() ? "" : "; ", near);
  };
  return {check, in_braces(names)};
}

CLI::Validator such_as(std::function<std::vector<std::string>()> names, bool files) {
  return Described([names = std::move(names), files] {
    return fmt::format("{}:{}{}", in_braces(names()), kOthers, files ? fmt::format(":{}", kFiles) : "");
  });
}

CLI::Validator whole(int low, int high) { return limited(low, high, "a whole number"); }
CLI::Validator number(double low, double high) { return limited(low, high, "a number"); }

ValueKind kind_of(const CLI::Option& option) {
  ValueKind kind;
  std::vector<std::string> parts = parts_of(option.get_type_name(), ':');
  if (!parts.empty()) parts.erase(parts.begin());  // the name of the type
  for (const std::string& part : parts) {
    using Path = ValueKind::Path;
    if (part == kReads || part == kFiles) {
      kind.path = Path::kReads;
    } else if (part == kReadsFolder) {
      kind.path = Path::kReadsFolder;
    } else if (part == kWrites) {
      kind.path = Path::kWrites;
    } else if (part == kWritesFile) {
      kind.path = Path::kWritesFile;
    } else if (part == kWritesFolder) {
      kind.path = Path::kWritesFolder;
    } else if (part == kOthers) {
      kind.others = true;
    } else if (part.starts_with("{")) {
      kind.choices = parts_of(part.substr(1, part.size() - 2), ',');
    } else {
      kind.range = part;
    }
  }
  return kind;
}

namespace {

void check_use_of(ValueKind::Path use, const std::string& path, const std::string& option) {
  using Path = ValueKind::Path;
  switch (use) {
    case Path::kNone: return;
    case Path::kReads:
    case Path::kReadsFolder: return check_readable(path);
    case Path::kWritesFile: return check_output_file(path, option);
    case Path::kWritesFolder: return check_output_folder(path, option);
    case Path::kWrites: {
      std::error_code ignored;
      return std::filesystem::is_directory(path, ignored) ? check_output_folder(path, option)
                                                          : check_output_file(path, option);
    }
  }
}

}  // namespace

void check_paths(const CLI::App& command) {
  using Path = ValueKind::Path;
  std::vector<std::filesystem::path> inputs;
  std::vector<std::pair<std::string, std::string>> outputs;  // path, option
  for (const CLI::Option* option : command.get_options()) {
    if (option->count() == 0) continue;
    const ValueKind kind = kind_of(*option);
    if (kind.others) continue;  // not always a path
    for (const std::string& path : option->results()) {
      check_use_of(kind.path, path, option->get_name());
      if (kind.path == Path::kReads && option->get_positional()) check_is_file_or_folder(path);
      if (kind.path == Path::kReads || kind.path == Path::kReadsFolder) inputs.emplace_back(path);
      if (kind.path == Path::kWrites || kind.path == Path::kWritesFile) outputs.emplace_back(path, option->get_name());
    }
  }
  for (const auto& [path, option] : outputs) check_output_is_no_input(path, inputs, option);
  protect_inputs(inputs);
}

void make_parent(const std::filesystem::path& file) {
  if (file.has_parent_path()) make_folder(file.parent_path());
}

}  // namespace isobath::app
