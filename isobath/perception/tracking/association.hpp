// Association: how probable it is that each reading of a look comes from each body, from a body that is new, or from
// none (Williams, Lau 2014, belief propagation; Williams 2015, TOMB/P; ledger S3-15).
//
// Bodies i with readings j. Each body gives at most one reading, each reading comes from at most one body. Given are
//   missed[i]     weight of "body i gave no reading", above 0
//   weight(i, j)  weight of "body i gave reading j"; 0: outside its gate
//   alone[j]      weight of "reading j comes from no body that is known": false echoes and new bodies, above 0
// The probability of a joint association is proportional to the product of its weights; `associate` gives the marginal
// probabilities. They are exact where the gates form no loops, and else within 0.02 on average, 0.15 at most, of what
// enumeration gives (tests/perception/association_test.cpp). Cost: a round is linear in the pairs within gates.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace isobath {

/// Pairs of bodies and readings within gates, body by body.
struct AssociationPair {
  std::size_t body, reading;
  double weight;
  double probability = 0;  ///< result
};

struct AssociationTask {
  std::vector<double> missed, alone;
  std::vector<AssociationPair> pairs;                         ///< in the order of bodies
  std::vector<double> missed_probability, alone_probability;  ///< results
};

/// Works until no message changes by more than 1e-6 of itself, or for 200 rounds.
class Association {
 public:
  void associate(AssociationTask& task);

 private:
  std::vector<double> to_reading_, to_body_, sum_;
};

}  // namespace isobath
