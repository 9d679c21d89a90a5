#include "pinode/case/finite_element_result.h"

#include <cmath>
#include <filesystem>

#include "pinode/base/file.h"
#include "pinode/base/logging.h"
#include "pinode/base/strings.h"
#include "pinode/case/finite_element_section.h"
#include "pinode/structure/matrix_market.h"

namespace pinode {
namespace {

std::string Cell(double value) {
  return std::isfinite(value) ? FormatNumber(value) : "";
}

// Rounding of sums must not leave one triangle different from the other.
SparseMatrix Symmetric(const SparseMatrix& matrix) {
  return SparseMatrix(0.5 * (matrix + SparseMatrix(matrix.transpose())));
}

std::string ElementFactors(const FiniteElementCase& source,
                           const StructuralDynamics& dynamics,
                           const IdentificationSummary& summary) {
  std::string text =
      "group,property,factor,sigma,lower95,upper95,free,export\n";
  for (size_t j = 0; j < source.groups.size(); ++j) {
    const GroupTerm& term = dynamics.groups()[j];
    if (!source.groups[j].is_element_set ||
        term.follows != GroupTerm::Follows::kNothing) {
      continue;
    }
    ParameterEstimate estimate;
    estimate.value = term.alpha.value;
    estimate.sigma = estimate.lower95 = estimate.upper95 = std::nan("");
    for (const ParameterEstimate& candidate : summary.parameters) {
      if (candidate.name == term.alpha.name) estimate = candidate;
    }
    // What the export has of the set already counts as one.
    const auto factor = [&term](double alpha) {
      return Cell((term.present + alpha) / term.present);
    };
    text += term.group.name + "," + TargetName(term.group.target) + "," +
            factor(estimate.value) + "," +
            Cell(estimate.sigma / std::abs(term.present)) + "," +
            factor(estimate.lower95) + "," + factor(estimate.upper95) + "," +
            (estimate.free ? "1" : "0") + ",\"" +
            std::filesystem::path(source.groups[j].source).filename().string() +
            "\"\n";
  }
  return text;
}

}  // namespace

bool WriteFiniteElementResult(const Case& c,
                              const IdentificationSummary& summary,
                              const IdentifiedModel& model,
                              const std::string& folder, std::string* error) {
  if (c.finite_element == nullptr) return true;
  const FiniteElementCase& source = *c.finite_element;
  StructuralDynamics dynamics = *c.problem.dynamics;
  dynamics.SetParameters(model.parameters.head(dynamics.num_parameters()));
  CHECK_EQ(source.groups.size(), dynamics.groups().size());
  FiniteElementModel updated = source.exported;
  for (size_t j = 0; j < source.groups.size(); ++j) {
    const GroupTerm& term = dynamics.groups()[j];
    const SparseMatrix& matrix = source.groups[j].matrix;
    if (matrix.rows() == 0 || term.follows != GroupTerm::Follows::kNothing) {
      continue;
    }
    SparseMatrix* target = term.group.target == MatrixGroup::Target::kMass
                               ? &updated.mass
                           : term.group.target == MatrixGroup::Target::kDamping
                               ? &updated.damping
                               : &updated.stiffness;
    // Dampers beside an export without damping: C_full.mtx is not written.
    if (target->rows() == 0) continue;
    *target = SparseMatrix(*target + term.alpha.value * matrix);
  }
  const auto path = [&folder](const char* name) {
    return (std::filesystem::path(folder) / name).string();
  };
  std::string names;
  for (const std::string& name : updated.dof_names) names += name + "\n";
  return WriteMatrixMarket(path("M_full.mtx"), Symmetric(updated.mass),
                           error) &&
         WriteMatrixMarket(path("K_full.mtx"), Symmetric(updated.stiffness),
                           error) &&
         (!source.exported.has_damping() ||
          WriteMatrixMarket(path("C_full.mtx"), Symmetric(updated.damping),
                            error)) &&
         WriteFileAtomically(path("dofs_full.txt"), names, error) &&
         WriteFileAtomically(path("element_factors.csv"),
                             ElementFactors(source, dynamics, summary), error);
}

}  // namespace pinode
