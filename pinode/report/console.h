// Results of an identification as tables for a terminal.

#ifndef PINODE_REPORT_CONSOLE_H_
#define PINODE_REPORT_CONSOLE_H_

#include <string>

#include "pinode/report/report.h"
#include "pinode/report/text_table.h"

namespace pinode {

// Returns the changes since the baselines.
TextTable MakeChangeTable(const DamageResult& damage);
// Changes of each explanation that was fitted, with its probability. Empty if
// there is only one.
TextTable MakeChangeExplanationTable(const DamageResult& damage);

// Returns the named parameters: initial and identified value, half width of the
// 95 % interval (its ends, where it is not centred on the value), unit, and
// "fixed", "at bound" or "no interval" if it applies.
TextTable MakeParameterTable(const ReportInput& input);

// Returns the share of each ambient channel that the model explains.
TextTable MakeAmbientTable(const ReportInput& input);

// Returns the errors of frequency response functions in per cent, of the
// initial and the updated model.
TextTable MakeFrfTable(const ReportInput& input);

// Returns what the model may lack, best first.
TextTable MakeExplanationTable(const ReportInput& input);

// Returns the named parameters under the explanations whose odds are within 20
// of the best one's.
TextTable MakeExplainedValueTable(const ReportInput& input);

// Returns the profiles of the likelihood.
TextTable MakeProfileTable(const ReportInput& input);

// Returns the errors of the simulations in per cent (nrmse), compared with the
// initial model's; hold-out records first.
TextTable MakeRecordTable(const ReportInput& input);

// Returns the same per sensor, with the error in the channel's unit and the
// estimated noise.
TextTable MakeSensorTable(const ReportInput& input);

// Returns the stages of the solution.
TextTable MakeStageTable(const ReportInput& input);

// Returns the verdict, remarks and the first five tables with a heading each,
// ended by a line break; empty tables are left out.
std::string ConsoleReport(const ReportInput& input);

}  // namespace pinode

#endif  // PINODE_REPORT_CONSOLE_H_
