// From a case and its outcome to what the report is made from.

#ifndef PINODE_APPS_REPORTING_H_
#define PINODE_APPS_REPORTING_H_

#include "pinode/report/report.h"
#include "pinode/study/damage_analysis.h"

namespace pinode {

// What has changed, without what was looked for and not found.
ReportDamage MakeReportDamage(const DamageResult& result);

}  // namespace pinode

#endif  // PINODE_APPS_REPORTING_H_
