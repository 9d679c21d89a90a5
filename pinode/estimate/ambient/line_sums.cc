#include "pinode/estimate/ambient/line_sums.h"

#include <cmath>
#include <complex>
#include <set>
#include <utility>

#include "pinode/base/constants.h"
#include "pinode/problem/ambient_spectrum.h"

namespace pinode {
namespace {

using Complex = std::complex<double>;

// Number of neighbouring lines that share a score.
constexpr Eigen::Index kStretch = 8;

// A Hermitian matrix as as many numbers, with tr(A B) as their product.
template <typename Target>
void Flatten(const ComplexMatrix& a, Target target) {
  const Eigen::Index n = a.rows();
  Eigen::Index place = 0;
  for (Eigen::Index j = 0; j < n; ++j) {
    target[place++] = a(j, j).real();
    for (Eigen::Index i = j + 1; i < n; ++i) {
      target[place++] = kRootTwo * a(i, j).real();
      target[place++] = kRootTwo * a(i, j).imag();
    }
  }
}

}  // namespace

LineSums::LineSums(const AmbientLines& lines, const AmbientTransfer& transfer,
                   const AmbientLoads& loads, bool with_groups, int knot)
    : lines_(lines),
      transfer_(transfer),
      spectrum_(loads.spectrum()),
      sizes_{loads.num_channels(), with_groups ? transfer.num_groups() : 0,
             spectrum_.num_areas(), loads.num_channels() * loads.num_channels(),
             transfer.num_nodes()},
      knot_(knot),
      two_(spectrum_.num_knots() > 1),
      roots_{spectrum_.Root(loads.unknowns(), knot),
             spectrum_.Root(loads.unknowns(), two_ ? knot + 1 : knot)},
      noise_(2.0 * loads.Noise()),
      information_(spectrum_),
      rest_(Matrix::Zero(sizes_.channels + sizes_.groups,
                         sizes_.channels + sizes_.groups)),
      mean_score_(Vector::Zero(sizes_.groups)),
      mean_information_(Matrix::Zero(sizes_.groups, sizes_.groups)) {
  const auto [channels, groups, areas, square, nodes] = sizes_;
  const Eigen::Index rows = 2 * channels * nodes * kStretch;
  stretch_.rows.resize(square * kStretch, channels + groups);
  stretch_.misfit.resize(square * kStretch);
  for (Matrix& seen : stretch_.seen) seen.resize(rows, areas);
  stretch_.misfit_seen.resize(rows, areas);
  stretch_.by_group.assign(static_cast<size_t>(groups), Matrix(rows, areas));
  stretch_.by_noise.assign(static_cast<size_t>(channels),
                           Matrix(2 * nodes * kStretch, areas));
  for (Matrix& weights : stretch_.weights) {
    weights.resize(2 * nodes * kStretch, channels);
  }
  for (Matrix& cross : cross_) {
    cross = Matrix::Zero(areas * areas, channels + groups);
  }
}

void LineSums::Add(Eigen::Index line, const Matrix& covariance,
                   const ComplexFactor& factor, const ComplexMatrix& powers) {
  const double count = lines_.count(line);
  const auto lower = factor.matrixL();
  double below = 0.0;
  double above = 0.0;
  spectrum_.Weigh(lines_.frequency(line), &below, &above);
  line_.h = transfer_.at(line);
  lower.solveInPlace(line_.h);
  line_.inverse.setIdentity(sizes_.channels, sizes_.channels);
  lower.solveInPlace(line_.inverse);
  line_.off = -powers;
  line_.off.diagonal().array() += count;
  line_.product.noalias() = line_.h.adjoint() * line_.h;
  AddInformation(count, below, above);
  line_.moved.noalias() = line_.off * line_.h;
  for (int node = 0; node < sizes_.nodes; ++node) {
    RowsOf(node, &stretch_.seen[0]) = below * OfNode(line_.h, node);
    RowsOf(node, &stretch_.seen[1]) = above * OfNode(line_.h, node);
    RowsOf(node, &stretch_.misfit_seen) = OfNode(line_.moved, node);
  }
  line_.off /= std::sqrt(count);
  Flatten(line_.off, stretch_.misfit.segment(stretch_.size * sizes_.square,
                                             sizes_.square));
  AddNoise(count, below, above);
  if (sizes_.groups > 0) {
    AddGroups(line, covariance, factor);
    if (lines_.mean() != nullptr) AddMean(line, factor);
  }
  if (++stretch_.size == kStretch) EndStretch();
}

IntervalSums LineSums::Finish() {
  EndStretch();
  const Eigen::Index areas = sizes_.areas;
  const Eigen::Index groups = sizes_.groups;
  const Eigen::Index per_knot = spectrum_.per_knot();
  const Eigen::Index rest = sizes_.channels + groups;
  const Eigen::Index active = 2 * per_knot + rest;
  IntervalSums sums;
  sums.knot = knot_;
  Matrix& information = sums.information;
  information.resize(active, active);
  information.topLeftCorner(2 * per_knot, 2 * per_knot) =
      information_.Finish(roots_[0], roots_[1]);
  for (Eigen::Index i = 0; i < rest; ++i) {
    for (size_t side = 0; side < 2; ++side) {
      information.col(2 * per_knot + i)
          .segment(static_cast<Eigen::Index>(side) * per_knot, per_knot) =
          ByLoadEntries(spectrum_, roots_[side],
                        Eigen::Map<const Matrix>(cross_[side].col(i).data(),
                                                 areas, areas));
    }
  }
  information.bottomLeftCorner(rest, 2 * per_knot) =
      information.topRightCorner(2 * per_knot, rest).transpose();
  information.bottomRightCorner(rest, rest) = rest_;
  information.bottomRightCorner(groups, groups) +=
      Matrix(mean_information_.selfadjointView<Eigen::Lower>());
  sums.gradient = Vector::Zero(active);
  for (const Vector& score : scores_) sums.gradient += score;
  if (groups > 0) {
    sums.products = Matrix::Zero(active, active);
    for (const Vector& score : scores_) {
      sums.products.selfadjointView<Eigen::Lower>().rankUpdate(score);
    }
    sums.products.triangularView<Eigen::StrictlyUpper>() =
        sums.products.transpose().triangularView<Eigen::StrictlyUpper>();
  }
  return sums;
}

Eigen::Ref<const Matrix> LineSums::OfNode(const ComplexMatrix& all,
                                          int node) const {
  return RealRows(all).middleCols(node * sizes_.areas, sizes_.areas);
}

Eigen::Ref<Matrix> LineSums::RowsOf(int node, Matrix* sums) const {
  return sums->middleRows(
      2 * sizes_.channels * (stretch_.size * sizes_.nodes + node),
      2 * sizes_.channels);
}

// Both nodes have the same loads:
//   sum over nodes s, t of tr(A_st D_p A_ts D_q),  A_st = H_s^H S^-1 H_t,
// where A_01 = B + i C counts as B and C do, both Hermitian.
void LineSums::AddInformation(double count, double below, double above) {
  const Eigen::Index areas = sizes_.areas;
  for (int node = 0; node < sizes_.nodes; ++node) {
    information_.Add(
        line_.product.block(node * areas, node * areas, areas, areas), count,
        below, above);
  }
  if (sizes_.nodes == 1) return;
  const ComplexMatrix a = line_.product.topRightCorner(areas, areas);
  information_.Add(0.5 * (a + a.adjoint()), 2.0 * count, below, above);
  information_.Add(Complex(0.0, -0.5) * (a - a.adjoint()), 2.0 * count, below,
                   above);
}

void LineSums::AddNoise(double count, double below, double above) {
  const double root_of_count = std::sqrt(count);
  const int rows = 2 * sizes_.nodes;
  const Eigen::Index first = rows * stretch_.size;
  line_.moved.noalias() = line_.inverse.adjoint() * line_.h;
  for (Eigen::Index c = 0; c < sizes_.channels; ++c) {
    // The square of a column of the lower triangle of L^-1.
    ComplexMatrix& square = line_.off;
    square.noalias() = (root_of_count * noise_[c] * line_.inverse.col(c)) *
                       line_.inverse.col(c).adjoint();
    Flatten(square, stretch_.rows.col(c).segment(stretch_.size * sizes_.square,
                                                 sizes_.square));
    for (int node = 0; node < sizes_.nodes; ++node) {
      stretch_.by_noise[static_cast<size_t>(c)].middleRows(
          first + 2 * node, 2) = OfNode(line_.moved, node).middleRows(2 * c, 2);
    }
    stretch_.weights[0]
        .col(c)
        .segment(first, rows)
        .setConstant(count * noise_[c] * below);
    stretch_.weights[1]
        .col(c)
        .segment(first, rows)
        .setConstant(count * noise_[c] * above);
  }
}

void LineSums::AddGroups(Eigen::Index line, const Matrix& covariance,
                         const ComplexFactor& factor) {
  const double count = lines_.count(line);
  std::vector<ComplexMatrix> both(
      static_cast<size_t>(sizes_.groups),
      ComplexMatrix::Zero(sizes_.channels, sizes_.channels));
  transfer_.AddDerivatives(line, covariance, line_.h, factor, &both);
  for (Eigen::Index g = 0; g < sizes_.groups; ++g) {
    ComplexMatrix& half = both[static_cast<size_t>(g)];
    half += half.adjoint().eval();
    Flatten(std::sqrt(count) * half,
            stretch_.rows.col(sizes_.channels + g)
                .segment(stretch_.size * sizes_.square, sizes_.square));
    line_.moved.noalias() = count * half * line_.h;
    for (int node = 0; node < sizes_.nodes; ++node) {
      RowsOf(node, &stretch_.by_group[static_cast<size_t>(g)]) =
          OfNode(line_.moved, node);
    }
  }
}

void LineSums::AddMean(Eigen::Index line, const ComplexFactor& factor) {
  const AmbientMean& mean = *lines_.mean();
  const std::vector<Eigen::Index>& singles = lines_.groups().first;
  const Eigen::Index first = singles[static_cast<size_t>(line)];
  const Eigen::Index end = singles[static_cast<size_t>(line) + 1];
  const double weight =
      2.0 * lines_.count(line) / static_cast<double>(end - first);
  const Eigen::Index groups = sizes_.groups;
  ComplexMatrix both(sizes_.channels, 1 + groups);
  for (Eigen::Index single = first; single < end; ++single) {
    both.col(0) = mean.rest().col(single);
    // The mean's slope by an unknown that two groups share counts once.
    std::set<int> seen;
    for (Eigen::Index g = 0; g < groups; ++g) {
      const int free = transfer_.groups()[static_cast<size_t>(g)].free;
      if (seen.insert(free).second) {
        both.col(1 + g) = mean.slopes(single).col(free);
      } else {
        both.col(1 + g).setZero();
      }
    }
    factor.matrixL().solveInPlace(both);
    const auto rows = RealRows(both);
    mean_score_.noalias() -=
        weight * rows.rightCols(groups).transpose() * rows.col(0);
    mean_information_.selfadjointView<Eigen::Lower>().rankUpdate(
        rows.rightCols(groups).transpose(), weight);
  }
}

void LineSums::EndStretch() {
  if (stretch_.size == 0) return;
  const auto [channels, groups, areas, square, nodes] = sizes_;
  const Eigen::Index per_knot = spectrum_.per_knot();
  const Eigen::Index rows = 2 * channels * nodes * stretch_.size;
  const auto part = stretch_.rows.topRows(stretch_.size * square);
  Vector score(2 * per_knot + channels + groups);
  for (size_t s = 0; s < (two_ ? 2 : 1); ++s) {
    const Matrix seen = stretch_.seen[s].topRows(rows).transpose();
    score.segment(static_cast<Eigen::Index>(s) * per_knot, per_knot) =
        ByLoadEntries(spectrum_, roots_[s],
                      seen * stretch_.misfit_seen.topRows(rows));
    for (Eigen::Index i = 0; i < channels + groups; ++i) {
      Eigen::Map<Matrix> cross(cross_[s].col(i).data(), areas, areas);
      if (i >= channels) {
        cross.noalias() +=
            seen *
            stretch_.by_group[static_cast<size_t>(i - channels)].topRows(rows);
        continue;
      }
      const auto by_noise =
          stretch_.by_noise[static_cast<size_t>(i)].topRows(rows / channels);
      cross.noalias() +=
          by_noise.transpose() *
          (stretch_.weights[s].col(i).head(rows / channels).asDiagonal() *
           by_noise);
    }
  }
  if (!two_) score.segment(per_knot, per_knot).setZero();
  score.tail(channels + groups) =
      part.transpose() * stretch_.misfit.head(stretch_.size * square);
  score.tail(groups) += mean_score_;
  mean_score_.setZero();
  if (groups > 0 || scores_.empty()) {
    scores_.push_back(std::move(score));
  } else {
    scores_[0] += score;
  }
  rest_.noalias() += part.transpose() * part;
  stretch_.size = 0;
}

}  // namespace pinode
