// Answers: the answers of a user to the questions of a command: from options, from the terminal, or the defaults.
#pragma once

#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

namespace isobath::app {

class Answers {
 public:
  /// `given`: KEY=VALUE each. Throws Error for another text. `takes_defaults`: asks nothing.
  Answers(const std::vector<std::string>& given, bool takes_defaults);

  /// Asks at the terminal, where the answer is not given. An empty answer is the default. Throws Error if there is no
  /// terminal and the defaults are not to be taken.
  std::string ask(const std::string& key, const std::string& question, const std::string& by_default);
  /// The answer, if it was given.
  std::optional<std::string> given(const std::string& key);
  /// Throws Error if an answer was given to a question that was not asked.
  void check_all_used() const;

 private:
  std::map<std::string, std::string> given_;
  std::set<std::string> used_;
  bool takes_defaults_;
};

}  // namespace isobath::app
