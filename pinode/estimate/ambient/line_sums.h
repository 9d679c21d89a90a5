// Sums over the lines between two knots of the loads' spectrum.

#ifndef PINODE_ESTIMATE_AMBIENT_LINE_SUMS_H_
#define PINODE_ESTIMATE_AMBIENT_LINE_SUMS_H_

#include <Eigen/Core>
#include <array>
#include <vector>

#include "pinode/base/types.h"
#include "pinode/estimate/ambient/ambient_lines.h"
#include "pinode/estimate/ambient/ambient_loads.h"
#include "pinode/estimate/ambient/ambient_transfer.h"
#include "pinode/problem/load_information.h"

namespace pinode {

// Derivatives of the likelihood of the lines between a knot and the next, by
// the loads of both, the noise and, if asked for, the free groups.
struct IntervalSums {
  int knot = 0;
  Vector gradient;
  Matrix information;
  Matrix products;  // of scores; empty without groups
};

// Sums these derivatives. The taper ties neighbouring lines together: a stretch
// of a few neighbours shares one score.
class LineSums {
 public:
  // The arguments must outlive this object.
  LineSums(const AmbientLines& lines, const AmbientTransfer& transfer,
           const AmbientLoads& loads, bool with_groups, int knot);

  // Adds a line. `covariance` is that of the loads at its frequency, `factor`
  // is the factor L of S_y, and `powers` is L^-1 Y Y^H L^-H.
  void Add(Eigen::Index line, const Matrix& covariance,
           const ComplexFactor& factor, const Eigen::MatrixXcd& powers);

  // The sums; ends the use of this object.
  IntervalSums Finish();

 private:
  // Sizes of all matrices.
  struct Sizes {
    Eigen::Index channels = 0;
    Eigen::Index groups = 0;
    Eigen::Index areas = 0;
    Eigen::Index square = 0;  // channels^2
    int nodes = 1;
  };
  // Matrices of the present line; kept for their memory.
  struct Line {
    Eigen::MatrixXcd h;        // L^-1 H of all nodes
    Eigen::MatrixXcd inverse;  // L^-1
    Eigen::MatrixXcd off;      // count I - powers
    Eigen::MatrixXcd product;  // H^H S^-1 H
    Eigen::MatrixXcd moved;
  };
  // Rows of the present stretch.
  struct Stretch {
    Eigen::Index size = 0;  // lines so far
    // Channels^2 rows for each line: derivatives of the whitened spectrum by
    // noise and groups, and the misfit that they should explain.
    Matrix rows;
    Vector misfit;
    // Rows for each line and node: L^-1 H with the weights of both sides, and
    // the misfit times it.
    std::array<Matrix, 2> seen;
    Matrix misfit_seen;
    // The derivatives by groups times L^-1 H, and the roots of those by noise
    // times it, with the weights of their rows for both sides.
    std::vector<Matrix> by_group, by_noise;
    std::array<Matrix, 2> weights;
  };

  // Columns of a node in a matrix that has those of all.
  Eigen::Ref<const Matrix> OfNode(const Eigen::MatrixXcd& all, int node) const;
  // Rows of a node of the present line in a matrix of the stretch.
  Eigen::Ref<Matrix> RowsOf(int node, Matrix* sums) const;
  void AddInformation(double count, double below, double above);
  void AddNoise(double count, double below, double above);
  void AddGroups(Eigen::Index line, const Matrix& covariance,
                 const ComplexFactor& factor);
  // Adds the response to measured loads, at each single line.
  void AddMean(Eigen::Index line, const ComplexFactor& factor);
  void EndStretch();

  const AmbientLines& lines_;
  const AmbientTransfer& transfer_;
  const LoadSpectrum& spectrum_;
  const Sizes sizes_;
  const int knot_;
  const bool two_;                     // there is a next knot
  const std::array<Matrix, 2> roots_;  // of the loads' covariances at both
  const Vector noise_;                 // derivative of each channel's density
  LoadInformation information_;        // on the loads
  Line line_;
  Stretch stretch_;
  // Information on loads and (noise, groups), by side: areas^2 rows.
  std::array<Matrix, 2> cross_;
  Matrix rest_;                 // information on (noise, groups)
  Vector mean_score_;           // of measured loads, in the stretch
  Matrix mean_information_;     // lower triangle
  std::vector<Vector> scores_;  // of stretches
};

}  // namespace pinode

#endif  // PINODE_ESTIMATE_AMBIENT_LINE_SUMS_H_
