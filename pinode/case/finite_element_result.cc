#include "pinode/case/finite_element_result.h"

#include <cmath>
#include <filesystem>

#include "pinode/base/file.h"
#include "pinode/base/logging.h"
#include "pinode/case/csv_file.h"
#include "pinode/case/finite_element_section.h"
#include "pinode/case/result_files.h"
#include "pinode/structure/matrix_market.h"
#include "pinode/structure/modal_analysis.h"

namespace pinode {
namespace {

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
      return CsvCell((term.present + alpha) / term.present);
    };
    text += term.group.name + "," + TargetName(term.group.target) + "," +
            factor(estimate.value) + "," +
            CsvCell(estimate.sigma / std::abs(term.present)) + "," +
            factor(estimate.lower95) + "," + factor(estimate.upper95) + "," +
            (estimate.free ? "1" : "0") + ",\"" +
            std::filesystem::path(source.groups[j].source).filename().string() +
            "\"\n";
  }
  return text;
}

// T times the modes of the coordinates.
bool WriteModes(const Case& c, const StructuralDynamics& dynamics,
                const std::string& path, std::string* error) {
  const StructuralModel model = dynamics.CorrectedModel(dynamics.Parameters());
  UndampedModes modes;
  if (!ComputeUndampedModes(model.mass, model.stiffness, &modes, error)) {
    return false;
  }
  const FiniteElementCase& source = *c.finite_element;
  const Matrix shapes = source.expansion * modes.shapes;
  std::string text = "dof";
  for (Eigen::Index k = 0; k < shapes.cols(); ++k) {
    text += ",mode_" + std::to_string(k + 1);
  }
  text += "\nfrequency_hz";
  for (const double square : modes.eigenvalues) {
    text += "," + CsvCell(c.problem.description.HzPerModelFrequency() *
                          std::sqrt(square) / (2.0 * std::acos(-1.0)));
  }
  for (Eigen::Index i = 0; i < shapes.rows(); ++i) {
    text += "\n" + CsvCell(source.exported.dof_names[static_cast<size_t>(i)]);
    for (const double entry : shapes.row(i)) text += "," + CsvCell(entry);
  }
  return WriteFileAtomically(path, text + "\n", error);
}

// T times the coordinates.
bool WriteResponses(const Case& c, const IdentificationSummary& summary,
                    const std::string& folder, std::string* error) {
  const FiniteElementCase& source = *c.finite_element;
  if (source.expanded_dofs.empty()) return true;
  for (size_t r = 0; r < summary.records.size(); ++r) {
    const RecordScore& score = summary.records[r];
    // A run that never became finite has nothing to show.
    if (score.states.cols() != c.problem.records[r].num_samples()) continue;
    const Matrix coordinates = score.states.topRows(source.expansion.cols());
    std::vector<CsvColumn> columns = {
        {"time", FileTimes(c.problem.records[r])}};
    for (const int dof : source.expanded_dofs) {
      columns.push_back(
          {source.exported.dof_names[static_cast<size_t>(dof)],
           (source.expansion.row(dof) * coordinates).transpose()});
    }
    const std::filesystem::path file = std::filesystem::path(folder) /
                                       ("response_full_" + score.name + ".csv");
    if (!WriteCsv(file.string(), columns, error)) return false;
  }
  return true;
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
  updated.damping = source.damping;
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
    // Dampers beside damping that is known for the coordinates alone.
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
         (!updated.has_damping() ||
          WriteMatrixMarket(path("C_full.mtx"), Symmetric(updated.damping),
                            error)) &&
         WriteFileAtomically(path("dofs_full.txt"), names, error) &&
         WriteFileAtomically(path("element_factors.csv"),
                             ElementFactors(source, dynamics, summary),
                             error) &&
         WriteModes(c, dynamics, path("modes_full.csv"), error) &&
         WriteResponses(c, summary, folder, error);
}

}  // namespace pinode
