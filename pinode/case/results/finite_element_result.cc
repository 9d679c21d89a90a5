#include "pinode/case/results/finite_element_result.h"

#include <filesystem>
#include <vector>

#include "pinode/base/file.h"
#include "pinode/case/results/result_files.h"
#include "pinode/case/text/csv_file.h"
#include "pinode/structure/matrices/matrix_market.h"
#include "pinode/study/reduction/finite_element_result.h"

namespace pinode {
namespace {

std::string FactorsAsCsv(const std::vector<ElementFactor>& factors) {
  std::string text =
      "group,property,factor,sigma,lower95,upper95,free,export\n";
  for (const ElementFactor& factor : factors) {
    text += factor.group + "," + TargetName(factor.target) + "," +
            CsvCell(factor.factor) + "," + CsvCell(factor.sigma) + "," +
            CsvCell(factor.lower95) + "," + CsvCell(factor.upper95) + "," +
            (factor.free ? "1" : "0") + ",\"" +
            std::filesystem::path(factor.source).filename().string() + "\"\n";
  }
  return text;
}

std::string ModesAsCsv(const WholeModes& modes, double hz_per_model_frequency,
                       const std::vector<std::string>& dof_names) {
  std::string text = "dof";
  for (Eigen::Index k = 0; k < modes.shapes.cols(); ++k) {
    text += ",mode_" + std::to_string(k + 1);
  }
  text += "\nfrequency_hz";
  for (const double frequency : modes.frequency_hz) {
    text += "," + CsvCell(hz_per_model_frequency * frequency);
  }
  for (Eigen::Index i = 0; i < modes.shapes.rows(); ++i) {
    text += "\n" + CsvCell(dof_names[static_cast<size_t>(i)]);
    for (const double entry : modes.shapes.row(i)) text += "," + CsvCell(entry);
  }
  return text + "\n";
}

bool WriteResponses(const Case& c, const IdentificationSummary& summary,
                    const std::string& folder, std::string* error) {
  const ReducedStructure& structure = *c.finite_element;
  if (structure.expanded_dofs.empty()) return true;
  for (size_t r = 0; r < summary.records.size(); ++r) {
    const RecordScore& score = summary.records[r];
    // A run that was never finite has no response.
    if (score.states.cols() != c.problem.records[r].num_samples()) continue;
    const Matrix response = ExpandedResponse(structure, score.states);
    std::vector<CsvColumn> columns = {
        {"time", FileTimes(c.problem.records[r])}};
    for (size_t i = 0; i < structure.expanded_dofs.size(); ++i) {
      const auto dof = static_cast<size_t>(structure.expanded_dofs[i]);
      columns.push_back(
          {structure.exported.dof_names[dof],
           Vector(response.row(static_cast<Eigen::Index>(i)).transpose())});
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
  const ReducedStructure& structure = *c.finite_element;
  StructuralDynamics dynamics = *c.problem.dynamics;
  dynamics.SetParameters(model.parameters.head(dynamics.num_parameters()));
  const FiniteElementModel updated = UpdatedExport(structure, dynamics);
  WholeModes modes;
  if (!ModesOfWhole(structure, dynamics, &modes, error)) return false;
  const auto path = [&folder](const char* name) {
    return (std::filesystem::path(folder) / name).string();
  };
  std::string names;
  for (const std::string& name : updated.dof_names) names += name + "\n";
  return WriteMatrixMarket(path("M_full.mtx"), updated.mass, error) &&
         WriteMatrixMarket(path("K_full.mtx"), updated.stiffness, error) &&
         (!updated.has_damping() ||
          WriteMatrixMarket(path("C_full.mtx"), updated.damping, error)) &&
         WriteFileAtomically(path("dofs_full.txt"), names, error) &&
         WriteFileAtomically(
             path("element_factors.csv"),
             FactorsAsCsv(ElementFactors(structure, dynamics, summary)),
             error) &&
         WriteFileAtomically(
             path("modes_full.csv"),
             ModesAsCsv(modes, c.problem.description.HzPerModelFrequency(),
                        updated.dof_names),
             error) &&
         WriteResponses(c, summary, folder, error);
}

}  // namespace pinode
