// Compiles the parts of Eigen in eigen_instances.inc for the whole library.

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <Eigen/QR>
#include <Eigen/SVD>
#include <complex>

#define PINODE_INSTANCE
#include "pinode/base/eigen_instances.inc"
