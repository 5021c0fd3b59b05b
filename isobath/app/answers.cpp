#include <cstdio>
#include <fmt/format.h>
#include <iostream>
#include <isobath/app/answers.hpp>
#include <isobath/base/error.hpp>
#include <unistd.h>

namespace isobath::app {

Answers::Answers(const std::vector<std::string>& given, bool takes_defaults) : takes_defaults_(takes_defaults) {
  for (const std::string& word : given) {
    const std::size_t at = word.find('=');
    if (at == std::string::npos || at == 0) throw Error(word + ": not KEY=VALUE", {"--answer"}, "ping360.range_m=30");
    given_[word.substr(0, at)] = word.substr(at + 1);
  }
}

std::optional<std::string> Answers::given(const std::string& key) {
  const auto found = given_.find(key);
  if (found == given_.end()) return std::nullopt;
  used_.insert(key);
  return found->second;
}

std::string Answers::ask(const std::string& key, const std::string& question, const std::string& by_default) {
  if (const auto answer = given(key)) return *answer;
  if (takes_defaults_) return by_default;
  if (::isatty(STDIN_FILENO) == 0)
    throw Error("no answer to: " + question, {}, "", fmt::format("--answer {}=VALUE, or --yes for the defaults", key));
  fmt::print("{} [{}]: ", question, by_default);
  std::fflush(stdout);
  std::string answer;
  if (!std::getline(std::cin, answer)) throw Error("the input has ended", {}, "", "answer, or end with Ctrl-C");
  return answer.empty() ? by_default : answer;
}

void Answers::check_all_used() const {
  for (const auto& [key, value] : given_) {
    if (!used_.contains(key))
      throw Error(key + ": no such question", {"--answer"}, "", "see the keys that are printed");
  }
}

}  // namespace isobath::app
