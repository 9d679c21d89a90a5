// Types of dense vectors and matrices that all layers share. Vectors are
// columns. Matrices are stored by columns.

#ifndef PINODE_BASE_TYPES_H_
#define PINODE_BASE_TYPES_H_

#include <Eigen/Core>

namespace pinode {

using Vector = Eigen::VectorXd;
using RowVector = Eigen::RowVectorXd;
using Matrix = Eigen::MatrixXd;
using ComplexVector = Eigen::VectorXcd;
using ComplexMatrix = Eigen::MatrixXcd;

}  // namespace pinode

#endif  // PINODE_BASE_TYPES_H_
