#include "apps/reporting.h"

#include <utility>

namespace pinode {

ReportDamage MakeReportDamage(const DamageResult& result) {
  ReportDamage damage;
  damage.sentence = result.judgement.sentence;
  damage.alarm = result.judgement.verdict != DamageVerdict::kNoDamage;
  damage.threshold = result.options.threshold;
  damage.baselines = result.baselines;
  damage.places = result.places;
  damage.remarks = result.remarks;
  for (size_t j = 0; j < result.subjects.size(); ++j) {
    const ChangeSubject& subject = result.subjects[j];
    const GroupChange& change = result.estimate.groups[j];
    if (!subject.place.empty() && !change.changed) continue;
    ReportDamage::Change reported;
    reported.name = subject.name;
    reported.change = change.change;
    reported.lower95 = change.lower95;
    reported.upper95 = change.upper95;
    if (subject.kind == ChangeKind::kStiffness) {
      reported.probability = change.probability;
    }
    reported.changed = change.changed;
    damage.changes.push_back(std::move(reported));
  }
  return damage;
}

}  // namespace pinode
