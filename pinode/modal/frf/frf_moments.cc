#include "pinode/modal/frf/frf_moments.h"

#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <set>

#include "pinode/base/parallel_for.h"
#include "pinode/base/statistics.h"

namespace pinode {
namespace {

using Complex = std::complex<double>;
using Eigen::Index;

// Deviations from the median at which a file does not count, and the deviation
// of normal numbers over the median of their distances.
constexpr double kFarthestFile = 4.0;
constexpr double kNormalMedian = 1.4826;

// Covariance of the nonlinear unknowns: the inverse of the information.
Matrix InverseOf(const Matrix& normal) {
  const Vector scale =
      normal.diagonal().cwiseMax(1e-300).cwiseSqrt().cwiseInverse();
  return scale.asDiagonal() *
         Eigen::CompleteOrthogonalDecomposition<Matrix>(
             scale.asDiagonal() * normal * scale.asDiagonal())
             .pseudoInverse() *
         scale.asDiagonal();
}

// Rows of a complex number's real and imaginary part as it follows another one:
// the matrix of multiplication by `factor`.
Eigen::Matrix2d Times(Complex factor) {
  Eigen::Matrix2d matrix;
  matrix << factor.real(), -factor.imag(), factor.imag(), factor.real();
  return matrix;
}

// A weighted mean of numbers with variances and a scatter of their own.
struct RandomEffects {
  double mean = 0.0;
  double variance = 0.0;  // of the mean
  double between = 0.0;   // variance between the numbers
};

// Numbers far from the median are left out: near a node of a mode a file may
// show noise in its place. (The first of nine files of a free beam has the
// fourth mode's damping at a quarter of what the others agree on.)
RandomEffects MeanOf(const Vector& all_values, const Vector& all_variances) {
  const Index all_count = all_values.size();
  const std::vector<double> list(all_values.data(),
                                 all_values.data() + all_count);
  const double middle = Median(list);
  std::vector<double> distances;
  for (const double value : list) distances.push_back(std::abs(value - middle));
  const double scatter_of_most = kNormalMedian * Median(distances);
  std::vector<Index> near;
  for (Index i = 0; i < all_count; ++i) {
    if (std::abs(all_values[i] - middle) <=
        kFarthestFile *
            std::hypot(scatter_of_most, std::sqrt(all_variances[i]))) {
      near.push_back(i);
    }
  }
  const Vector values = all_values(near);
  const Vector variances = all_variances(near);
  RandomEffects result;
  const Vector weights = variances.cwiseInverse();
  const double sum = weights.sum();
  const double mean = weights.dot(values) / sum;
  const double scatter = weights.dot((values.array() - mean).square().matrix());
  const double left = sum - weights.squaredNorm() / sum;
  if (left > 0.0) {
    result.between = std::max(
        0.0, (scatter - static_cast<double>(values.size() - 1)) / left);
  }
  const Vector all = (variances.array() + result.between).inverse().matrix();
  result.mean = all.dot(values) / all.sum();
  result.variance = 1.0 / all.sum();
  return result;
}

// The data of some outputs.
FrfData OutputsOf(const FrfData& data, const std::vector<Index>& outputs) {
  FrfData part;
  part.angular = data.angular;
  part.outputs = static_cast<Index>(outputs.size());
  part.references = 1;
  part.derivative = data.derivative;
  part.h.resize(data.num_lines(), part.outputs);
  for (Index i = 0; i < part.outputs; ++i) {
    part.h.col(i) = data.h.col(outputs[static_cast<size_t>(i)]);
  }
  return part;
}

}  // namespace

std::vector<FrfMoments> MomentsOf(const FrfModel& model, const FrfFit& fit) {
  std::vector<FrfMoments> all;
  if (fit.modes.empty()) return all;
  const Matrix unknowns = InverseOf(fit.normal);
  const Index per_mode = model.unknowns_of_mode();
  const Index outputs = fit.shapes.cols();
  const Index references = model.data().references;
  for (size_t m = 0; m < fit.modes.size(); ++m) {
    FrfMoments moments;
    moments.mode = fit.modes[m];
    const Index row = static_cast<Index>(m);
    moments.shape = fit.shapes.row(row).transpose();
    Matrix slopes =
        Matrix::Zero(2 + 2 * outputs + 2 * references, unknowns.cols());
    slopes(0, per_mode * row) = 1.0;
    slopes(1, per_mode * row + 1) = 1.0;
    for (Index o = 0; o < outputs; ++o) {
      slopes.middleRows(2 + 2 * o, 2) =
          fit.shape_slopes[static_cast<size_t>(o)].middleRows(2 * row, 2);
    }
    Index at = per_mode * row + 2;
    for (Index j = 0; j < references; ++j) {
      if (j == moments.mode.reference) continue;
      slopes.block<2, 2>(2 + 2 * outputs + 2 * j, at).setIdentity();
      at += 2;
    }
    moments.covariance = slopes * unknowns * slopes.transpose();
    for (Index o = 0; o < outputs; ++o) {
      moments.covariance.block<2, 2>(2 + 2 * o, 2 + 2 * o) +=
          fit.shape_covariances[static_cast<size_t>(o)].block<2, 2>(2 * row,
                                                                    2 * row);
    }
    all.push_back(std::move(moments));
  }
  return all;
}

FrfResidue ResidueOf(const FrfMoments& moments, Index output, Index reference) {
  const Index outputs = moments.shape.size();
  const Complex shape = moments.shape[output];
  const Complex participation = moments.mode.participation[reference];
  Matrix slopes = Matrix::Zero(2, moments.covariance.cols());
  slopes.middleCols(2 + 2 * output, 2) = Times(participation);
  slopes.middleCols(2 + 2 * outputs + 2 * reference, 2) = Times(shape);
  const Matrix covariance = slopes * moments.covariance * slopes.transpose();
  return {shape * participation, std::sqrt(std::max(0.0, covariance(0, 0))),
          std::sqrt(std::max(0.0, covariance(1, 1)))};
}

// With the residue R = psi_o L_j and the shape psi / psi_l, A = (psi_o /
// psi_l)^2 / R = psi_o / (psi_l^2 L_j), and the mass A / (2 i Im s).
FrfScale ScaleOf(const FrfMoments& moments, Index output, Index reference) {
  const Index outputs = moments.shape.size();
  Index largest = 0;
  moments.shape.cwiseAbs().maxCoeff(&largest);
  const Complex own = moments.shape[output];
  const Complex top = moments.shape[largest];
  const Complex participation = moments.mode.participation[reference];
  FrfScale scale;
  scale.modal_a = own / (top * top * participation);
  const double w = moments.mode.s.imag();
  const Complex mass = scale.modal_a / Complex(0.0, 2.0 * w);
  scale.mass = mass.real();
  Matrix slopes = Matrix::Zero(2, moments.covariance.cols());
  slopes(0, 1) = -mass.real() / w;
  slopes(1, 1) = -mass.imag() / w;
  slopes.middleCols(2 + 2 * output, 2) += Times(mass / own);
  slopes.middleCols(2 + 2 * largest, 2) += Times(-2.0 * mass / top);
  slopes.middleCols(2 + 2 * outputs + 2 * reference, 2) +=
      Times(-mass / participation);
  const Matrix covariance = slopes * moments.covariance * slopes.transpose();
  scale.mass_sigma = std::sqrt(std::max(0.0, covariance(0, 0)));
  return scale;
}

std::vector<FrfMoments> FitPolesPerFile(const FrfData& data,
                                        const std::vector<FrfMode>& common,
                                        const std::vector<int>& groups,
                                        bool complex_residuals, int num_threads,
                                        ComplexMatrix* residuals,
                                        std::vector<Complex>* drift) {
  const std::set<int> distinct(groups.begin(), groups.end());
  const std::vector<int> files(distinct.begin(), distinct.end());
  std::vector<std::vector<Index>> outputs(files.size());
  for (size_t o = 0; o < groups.size(); ++o) {
    const auto file = std::lower_bound(files.begin(), files.end(), groups[o]);
    outputs[static_cast<size_t>(file - files.begin())].push_back(
        static_cast<Index>(o));
  }
  std::vector<std::vector<FrfMoments>> by_file(files.size());
  residuals->resize(data.num_lines(), data.outputs);
  ParallelFor(static_cast<int>(files.size()), num_threads, [&](int f, int) {
    const std::vector<Index>& own = outputs[static_cast<size_t>(f)];
    const FrfData part = OutputsOf(data, own);
    FrfModel model(part, /*num_threads=*/1);
    model.set_complex_residuals(complex_residuals);
    FrfNoise noise;
    const FrfFit fit = FitFrfModes(common, /*fresh=*/true, &model, &noise);
    by_file[static_cast<size_t>(f)] = MomentsOf(model, fit);
    for (size_t i = 0; i < own.size(); ++i) {
      residuals->col(own[i]) = fit.residuals.col(static_cast<Index>(i));
    }
  });
  const Index count = static_cast<Index>(files.size());
  std::vector<FrfMoments> all;
  drift->clear();
  for (size_t m = 0; m < common.size(); ++m) {
    FrfMoments moments;
    moments.mode = common[m];
    moments.shape.resize(data.outputs);
    moments.covariance =
        Matrix::Zero(4 + 2 * data.outputs, 4 + 2 * data.outputs);
    RandomEffects parts[2];
    for (Index part = 0; part < 2; ++part) {
      Vector values(count);
      Vector variances(count);
      for (Index f = 0; f < count; ++f) {
        const FrfMoments& own = by_file[static_cast<size_t>(f)][m];
        values[f] = part == 0 ? own.mode.s.real() : own.mode.s.imag();
        variances[f] = std::max(own.covariance(part, part), 1e-300);
      }
      parts[part] = MeanOf(values, variances);
      moments.covariance(part, part) =
          parts[part].variance + parts[part].between;
    }
    moments.mode.s = {parts[0].mean, parts[1].mean};
    drift->emplace_back(std::sqrt(parts[0].between),
                        std::sqrt(parts[1].between));
    for (Index f = 0; f < count; ++f) {
      const std::vector<Index>& places = outputs[static_cast<size_t>(f)];
      const FrfMoments& own = by_file[static_cast<size_t>(f)][m];
      for (size_t i = 0; i < places.size(); ++i) {
        moments.shape[places[i]] = own.shape[static_cast<Index>(i)];
        for (size_t k = 0; k < places.size(); ++k) {
          moments.covariance.block<2, 2>(2 + 2 * places[i], 2 + 2 * places[k]) =
              own.covariance.block<2, 2>(2 + 2 * static_cast<Index>(i),
                                         2 + 2 * static_cast<Index>(k));
        }
      }
    }
    all.push_back(std::move(moments));
  }
  return all;
}

}  // namespace pinode
