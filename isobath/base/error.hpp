// Errors in three tiers.
//
// 1. A programmer's mistake: ISOBATH_ASSERT. Stops the program, in every build type.
// 2. A bad file, configuration or argument when something is built or opened: `Error` is thrown. It says what is wrong,
//    where, what is allowed, and what to do.
// 3. An expected condition at run time (no path, stale sonar, a damaged record): a value, `Result<T, E>`, where E is a
//    small enum.
#pragma once

#include <cstdint>
#include <optional>
#include <stdexcept>
#include <string>
#include <tl/expected.hpp>

namespace isobath {

/// Where the input is wrong; members that do not apply stay empty.
struct Place {
  std::string file = {};
  std::optional<std::uint64_t> byte = {};  ///< offset from the start of the file
  std::optional<std::uint64_t> line = {};  ///< counted from 1
  std::optional<std::uint64_t> column = {};
  std::string key = {};  ///< configuration key or field name

  [[nodiscard]] std::string text() const;
};

/// Tier 2. `what()` is one line: "file:line:column: key: problem; allowed: ...; advice". Each part is made printable
/// (printable_text.hpp), and a long one is cut in its middle, because it may hold text of an input.
class Error : public std::runtime_error {
 public:
  explicit Error(const std::string& problem, Place where = {}, const std::string& allowed = {},
                 const std::string& advice = {});

  [[nodiscard]] const Place& where() const { return where_; }

 private:
  Place where_;
};

/// Tier 3.
template <class T, class E>
using Result = tl::expected<T, E>;

[[noreturn]] void assertion_failed(const char* condition, const char* file, int line);

}  // namespace isobath

#define ISOBATH_ASSERT(condition) \
  ((condition) ? static_cast<void>(0) : ::isobath::assertion_failed(#condition, __FILE__, __LINE__))
