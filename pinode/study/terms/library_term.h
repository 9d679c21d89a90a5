// Sparse library terms of a structure, with names and units.

#ifndef PINODE_STUDY_TERMS_LIBRARY_TERM_H_
#define PINODE_STUDY_TERMS_LIBRARY_TERM_H_

#include <string>
#include <vector>

#include "pinode/base/parameter_block.h"
#include "pinode/base/types.h"
#include "pinode/base/units.h"
#include "pinode/dynamics/feature.h"
#include "pinode/dynamics/library_function.h"
#include "pinode/dynamics/structural_dynamics.h"
#include "pinode/structure/model/structural_model.h"

namespace pinode {

// Returns the unit of the coefficient of `function` if the product is an
// acceleration or a force. Functions that do not scale with their features'
// units, such as the sine of a displacement, count as pure numbers. `features`
// are those of the function; `inputs` those of the dynamics.
std::string LibraryCoefficientUnit(const LibraryFunction& function,
                                   const std::vector<Feature>& features,
                                   const std::vector<InputSpec>& inputs,
                                   ActsAs acts_as, const UnitSystem& units);

// Reads the output of a term: "u1", or "u1-u2" (g on u1 and -g on u2), as a
// column of num_dofs entries. Returns false for any other text; names may
// contain a '-'.
[[nodiscard]] bool OutputColumn(const StructuralModel& model,
                                const std::string& text, Vector* column);

// Term sum_k xi_k f_k(q) at one output, see LibraryLaw.
struct LibrarySpec {
  std::string name;
  std::vector<Feature> features;  // q, at least one
  std::string output;             // as OutputColumn reads it
  ActsAs acts_as = ActsAs::kAcceleration;

  struct Coefficient {
    std::string basis;    // f_k, "x[u1]^3"
    Parameter parameter;  // name and unit follow from the above
  };
  std::vector<Coefficient> coefficients;  // at least one
};

// Makes the term of `dynamics` specified by `spec`, with unknowns
// "<name>.<basis>". Features that no function uses are left out. Returns false
// for a basis that cannot be read, an unknown output, or no coefficient.
[[nodiscard]] bool MakeLibraryTerm(const LibrarySpec& spec,
                                   const StructuralDynamics& dynamics,
                                   const UnitSystem& units, LawTerm* term,
                                   std::string* error);

}  // namespace pinode

#endif  // PINODE_STUDY_TERMS_LIBRARY_TERM_H_
