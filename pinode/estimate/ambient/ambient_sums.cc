// Sums over the lines of an ambient record: the cost and its derivatives.

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <cstdint>
#include <memory>
#include <numeric>
#include <vector>

#include "pinode/base/constants.h"
#include "pinode/base/parallel_for.h"
#include "pinode/estimate/ambient/ambient_cost.h"
#include "pinode/problem/load_information.h"

namespace pinode {
namespace {

using Complex = std::complex<double>;

// Neighbouring lines that share a score: the taper ties them together.
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

// Of the loads of a knot and the next, the noise, and groups where asked for.
struct AmbientCost::IntervalSums {
  int knot = 0;
  Vector gradient;
  Matrix information;
  Matrix products;
};

struct AmbientCost::PieceSums {
  bool ok = false;
  double cost = 0.0;
  std::vector<IntervalSums> intervals;
};

// Sums over the lines between two knots; `stretch` sums of a few neighbours.
class AmbientCost::LineSums {
 public:
  LineSums(const AmbientCost& cost, bool with_groups, int knot)
      : cost_(cost),
        spectrum_(*cost.spectrum_),
        channels_(cost.scales_.size()),
        groups_(with_groups ? static_cast<Eigen::Index>(cost.columns_.size())
                            : 0),
        square_(channels_ * channels_),
        areas_(cost.spectrum_->num_areas()),
        nodes_(cost.num_nodes_),
        knot_(knot),
        two_(spectrum_.num_knots() > 1),
        root_(spectrum_.Root(cost.unknowns_, knot)),
        next_root_(two_ ? spectrum_.Root(cost.unknowns_, knot + 1)
                        : Matrix(root_)),
        information_(spectrum_),
        rows_(square_ * kStretch, channels_ + groups_),
        misfit_(square_ * kStretch),
        rest_(Matrix::Zero(channels_ + groups_, channels_ + groups_)),
        mean_score_(Vector::Zero(groups_)),
        mean_information_(Matrix::Zero(groups_, groups_)) {
    const Eigen::Index rows = 2 * channels_ * nodes_ * kStretch;
    for (Matrix& seen : seen_) seen.resize(rows, areas_);
    misfit_seen_.resize(rows, areas_);
    by_group_.assign(static_cast<size_t>(groups_), Matrix(rows, areas_));
    by_noise_.assign(static_cast<size_t>(channels_),
                     Matrix(2 * nodes_ * kStretch, areas_));
    for (Matrix& weights : weights_) {
      weights.resize(2 * nodes_ * kStretch, channels_);
    }
    const Matrix empty = Matrix::Zero(areas_ * areas_, channels_ + groups_);
    cross_ = {empty, empty};
  }

  // A line whose S_y has the factor `lower`, whose powers are L^-1 Y Y^H L^-H;
  // `loads` is the covariance of the loads there.
  template <typename Lower>
  void Add(Eigen::Index line, const Matrix& loads, const Lower& lower,
           const ComplexMatrix& powers) {
    const double count = cost_.lines_.count[line];
    const double root_of_count = std::sqrt(count);
    double below = 0.0;
    double above = 0.0;
    spectrum_.Weigh(cost_.lines_.frequency[line], &below, &above);
    h_ = cost_.transfer_[static_cast<size_t>(line)];
    lower.solveInPlace(h_);
    inverse_.setIdentity(channels_, channels_);
    lower.solveInPlace(inverse_);
    off_ = -powers;
    off_.diagonal().array() += count;
    product_.noalias() = h_.adjoint() * h_;
    AddInformation(count, below, above);
    moved_.noalias() = off_ * h_;
    for (int node = 0; node < nodes_; ++node) {
      RowsOf(node, &seen_[0]) = below * OfNode(h_, node);
      RowsOf(node, &seen_[1]) = above * OfNode(h_, node);
      RowsOf(node, &misfit_seen_) = OfNode(moved_, node);
    }
    const Eigen::Index place = in_stretch_ * square_;
    off_ /= root_of_count;
    Flatten(off_, misfit_.segment(place, square_));
    const Vector noise =
        2.0 * (2.0 * cost_.unknowns_.tail(channels_)).array().exp();
    moved_.noalias() = inverse_.adjoint() * h_;
    for (Eigen::Index c = 0; c < channels_; ++c) {
      // The square of a column of the lower triangle of L^-1.
      ComplexMatrix& square = off_;
      square.noalias() = (root_of_count * noise[c] * inverse_.col(c)) *
                         inverse_.col(c).adjoint();
      Flatten(square, rows_.col(c).segment(place, square_));
      const Eigen::Index first = 2 * nodes_ * in_stretch_;
      for (int node = 0; node < nodes_; ++node) {
        by_noise_[static_cast<size_t>(c)].middleRows(first + 2 * node, 2) =
            OfNode(moved_, node).middleRows(2 * c, 2);
      }
      weights_[0]
          .col(c)
          .segment(first, 2 * nodes_)
          .setConstant(count * noise[c] * below);
      weights_[1]
          .col(c)
          .segment(first, 2 * nodes_)
          .setConstant(count * noise[c] * above);
    }
    if (groups_ > 0) AddGroups(line, loads, lower);
    if (groups_ > 0 && cost_.mean_ != nullptr) AddMean(line, lower);
    if (++in_stretch_ == kStretch) EndStretch();
  }

  // Ends this object.
  IntervalSums Finish() {
    EndStretch();
    const Eigen::Index per_knot = spectrum_.per_knot();
    const Eigen::Index rest = channels_ + groups_;
    const Eigen::Index active = 2 * per_knot + rest;
    IntervalSums sums;
    sums.knot = knot_;
    Matrix& information = sums.information;
    information.resize(active, active);
    information.topLeftCorner(2 * per_knot, 2 * per_knot) =
        information_.Finish(root_, next_root_);
    for (Eigen::Index i = 0; i < rest; ++i) {
      for (int side = 0; side < 2; ++side) {
        information.col(2 * per_knot + i).segment(side * per_knot, per_knot) =
            ByLoadEntries(spectrum_, side == 0 ? root_ : next_root_,
                          Eigen::Map<const Matrix>(
                              cross_[static_cast<size_t>(side)].col(i).data(),
                              areas_, areas_));
      }
    }
    information.bottomLeftCorner(rest, 2 * per_knot) =
        information.topRightCorner(2 * per_knot, rest).transpose();
    information.bottomRightCorner(rest, rest) = rest_;
    information.bottomRightCorner(groups_, groups_) +=
        Matrix(mean_information_.selfadjointView<Eigen::Lower>());
    sums.gradient = Vector::Zero(active);
    for (const Vector& score : scores_) sums.gradient += score;
    if (groups_ > 0) {
      sums.products = Matrix::Zero(active, active);
      for (const Vector& score : scores_) {
        sums.products.selfadjointView<Eigen::Lower>().rankUpdate(score);
      }
      sums.products.triangularView<Eigen::StrictlyUpper>() =
          sums.products.transpose().triangularView<Eigen::StrictlyUpper>();
    }
    return sums;
  }

 private:
  // Columns of a node in what has those of all; its rows in a sum of the
  // stretch.
  Eigen::Ref<const Matrix> OfNode(const ComplexMatrix& all, int node) const {
    return RealRows(all).middleCols(node * areas_, areas_);
  }
  Eigen::Ref<Matrix> RowsOf(int node, Matrix* sums) const {
    return sums->middleRows(2 * channels_ * (in_stretch_ * nodes_ + node),
                            2 * channels_);
  }

  // Both nodes have the same loads:
  //   sum over nodes s, t of tr(A_st D_p A_ts D_q),  A_st = H_s^H S^-1 H_t,
  // where A_01 = B + i C counts as B and C do, both Hermitian.
  void AddInformation(double count, double below, double above) {
    for (int node = 0; node < nodes_; ++node) {
      information_.Add(
          product_.block(node * areas_, node * areas_, areas_, areas_), count,
          below, above);
    }
    if (nodes_ == 1) return;
    const ComplexMatrix a = product_.topRightCorner(areas_, areas_);
    information_.Add(0.5 * (a + a.adjoint()), 2.0 * count, below, above);
    information_.Add(Complex(0.0, -0.5) * (a - a.adjoint()), 2.0 * count, below,
                     above);
  }

  // Of h_, the line's.
  template <typename Lower>
  void AddGroups(Eigen::Index line, const Matrix& loads, const Lower& lower) {
    const double count = cost_.lines_.count[line];
    std::vector<ComplexMatrix> both(static_cast<size_t>(groups_),
                                    ComplexMatrix::Zero(channels_, channels_));
    for (int node = 0; node < nodes_; ++node) {
      AddHalves(line, node, loads, lower, &both);
    }
    for (Eigen::Index g = 0; g < groups_; ++g) {
      ComplexMatrix& half = both[static_cast<size_t>(g)];
      half += half.adjoint().eval();
      Flatten(std::sqrt(count) * half,
              rows_.col(channels_ + g).segment(in_stretch_ * square_, square_));
      moved_.noalias() = count * half * h_;
      for (int node = 0; node < nodes_; ++node) {
        RowsOf(node, &by_group_[static_cast<size_t>(g)]) = OfNode(moved_, node);
      }
    }
  }

  // What measured loads do, of each line for itself.
  template <typename Lower>
  void AddMean(Eigen::Index group, const Lower& lower) {
    const AmbientMean& mean = *cost_.mean_;
    const Eigen::Index first = cost_.lines_.first[static_cast<size_t>(group)];
    const Eigen::Index end = cost_.lines_.first[static_cast<size_t>(group) + 1];
    const double weight =
        2.0 * cost_.lines_.count[group] / static_cast<double>(end - first);
    ComplexMatrix both(channels_, 1 + groups_);
    for (Eigen::Index line = first; line < end; ++line) {
      both.col(0) = mean.rest().col(line);
      for (Eigen::Index g = 0; g < groups_; ++g) {
        both.col(1 + g) =
            mean.slopes(line).col(cost_.columns_[static_cast<size_t>(g)].free);
      }
      lower.solveInPlace(both);
      const auto rows = RealRows(both);
      mean_score_.noalias() -=
          weight * rows.rightCols(groups_).transpose() * rows.col(0);
      mean_information_.selfadjointView<Eigen::Lower>().rankUpdate(
          rows.rightCols(groups_).transpose(), weight);
    }
  }

  // Adds L^-1 dH P H^H L^-H of a node for each group.
  template <typename Lower>
  void AddHalves(Eigen::Index line, int node, const Matrix& loads,
                 const Lower& lower, std::vector<ComplexMatrix>* halves) const {
    const double f = cost_.NodeFrequency(line, node);
    const double w = kTwoPi * f;
    // Forces that go with each whitened channel, and what they move; what
    // moves the channels.
    const ComplexMatrix right = loads *
                                h_.middleCols(node * areas_, areas_).adjoint() /
                                std::sqrt(static_cast<double>(nodes_));
    const Eigen::Index dofs = cost_.mass_.rows();
    ComplexMatrix both_sides(dofs, 2 * channels_);
    both_sides.leftCols(channels_) = cost_.loads_ * right;
    both_sides.rightCols(channels_) =
        cost_.sensors_.transpose().cast<Complex>();
    both_sides = cost_.DynamicStiffness(f).solve(both_sides);
    const ComplexMatrix moved = both_sides.leftCols(channels_).transpose();
    ComplexMatrix left = cost_.ChannelFactors(f).asDiagonal() *
                         both_sides.rightCols(channels_).transpose();
    lower.solveInPlace(left);
    const ComplexMatrix based =
        (cost_.base_ * right.bottomRows(cost_.base_.cols())).transpose();
    for (Eigen::Index g = 0; g < groups_; ++g) {
      const Column& group = cost_.columns_[static_cast<size_t>(g)];
      if (group.left.cols() == 0) continue;
      const bool mass = group.target == MatrixGroup::Target::kMass;
      const Complex by = group.target == MatrixGroup::Target::kStiffness
                             ? Complex(1.0, 0.0)
                         : group.target == MatrixGroup::Target::kDamping
                             ? Complex(0.0, w)
                             : Complex(-w * w, 0.0);
      const ComplexMatrix pushed = mass ? ComplexMatrix(-by * moved - based)
                                        : ComplexMatrix(-by * moved);
      (*halves)[static_cast<size_t>(g)].noalias() +=
          TimesReal(left, group.left) *
          (group.right.size() > 0 ? TimesReal(pushed, group.right) : pushed)
              .transpose();
    }
  }

  static ComplexMatrix TimesReal(const ComplexMatrix& a, const Matrix& b) {
    ComplexMatrix product(a.rows(), b.cols());
    Eigen::Map<Matrix>(reinterpret_cast<double*>(product.data()), 2 * a.rows(),
                       b.cols())
        .noalias() = RealRows(a) * b;
    return product;
  }

  void EndStretch() {
    if (in_stretch_ == 0) return;
    const Eigen::Index per_knot = spectrum_.per_knot();
    const Eigen::Index rows = 2 * channels_ * nodes_ * in_stretch_;
    const auto part = rows_.topRows(in_stretch_ * square_);
    Vector score(2 * per_knot + channels_ + groups_);
    for (int side = 0; side < (two_ ? 2 : 1); ++side) {
      const size_t s = static_cast<size_t>(side);
      const Matrix seen = seen_[s].topRows(rows).transpose();
      score.segment(side * per_knot, per_knot) =
          ByLoadEntries(spectrum_, side == 0 ? root_ : next_root_,
                        seen * misfit_seen_.topRows(rows));
      for (Eigen::Index i = 0; i < channels_ + groups_; ++i) {
        Eigen::Map<Matrix> cross(cross_[s].col(i).data(), areas_, areas_);
        if (i >= channels_) {
          cross.noalias() +=
              seen *
              by_group_[static_cast<size_t>(i - channels_)].topRows(rows);
          continue;
        }
        const auto by_noise =
            by_noise_[static_cast<size_t>(i)].topRows(rows / channels_);
        cross.noalias() +=
            by_noise.transpose() *
            (weights_[s].col(i).head(rows / channels_).asDiagonal() * by_noise);
      }
    }
    if (!two_) score.segment(per_knot, per_knot).setZero();
    score.tail(channels_ + groups_) =
        part.transpose() * misfit_.head(in_stretch_ * square_);
    score.tail(groups_) += mean_score_;
    mean_score_.setZero();
    if (groups_ > 0 || scores_.empty()) {
      scores_.push_back(std::move(score));
    } else {
      scores_[0] += score;
    }
    rest_.noalias() += part.transpose() * part;
    in_stretch_ = 0;
  }

  const AmbientCost& cost_;
  const LoadSpectrum& spectrum_;
  const Eigen::Index channels_, groups_, square_, areas_;
  const int nodes_;
  const int knot_;
  const bool two_;
  const Matrix root_, next_root_;
  LoadInformation information_;
  // Of a line: L^-1 H of all nodes, L^-1, what is left of the powers, and H^H
  // S^-1 H.
  ComplexMatrix h_, inverse_, off_, product_, moved_;
  // Of the stretch: rows of noise and groups, and what they should explain.
  Matrix rows_;
  Vector misfit_;
  // Of the stretch, rows of each line and node: L^-1 H with the weights of both
  // sides, and (I - powers), W of the groups and roots of that of the noise
  // times it.
  std::array<Matrix, 2> seen_;
  Matrix misfit_seen_;
  std::vector<Matrix> by_group_, by_noise_;
  std::array<Matrix, 2> weights_;  // of the rows of by_noise_
  Eigen::Index in_stretch_ = 0;
  std::array<Matrix, 2> cross_;  // sides: areas^2 x (channels + groups)
  Matrix rest_;
  Vector mean_score_;           // of the stretch
  Matrix mean_information_;     // lower triangle
  std::vector<Vector> scores_;  // of stretches
};

bool AmbientCost::AccumulateLines(Eigen::Index first, Eigen::Index last,
                                  bool with_groups, double* cost,
                                  std::vector<IntervalSums>* sums) const {
  *cost = 0.0;
  Eigen::LLT<ComplexMatrix> factor;
  std::unique_ptr<LineSums> lines;
  int last_knot = -1;
  const std::vector<Matrix> at_knots = KnotCovariances();
  for (Eigen::Index k = first; k < last; ++k) {
    const Matrix loads = LoadCovariance(lines_.frequency[k], at_knots);
    if (!FactorizeLine(k, loads, &factor)) return false;
    const auto lower = factor.matrixL();
    // L^-1 (sum Y Y^H) L^-H.
    ComplexMatrix powers = lower.solve(lines_.products[static_cast<size_t>(k)]);
    powers = lower.solve(powers.adjoint().eval());
    *cost += 2.0 * lines_.count[k] *
                 factor.matrixLLT().diagonal().real().array().log().sum() +
             powers.diagonal().real().sum();
    if (sums == nullptr) continue;
    double below = 0.0;
    double above = 0.0;
    const int knot = spectrum_->Weigh(lines_.frequency[k], &below, &above);
    if (lines == nullptr || knot != last_knot) {
      if (lines != nullptr) sums->push_back(lines->Finish());
      lines = std::make_unique<LineSums>(*this, with_groups, knot);
      last_knot = knot;
    }
    lines->Add(k, loads, lower, powers);
  }
  if (lines != nullptr) sums->push_back(lines->Finish());
  return std::isfinite(*cost);
}

void AmbientCost::AddInterval(const IntervalSums& interval, Sums* sums) const {
  // Without a second knot its part is zero.
  const Eigen::Index per_knot = spectrum_->per_knot();
  const Eigen::Index active = interval.gradient.size();
  std::vector<Eigen::Index> places;
  for (int side = 0; side < 2; ++side) {
    const Eigen::Index from =
        (spectrum_->num_knots() > 1 ? interval.knot + side : 0) * per_knot;
    for (Eigen::Index e = 0; e < per_knot; ++e) places.push_back(from + e);
  }
  for (Eigen::Index i = 2 * per_knot; i < active; ++i) {
    places.push_back(spectrum_->num_unknowns() + i - 2 * per_knot);
  }
  for (Eigen::Index j = 0; j < active; ++j) {
    const Eigen::Index to = places[static_cast<size_t>(j)];
    sums->gradient[to] += interval.gradient[j];
    for (Eigen::Index i = 0; i < active; ++i) {
      const Eigen::Index row = places[static_cast<size_t>(i)];
      sums->information(row, to) += interval.information(i, j);
      if (interval.products.size() > 0 && sums->products.size() > 0) {
        sums->products(row, to) += interval.products(i, j);
      }
    }
  }
}

bool AmbientCost::Exchange(bool with_sums, bool with_groups,
                           std::vector<PieceSums>* pieces) const {
  const int ranks = communicator_.size();
  if (ranks == 1) return true;
  // What a piece's intervals are follows from its lines.
  std::vector<std::vector<int>> knots(kPieces);
  for (int p = 0; with_sums && p < kPieces; ++p) {
    std::vector<int>& own = knots[static_cast<size_t>(p)];
    double below = 0.0;
    double above = 0.0;
    for (Eigen::Index k = FirstLine(p); k < FirstLine(p + 1); ++k) {
      const int knot = spectrum_->Weigh(lines_.frequency[k], &below, &above);
      if (own.empty() || own.back() != knot) own.push_back(knot);
    }
  }
  const Eigen::Index active =
      2 * spectrum_->per_knot() + scales_.size() +
      (with_groups ? static_cast<Eigen::Index>(columns_.size()) : 0);
  const bool with_products = with_groups && !columns_.empty();
  const Eigen::Index of_interval =
      active + (with_products ? 2 : 1) * active * active;
  const auto size_of = [&](int p) {
    return 2 + static_cast<Eigen::Index>(knots[static_cast<size_t>(p)].size()) *
                   of_interval;
  };
  std::vector<int64_t> sizes(static_cast<size_t>(ranks), 0);
  for (int p = 0; p < kPieces; ++p) {
    sizes[static_cast<size_t>(RankOf(p))] += size_of(p);
  }
  // Pieces are ranked in their order.
  Vector numbers(std::accumulate(sizes.begin(), sizes.end(), int64_t{0}));
  const auto pass = [&](bool writes) {
    double* at = numbers.data();
    const auto next = [&at, writes](Eigen::Index count, double* here) {
      if (writes) {
        std::copy_n(here, count, at);
      } else {
        std::copy_n(at, count, here);
      }
      at += count;
    };
    for (int p = 0; p < kPieces; ++p) {
      if (writes != (RankOf(p) == communicator_.rank())) {
        at += size_of(p);
        continue;
      }
      PieceSums& piece = (*pieces)[static_cast<size_t>(p)];
      const std::vector<int>& of_piece = knots[static_cast<size_t>(p)];
      double* const end = at + size_of(p);
      double ok = piece.ok ? 1.0 : 0.0;
      next(1, &ok);
      next(1, &piece.cost);
      piece.ok = ok != 0.0;
      piece.intervals.resize(piece.ok ? of_piece.size() : 0);
      for (size_t i = 0; i < piece.intervals.size(); ++i) {
        IntervalSums& interval = piece.intervals[i];
        interval.knot = of_piece[i];
        interval.gradient.resize(active);
        interval.information.resize(active, active);
        next(active, interval.gradient.data());
        next(active * active, interval.information.data());
        if (!with_products) continue;
        interval.products.resize(active, active);
        next(active * active, interval.products.data());
      }
      // Of one that has failed nothing more is known.
      if (writes) std::fill(at, end, 0.0);
      at = end;
    }
  };
  pass(true);
  if (!communicator_.Gather(sizes, numbers.data())) return false;
  pass(false);
  return true;
}

bool AmbientCost::Accumulate(bool with_groups, double* cost, Sums* sums) const {
  std::vector<PieceSums> pieces(kPieces);
  ParallelFor(kPieces, num_threads_, [&](int p, int) {
    if (RankOf(p) != communicator_.rank()) return;
    PieceSums& piece = pieces[static_cast<size_t>(p)];
    piece.ok = AccumulateLines(FirstLine(p), FirstLine(p + 1), with_groups,
                               &piece.cost,
                               sums != nullptr ? &piece.intervals : nullptr);
  });
  if (!Exchange(sums != nullptr, with_groups, &pieces)) return false;
  *cost = offset_;
  if (sums != nullptr) {
    const Eigen::Index size =
        num_nuisance() +
        (with_groups ? static_cast<Eigen::Index>(columns_.size()) : 0);
    sums->gradient = Vector::Zero(size);
    sums->information = Matrix::Zero(size, size);
    const Eigen::Index of_products =
        with_groups && sums->with_products ? size : 0;
    sums->products = Matrix::Zero(of_products, of_products);
  }
  for (const PieceSums& piece : pieces) {
    if (!piece.ok) return false;
    *cost += piece.cost;
    for (const IntervalSums& interval : piece.intervals) {
      AddInterval(interval, sums);
    }
  }
  AddPrior(cost, sums);
  return std::isfinite(*cost);
}

}  // namespace pinode
