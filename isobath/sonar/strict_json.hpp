// JsonObject: strict reading of the JSON files of models. The keys of the file must be exactly the requested ones; a
// missing or unknown key, a wrong type, size or value throws Error with file and key.
#pragma once

#include <initializer_list>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <string_view>
#include <vector>

namespace isobath {

using Json = nlohmann::ordered_json;

class JsonObject {
 public:
  /// `path`: path of the object in the file, with a dot at its end; `advice`: what to do about a wrong file.
  JsonObject(const Json& object, std::string file, std::string path, std::string advice,
             std::initializer_list<const char*> keys);
  [[nodiscard]] double number(const char* key) const;
  [[nodiscard]] double number(const char* key, double low, double high) const;
  [[nodiscard]] int integer(const char* key, int low, int high) const;
  [[nodiscard]] std::string text(const char* key) const;
  [[nodiscard]] bool flag(const char* key) const;
  /// A list of at most `most` numbers.
  [[nodiscard]] std::vector<double> numbers(const char* key, std::size_t most, double low, double high) const;
  template <class Integer>
  [[nodiscard]] std::vector<Integer> integers(const char* key, std::size_t most, int low, int high) const {
    std::vector<Integer> all;
    for (const double one : numbers(key, most, low, high)) {
      all.push_back(static_cast<Integer>(whole(key, one, low, high)));
    }
    return all;
  }
  [[nodiscard]] const Json& list(const char* key, std::size_t most) const;
  [[noreturn]] void fail(const std::string& key, const std::string& problem, const std::string& allowed) const;

 private:
  [[nodiscard]] double within(const char* key, double value, double low, double high) const;
  [[nodiscard]] int whole(const char* key, double value, int low, int high) const;

  const Json& object_;
  std::string file_, path_, advice_;
};

/// Throws Error, with the byte, if the text is not JSON.
Json parse_json(std::string_view text, const std::string& file, const std::string& advice);

}  // namespace isobath
