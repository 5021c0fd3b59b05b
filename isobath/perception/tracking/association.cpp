#include <algorithm>
#include <cmath>
#include <isobath/perception/tracking/association.hpp>

namespace isobath {
namespace {

constexpr int kRounds = 200;
constexpr double kSettled = 1e-6;

}  // namespace

// Messages mu (body to reading) and nu (reading to body) of Williams and Lau 2014, eq. 28 to 31, with weights that are
// divided by missed[i].
void Association::associate(AssociationTask& task) {
  const std::size_t pairs = task.pairs.size();
  to_reading_.assign(pairs, 0);
  to_body_.assign(pairs, 0);
  const auto share = [&](std::size_t k) { return task.pairs[k].weight / task.missed[task.pairs[k].body]; };
  for (std::size_t k = 0; k < pairs; ++k) to_body_[k] = 1 / task.alone[task.pairs[k].reading];
  for (int round = 0; round < kRounds; ++round) {
    sum_.assign(task.missed.size(), 1);
    for (std::size_t k = 0; k < pairs; ++k) sum_[task.pairs[k].body] += share(k) * to_body_[k];
    for (std::size_t k = 0; k < pairs; ++k) {
      const double own = share(k) * to_body_[k];
      to_reading_[k] = share(k) / std::max(sum_[task.pairs[k].body] - own, 1.0);
    }
    sum_ = task.alone;
    for (std::size_t k = 0; k < pairs; ++k) sum_[task.pairs[k].reading] += to_reading_[k];
    bool settled = true;
    for (std::size_t k = 0; k < pairs; ++k) {
      const std::size_t reading = task.pairs[k].reading;
      const double next = 1 / std::max(sum_[reading] - to_reading_[k], task.alone[reading]);
      settled = settled && std::abs(next - to_body_[k]) <= kSettled * next;
      to_body_[k] = next;
    }
    if (settled) break;
  }
  sum_.assign(task.missed.size(), 1);
  for (std::size_t k = 0; k < pairs; ++k) sum_[task.pairs[k].body] += share(k) * to_body_[k];
  task.missed_probability.resize(task.missed.size());
  for (std::size_t i = 0; i < task.missed.size(); ++i) task.missed_probability[i] = 1 / sum_[i];
  for (std::size_t k = 0; k < pairs; ++k) {
    task.pairs[k].probability = share(k) * to_body_[k] / sum_[task.pairs[k].body];
  }
  sum_ = task.alone;
  for (std::size_t k = 0; k < pairs; ++k) sum_[task.pairs[k].reading] += to_reading_[k];
  task.alone_probability.resize(task.alone.size());
  for (std::size_t j = 0; j < task.alone.size(); ++j) task.alone_probability[j] = task.alone[j] / sum_[j];
}

}  // namespace isobath
