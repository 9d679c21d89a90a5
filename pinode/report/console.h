// The outcome of an identification as tables for a terminal.

#ifndef PINODE_REPORT_CONSOLE_H_
#define PINODE_REPORT_CONSOLE_H_

#include <string>

#include "pinode/report/report.h"
#include "pinode/report/text_table.h"

namespace pinode {

// Named parameters: initial and identified value, half width of the 95 %
// interval, unit, and "fixed", "at bound" or "no interval" where it applies.
// What has changed since healthy records.
TextTable MakeChangeTable(const DamageResult& damage);

TextTable MakeParameterTable(const ReportInput& input);

// Measured modes: frequencies (Hz) of them and of the model before and after,
// errors of these in per cent, and MAC at the measured DOFs.
TextTable MakeMeasuredModeTable(const ReportInput& input);
// What the model explains of each channel of the ambient records.
TextTable MakeAmbientTable(const ReportInput& input);

// Frequencies (Hz), damping ratios (%) and MAC, before and after.
TextTable MakeProfileTable(const ReportInput& input);
TextTable MakeModeTable(const ReportInput& input);

// Errors of the free runs in per cent (nrmse) beside the prior model's;
// hold-out records first.
TextTable MakeRecordTable(const ReportInput& input);

// The same by sensor, with the error in the channel's unit and the estimated
// noise.
TextTable MakeSensorTable(const ReportInput& input);

// Stages of the solution.
TextTable MakeStageTable(const ReportInput& input);

// Verdict, remarks and the first five tables with a heading each, ended by a
// line break; empty tables are left out.
std::string ConsoleReport(const ReportInput& input);

}  // namespace pinode

#endif  // PINODE_REPORT_CONSOLE_H_
