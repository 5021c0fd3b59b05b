// RevisitRecord: what the surveys of a map have shown about its own depths, and from it the share of soundings that
// will agree with a depth of the map, and the total vertical uncertainty (TVU) of a depth.
//
// A revisit is a sounding that meets depths of an earlier pass: at least kApartMin minutes older, and, of the soundings
// of one pass, only one a footprint. It is compared with the map before it changes it, as a cross line is compared with
// a survey (IHO S-44, edition 6, 3.2.3: uncertainty at 95 %). Revisits within kSurveyMin of the older pass share errors
// that last for hours (fixes of the same satellites, the same speed of sound), so they are counted apart: the record
// speaks by revisits of another survey where it has enough of them.
//
// Share of soundings that will agree (ledger S1-45, S1-76): of a class of confidence, the share of its revisits that
// agreed, as (k + 1/2) / (n + 1); of a class with too few revisits, the share of all of them.
//
// TVU at 95 %: the 95 % quantile of the revisits' differences by classes of the bottom's slope, since on a slope an
// error of position is an error of depth. It is never less on a steeper slope: neighbouring classes are pooled until it
// is not, and until each has kFewest revisits (pool adjacent violators). Differences and slopes are in margins, where
// margin is the one within which soundings agree, max(floor, share of depth), so that what was learnt in shallow water
// holds in deep water. A fit of errors of depth and of position, TVU^2 = v^2 + (slope h)^2, was tried: where maps
// flatten steep banks it states too little (79 % within on the worst day of a lake, for 95 %).
//
// Differences are counted in classes whose bounds grow by a quarter, so a quantile errs by 6 % at most. No state beyond
// the counts; nothing allocates.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>

namespace isobath {

struct Revisit {
  double difference_m = 0;           ///< sounding minus map
  double margin_m = 0.5;             ///< within which the two agree
  int confidence = 0;                ///< of the map, 0 .. 20
  std::optional<double> slope = {};  ///< magnitude of the bottom's gradient; empty: not known
  double apart_min = 0;              ///< age of the older pass
};

class RevisitRecord {
 public:
  static constexpr double kApartMin = 5;
  static constexpr double kSurveyMin = 360;
  static constexpr int kClasses = 5;  ///< of confidence: 0-4, 5-9, 10-14, 15-19, 20
  static constexpr int kSlopes = 13;  ///< the last: not known
  static constexpr int kDifferences = 32;
  enum Apart : std::uint8_t { kPass, kSurvey };

  /// Ignores a revisit that is not finite, or that is less than kApartMin apart.
  void add(const Revisit& revisit);

  struct Agreement {
    std::uint64_t n = 0, agreed = 0;
  };
  /// Revisits of a class of confidence (confidence / 5).
  [[nodiscard]] const Agreement& agreement(Apart apart, int confidence_class) const {
    return agreements_[apart][static_cast<std::size_t>(confidence_class)];
  }
  [[nodiscard]] std::uint64_t count(Apart apart) const;

  struct Promise {
    double share = 0;
    Apart apart = kPass;  ///< the revisits that it rests on
    std::uint64_t n = 0;
  };
  /// Empty if the record holds fewer than kFewest revisits.
  [[nodiscard]] std::optional<Promise> promise(int confidence) const;

  struct Uncertainty {
    std::array<double, kSlopes> margins;  ///< at 95 %, by class of slope; the last: slope not known
    Apart apart = kPass;
    std::uint64_t n = 0;

    /// m, at 95 %; `slope`: magnitude of the gradient.
    [[nodiscard]] double tvu_m(double margin_m, std::optional<double> slope) const;
  };
  /// Empty if the record holds fewer than kFewest revisits.
  [[nodiscard]] std::optional<Uncertainty> uncertainty() const;

  static constexpr std::uint64_t kFewest = 30;

  RevisitRecord& operator+=(const RevisitRecord& other);
  /// All counts in a fixed order, for a file.
  static constexpr std::size_t kWords = 2 * (2 * kClasses + kSlopes * kDifferences);
  [[nodiscard]] std::array<std::uint64_t, kWords> words() const;
  static RevisitRecord of(const std::array<std::uint64_t, kWords>& words);
  bool operator==(const RevisitRecord& other) const { return words() == other.words(); }

 private:
  using Differences = std::array<std::uint64_t, kDifferences>;
  std::array<std::array<Agreement, kClasses>, 2> agreements_{};
  std::array<std::array<Differences, kSlopes>, 2> differences_{};
};

/// "learnt from 812 revisits of other surveys: 0.21 m on a flat bottom, 0.62 m on a slope of 0.1".
std::string to_text(const RevisitRecord::Uncertainty& uncertainty, double margin_m);

}  // namespace isobath
