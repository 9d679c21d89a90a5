#include "tests/cases/measure.h"

#include <fstream>
#include <nlohmann/json.hpp>

#include "gtest/gtest.h"
#include "pinode/network/initialize_weights.h"
#include "pinode/study/damage/baseline.h"
#include "tests/support/figure_testing.h"
#include "tests/support/identify_testing.h"
#include "tests/support/measured_data_testing.h"

namespace pinode {
namespace testing {

std::string FromRoot(const std::string& path) {
  return path[0] == '/' ? path : std::string(PINODE_SOURCE_DIR) + "/" + path;
}

const RecordScore& CaseRun::Record(const std::string& name) const {
  for (const RecordScore& record : summary.records) {
    if (record.name == name) return record;
  }
  ADD_FAILURE() << "no record " << name;
  static const RecordScore kNothing;
  return kNothing;
}

const ParameterEstimate& CaseRun::Parameter(const std::string& name) const {
  for (const ParameterEstimate& parameter : summary.parameters) {
    if (parameter.name == name) return parameter;
  }
  ADD_FAILURE() << "no parameter " << name;
  static const ParameterEstimate kNothing;
  return kNothing;
}

double CaseRun::MeanSquaredError(const std::string& record) const {
  const RecordScore& score = Record(record);
  double sum = 0.0;
  for (const ChannelScore& channel : score.channels) {
    sum += channel.rmse * channel.rmse;
  }
  return sum / static_cast<double>(score.channels.size());
}

double CaseRun::Nrmse(const std::string& record,
                      const std::string& channel) const {
  for (const ChannelScore& score : Record(record).channels) {
    if (score.name == channel) return score.nrmse;
  }
  ADD_FAILURE() << "no channel " << channel;
  return 1.0;
}

Case ReadCaseOrFail(const std::string& path) {
  Case c;
  std::string error;
  EXPECT_TRUE(ReadCase(FromRoot(path), &c, &error)) << error;
  return c;
}

CaseRun RunCase(Case c, const IdentifiedModel* begin) {
  CaseRun run;
  run.c = std::move(c);
  testing::FitAndJudge(run.c.problem, run.c.options, begin, &run.summary,
                       &run.model);
  return run;
}

const GroupChange& ChangeRun::Of(const std::string& name) const {
  size_t j = 0;
  while (j + 1 < subjects.size() && subjects[j].name != name) ++j;
  EXPECT_EQ(subjects[j].name, name);
  return estimate.groups[j];
}

ChangeRun CompareRuns(const CaseRun& healthy, const CaseRun& current) {
  const StructuralDynamics& dynamics = *current.c.problem.dynamics;
  const std::vector<std::string> names = FreeGroups(dynamics);
  ChangeRun run;
  for (const GroupTerm& term : dynamics.groups()) {
    ChangeSubject subject;
    subject.name = term.group.name;
    subject.kind = KindOf(term.group.target);
    run.subjects.push_back(std::move(subject));
  }
  GroupState before, after;
  std::string error;
  EXPECT_TRUE(GroupsOf(*healthy.c.problem.dynamics, healthy.summary, names,
                       &before, &error))
      << error;
  EXPECT_TRUE(GroupsOf(dynamics, current.summary, names, &after, &error))
      << error;
  ChangeOptions options;
  options.absolute = NearlyGone({before});
  EXPECT_TRUE(EstimateChange({before}, after, options, &run.estimate, &error))
      << error;
  run.judgement = JudgeChange(run.subjects, run.estimate, options);
  return run;
}

double Truth(const std::string& path, const std::string& pointer) {
  std::ifstream file(FromRoot(path));
  const nlohmann::json truth = nlohmann::json::parse(file);
  return truth.at(nlohmann::json::json_pointer(pointer)).get<double>();
}

std::string MeasuredData() { return FindMeasuredData(""); }

void SeedNetworks(uint64_t seed, Case* c) {
  auto dynamics = std::make_shared<StructuralDynamics>(*c->problem.dynamics);
  Vector theta = dynamics->Parameters();
  const int first = static_cast<int>(dynamics->blocks().size()) -
                    static_cast<int>(dynamics->networks().size());
  for (size_t j = 0; j < dynamics->networks().size(); ++j) {
    const Vector weights = InitializeWeights(
        dynamics->networks()[j].network->architecture(), seed + j, true);
    theta.segment(dynamics->block_offset(first + static_cast<int>(j)),
                  weights.size()) = weights;
  }
  dynamics->SetParameters(theta);
  c->problem.dynamics = dynamics;
}

void ExpectFigure(const std::string& what, double asked, double measured) {
  ReportFigure(what, AtMost(asked), measured);
  EXPECT_LT(measured, asked) << what;
}

void ExpectFigure(const std::string& what, double asked, double held,
                  double measured) {
  ExpectFigure(what, asked, measured);
  if (held < asked) {
    ExpectFigure(what + ", held to what is reached", held, measured);
  }
}

}  // namespace testing
}  // namespace pinode
