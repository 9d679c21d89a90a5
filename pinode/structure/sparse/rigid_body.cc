#include "pinode/structure/sparse/rigid_body.h"

#include <Eigen/SVD>
#include <cmath>

#include "pinode/base/logging.h"
#include "pinode/structure/model/symmetric.h"

namespace pinode {
namespace {

// Ratio of singular values above which DOFs fix motions independently. Below
// it, rounding of the shapes would determine the result.
constexpr double kSmallestHold = 1e-6;
// Share of the largest entry below which a DOF does not take part in a motion.
constexpr double kRoundingOfMotion = 1e-8;
// Share of the cancelling terms below which a resistance is rounding, either of
// the products or of an export's fourteen digits.
constexpr double kNoResistance = 1e-10;

// Returns the combinations of columns for which `rows` (of any length each) are
// zero.
Matrix NullSpace(Matrix rows, double least) {
  for (Eigen::Index i = 0; i < rows.rows(); ++i) {
    const double size = rows.row(i).norm();
    rows.row(i) *= size > least ? 1.0 / size : 0.0;
  }
  const Eigen::JacobiSVD<Matrix> svd(rows, Eigen::ComputeFullV);
  const Vector& values = svd.singularValues();
  Eigen::Index rank = 0;
  while (rank < values.size() && values[rank] > kSmallestHold * values[0]) {
    ++rank;
  }
  return svd.matrixV().rightCols(rows.cols() - rank);
}

}  // namespace

Matrix RigidBodyShapes(const SparseModes& modes) {
  Matrix shapes(modes.mode_shapes.rows(), modes.num_rigid_body_modes);
  Eigen::Index next = 0;
  for (Eigen::Index i = 0; i < modes.eigenvalues.size(); ++i) {
    if (modes.eigenvalues[i] == 0.0) {
      shapes.col(next++) = modes.mode_shapes.col(i);
    }
  }
  CHECK_EQ(next, shapes.cols()) << "rigid-body modes are those with w^2 = 0";
  return shapes;
}

std::vector<int> DofsToHold(const Matrix& shapes, const Vector& mass_diagonal,
                            const std::vector<int>& held) {
  CHECK_EQ(shapes.rows(), mass_diagonal.size()) << "a mass for each DOF";
  std::vector<int> missing;
  if (shapes.cols() == 0) return missing;
  const double least = kRoundingOfMotion * shapes.cwiseAbs().maxCoeff();
  Matrix rows(static_cast<Eigen::Index>(held.size()), shapes.cols());
  for (size_t i = 0; i < held.size(); ++i) {
    rows.row(static_cast<Eigen::Index>(i)) = shapes.row(held[i]);
  }
  const Vector root = mass_diagonal.cwiseSqrt();
  Matrix left = rows.rows() > 0
                    ? NullSpace(rows, least)
                    : Matrix::Identity(shapes.cols(), shapes.cols());
  while (left.cols() > 0) {
    const Matrix motion = shapes * left;
    Eigen::Index most = 0;
    (root.asDiagonal() * motion).rowwise().norm().maxCoeff(&most);
    missing.push_back(static_cast<int>(most));
    const Matrix next = NullSpace(motion.row(most), 0.0);
    CHECK_LT(next.cols(), left.cols()) << "mode shapes are independent";
    left = Matrix(left * next);
  }
  return missing;
}

Matrix WithoutResistance(const Matrix& matrix, const Matrix& motions) {
  CHECK_EQ(matrix.rows(), motions.rows()) << "a row for each coordinate";
  if (motions.cols() == 0) return matrix;
  // The coordinates are y = S r with S^2 the diagonal, so that units do not
  // matter. Coordinates on which the matrix does not act are left out.
  const Vector scale = matrix.diagonal().cwiseAbs().cwiseSqrt();
  Vector inverse = Vector::Zero(scale.size());
  for (Eigen::Index i = 0; i < scale.size(); ++i) {
    if (scale[i] > 0.0) inverse[i] = 1.0 / scale[i];
  }
  Eigen::JacobiSVD<Matrix> svd(scale.asDiagonal() * motions,
                               Eigen::ComputeThinU);
  svd.setThreshold(kSmallestHold);
  const Matrix space = svd.matrixU().leftCols(svd.rank());
  const Matrix scaled = inverse.asDiagonal() * matrix * inverse.asDiagonal();
  const Matrix right = scaled - (scaled * space) * space.transpose();
  const Matrix both = right - space * (space.transpose() * right);
  return SymmetricPart(scale.asDiagonal() * both * scale.asDiagonal());
}

Matrix ReduceMatrix(const SparseMatrix& matrix, const Matrix& basis,
                    const Matrix& motions) {
  CHECK_EQ(matrix.rows(), basis.rows()) << "the basis has a row for each DOF";
  CHECK_EQ(matrix.cols(), basis.rows()) << "the basis has a row for each DOF";
  CHECK_EQ(basis.cols(), motions.rows()) << "a row for each coordinate";
  const Matrix reduced =
      SymmetricPart(basis.transpose() * Matrix(matrix * basis));
  if (motions.cols() == 0) return reduced;
  const Matrix shapes = (basis * motions).cwiseAbs();
  const Matrix terms =
      basis.cwiseAbs().transpose() * Matrix(matrix.cwiseAbs() * shapes);
  const Matrix resistance = reduced * motions;
  if ((resistance.array().abs() > kNoResistance * terms.array()).any()) {
    return reduced;
  }
  return WithoutResistance(reduced, motions);
}

}  // namespace pinode
