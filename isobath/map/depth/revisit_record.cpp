#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <isobath/map/depth/revisit_record.hpp>
#include <numeric>
#include <vector>

namespace isobath {
namespace {

constexpr double kShare = 0.95;
constexpr double kFinest = 0.01;  // margins: the upper bound of the first class of differences
constexpr double kGrowth = 1.25;
/// The first class of slopes, in margins a metre, ends at a slope of 0.01 where the margin is 0.5 m; each next one
/// is 1.5 times as steep, up to 0.6.
constexpr double kFlat = 0.02, kSteeper = 1.5;

std::size_t class_of_slope(double slope) {
  const double steps = std::ceil(std::log(std::max(slope, kFlat) / kFlat) / std::log(kSteeper));
  return static_cast<std::size_t>(std::clamp(steps, 0.0, RevisitRecord::kSlopes - 2.0));
}

std::size_t class_of_difference(double margins) {
  const double steps = std::ceil(std::log(std::max(margins, kFinest) / kFinest) / std::log(kGrowth));
  return static_cast<std::size_t>(std::clamp(steps, 0.0, RevisitRecord::kDifferences - 1.0));
}

std::uint64_t total(const std::array<std::uint64_t, RevisitRecord::kDifferences>& counts) {
  return std::accumulate(counts.begin(), counts.end(), std::uint64_t{0});
}

/// The 95 % quantile in margins, linear within a class; 0 without counts.
double quantile(const std::array<std::uint64_t, RevisitRecord::kDifferences>& counts) {
  const double wanted = kShare * static_cast<double>(total(counts));
  double below = 0, low = 0;
  for (std::size_t i = 0; i < counts.size(); ++i) {
    const double high = kFinest * std::pow(kGrowth, static_cast<double>(i));
    const auto here = static_cast<double>(counts[i]);
    if (here > 0 && below + here >= wanted) return low + (high - low) * std::clamp((wanted - below) / here, 0.0, 1.0);
    below += here;
    low = high;
  }
  return low;
}

}  // namespace

void RevisitRecord::add(const Revisit& r) {
  const bool usable = std::isfinite(r.difference_m) && std::isfinite(r.margin_m) && r.margin_m > 0 &&
                      r.confidence >= 0 && r.apart_min >= kApartMin;
  if (!usable) return;
  const Apart apart = r.apart_min >= kSurveyMin ? kSurvey : kPass;
  const double margins = std::abs(r.difference_m) / r.margin_m;
  Agreement& agreement = agreements_[apart][static_cast<std::size_t>(std::min(r.confidence / 5, kClasses - 1))];
  ++agreement.n;
  agreement.agreed += margins <= 1 ? 1 : 0;
  std::size_t slope = kSlopes - 1;
  if (r.slope && std::isfinite(*r.slope)) slope = class_of_slope(std::abs(*r.slope) / r.margin_m);
  ++differences_[apart][slope][class_of_difference(margins)];
}

std::uint64_t RevisitRecord::count(Apart apart) const {
  std::uint64_t n = 0;
  for (const Agreement& agreement : agreements_[apart]) n += agreement.n;
  return n;
}

std::optional<RevisitRecord::Promise> RevisitRecord::promise(int confidence) const {
  const int confidence_class = std::clamp(confidence / 5, 0, kClasses - 1);
  for (const Apart apart : {kSurvey, kPass}) {
    Agreement all;
    for (const Agreement& a : agreements_[apart]) {
      all.n += a.n;
      all.agreed += a.agreed;
    }
    const Agreement& own = agreement(apart, confidence_class);
    const Agreement& a = own.n >= kFewest ? own : all;
    if (a.n < kFewest) continue;
    return Promise{(static_cast<double>(a.agreed) + 0.5) / (static_cast<double>(a.n) + 1), apart, a.n};
  }
  return std::nullopt;
}

std::optional<RevisitRecord::Uncertainty> RevisitRecord::uncertainty() const {
  const Apart apart = count(kSurvey) >= kFewest ? kSurvey : kPass;
  if (count(apart) < kFewest) return std::nullopt;
  struct Group {
    std::size_t end;  ///< past its last class
    Differences counts;
    double margins;
  };
  std::vector<Group> groups;
  const auto pool_last = [&groups] {
    const Group last = groups.back();
    groups.pop_back();
    groups.back().end = last.end;
    for (std::size_t i = 0; i < kDifferences; ++i) groups.back().counts[i] += last.counts[i];
    groups.back().margins = quantile(groups.back().counts);
  };
  for (std::size_t k = 0; k + 1 < kSlopes; ++k) {
    const Differences& counts = differences_[apart][k];
    groups.push_back({k + 1, counts, quantile(counts)});
    const auto wrong = [&groups] {
      const Group &last = groups.back(), &flatter = groups[groups.size() - 2];
      return total(last.counts) < kFewest || total(flatter.counts) < kFewest || last.margins < flatter.margins;
    };
    while (groups.size() > 1 && wrong()) pool_last();
  }
  Uncertainty found{.margins = {}, .apart = apart, .n = count(apart)};
  std::size_t k = 0;
  Differences all = differences_[apart][kSlopes - 1];
  for (const Group& group : groups) {
    for (; k < group.end; ++k) found.margins[k] = group.margins;
    for (std::size_t i = 0; i < kDifferences; ++i) all[i] += group.counts[i];
  }
  const Differences& blind = differences_[apart][kSlopes - 1];
  found.margins[kSlopes - 1] = quantile(total(blind) >= kFewest ? blind : all);
  if (total(groups.front().counts) == 0) found.margins.fill(found.margins.back());
  return found;
}

double RevisitRecord::Uncertainty::tvu_m(double margin_m, std::optional<double> slope) const {
  const std::size_t k = slope ? class_of_slope(std::abs(*slope) / margin_m) : kSlopes - 1;
  return margins[k] * margin_m;
}

RevisitRecord& RevisitRecord::operator+=(const RevisitRecord& other) {
  auto sum = words();
  const auto more = other.words();
  for (std::size_t i = 0; i < sum.size(); ++i) sum[i] += more[i];
  return *this = of(sum);
}

std::string to_text(const RevisitRecord::Uncertainty& u, double margin_m) {
  return fmt::format("learnt from {} revisits of {}: {:.2f} m on a flat bottom, {:.2f} m on a slope of 0.1", u.n,
                     u.apart == RevisitRecord::kSurvey ? "other surveys" : "other passes", u.tvu_m(margin_m, 0.0),
                     u.tvu_m(margin_m, 0.1));
}

std::array<std::uint64_t, RevisitRecord::kWords> RevisitRecord::words() const {
  std::array<std::uint64_t, kWords> words{};
  std::size_t at = 0;
  for (const Apart apart : {kPass, kSurvey}) {
    for (const Agreement& a : agreements_[apart]) {
      words[at++] = a.n;
      words[at++] = a.agreed;
    }
    for (const Differences& counts : differences_[apart]) {
      for (const std::uint64_t count : counts) words[at++] = count;
    }
  }
  return words;
}

RevisitRecord RevisitRecord::of(const std::array<std::uint64_t, kWords>& words) {
  RevisitRecord record;
  std::size_t at = 0;
  for (const Apart apart : {kPass, kSurvey}) {
    for (Agreement& a : record.agreements_[apart]) {
      a.n = words[at++];
      a.agreed = std::min(words[at++], a.n);
    }
    for (Differences& counts : record.differences_[apart]) {
      for (std::uint64_t& count : counts) count = words[at++];
    }
  }
  return record;
}

}  // namespace isobath
