#include <algorithm>
#include <isobath/base/nearest_name.hpp>
#include <limits>

namespace isobath {
namespace {

constexpr std::size_t kMaxLetters = 64;  // of a name that is compared: the work grows with the square
constexpr std::size_t kMinPart = 3;      // letters that say enough to find a longer name by
constexpr std::size_t kPartDistance = 2;

std::string lower(std::string_view text) {
  std::string out(text.substr(0, kMaxLetters));
  for (char& c : out) {
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  }
  return out;
}

/// Letters to insert, delete, replace or exchange with their neighbour (optimal string alignment).
std::size_t edit_distance(const std::string& a, const std::string& b) {
  std::vector<std::vector<std::size_t>> d(a.size() + 1, std::vector<std::size_t>(b.size() + 1));
  for (std::size_t i = 0; i <= a.size(); ++i) {
    for (std::size_t j = 0; j <= b.size(); ++j) {
      if (i == 0 || j == 0) {
        d[i][j] = i + j;
        continue;
      }
      const bool same = a[i - 1] == b[j - 1];
      d[i][j] = std::min({d[i - 1][j] + 1, d[i][j - 1] + 1, d[i - 1][j - 1] + (same ? 0 : 1)});
      const bool exchanged = i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1];
      if (exchanged) d[i][j] = std::min(d[i][j], d[i - 2][j - 2] + 1);
    }
  }
  return d[a.size()][b.size()];
}

bool one_contains_the_other(const std::string& a, const std::string& b) {
  if (std::min(a.size(), b.size()) < kMinPart) return false;
  return a.find(b) != std::string::npos || b.find(a) != std::string::npos;
}

}  // namespace

std::string nearest_name(std::string_view wanted, const std::vector<std::string>& names) {
  const std::string typed = lower(wanted);
  std::string best;
  std::size_t least = std::numeric_limits<std::size_t>::max();
  for (const std::string& name : names) {
    const std::string known = lower(name);
    const bool part = one_contains_the_other(typed, known);
    const std::size_t distance = std::min(edit_distance(typed, known), part ? kPartDistance : kMaxLetters);
    if (distance >= least || 2 * distance > std::max(typed.size(), known.size())) continue;
    least = distance;
    best = name;
  }
  return best;
}

std::string alternatives(const std::vector<std::string>& names) {
  std::string text;
  for (std::size_t i = 0; i < names.size(); ++i) {
    if (i > 0) text += i + 1 == names.size() ? " or " : ", ";
    text += names[i];
  }
  return text;
}

std::string did_you_mean(std::string_view wanted, const std::vector<std::string>& names) {
  const std::string name = nearest_name(wanted, names);
  return name.empty() ? "" : "did you mean " + name + "?";
}

}  // namespace isobath
