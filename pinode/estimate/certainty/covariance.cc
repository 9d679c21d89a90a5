#include "pinode/estimate/certainty/covariance.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <random>

#include "pinode/base/logging.h"
#include "pinode/base/statistics.h"
#include "pinode/estimate/ambient/ambient_score.h"
#include "pinode/estimate/certainty/input_noise.h"
#include "pinode/estimate/frf/frf_score.h"
#include "pinode/estimate/shooting/residual_statistics.h"
#include "pinode/estimate/shooting/trajectory_outline.h"

namespace pinode {
namespace {

// Significant autocorrelation, in standard deviations of white noise: about one
// false alarm in a thousand channels.
constexpr double kAutocorrelated = 3.5;
constexpr int kLags = 20;

// Random sign vectors per channel for the trace of the induced noise.
constexpr int kProbes = 6;

// Returns the samples per block for each record, from residuals, channels x
// samples.
std::vector<Eigen::Index> BlockLengths(const std::vector<Matrix>& residuals) {
  std::vector<Eigen::Index> lengths;
  for (const Matrix& record : residuals) {
    double time = 1.0;
    for (int c = 0; c < record.rows(); ++c) {
      time = std::max(time, AutocorrelationTime(record.row(c)));
    }
    // Blocks are long compared with the memory of the residuals, but numerous
    // enough.
    const Eigen::Index samples = record.cols();
    lengths.push_back(std::clamp<Eigen::Index>(
        static_cast<Eigen::Index>(std::ceil(8.0 * time)), 5,
        std::max<Eigen::Index>(5, samples / 12)));
  }
  return lengths;
}

// Sums g g' over blocks of consecutive samples, g = sum_i J_i' r_i being a
// block's score. The samples of each record come in their order.
class BlockScores {
 public:
  BlockScores(const std::vector<Matrix>& residuals, int num_free)
      : lengths_(BlockLengths(residuals)),
        score_(Vector::Zero(num_free)),
        products_(Matrix::Zero(num_free, num_free)) {
    for (const Matrix& record : residuals) {
      samples_.push_back(record.cols());
    }
  }

  // Adds residuals as MultipleShooting::Visitor provides them.
  void Add(size_t record, Eigen::Index first, const Matrix& residuals,
           const Matrix& jacobian) {
    const Eigen::Index count = residuals.cols();
    const Eigen::Index nc = residuals.rows();
    const Eigen::Index length = lengths_[record];
    for (Eigen::Index i = 0; i < count;) {
      const Eigen::Index sample = first + i;
      const Eigen::Index end = std::min(count, i + length - sample % length);
      score_.noalias() +=
          jacobian.middleRows(i * nc, (end - i) * nc).transpose() *
          Eigen::Map<const Vector>(residuals.col(i).data(), (end - i) * nc);
      i = end;
      if ((first + i) % length == 0 || first + i == samples_[record]) {
        products_.selfadjointView<Eigen::Lower>().rankUpdate(score_);
        score_.setZero();
        ++count_;
      }
    }
  }

  double count() const { return count_; }
  Matrix products() const { return products_.selfadjointView<Eigen::Lower>(); }

 private:
  std::vector<Eigen::Index> lengths_;
  std::vector<Eigen::Index> samples_;
  Vector score_;
  Matrix products_;
  double count_ = 0.0;
};

bool AnyAutocorrelated(const std::vector<Matrix>& residuals) {
  for (const Matrix& record : residuals) {
    for (int c = 0; c < record.rows(); ++c) {
      if (LjungBoxExcess(record.row(c), kLags) > kAutocorrelated) return true;
    }
  }
  return false;
}

// True if the spectra of an ambient record differ from the model's by more than
// chance allows.
bool AnyMisfit(const Vector& free, const Objective& objective) {
  return std::any_of(objective.ambient().begin(), objective.ambient().end(),
                     [&free](const auto& record) {
                       AmbientScore score;
                       return !ScoreAmbient(free, record.get(), &score) ||
                              score.LeastProbability() <
                                  kDoubtfulAmbientProbability;
                     });
}

// True if the residuals of FRFs are not noise.
bool AnyFrfMisfit(const Vector& free, const Objective& objective) {
  return std::any_of(objective.frfs().begin(), objective.frfs().end(),
                     [&free](const auto& record) {
                       FrfScore score;
                       return !ScoreFrfs(free, record.get(), &score) ||
                              score.probability < kDoubtfulFrfProbability;
                     });
}

// Returns the change of the middle matrix when scores of lines replace the
// information of ambient records, or of FRFs.
Matrix ScoresForInformation(const Objective& objective, bool ambient, bool frfs,
                            Eigen::Index size) {
  Matrix change = Matrix::Zero(size, size);
  if (ambient) {
    for (const auto& record : objective.ambient()) {
      change += record->score_products() - record->information();
    }
  }
  if (frfs) {
    for (const auto& record : objective.frfs()) {
      change += record->ScoreProducts() - record->information();
    }
  }
  return change;
}

// Makes the covariance from a root of the inverse Hessian and the given middle
// matrix. In the coordinates of the root the middle matrix is near the
// identity. The product of inverse, middle and inverse lost its symmetry, and
// with it the verdict on damage, where prior knowledge alone tells two unknowns
// apart: a free decay knows stiffness over mass to 1e-4.
bool MakeSandwich(const Matrix& middle, const Matrix& inverse_root,
                  CovarianceEstimate* estimate) {
  const Matrix inner = inverse_root.transpose() * middle * inverse_root;
  const Matrix outer = inverse_root * (0.5 * (inner + inner.transpose())) *
                       inverse_root.transpose();
  estimate->covariance = 0.5 * (outer + outer.transpose());
  return estimate->covariance.allFinite();
}

// Returns a step from the mode of the posterior to a draw from it. Residuals at
// the draw replace those at the mode in tests. With a right model and white
// noise, the residuals at the mode have the covariance I - J H^-1 J'
// (weighted): a fit with many parameters follows some of the noise, and the
// rest is not white. Moved by J H^(-1/2) z, z of unit covariance, they are
// white again, and autocorrelation is due to the model. `inverse_root` is any
// root of H^-1.
Vector StepToADraw(const Matrix& inverse_root) {
  std::mt19937_64 random(2021);
  Vector z(inverse_root.cols());
  for (double& value : z) value = (random() & 1) != 0 ? 1.0 : -1.0;
  return inverse_root * z;
}

// Returns kProbes columns per channel: random signs in its samples, zeros
// elsewhere.
Matrix ProbeColumns(int nc, Eigen::Index samples) {
  Matrix probes = Matrix::Zero(nc * samples, nc * kProbes);
  std::mt19937_64 random(12345);
  for (int c = 0; c < nc; ++c) {
    for (int p = 0; p < kProbes; ++p) {
      for (Eigen::Index i = 0; i < samples; ++i) {
        probes(i * nc + c, c * kProbes + p) = (random() & 1) != 0 ? 1.0 : -1.0;
      }
    }
  }
  return probes;
}

// Filters the weights. The filter is symmetric but for its ends, so that this
// is the adjoint of "predict, then filter".
void FilterWeights(const ZeroPhaseFilter& filter, int nc, Matrix* weights) {
  const Eigen::Index samples = weights->rows() / nc;
  for (int c = 0; c < nc; ++c) {
    Matrix history(samples, weights->cols());
    for (Eigen::Index i = 0; i < samples; ++i) {
      history.row(i) = weights->row(i * nc + c);
    }
    filter.Apply(&history);
    for (Eigen::Index i = 0; i < samples; ++i) {
      weights->row(i * nc + c) = history.row(i);
    }
  }
}

// Returns the rows of one channel.
Matrix ChannelRows(const Matrix& jacobian, int nc, int c) {
  const Eigen::Index samples = jacobian.rows() / nc;
  Matrix rows(samples, jacobian.cols());
  for (Eigen::Index i = 0; i < samples; ++i)
    rows.row(i) = jacobian.row(i * nc + c);
  return rows;
}

// Adds sum_c rho_c s_c J_c' J_c + sum_i sigma_u^2 v_i v_i' of one record to
// *middle.
void AddRecordInputNoise(const IdentificationRecord& data,
                         const LinearizedRecord& linearized,
                         const Matrix& residuals, const Matrix& jacobian,
                         const Vector& sigmas, Matrix* middle) {
  const int nc = static_cast<int>(residuals.rows());
  const Eigen::Index samples = residuals.cols();
  const Eigen::Index n = jacobian.cols();
  // Columns: the weighted Jacobian, then random signs per channel.
  Matrix weights(nc * samples, n + nc * kProbes);
  weights << jacobian, ProbeColumns(nc, samples);
  if (data.filter != nullptr) FilterWeights(*data.filter, nc, &weights);
  for (Eigen::Index row = 0; row < weights.rows(); ++row) {
    weights.row(row) /= sigmas[row % nc];
  }
  Vector induced = Vector::Zero(nc);  // sum of squares, units of sigma^2
  const std::vector<int> inputs = data.NoisyInputs();
  for (size_t j = 0; j < inputs.size(); ++j) {
    const Matrix effect =
        data.input_sigma[inputs[j]] *
        InputSensitivity(linearized, static_cast<int>(j), weights);
    middle->noalias() += effect.topRows(n) * effect.topRows(n).transpose();
    for (int c = 0; c < nc; ++c) {
      induced[c] +=
          effect.middleRows(n + c * kProbes, kProbes).squaredNorm() / kProbes;
    }
  }
  for (int c = 0; c < nc; ++c) {
    const double total = residuals.row(c).squaredNorm();
    // The share is never zero, because the split itself is estimated.
    const double share =
        total > 0.0 ? std::clamp(1.0 - induced[c] / total, 0.02, 1.0) : 1.0;
    const double scale_to_one =
        total / static_cast<double>(std::max<Eigen::Index>(1, samples));
    const Matrix rows = ChannelRows(jacobian, nc, c);
    middle->noalias() += share * scale_to_one * rows.transpose() * rows;
  }
}

// Adds the same for all training records.
bool AddInputNoise(const IdentificationProblem& problem,
                   const ParameterLayout& layout, const Vector& free,
                   const std::vector<Vector>& sigmas,
                   MultipleShooting* shooting, Matrix* middle) {
  std::vector<Matrix> residuals, jacobians, states;
  if (!WeightedResiduals(free, true, shooting, &residuals, &jacobians) ||
      !RunTrajectories(*shooting, free, &states)) {
    return false;
  }
  Vector parameters = layout.InitialValues();
  layout.SetFree(free, &parameters);
  for (size_t t = 0; t < residuals.size(); ++t) {
    const int record = shooting->train_records()[t];
    const IdentificationRecord& data =
        problem.records[static_cast<size_t>(record)];
    const LinearizedRecord linearized = LinearizeRecord(
        problem, layout, record, data.NoisyInputs(), parameters, states[t]);
    AddRecordInputNoise(data, linearized, residuals[t], jacobians[t], sigmas[t],
                        middle);
  }
  return true;
}

// Adds sum_c tau_c J_c' J_c, with tau_c from the residuals `drawn`.
bool AddInflated(const Vector& free, const std::vector<Matrix>& drawn,
                 MultipleShooting* shooting, Matrix* middle) {
  std::vector<Vector> roots;
  for (const Matrix& record : drawn) {
    Vector root(record.rows());
    for (Eigen::Index c = 0; c < record.rows(); ++c) {
      root[c] = std::sqrt(AutocorrelationTime(record.row(c)));
    }
    roots.push_back(root);
  }
  return shooting->VisitWeightedResiduals(
      free, true,
      [&](size_t r, Eigen::Index, const Matrix& part, const Matrix& jacobian) {
        const Vector weights = roots[r].replicate(part.cols(), 1);
        const Matrix rows = weights.asDiagonal() * jacobian;
        middle->noalias() += rows.transpose() * rows;
      });
}

// Collects the residuals' information on the parameters' covariance.
class Scores {
 public:
  // Computes the residuals after a move by `step` to a draw. All quantities
  // that need each sample's derivatives are found in one pass.
  [[nodiscard]] bool Compute(const Vector& free, const Vector& step,
                             MultipleShooting* shooting) {
    by_modes_ = shooting->sweep().IsByModes() &&
                MovedResiduals(*shooting, free, step, &drawn_);
    if (by_modes_) return true;
    std::vector<Matrix> residuals;
    if (!WeightedResiduals(free, false, shooting, &residuals, nullptr)) {
      return false;
    }
    drawn_ = residuals;
    BlockScores blocks(residuals, static_cast<int>(free.size()));
    if (!shooting->VisitWeightedResiduals(
            free, true,
            [&](size_t r, Eigen::Index first, const Matrix& part,
                const Matrix& rows) {
              const Vector move = rows * step;
              drawn_[r].middleCols(first, part.cols()) +=
                  Eigen::Map<const Matrix>(move.data(), part.rows(),
                                           part.cols());
              blocks.Add(r, first, part, rows);
            })) {
      return false;
    }
    products_ = blocks.products();
    count_ = blocks.count();
    return true;
  }

  // Residuals at a draw from the posterior.
  const std::vector<Matrix>& drawn() const { return drawn_; }

  // Sums g g' over blocks, and counts these. Ends drawn().
  [[nodiscard]] bool Sum(const Vector& free, MultipleShooting* shooting,
                         Matrix* products, double* count) {
    if (by_modes_) {
      std::vector<Matrix>& residuals = drawn_;
      products_ = Matrix::Zero(free.size(), free.size());
      count_ = 0.0;
      if (!MovedResiduals(*shooting, free, Vector::Zero(free.size()),
                          &residuals) ||
          !AddScores(*shooting, free, BlockLengths(residuals), &products_,
                     &count_)) {
        return false;
      }
      products_ = Matrix(products_.selfadjointView<Eigen::Lower>());
    }
    *products = products_;
    *count = count_;
    return true;
  }

 private:
  bool by_modes_ = false;
  std::vector<Matrix> drawn_;
  Matrix products_;
  double count_ = 0.0;
};

bool HasNoisyInput(const IdentificationProblem& problem,
                   const std::vector<int>& records) {
  return std::any_of(records.begin(), records.end(), [&problem](int r) {
    return !problem.records[static_cast<size_t>(r)].NoisyInputs().empty();
  });
}

}  // namespace

bool FactorizeInformation(const Matrix& information, Matrix* lower) {
  CHECK(lower != nullptr);
  if (!information.allFinite()) return false;
  for (double least = 1e-10; least < 2.0; least *= 10.0) {
    Matrix determined = information;
    determined.diagonal().array() += least;
    const Eigen::LLT<Matrix> factor(determined);
    if (factor.info() != Eigen::Success) continue;
    *lower = factor.matrixL();
    return true;
  }
  return false;
}

Vector SolveInformation(const Matrix& information, const Vector& right) {
  Vector scale(right.size());
  for (Eigen::Index j = 0; j < scale.size(); ++j) {
    scale[j] =
        information(j, j) > 0.0 ? 1.0 / std::sqrt(information(j, j)) : 1.0;
  }
  Matrix lower;
  if (!FactorizeInformation(
          scale.asDiagonal() * information * scale.asDiagonal(), &lower)) {
    return Vector();
  }
  Vector solution = scale.cwiseProduct(right);
  lower.triangularView<Eigen::Lower>().solveInPlace(solution);
  lower.transpose().triangularView<Eigen::Upper>().solveInPlace(solution);
  return scale.cwiseProduct(solution);
}

double InformationRounding(const IdentificationProblem& problem) {
  return problem.ambient.empty() ? 1e-13 : 1e-11;
}

bool InvertInformation(const Matrix& information, Matrix* inverse_root,
                       Matrix* null_space, double rounding) {
  const int n = static_cast<int>(information.rows());
  // Scaling to a unit diagonal makes small entries small in every unit.
  Vector scale(n);
  for (int i = 0; i < n; ++i) {
    scale[i] = information(i, i) > 0.0 ? std::sqrt(information(i, i)) : 1.0;
  }
  const Vector inverse_scale = scale.cwiseInverse();
  const Eigen::SelfAdjointEigenSolver<Matrix> eigen(Matrix(
      inverse_scale.asDiagonal() * information * inverse_scale.asDiagonal()));
  if (eigen.info() != Eigen::Success) return false;
  const double threshold = rounding * n * eigen.eigenvalues().maxCoeff();
  Vector inverse_values(n);
  int null = 0;
  for (int i = 0; i < n; ++i) {
    const double value = eigen.eigenvalues()[i];
    if (value <= threshold) ++null;
    inverse_values[i] = 1.0 / std::max(value, threshold);
  }
  *null_space = eigen.eigenvectors().leftCols(null);
  *inverse_root = inverse_scale.asDiagonal() * eigen.eigenvectors() *
                  inverse_values.cwiseSqrt().asDiagonal();
  return inverse_root->allFinite();
}

bool EstimateCovariance(const IdentificationProblem& problem,
                        const ParameterLayout& layout,
                        IdentificationOptions::Covariance choice,
                        const Vector& free, const std::vector<Vector>& sigmas,
                        Objective* objective, CovarianceEstimate* estimate) {
  using Covariance = IdentificationOptions::Covariance;
  CondensedSystem system;
  MultipleShooting& shooting = objective->shooting();
  Matrix inverse_root;
  if (!objective->Linearize(free, &system) ||
      !InvertInformation(system.hessian, &inverse_root, &estimate->null_space,
                         InformationRounding(problem))) {
    return false;
  }
  estimate->covariance = inverse_root * inverse_root.transpose();
  estimate->method = "plain";
  estimate->quantile = StudentQuantile(1e6);
  if (choice == Covariance::kPlain) return true;
  const bool automatic = choice == Covariance::kAuto;
  const bool ambient_scores = !objective->ambient().empty() &&
                              (!automatic || AnyMisfit(free, *objective));
  const bool frf_scores = !objective->frfs().empty() &&
                          (!automatic || AnyFrfMisfit(free, *objective));
  const bool by_scores_of_lines = ambient_scores || frf_scores;
  Matrix middle = system.hessian;
  if (by_scores_of_lines) {
    middle += ScoresForInformation(*objective, ambient_scores, frf_scores,
                                   free.size());
  }
  const auto of_lines_alone = [&] {
    if (!by_scores_of_lines) return true;
    estimate->method = "sandwich";
    return MakeSandwich(middle, inverse_root, estimate);
  };
  if (shooting.train_records().empty()) return of_lines_alone();

  // The priors have the same share in the middle matrix as in the Hessian.
  Scores scores;
  if (!scores.Compute(free, StepToADraw(inverse_root), &shooting)) return false;
  const bool noisy_input = HasNoisyInput(problem, shooting.train_records());
  if (automatic && !noisy_input && !AnyAutocorrelated(scores.drawn())) {
    return of_lines_alone();
  }
  middle -= ResidualInformation(shooting);
  if (automatic && noisy_input) {
    estimate->method = "input noise";
    if (!AddInputNoise(problem, layout, free, sigmas, &shooting, &middle)) {
      return false;
    }
  } else if (automatic && layout.HasForceDecay()) {
    // More knots than blocks: scores of blocks cannot say how well each is
    // known. Autocorrelated noise counts as one sample per autocorrelation
    // time.
    estimate->method = "inflated";
    if (!AddInflated(free, scores.drawn(), &shooting, &middle)) return false;
  } else {
    estimate->method = "sandwich";
    Matrix products;
    double count = 0.0;
    if (!scores.Sum(free, &shooting, &products, &count)) return false;
    middle += count / std::max(1.0, count - 1.0) * products;
    estimate->quantile = StudentQuantile(count - 1.0);
  }
  return MakeSandwich(middle, inverse_root, estimate);
}

}  // namespace pinode
