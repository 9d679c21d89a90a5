// [damage]: possible changes besides those of groups, and their places.

#ifndef PINODE_CASE_SECTIONS_DAMAGE_SECTION_H_
#define PINODE_CASE_SECTIONS_DAMAGE_SECTION_H_

#include "pinode/case/text/toml_table.h"
#include "pinode/problem/identification_problem.h"
#include "pinode/study/damage/damage_search.h"

namespace pinode {

// Reads the section; without it, the search is as in LookEverywhere. `problem`
// is complete.
[[nodiscard]] bool ReadDamage(const TomlTable& root,
                              const IdentificationProblem& problem,
                              DamageSearch* search);

}  // namespace pinode

#endif  // PINODE_CASE_SECTIONS_DAMAGE_SECTION_H_
