// A result to report on, made without identifying anything.

#ifndef TESTS_SUPPORT_REPORT_TESTING_H_
#define TESTS_SUPPORT_REPORT_TESTING_H_

#include <memory>
#include <string>

#include "pinode/report/report.h"

namespace pinode {
namespace testing {

// What a ReportInput points to, kept together.
struct ReportExample {
  IdentificationProblem problem;
  IdentificationSummary summary;
  IdentifiedModel model;
  // By record, channels x samples: what input.run_prior gives.
  std::vector<Matrix> priors;
  ReportInput input;
};

// A three-storey shear frame under ground motion, with stiffness groups k1..k3,
// a Rayleigh-like damping group, a cubic spring in the first storey, a
// hysteretic one in the second and a small network; one training and one
// hold-out record with the absolute accelerations of the floors. "Measured" are
// free runs with known parameters plus noise of a seeded generator,
// "identified" are nearly those parameters; scores, modes, stages and
// covariance agree with that.
std::unique_ptr<ReportExample> MakeReportExample();

// A term as a refit leaves it; without an interval where half_width is NaN.
DiscoveredTerm MakeTerm(const std::string& basis, const std::string& unit,
                        double coefficient, double half_width,
                        double regressed);

// A change with its 95 % limits, in *damage, of a group of stiffness or
// damping.
void AddChange(const std::string& name, ChangeKind kind, double change,
               double lower95, double upper95, double probability, bool changed,
               DamageResult* damage);

// Checks that every element opened in `html` is closed in its order (void
// elements excepted) and that attribute values are quoted. Returns "" or what
// is wrong, with the offset.
std::string FindHtmlFault(const std::string& html);

}  // namespace testing
}  // namespace pinode

#endif  // TESTS_SUPPORT_REPORT_TESTING_H_
