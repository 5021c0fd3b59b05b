#include <fmt/format.h>
#include <isobath/app/man_page.hpp>

namespace isobath::app {
namespace {

/// Text as roff shows it literally: hyphens stay hyphens that can be copied, and no line is taken for a request.
std::string literal(const std::string& text) {
  std::string out;
  for (const char c : text) {
    switch (c) {
      case '\\': out += "\\e"; break;
      case '-': out += "\\-"; break;
      case '\'': out += "\\(aq"; break;
      case '^': out += "\\(ha"; break;
      case '~': out += "\\(ti"; break;
      case '`': out += "\\(ga"; break;
      default: out += c;
    }
  }
  return out.starts_with('.') ? "\\&" + out : out;
}

std::string bold(const std::string& text) { return "\\fB" + literal(text) + "\\fR"; }
std::string italic(const std::string& text) { return "\\fI" + literal(text) + "\\fR"; }

std::string tagged(const std::string& tag, const std::string& text) {
  return ".TP\n" + tag + "\n" + literal(text) + "\n";
}

std::string tagged(const OptionFacts& option) {
  std::string tag;
  for (const std::string& name : option.names) {
    tag += (tag.empty() ? "" : ", ") + (option.is_argument() ? italic(name) : bold(name));
  }
  if (!option.is_argument() && !option.value.empty()) tag += " " + italic(option.value);
  std::string text = option.text + ".";
  if (!option.limits.empty()) text += " [" + option.limits + "]";
  return tagged(tag, text);
}

/// Lines that are shown as they are.
std::string as_typed(const std::vector<std::string>& lines) {
  std::string out = ".PP\n.nf\n.RS\n";
  for (const std::string& line : lines) out += literal(line) + "\n";
  return out + ".RE\n.fi\n";
}

std::string section_of(const CommandFacts& facts) {
  std::string out = ".SS " + literal(facts.usage) + "\n" + literal(facts.text) + ".\n";
  for (const OptionGroup& group : facts.groups) {
    for (const OptionFacts& option : group.options) out += tagged(option);
  }
  if (!facts.examples.empty()) out += as_typed(facts.examples);
  return out;
}

}  // namespace

std::string man_page(const CLI::App& program, const std::string& version) {
  const CommandFacts whole = facts_of(program);
  std::string out = fmt::format(".TH ISOBATH 1 \"\" \"isobath {}\" \"User Commands\"\n", version);
  out += ".SH NAME\nisobath \\- " + literal(whole.text) + "\n";
  out += ".SH SYNOPSIS\n" + bold("isobath") + " " + italic("COMMAND") + " [" + italic("OPTIONS") + "]\n.br\n" +
         bold("isobath help") + " [" + italic("COMMAND") + "]\n";
  out += ".SH DESCRIPTION\n" + literal(whole.text) + ".\n";
  for (const CommandGroup& group : commands_of(program)) {
    out += ".PP\n" + literal(group.name) + ":\n";
    for (const CLI::App* command : group.commands) {
      out += tagged(bold(command->get_name()), command->get_description() + ".");
    }
  }
  out += ".SH OPTIONS\n";
  for (const OptionGroup& group : whole.groups) {
    for (const OptionFacts& option : group.options) out += tagged(option);
  }
  out += ".SH COMMANDS\n";
  for (const CommandGroup& group : commands_of(program)) {
    for (const CLI::App* command : group.commands) out += section_of(facts_of(*command));
  }
  out += ".SH EXIT STATUS\n";
  for (const auto& [code, meaning] : exit_codes()) out += tagged(bold(std::to_string(code)), meaning + ".");
  out += ".SH EXAMPLES\n" + as_typed(whole.examples);
  return out;
}

}  // namespace isobath::app
