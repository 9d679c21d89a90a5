// Input of a report, and the sentence it begins with.

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
  std::string case_path;     // empty: from no file
  std::string command_line;  // empty: from no program
  double wall_seconds = 0.0;
};

// Returns the version of pinode.
std::string PinodeVersion();

// Input of a report: the problem with its description, the result of the fit,
// and the results of studies. The objects pointed to outlive it. The summary
// may be that of a failure: what it lacks is left out of the report.
struct ReportInput {
  const IdentificationProblem* problem = nullptr;
  const IdentificationSummary* summary = nullptr;
  const IdentifiedModel* model = nullptr;
  PriorComparison prior;
  // Runs of the model before: of some channels of a record, channels x samples,
  // empty where they are not finite. nullptr: nobody knows it.
  std::function<Matrix(int record, const std::vector<int>& channels)> run_prior;
  // In place of networks; nullptr: there was no discovery.
  const std::vector<DiscoveredEquation>* equations = nullptr;
  // Changes relative to baselines. nullptr: they were not asked for.
  const DamageResult* damage = nullptr;
  // Geometry of the structure. nullptr: the case has none.
  const StructurePicture* structure = nullptr;

  ReportOrigin origin;
  std::string version;  // of pinode
};

// A report on a fit of `problem`, compared with the model before it.
ReportInput MakeReportInput(const IdentificationProblem& problem,
                            const IdentificationSummary& summary,
                            const IdentifiedModel& model,
                            const ReportOrigin& origin = ReportOrigin());

// Returns the verdict of the summary in a sentence or two: "Usable. ...", or
// "Not usable: ..." with its findings.
std::string VerdictSentence(const ReportInput& input);

// Returns a sentence or two on the unexplained motion of the training records;
// empty if they leave little but noise.
std::string WhatIsMissed(const IdentificationSummary& summary);

// Name of the DOF at which channel `channel` measures, or the combination of
// them, "u2 - u1".
std::string ChannelPlace(const ReportInput& input, int record, int channel);

// "m/s^2": the unit of a channel's values in the model.
std::string ChannelUnit(const ReportInput& input, int record, int channel);

// Noise of the channel as a fraction of its fluctuation, sigma / rms(y -
// mean(y)): the nrmse of a perfect model. NaN where it is not known.
double NoiseShare(const ReportInput& input, int record, int channel);

// The changes that are shown, as indices of damage.subjects: those of groups,
// and what was found beside them.
std::vector<size_t> ShownChanges(const DamageResult& damage);

// Returns true if the data determine the change; otherwise its numbers are
// those of rounding.
bool IsSeen(const GroupChange& change);

// P(loss > threshold) of damage.subjects[index]; NaN where a loss has no
// meaning.
double LossProbability(const DamageResult& damage, size_t index);

// The unit of a feature's values; empty where it has none.
std::string FeatureUnit(const Feature& feature, const UnitSystem& units);

// Returns the remarks for the reader: those of the problem, of its records and
// of the result, and the reason if there are no modes.
std::vector<std::string> RemarksOf(const ReportInput& input);

}  // namespace pinode

#endif  // PINODE_REPORT_REPORT_H_
