#include "pinode/dynamics/spanned_terms.h"

#include <Eigen/Cholesky>
#include <Eigen/QR>

namespace pinode {
namespace {

// Rows: the displacement (or velocity) features as linear maps of x (of v).
Matrix FeatureRows(const std::vector<Feature>& features, int num_dofs,
                   bool velocity) {
  Matrix rows(0, num_dofs);
  for (const Feature& feature : features) {
    if (velocity ? feature.OnVelocity() : feature.OnDisplacement()) {
      rows.conservativeResize(rows.rows() + 1, num_dofs);
      rows.row(rows.rows() - 1) = feature.Selector(num_dofs);
    }
  }
  return rows;
}

// Returns true if every row of `matrix` is a combination of `rows`.
bool Spans(const Matrix& rows, const Matrix& matrix) {
  if (rows.rows() == 0) return false;
  const Matrix columns = rows.transpose();
  const Matrix wanted = matrix.transpose();
  const Matrix solution = columns.colPivHouseholderQr().solve(wanted);
  const Matrix residual = columns * solution - wanted;
  return residual.norm() <= 1e-9 * matrix.norm();
}

}  // namespace

std::vector<std::string> SpannedTerms(const StructuralDynamics& dynamics,
                                      const NetworkTerm& network) {
  const int n = dynamics.num_dofs();
  const Matrix displacements = FeatureRows(network.features, n, false);
  const Matrix velocities = FeatureRows(network.features, n, true);
  const Eigen::LLT<Matrix> mass(dynamics.model().mass);
  const auto is_spanned = [&](const Matrix& matrix, bool velocity) {
    if (!Spans(velocity ? velocities : displacements, matrix)) return false;
    const Matrix acting = network.acts_as == NetworkTerm::ActsAs::kForce
                              ? matrix
                              : Matrix(mass.solve(matrix));
    return (network.outputs.transpose() * acting).norm() >
           1e-9 * acting.norm() * network.outputs.norm();
  };
  std::vector<std::string> names;
  for (const GroupTerm& term : dynamics.groups()) {
    if ((!term.alpha.free && !term.alpha.IsTied()) ||
        term.follows != GroupTerm::Follows::kNothing ||
        term.group.target == MatrixGroup::Target::kMass) {
      continue;
    }
    if (is_spanned(term.group.matrix,
                   term.group.target == MatrixGroup::Target::kDamping)) {
      names.push_back(term.group.name);
    }
  }
  for (const LawTerm& term : dynamics.laws()) {
    if (term.type != "linear") continue;
    // Parameters k and c of the law k d + c w.
    const Matrix matrix = term.outputs * term.features[0].Selector(n);
    for (const Parameter& parameter : term.parameters.parameters) {
      const bool velocity = parameter.name == term.name + ".c";
      if ((parameter.free || parameter.IsTied()) &&
          is_spanned(matrix, velocity)) {
        names.push_back(parameter.name);
      }
    }
  }
  return names;
}

}  // namespace pinode
