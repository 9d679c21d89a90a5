// Cases that are made from others: the same records, other terms.

#ifndef PINODE_CASE_GROWN_CASE_H_
#define PINODE_CASE_GROWN_CASE_H_

#include <functional>
#include <map>
#include <string>

#include "pinode/case/case_file.h"
#include "pinode/case/toml_value.h"
#include "pinode/estimate/identification_summary.h"

namespace pinode {

// `text` as the name of a term: names of DOFs, of which it may be made, are
// freer.
std::string TermName(std::string text);

// `c` with another tree: its terms may differ, its records not. Options, and
// measured values as they were read, are those of `c`, whatever the files say
// by now. *result may be `c`.
[[nodiscard]] bool RebuildCase(const Case& c, const TomlValue& tree,
                               Case* result, std::string* error);

// The parameters of `problem` by name, as in `model`.
std::map<std::string, double> ParametersByName(
    const IdentificationProblem& problem, const IdentifiedModel& model);

// Fits c.problem from `begin` (nullptr: from the case's own values); `what` is
// for the progress line.
using FitFunction = std::function<void(
    const std::string& what, const Case& c, const IdentifiedModel* begin,
    IdentificationSummary* summary, IdentifiedModel* model)>;

// For a fit that begins where one of much the same case ended: segments are for
// those that begin far away.
void BeginNearTheEnd(IdentificationOptions* options);

// What a fit of `problem` begins from: `values` where it has parameters of
// these names, its own initial values elsewhere; noise and starts of `model`, a
// fit of the same records.
IdentifiedModel BeginFrom(const std::map<std::string, double>& values,
                          const IdentifiedModel& model,
                          const IdentificationProblem& problem);

}  // namespace pinode

#endif  // PINODE_CASE_GROWN_CASE_H_
