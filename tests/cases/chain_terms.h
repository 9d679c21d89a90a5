// What discovery has to find in the four-DOF chain of data/four_dof_free.

#ifndef PINODE_TESTS_CASES_CHAIN_TERMS_H_
#define PINODE_TESTS_CASES_CHAIN_TERMS_H_

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>
#include <random>
#include <string>
#include <utility>

#include "pinode/study/laws/refit.h"
#include "tests/cases/measure.h"

namespace pinode {
namespace testing {

// Coefficients by output and basis: accelerations, of unit masses.
using Terms = std::map<std::pair<std::string, std::string>, double>;

// How much of the chain a scheme leaves to be found; of what it leaves nothing,
// the cubic spring apart, all.
inline double ShareOfChain(const std::string& scheme) {
  return scheme == "scheme2" ? 0.3 : 1.0;
}

// What a scheme leaves to the network: Table 2 of Lai et al. (2021). Springs
// between the masses, a damper from each mass to the ground.
inline Terms MissingTerms(const std::string& scheme) {
  const double share_of_chain = scheme == "scheme2" ? 0.3 : 0.0;
  Terms truth;
  const int n = 4;
  for (int i = 0; i < n && share_of_chain > 0.0; ++i) {
    const std::string dof = "x" + std::to_string(i + 1);
    for (int j = std::max(i - 1, 0); j < std::min(i + 2, n); ++j) {
      const double unit = i != j ? 1.0 : (i + 1 < n ? -2.0 : -1.0);
      truth[{dof, "x[x" + std::to_string(j + 1) + "]"}] =
          10.0 * share_of_chain * unit;
    }
    truth[{dof, "v[" + dof + "]"}] = -0.5 * share_of_chain;
  }
  truth[{"x1", "x[x1]^3"}] = -2.0;
  return truth;
}

// Terms found against those that are there.
struct TermsFound {
  int num_missing = 0;
  int num_spurious = 0;
  std::string wrong;   // which they are, for people
  double worst = 0.0;  // largest relative error of a coefficient
  // The same of the linear stiffness terms, as fractions of the chain's own
  // stiffness, of which a scheme leaves a part to be found; and of the cubic.
  double worst_stiffness = 0.0;
  double worst_cubic = 0.0;
};

inline TermsFound Compare(const Discovery& discovery, Terms truth,
                          double share_of_chain) {
  TermsFound found;
  for (size_t e = 0; e < discovery.equations.size(); ++e) {
    for (const DiscoveredTerm& term : discovery.equations[e].terms) {
      const std::string& output = discovery.equations[e].output;
      const auto expected = truth.find({output, term.basis});
      if (expected == truth.end()) {
        ++found.num_spurious;
        found.wrong += "  +" + output + ": " + term.basis;
        continue;
      }
      const double error = std::abs(term.coefficient / expected->second - 1.0);
      found.worst = std::max(found.worst, error);
      if (term.basis.back() == '3') {
        found.worst_cubic = std::max(found.worst_cubic, error);
      } else if (term.basis[0] == 'x') {
        found.worst_stiffness =
            std::max(found.worst_stiffness, error * share_of_chain);
      }
      truth.erase(expected);
    }
  }
  found.num_missing = static_cast<int>(truth.size());
  for (const auto& [name, value] : truth) {
    found.wrong += "  -" + name.first + ": " + name.second;
  }
  return found;
}

// Gaussian noise on the training records, in per cent of each channel's
// standard deviation.
inline void AddNoise(double percent, uint64_t seed, Case* c) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal;
  for (IdentificationRecord& record : c->problem.records) {
    if (record.role != IdentificationRecord::Role::kTrain) continue;
    for (MeasuredChannel& channel : record.channels) {
      Vector& values = channel.values;
      const double sigma =
          percent / 100.0 *
          std::sqrt((values.array() - values.mean()).square().mean());
      for (double& value : values) value += sigma * normal(random);
    }
  }
}

}  // namespace testing
}  // namespace pinode

#endif  // PINODE_TESTS_CASES_CHAIN_TERMS_H_
