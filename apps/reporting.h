// From a case and its outcome to what the report is made from.

#ifndef PINODE_APPS_REPORTING_H_
#define PINODE_APPS_REPORTING_H_

#include <string>

#include "pinode/case/case_file.h"
#include "pinode/estimate/identification_summary.h"
#include "pinode/report/report.h"

namespace pinode {

// The arguments must outlive the result.
ReportInput MakeReportInput(const Case& c, const IdentificationSummary& summary,
                            const IdentifiedModel& model,
                            const std::string& command_line,
                            double wall_seconds);

}  // namespace pinode

#endif  // PINODE_APPS_REPORTING_H_
