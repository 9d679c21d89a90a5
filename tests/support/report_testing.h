// A result to report on, made without an identification.

#ifndef TESTS_SUPPORT_REPORT_TESTING_H_
#define TESTS_SUPPORT_REPORT_TESTING_H_

#include <memory>
#include <string>

#include "pinode/report/report.h"

namespace pinode {
namespace testing {

// The objects that a ReportInput points to.
struct ReportExample {
  IdentificationProblem problem;
  IdentificationSummary summary;
  IdentifiedModel model;
  // Values of input.run_prior for each record, channels x samples.
  std::vector<Matrix> priors;
  ReportInput input;
};

// Returns a three-storey shear frame under ground motion, with stiffness groups
// k1..k3 and a Rayleigh-like damping group. It has a cubic spring in the first
// storey, a hysteretic one in the second and a small network. It has one
// training and one hold-out record with the absolute accelerations of the
// floors. The "measured" records are free runs with known parameters plus noise
// of a seeded generator. The "identified" parameters are close to the known
// ones; scores, modes, stages and covariance are consistent with them.
std::unique_ptr<ReportExample> MakeReportExample();

// Returns a term as after a refit, without an interval if half_width is NaN.
DiscoveredTerm MakeTerm(const std::string& basis, const std::string& unit,
                        double coefficient, double half_width,
                        double regressed);

// Adds to *damage a change of a group of stiffness or damping, with its 95 %
// limits.
void AddChange(const std::string& name, ChangeKind kind, double change,
               double lower95, double upper95, double probability, bool changed,
               DamageResult* damage);

// Checks that every element opened in `html` is closed in order (except void
// elements) and that attribute values are quoted. Returns "" or the error with
// its offset.
std::string FindHtmlFault(const std::string& html);

}  // namespace testing
}  // namespace pinode

#endif  // TESTS_SUPPORT_REPORT_TESTING_H_
