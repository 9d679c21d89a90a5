#include "pinode/structure/sparse/mode_quotient.h"

#include <vector>

#include "pinode/base/double_double.h"

namespace pinode {
namespace {

std::vector<DoubleDouble> ExactImage(const SparseMatrix& matrix,
                                     const Vector& shape) {
  std::vector<DoubleDouble> image(static_cast<size_t>(shape.size()));
  for (Eigen::Index j = 0; j < matrix.outerSize(); ++j) {
    for (SparseMatrix::InnerIterator entry(matrix, j); entry; ++entry) {
      DoubleDouble& row = image[static_cast<size_t>(entry.row())];
      row = row + ExactProduct(entry.value(), shape[j]);
    }
  }
  return image;
}

DoubleDouble ExactDot(const Vector& shape,
                      const std::vector<DoubleDouble>& image) {
  DoubleDouble sum;
  for (Eigen::Index i = 0; i < shape.size(); ++i) {
    sum = sum + image[static_cast<size_t>(i)] * shape[i];
  }
  return sum;
}

}  // namespace

ModeQuotient QuotientOf(const SparseMatrix& mass, const SparseMatrix& stiffness,
                        const Vector& shape) {
  const std::vector<DoubleDouble> inertia = ExactImage(mass, shape);
  const std::vector<DoubleDouble> force = ExactImage(stiffness, shape);
  const DoubleDouble modal_mass = ExactDot(shape, inertia);
  const DoubleDouble eigenvalue = ExactDot(shape, force) / modal_mass;
  ModeQuotient result;
  result.eigenvalue = eigenvalue.Rounded();
  result.modal_mass = modal_mass.Rounded();
  result.residual.resize(shape.size());
  for (Eigen::Index i = 0; i < shape.size(); ++i) {
    const auto row = static_cast<size_t>(i);
    result.residual[i] = (force[row] - inertia[row] * eigenvalue).Rounded();
  }
  return result;
}

}  // namespace pinode
