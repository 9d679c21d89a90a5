// A problem as somebody would have it who works in other units.

#ifndef PINODE_TESTS_CASES_OTHER_UNITS_H_
#define PINODE_TESTS_CASES_OTHER_UNITS_H_

#include <string>

#include "pinode/problem/identification_problem.h"
#include "tests/cases/measure.h"

namespace pinode {
namespace testing {

// How many new units an old one is.
struct UnitFactors {
  std::string name;
  double force = 1.0;
  double length = 1.0;
  double time = 1.0;
};

// Matrices, groups, elements, libraries, unknown forces, networks, inputs,
// channels, sensors and measured modes of a problem whose DOFs are
// translations; the scales of networks are chosen anew. Fails the test where it
// has something else.
IdentificationProblem InOtherUnits(const IdentificationProblem& problem,
                                   const UnitFactors& unit);

// Largest relative change of what does not depend on units between two runs of
// one case: free-run errors of channels, values of groups, and all named free
// parameters in units of their deviations.
double LargestChange(const CaseRun& here, const CaseRun& there);

}  // namespace testing
}  // namespace pinode

#endif  // PINODE_TESTS_CASES_OTHER_UNITS_H_
