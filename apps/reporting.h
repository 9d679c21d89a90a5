// From a case and its outcome to what the report is made from.

#ifndef PINODE_APPS_REPORTING_H_
#define PINODE_APPS_REPORTING_H_

#include <string>
#include <vector>

#include "pinode/case/case_file.h"
#include "pinode/case/damage_analysis.h"
#include "pinode/case/discovered_case.h"
#include "pinode/estimate/identification_summary.h"
#include "pinode/report/report.h"

namespace pinode {

// The arguments must outlive the result.
ReportInput MakeReportInput(const Case& c, const IdentificationSummary& summary,
                            const IdentifiedModel& model,
                            const std::string& command_line,
                            double wall_seconds);

// What discovery found, and what it was regressed from.
std::vector<ReportEquation> MakeReportEquations(const Case& c,
                                                const Discovery& discovery);

// What has changed, without what was looked for and not found.
ReportDamage MakeReportDamage(const DamageResult& result);

}  // namespace pinode

#endif  // PINODE_APPS_REPORTING_H_
