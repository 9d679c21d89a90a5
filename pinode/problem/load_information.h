// Information in spectral lines on the covariances of loads.

#ifndef PINODE_PROBLEM_LOAD_INFORMATION_H_
#define PINODE_PROBLEM_LOAD_INFORMATION_H_

#include <Eigen/Core>
#include <vector>

#include "pinode/base/types.h"
#include "pinode/problem/ambient_spectrum.h"

namespace pinode {

// The Fisher information of the entries of L_b and L_b+1, P = L L^T, from the
// lines between knots b and b+1:
//
//   sum n tr(W_p W_q),  W_p = t L_S^-1 H D_p H^H L_S^-H,
//   D_p = e_i l_j^T + l_j e_i^T for the entry (i, j) of L with columns l,
//
// with S = L_S L_S^H. It needs of a line only A = H^H S^-1 H:
//
//   tr(W_p W_q) = t t' tr(A D_p A D_q),
//
// a form in the products of the entries of A, whose sums over lines are those
// of a matrix product. Work per line: 3/4 areas^4, or areas^2 where loads are
// not correlated; channels do not enter.
class LoadInformation {
 public:
  // Keeps a reference to `spectrum`, which must outlive this object.
  explicit LoadInformation(const LoadSpectrum& spectrum);

  // Adds a line, or `count` lines with one A, with the weights of the two
  // knots.
  void Add(const Eigen::MatrixXcd& a, double count, double below, double above);

  // Returns the information: entries of the knot with the factor `root`, then
  // those of the next. Ends the sums.
  Matrix Finish(const Matrix& root, const Matrix& next_root);

 private:
  void Flush();
  // Returns the sum of tr(A D_p A D_q) for D_p of the factor l and D_q of m,
  // with the weights of `pair`.
  Matrix Block(int pair, const Matrix& l, const Matrix& m) const;

  const LoadSpectrum& spectrum_;
  const int areas_;
  // Lines not yet summed: entries of the lower triangle of A by columns, real
  // and imaginary; n t t' for the pairs (b, b), (b, b+1), (b+1, b+1).
  Matrix real_, imaginary_;
  Matrix weights_;
  Eigen::Index waiting_ = 0;
  // Sums of n t t' Re A_ab Re A_cd, and of the imaginary parts, for each pair;
  // |A_ab|^2 where loads are not correlated.
  std::vector<Matrix> real_products_, imaginary_products_;
};

// Returns d/dp of tr(P S) for each entry of L and a symmetric S: 2 (S L)_ij.
Vector ByLoadEntries(const LoadSpectrum& spectrum, const Matrix& root,
                     const Matrix& s);

}  // namespace pinode

#endif  // PINODE_PROBLEM_LOAD_INFORMATION_H_
