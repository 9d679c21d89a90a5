#include "pinode/estimate/ambient/ambient_likelihood.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <cstdint>
#include <memory>
#include <numeric>

#include "pinode/problem/ambient_spectrum.h"

namespace pinode {
namespace {

// Adds the sums of an interval to those of the band.
void AddInterval(const IntervalSums& interval, const LoadSpectrum& spectrum,
                 LikelihoodSums* sums) {
  // Without a second knot its part is zero.
  const Eigen::Index per_knot = spectrum.per_knot();
  const Eigen::Index active = interval.gradient.size();
  std::vector<Eigen::Index> places;
  for (int side = 0; side < 2; ++side) {
    const Eigen::Index from =
        (spectrum.num_knots() > 1 ? interval.knot + side : 0) * per_knot;
    for (Eigen::Index e = 0; e < per_knot; ++e) places.push_back(from + e);
  }
  for (Eigen::Index i = 2 * per_knot; i < active; ++i) {
    places.push_back(spectrum.num_unknowns() + i - 2 * per_knot);
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

}  // namespace

struct AmbientLikelihood::PieceSums {
  bool ok = false;
  double cost = 0.0;
  std::vector<IntervalSums> intervals;
};

bool AmbientLikelihood::FactorizeLine(Eigen::Index line,
                                      const AmbientLoads& loads,
                                      const Matrix& covariance,
                                      ComplexFactor* factor) const {
  const ComplexMatrix& h = transfer_.at(line);
  const auto rows = RealRows(h);
  const Eigen::Index areas = covariance.cols();
  Matrix half(rows.rows(), rows.cols());
  for (int node = 0; node < transfer_.num_nodes(); ++node) {
    half.middleCols(node * areas, areas).noalias() =
        rows.middleCols(node * areas, areas) * covariance;
  }
  const Matrix product = half * rows.transpose();
  const auto noise = loads.unknowns().tail(h.rows());
  ComplexMatrix s(h.rows(), h.rows());
  for (Eigen::Index j = 0; j < h.rows(); ++j) {
    for (Eigen::Index i = j; i < h.rows(); ++i) {
      s(i, j) = {product(2 * i, 2 * j) + product(2 * i + 1, 2 * j + 1),
                 product(2 * i + 1, 2 * j) - product(2 * i, 2 * j + 1)};
    }
    s(j, j) += std::exp(2.0 * noise[j]);
  }
  factor->compute(s);
  return factor->info() == Eigen::Success;
}

bool AmbientLikelihood::SumPiece(const AmbientLoads& loads, int piece,
                                 AmbientDerivatives derivatives,
                                 PieceSums* sums) const {
  double cost = 0.0;
  ComplexFactor factor;
  std::unique_ptr<LineSums> interval;
  int last_knot = -1;
  const std::vector<Matrix> at_knots = loads.KnotCovariances();
  for (Eigen::Index k = pieces_.First(piece); k < pieces_.First(piece + 1);
       ++k) {
    const double frequency = lines_.frequency(k);
    const Matrix covariance = loads.Covariance(frequency, at_knots);
    if (!FactorizeLine(k, loads, covariance, &factor)) return false;
    const auto lower = factor.matrixL();
    // L^-1 (sum Y Y^H) L^-H.
    ComplexMatrix powers = lower.solve(lines_.products(k));
    powers = lower.solve(powers.adjoint().eval());
    cost += 2.0 * lines_.count(k) *
                factor.matrixLLT().diagonal().real().array().log().sum() +
            powers.diagonal().real().sum();
    if (derivatives == AmbientDerivatives::kNone) continue;
    double below = 0.0;
    double above = 0.0;
    const int knot = loads.spectrum().Weigh(frequency, &below, &above);
    if (interval == nullptr || knot != last_knot) {
      if (interval != nullptr) sums->intervals.push_back(interval->Finish());
      interval = std::make_unique<LineSums>(
          lines_, transfer_, loads,
          /*with_groups=*/derivatives >= AmbientDerivatives::kGroups, knot);
      last_knot = knot;
    }
    interval->Add(k, covariance, factor, powers);
  }
  if (interval != nullptr) sums->intervals.push_back(interval->Finish());
  sums->cost = cost;
  return std::isfinite(cost);
}

bool AmbientLikelihood::Exchange(const LoadSpectrum& spectrum,
                                 AmbientDerivatives derivatives,
                                 std::vector<PieceSums>* pieces) const {
  constexpr int kPieces = LinePieces::kCount;
  Communicator& communicator = pieces_.communicator();
  const int ranks = communicator.size();
  if (ranks == 1) return true;
  const bool with_sums = derivatives != AmbientDerivatives::kNone;
  const Eigen::Index groups =
      derivatives >= AmbientDerivatives::kGroups ? transfer_.num_groups() : 0;
  // The intervals of a piece follow from its lines.
  std::vector<std::vector<int>> knots(kPieces);
  for (int p = 0; with_sums && p < kPieces; ++p) {
    std::vector<int>& own = knots[static_cast<size_t>(p)];
    double below = 0.0;
    double above = 0.0;
    for (Eigen::Index k = pieces_.First(p); k < pieces_.First(p + 1); ++k) {
      const int knot = spectrum.Weigh(lines_.frequency(k), &below, &above);
      if (own.empty() || own.back() != knot) own.push_back(knot);
    }
  }
  const Eigen::Index active =
      2 * spectrum.per_knot() + lines_.scales().size() + groups;
  const bool with_products = groups > 0;
  const Eigen::Index of_interval =
      active + (with_products ? 2 : 1) * active * active;
  const auto size_of = [&](int p) {
    return 2 + static_cast<Eigen::Index>(knots[static_cast<size_t>(p)].size()) *
                   of_interval;
  };
  std::vector<int64_t> sizes(static_cast<size_t>(ranks), 0);
  for (int p = 0; p < kPieces; ++p) {
    sizes[static_cast<size_t>(pieces_.RankOf(p))] += size_of(p);
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
      if (writes != (pieces_.RankOf(p) == communicator.rank())) {
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
      // A piece that failed has no more numbers.
      if (writes) std::fill(at, end, 0.0);
      at = end;
    }
  };
  pass(true);
  if (!communicator.Gather(sizes, numbers.data())) return false;
  pass(false);
  return true;
}

bool AmbientLikelihood::Sum(const AmbientLoads& loads,
                            AmbientDerivatives derivatives, double* cost,
                            LikelihoodSums* sums) const {
  std::vector<PieceSums> pieces(LinePieces::kCount);
  pieces_.ForOwn([&](int p) {
    PieceSums& piece = pieces[static_cast<size_t>(p)];
    piece.ok = SumPiece(loads, p, derivatives, &piece);
  });
  if (!Exchange(loads.spectrum(), derivatives, &pieces)) return false;
  *cost = lines_.offset();
  if (derivatives != AmbientDerivatives::kNone) {
    const Eigen::Index size =
        loads.num_unknowns() + (derivatives >= AmbientDerivatives::kGroups
                                    ? transfer_.num_groups()
                                    : 0);
    sums->gradient = Vector::Zero(size);
    sums->information = Matrix::Zero(size, size);
    const Eigen::Index of_products =
        derivatives == AmbientDerivatives::kScores ? size : 0;
    sums->products = Matrix::Zero(of_products, of_products);
  }
  for (const PieceSums& piece : pieces) {
    if (!piece.ok) return false;
    *cost += piece.cost;
    for (const IntervalSums& interval : piece.intervals) {
      AddInterval(interval, loads.spectrum(), sums);
    }
  }
  loads.AddPrior(cost,
                 derivatives == AmbientDerivatives::kNone ? nullptr : sums);
  return std::isfinite(*cost);
}

}  // namespace pinode
