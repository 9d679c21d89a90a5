// Input of a report, and parts of its text.

#ifndef PINODE_REPORT_REPORT_H_
#define PINODE_REPORT_REPORT_H_

#include <functional>
#include <string>
#include <vector>

#include "pinode/base/types.h"
#include "pinode/base/units.h"
#include "pinode/discover/discovery.h"
#include "pinode/dynamics/feature.h"
#include "pinode/problem/identification_problem.h"
#include "pinode/problem/identification_summary.h"
#include "pinode/structure/model/mode_comparison.h"
#include "pinode/study/damage/damage_analysis.h"

namespace pinode {

struct StructurePicture;

// Origin of a report.
struct ReportOrigin {
  // Path of the case file, and command that was run; empty: none.
  std::string case_path;
  std::string command_line;
  // Duration of the run.
  double wall_seconds = 0.0;
};

// Returns the version of pinode.
std::string PinodeVersion();

// Input of a report: the problem with its description, the result of the fit,
// and the results of studies. The objects that it points to must outlive it.
// The fit may have failed; the report then leaves out the missing parts.
struct ReportInput {
  // Problem, and result of its fit.
  const IdentificationProblem* problem = nullptr;
  const IdentificationSummary* summary = nullptr;
  const IdentifiedModel* model = nullptr;
  // Comparison of the modes of the initial and the updated model.
  PriorComparison prior;
  // Function that simulates channels of a record with the initial model. It
  // returns channels x samples, or an empty matrix if the simulation diverges.
  // Null: the initial model is not known.
  std::function<Matrix(int record, const std::vector<int>& channels)> run_prior;
  // Equations that were discovered in place of networks. nullptr: there was no
  // discovery.
  const std::vector<DiscoveredEquation>* equations = nullptr;
  // Changes relative to baselines. nullptr: there was no damage analysis.
  const DamageResult* damage = nullptr;
  // Geometry of the structure. nullptr: the case has none.
  const StructurePicture* structure = nullptr;

  ReportOrigin origin;
  std::string version;  // version of pinode
};

// Returns the input of a report on a fit of `problem`, compared with the
// initial model.
ReportInput MakeReportInput(const IdentificationProblem& problem,
                            const IdentificationSummary& summary,
                            const IdentifiedModel& model,
                            const ReportOrigin& origin = ReportOrigin());

// Returns the verdict of the summary with its findings in words: "Good. ..."
// or "Not usable: ...".
std::string VerdictSentence(const ReportInput& input);

// Returns a sentence or two on the unexplained motion of the training records.
// Empty if the remaining error is mostly noise.
std::string WhatIsMissed(const IdentificationSummary& summary);

// Returns the name of the DOF that a channel measures, or a combination such as
// "u2 - u1". `record` and `channel` count from 0.
std::string ChannelPlace(const ReportInput& input, int record, int channel);

// Returns the model's unit of a channel's values, such as "m/s^2".
std::string ChannelUnit(const ReportInput& input, int record, int channel);

// Returns the standard deviation of a channel's noise divided by rms(y -
// mean(y)). This is the nrmse of a perfect model. NaN if the noise is unknown.
double NoiseShare(const ReportInput& input, int record, int channel);

// Returns the changes that are shown, as indices into damage.subjects: changes
// of groups, and other changes that were found.
std::vector<size_t> ShownChanges(const DamageResult& damage);

// True if the data determine the change. If not, its numbers are rounding
// errors.
bool IsSeen(const GroupChange& change);

// Returns the probability that damage.subjects[index] has lost more than the
// threshold. NaN if a loss has no meaning for it.
double LossProbability(const DamageResult& damage, size_t index);

// Returns the unit of a feature's values. Empty if it has none.
std::string FeatureUnit(const Feature& feature, const UnitSystem& units);

// Returns the remarks for the reader, one sentence each: remarks on the
// problem, its records and the result, and the reason if there are no modes.
std::vector<std::string> RemarksOf(const ReportInput& input);

}  // namespace pinode

#endif  // PINODE_REPORT_REPORT_H_
