#include "pinode/estimate/solver/free_groups.h"

#include <Eigen/QR>
#include <algorithm>
#include <utility>

namespace pinode {
namespace {

// Pivots of a group's matrix below this part of the largest one are zero.
constexpr double kSmallestPivot = 1e-13;

// G = left right^T with as few columns as G has rank, or G itself.
void FindFactors(const Matrix& g, Matrix* left, Matrix* right) {
  Eigen::ColPivHouseholderQR<Matrix> factor(g.rows(), g.cols());
  factor.setThreshold(kSmallestPivot);
  factor.compute(g);
  const Eigen::Index rank = factor.rank();
  if (2 * rank < g.rows()) {
    const Matrix upper =
        factor.matrixR().topRows(rank).triangularView<Eigen::Upper>();
    *left = factor.householderQ() * Matrix::Identity(g.rows(), rank);
    *right = factor.colsPermutation() * upper.transpose();
  } else {
    *left = g;
    right->resize(0, 0);
  }
}

}  // namespace

std::vector<FreeGroup> FindFreeGroups(const StructuralDynamics& dynamics,
                                      const ParameterLayout& layout) {
  std::vector<FreeGroup> groups;
  std::vector<Matrix> matrices;
  for (const MatrixChange& change : dynamics.linear_dynamics().changes()) {
    FreeGroup group;
    const auto [free, factor] = layout.DependenceOf(change.parameter);
    group.free = free;
    group.target = change.group->target;
    if (group.free < 0 || change.group->matrix.isZero(0.0)) continue;
    group.name = layout.free_parameter(group.free).name;
    const auto same = std::find_if(
        groups.begin(), groups.end(), [&group](const FreeGroup& other) {
          return other.free == group.free && other.target == group.target;
        });
    const auto of_same = matrices.begin() + (same - groups.begin());
    if (same == groups.end()) {
      groups.push_back(std::move(group));
      matrices.emplace_back(factor * change.group->matrix);
    } else {
      *of_same += factor * change.group->matrix;
    }
  }
  for (size_t g = 0; g < groups.size(); ++g) {
    FindFactors(matrices[g], &groups[g].left, &groups[g].right);
  }
  return groups;
}

}  // namespace pinode
