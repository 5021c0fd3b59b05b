#include <fmt/format.h>
#include <fmt/ranges.h>
#include <isobath/app/help_text.hpp>

namespace isobath::app {
namespace {

constexpr std::size_t kColumns = 80, kTextColumn = 24, kMargin = 2;

/// The words in lines that end before kColumns; lines after the first begin at `indent`. `at`: where the first begins.
std::string wrapped(const std::string& text, std::size_t at, std::size_t indent) {
  std::string out;
  std::size_t column = at;
  for (const std::string& word : CLI::detail::split(text, ' ')) {
    if (!out.empty() && column + 1 + word.size() > kColumns) {
      out += "\n" + std::string(indent, ' ');
      column = indent;
    } else if (!out.empty()) {
      out += ' ';
      ++column;
    }
    out += word;
    column += word.size();
  }
  return out;
}

/// A name in the left column, its text in the right one.
std::string entry(const std::string& name, const std::string& text) {
  std::string out = std::string(kMargin, ' ') + name;
  if (out.size() + 2 > kTextColumn) {
    out += "\n" + std::string(kTextColumn, ' ');
  } else {
    out.resize(kTextColumn, ' ');
  }
  return out + wrapped(text, kTextColumn, kTextColumn) + "\n";
}

std::string entry(const OptionFacts& option) {
  std::string name = fmt::format("{}", fmt::join(option.names, ", "));
  if (!option.is_argument() && !option.value.empty()) name += " " + option.value;
  return entry(name, option.text + (option.limits.empty() ? "" : " [" + option.limits + "]"));
}

std::string overview_of(const CLI::App& program) {
  std::string out;
  for (const CommandGroup& group : commands_of(program)) {
    out += "\n" + group.name + ":\n";
    for (const CLI::App* command : group.commands) out += entry(command->get_name(), command->get_description());
  }
  return out;
}

std::string codes_text() {
  std::string out = "\nExit codes:\n";
  for (const auto& [code, meaning] : exit_codes()) out += entry(std::to_string(code), meaning);
  return out;
}

}  // namespace

std::string help_text(const CLI::App& command) {
  const CommandFacts facts = facts_of(command);
  std::string out = wrapped(facts.text, 0, 0) + "\n\nUsage: " + facts.usage + "\n";
  const bool whole_program = facts.name.empty();
  if (whole_program) out += overview_of(command);
  for (const OptionGroup& group : facts.groups) {
    out += "\n" + group.name + ":\n";
    for (const OptionFacts& option : group.options) out += entry(option);
  }
  if (!facts.examples.empty()) out += "\nExamples:\n";
  for (const std::string& example : facts.examples) out += "  " + example + "\n";
  if (whole_program) out += codes_text() + "\nOptions of a command: isobath help COMMAND\n";
  return out;
}

}  // namespace isobath::app
