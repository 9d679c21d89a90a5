#include "pinode/study/reduction/finite_element_result.h"

#include <cmath>
#include <utility>

#include "pinode/base/constants.h"
#include "pinode/base/logging.h"
#include "pinode/structure/model/modal_analysis.h"

namespace pinode {
namespace {

// Makes a matrix symmetric: rounding of sums must not make the triangles
// different.
SparseMatrix Symmetric(const SparseMatrix& matrix) {
  return SparseMatrix(0.5 * (matrix + SparseMatrix(matrix.transpose())));
}

}  // namespace

FiniteElementModel UpdatedExport(const ReducedStructure& structure,
                                 const StructuralDynamics& dynamics) {
  CHECK_EQ(structure.groups.size(), dynamics.groups().size());
  FiniteElementModel updated = structure.exported;
  updated.damping = structure.damping;
  for (size_t j = 0; j < structure.groups.size(); ++j) {
    const GroupTerm& term = dynamics.groups()[j];
    const SparseMatrix& matrix = structure.groups[j].matrix;
    if (matrix.rows() == 0 || term.follows != GroupTerm::Follows::kNothing) {
      continue;
    }
    SparseMatrix* target = term.group.target == MatrixGroup::Target::kMass
                               ? &updated.mass
                           : term.group.target == MatrixGroup::Target::kDamping
                               ? &updated.damping
                               : &updated.stiffness;
    // Dampers cannot be added to damping that is known for the coordinates
    // alone.
    if (target->rows() == 0) continue;
    *target = SparseMatrix(*target + term.alpha.value * matrix);
  }
  updated.mass = Symmetric(updated.mass);
  updated.stiffness = Symmetric(updated.stiffness);
  if (updated.has_damping()) updated.damping = Symmetric(updated.damping);
  return updated;
}

std::vector<ElementFactor> ElementFactors(const ReducedStructure& structure,
                                          const StructuralDynamics& dynamics,
                                          const FitSummary& summary) {
  CHECK_EQ(structure.groups.size(), dynamics.groups().size());
  std::vector<ElementFactor> factors;
  for (size_t j = 0; j < structure.groups.size(); ++j) {
    const GroupTerm& term = dynamics.groups()[j];
    if (!structure.groups[j].is_element_set ||
        term.follows != GroupTerm::Follows::kNothing) {
      continue;
    }
    ParameterEstimate estimate;
    estimate.value = term.alpha.value;
    estimate.sigma = estimate.lower95 = estimate.upper95 = kNaN;
    for (const ParameterEstimate& candidate : summary.parameters) {
      if (candidate.name == term.alpha.name) estimate = candidate;
    }
    // The set's share in the export already counts as one.
    const auto factor = [&term](double alpha) {
      return (term.present + alpha) / term.present;
    };
    factors.push_back(
        {term.group.name, term.group.target, factor(estimate.value),
         estimate.sigma / std::abs(term.present), factor(estimate.lower95),
         factor(estimate.upper95), estimate.free, structure.groups[j].source});
  }
  return factors;
}

bool ModesOfWhole(const ReducedStructure& structure,
                  const StructuralDynamics& dynamics, WholeModes* modes,
                  std::string* error) {
  const StructuralModel model = dynamics.CorrectedModel(dynamics.Parameters());
  UndampedModes reduced;
  if (!ComputeUndampedModes(model.mass, model.stiffness, &reduced, error)) {
    return false;
  }
  modes->frequency_hz = reduced.eigenvalues.array().sqrt() / kTwoPi;
  modes->shapes = structure.expansion * reduced.shapes;
  return true;
}

Matrix ExpandedResponse(const ReducedStructure& structure,
                        const Matrix& states) {
  const Matrix coordinates = states.topRows(structure.expansion.cols());
  Matrix response(static_cast<Eigen::Index>(structure.expanded_dofs.size()),
                  states.cols());
  for (Eigen::Index i = 0; i < response.rows(); ++i) {
    const int dof = structure.expanded_dofs[static_cast<size_t>(i)];
    response.row(i) = structure.expansion.row(dof) * coordinates;
  }
  return response;
}

}  // namespace pinode
