// Runs a case of data/ and measures what its test holds it to.

#ifndef PINODE_TESTS_CASES_MEASURE_H_
#define PINODE_TESTS_CASES_MEASURE_H_

#include <string>
#include <vector>

#include "pinode/case/sections/case_file.h"
#include "pinode/damage/change.h"
#include "pinode/damage/verdict.h"
#include "pinode/problem/identification_summary.h"

namespace pinode {
namespace testing {

struct CaseRun {
  Case c;
  IdentificationSummary summary;
  IdentifiedModel model;

  const RecordScore& Record(const std::string& name) const;
  const ParameterEstimate& Parameter(const std::string& name) const;
  // Mean squared error over all channels and samples of a record.
  double MeanSquaredError(const std::string& record) const;
  // nrmse of one channel.
  double Nrmse(const std::string& record, const std::string& channel) const;
};

// `path` relative to the project's root, or absolute.
std::string FromRoot(const std::string& path);
// A case that cannot be read fails the test; `path` as above.
Case ReadCaseOrFail(const std::string& path);
// Begins from `begin`, or from the case's own values.
CaseRun RunCase(Case c, const IdentifiedModel* begin = nullptr);

// What has changed in the free groups, groups alone.
struct ChangeRun {
  std::vector<ChangeSubject> subjects;
  ChangeEstimate estimate;
  Judgement judgement;

  const GroupChange& Of(const std::string& name) const;
};
ChangeRun CompareRuns(const CaseRun& healthy, const CaseRun& current);

// Number from a case's truth.json: "elements/spring1/k3".
double Truth(const std::string& path, const std::string& pointer);

// The measured data of other institutes; empty where they are not at hand.
std::string MeasuredData();

// Seeds the networks of a case anew.
void SeedNetworks(uint64_t seed, Case* c);

// Reports a figure against what is asked of it at most, and expects it.
void ExpectFigure(const std::string& what, double asked, double measured);
// The same; and holds what is reached where that lies far inside what is asked.
void ExpectFigure(const std::string& what, double asked, double held,
                  double measured);

}  // namespace testing
}  // namespace pinode

#endif  // PINODE_TESTS_CASES_MEASURE_H_
