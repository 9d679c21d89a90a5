// Output of a check of a case.

#ifndef PINODE_APPS_CHECK_TEXT_H_
#define PINODE_APPS_CHECK_TEXT_H_

#include "pinode/case/results/case_check.h"
#include "pinode/case/sections/case_file.h"

namespace pinode {

// Prints the model, the records and what a fit could determine on standard
// output.
void PrintCaseCheck(const Case& c, const CaseCheck& check);

}  // namespace pinode

#endif  // PINODE_APPS_CHECK_TEXT_H_
