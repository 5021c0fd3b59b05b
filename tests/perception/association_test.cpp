// The marginal probabilities of associations against enumeration of all joint associations.
#include <gtest/gtest.h>
#include <isobath/base/random.hpp>
#include <isobath/perception/tracking/association.hpp>

namespace isobath {
namespace {

struct Enumerated {
  std::vector<double> missed, alone, pairs;
};

/// Adds up the products of weights of all joint associations, body by body.
class Enumeration {
 public:
  explicit Enumeration(const AssociationTask& task) : task_(task), taken_(task.alone.size(), false) {
    sums_.missed.assign(task.missed.size(), 0);
    sums_.alone.assign(task.alone.size(), 0);
    sums_.pairs.assign(task.pairs.size(), 0);
    chosen_.assign(task.missed.size(), kNone);
    from(0, 1);
  }
  [[nodiscard]] Enumerated marginals() const {
    Enumerated out = sums_;
    for (std::vector<double>* some : {&out.missed, &out.alone, &out.pairs}) {
      for (double& v : *some) v /= all_;
    }
    return out;
  }

 private:
  static constexpr std::size_t kNone = ~std::size_t{0};
  void from(std::size_t body, double product) {
    if (body == task_.missed.size()) return count(product);
    from(body + 1, product * task_.missed[body]);
    for (std::size_t k = 0; k < task_.pairs.size(); ++k) {
      const AssociationPair& pair = task_.pairs[k];
      if (pair.body != body || taken_[pair.reading]) continue;
      taken_[pair.reading] = true;
      chosen_[body] = k;
      from(body + 1, product * pair.weight);
      chosen_[body] = kNone;
      taken_[pair.reading] = false;
    }
  }
  void count(double product) {
    for (std::size_t j = 0; j < taken_.size(); ++j) product *= taken_[j] ? 1 : task_.alone[j];
    all_ += product;
    for (std::size_t j = 0; j < taken_.size(); ++j) sums_.alone[j] += taken_[j] ? 0 : product;
    for (std::size_t i = 0; i < chosen_.size(); ++i) {
      (chosen_[i] == kNone ? sums_.missed[i] : sums_.pairs[chosen_[i]]) += product;
    }
  }

  const AssociationTask& task_;
  std::vector<bool> taken_;
  std::vector<std::size_t> chosen_;
  Enumerated sums_;
  double all_ = 0;
};

AssociationTask random_task(Random& random, std::size_t bodies, std::size_t readings, double in_gate) {
  AssociationTask task;
  for (std::size_t i = 0; i < bodies; ++i) task.missed.push_back(random.uniform(0.05, 1));
  for (std::size_t j = 0; j < readings; ++j) task.alone.push_back(random.uniform(0.05, 1));
  for (std::size_t i = 0; i < bodies; ++i) {
    for (std::size_t j = 0; j < readings; ++j) {
      if (random.uniform() < in_gate) task.pairs.push_back({i, j, random.uniform(0.01, 3)});
    }
  }
  return task;
}

double largest_difference(const AssociationTask& task) {
  const Enumerated exact = Enumeration(task).marginals();
  double most = 0;
  for (std::size_t i = 0; i < task.missed.size(); ++i)
    most = std::max(most, std::abs(task.missed_probability[i] - exact.missed[i]));
  for (std::size_t j = 0; j < task.alone.size(); ++j)
    most = std::max(most, std::abs(task.alone_probability[j] - exact.alone[j]));
  for (std::size_t k = 0; k < task.pairs.size(); ++k)
    most = std::max(most, std::abs(task.pairs[k].probability - exact.pairs[k]));
  return most;
}

// ledger: S3-15
TEST(Association, IsThatOfEnumerationWhereGatesFormNoLoops) {
  Random random(1);
  Association association;
  for (int round = 0; round < 200; ++round) {
    AssociationTask task = random_task(random, 1 + random.index(6), 1 + random.index(6), 0);
    for (std::size_t j = 0; j < task.alone.size(); ++j) {  // a star: body 0 with every reading
      task.pairs.push_back({0, j, random.uniform(0.01, 3)});
    }
    for (std::size_t i = 1; i < task.missed.size(); ++i) {  // and each other body with one reading
      task.pairs.push_back({i, random.index(task.alone.size()), random.uniform(0.01, 3)});
    }
    association.associate(task);
    EXPECT_LT(largest_difference(task), 1e-5);
  }
}

// Of 500 looks in which all gates overlap at random, up to six bodies with six readings. ledger: S3-15
TEST(Association, IsNearThatOfEnumerationWhereTheyDo) {
  Random random(2);
  Association association;
  double worst = 0, sum = 0;
  for (int round = 0; round < 500; ++round) {
    AssociationTask task = random_task(random, 1 + random.index(6), 1 + random.index(6), random.uniform());
    association.associate(task);
    const double difference = largest_difference(task);
    worst = std::max(worst, difference);
    sum += difference;
  }
  EXPECT_LT(worst, 0.15);
  EXPECT_LT(sum / 500, 0.02);
}

TEST(Association, OfABodySumsToOne) {
  Random random(3);
  Association association;
  AssociationTask task = random_task(random, 40, 60, 0.3);
  association.associate(task);
  std::vector<double> sums = task.missed_probability;
  for (const AssociationPair& pair : task.pairs) sums[pair.body] += pair.probability;
  for (const double sum : sums) EXPECT_NEAR(sum, 1, 1e-9);
  task = {};
  association.associate(task);  // no body, no reading
  EXPECT_TRUE(task.missed_probability.empty());
}

}  // namespace
}  // namespace isobath
