#include "pinode/integrate/periodic/harmonic_balance.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <complex>
#include <cstdlib>
#include <utility>

#include "pinode/base/constants.h"
#include "pinode/dynamics/memory_network.h"
#include "pinode/integrate/modal_basis.h"

namespace pinode {
namespace {

using Complex = std::complex<double>;

// Number of samples of a period. A product of up to seven harmonics is not
// taken for another harmonic that is kept.
int NumSamples(int harmonics) {
  int samples = 64;
  while (samples < 8 * (harmonics + 1)) samples *= 2;
  return samples;
}

// Values of the functions 1, cos, sin, cos 2, ... at the phases of the samples,
// one column each.
Matrix Basis(int harmonics, int samples) {
  Matrix basis(2 * harmonics + 1, samples);
  for (int j = 0; j < samples; ++j) {
    const double phase = kTwoPi * j / samples;
    basis(0, j) = 1.0;
    for (int k = 1; k <= harmonics; ++k) {
      basis(2 * k - 1, j) = std::cos(k * phase);
      basis(2 * k, j) = std::sin(k * phase);
    }
  }
  return basis;
}

// Coefficients of the signals with these samples, one signal a row.
Matrix CoefficientsOf(const Matrix& samples, int harmonics) {
  const Matrix basis = Basis(harmonics, static_cast<int>(samples.cols()));
  Matrix result =
      samples * basis.transpose() * (2.0 / static_cast<double>(samples.cols()));
  result.col(0) *= 0.5;
  return result;
}

// Harmonic k as one complex vector.
ComplexVector Harmonic(const Matrix& coefficients, int k) {
  if (k == 0) return coefficients.col(0).cast<Complex>();
  return coefficients.col(2 * k - 1).cast<Complex>() -
         Complex(0.0, 1.0) * coefficients.col(2 * k).cast<Complex>();
}

void SetHarmonic(int k, const ComplexVector& value, Matrix* coefficients) {
  if (k == 0) {
    coefficients->col(0) = value.real();
    return;
  }
  coefficients->col(2 * k - 1) = value.real();
  coefficients->col(2 * k) = -value.imag();
}

// Derivatives of the harmonics of the laws' results by the coefficients of w,
// from the slopes at the samples of a period.
class SlopeHarmonics {
 public:
  // `slopes` has one column per sample, a matrix results x states.
  SlopeHarmonics(const Matrix& slopes, Eigen::Index results, int harmonics) {
    const Matrix parts = CoefficientsOf(slopes, 2 * harmonics);
    const auto add = [results](const Vector& column, std::vector<Matrix>* to) {
      to->push_back(Eigen::Map<const Matrix>(column.data(), results,
                                             column.size() / results));
    };
    add(2.0 * parts.col(0), &cosine_);
    add(Vector::Zero(parts.rows()), &sine_);
    for (int p = 1; p <= 2 * harmonics; ++p) {
      add(parts.col(2 * p - 1), &cosine_);
      add(parts.col(2 * p), &sine_);
    }
  }

  // Derivative of harmonic k by coefficient m, results x states.
  ComplexMatrix By(int k, int m) const {
    const int n = (m + 1) / 2;  // harmonic of coefficient m
    const double half = k == 0 ? 0.25 : 0.5;
    ComplexMatrix result(cosine_[0].rows(), cosine_[0].cols());
    if (m == 0 || m % 2 == 1) {
      result.real() = half * (Cosine(k - n) + Cosine(k + n));
      result.imag() = -half * (Sine(k + n) + Sine(k - n));
    } else {
      result.real() = half * (Sine(n + k) + Sine(n - k));
      result.imag() = -half * (Cosine(k - n) - Cosine(k + n));
    }
    if (k == 0) result.imag().setZero();
    return result;
  }

 private:
  // 2 / samples times the sum of slopes times cos(p phase), or sin(p phase).
  const Matrix& Cosine(int p) const {
    return cosine_[static_cast<size_t>(std::abs(p))];
  }
  Matrix Sine(int p) const {
    const Matrix& sine = sine_[static_cast<size_t>(std::abs(p))];
    return p < 0 ? Matrix(-sine) : sine;
  }

  std::vector<Matrix> cosine_, sine_;
};

// True if the dynamics contain only laws, and groups that follow nothing.
bool HasLawsAlone(const StructuralDynamics& dynamics) {
  const bool constant =
      std::all_of(dynamics.groups().begin(), dynamics.groups().end(),
                  [](const GroupTerm& group) {
                    return group.follows == GroupTerm::Follows::kNothing;
                  });
  const size_t terms =
      dynamics.laws().size() + (dynamics.groups().empty() ? 0 : 1);
  return constant && dynamics.prescribed().empty() &&
         static_cast<size_t>(dynamics.num_terms()) == terms;
}

bool DependsOnTime(const StructuralDynamics& dynamics, std::string* name) {
  for (const LawTerm& law : dynamics.laws()) {
    for (const Feature& feature : law.features) {
      if (feature.kind != Feature::Kind::kTime) continue;
      *name = law.name;
      return true;
    }
  }
  return false;
}

// The dissipated energy is a state of these laws, and grows with every cycle.
bool CountsEnergy(const StructuralDynamics& dynamics, std::string* name) {
  for (const LawTerm& law : dynamics.laws()) {
    if (law.type != "baber_noori" && AsMemoryNetwork(law) == nullptr) continue;
    *name = law.name;
    return true;
  }
  return false;
}

}  // namespace

std::unique_ptr<HarmonicBalance> HarmonicBalance::Create(
    const StructuralDynamics& dynamics,
    const StructuralDynamics::Prepared& prepared, HarmonicInput input,
    std::string* error) {
  std::string name;
  if (!HasLawsAlone(dynamics)) {
    *error =
        "periodic responses are for models of matrices, constant groups and "
        "laws; make equations of a network with pinode_discover first, and "
        "take out what follows the time or a covariate";
    return nullptr;
  }
  if (DependsOnTime(dynamics, &name)) {
    *error =
        "law '" + name + "' depends on the time, so no response is periodic";
    return nullptr;
  }
  if (CountsEnergy(dynamics, &name)) {
    *error = "law '" + name +
             "' counts the energy that it dissipates, which grows, so no "
             "response is periodic; use a law without degradation, such as "
             "bouc_wen";
    return nullptr;
  }
  std::unique_ptr<HarmonicBalance> result(
      new HarmonicBalance(dynamics, prepared, std::move(input)));
  if (!result->Factor(error)) return nullptr;
  return result;
}

HarmonicBalance::HarmonicBalance(const StructuralDynamics& dynamics,
                                 const StructuralDynamics::Prepared& prepared,
                                 HarmonicInput input)
    : dynamics_(dynamics),
      prepared_(prepared),
      input_(std::move(input)),
      laws_(dynamics),
      active_(laws_.states()),
      state_(Vector::Zero(dynamics.num_states())) {
  for (int i = 0; i < laws_.num_internal(); ++i) {
    active_.push_back(2 * dynamics.num_dofs() + i);
  }
}

bool HarmonicBalance::Factor(std::string* error) {
  // Beyond this ratio of the slowest to the fastest motion, rounding could have
  // made the slowest one of none: half the digits.
  constexpr double kSlowest = 1e-8;
  const int n = dynamics_.num_dofs();
  const int motions = 2 * n;
  const int outputs = laws_.num_outputs();
  const int internal = laws_.num_internal();
  const int states = dynamics_.num_states();
  const auto spectrum =
      ModalBasis::FindSpectrum(prepared_.linear.state_jacobian);
  Eigen::ArrayXd speeds = Eigen::ArrayXd::Zero(1);
  if (spectrum != nullptr) speeds = spectrum->eigenvalues.array().abs();
  if (!(speeds.minCoeff() > kSlowest * speeds.maxCoeff())) {
    *error =
        "the linear part of the model has motions without stiffness or without "
        "modes, so that no periodic response is determined; support the model, "
        "or change a damper that is critical";
    return false;
  }
  shift_ = std::exp(speeds.log().mean());
  poles_ = ComplexVector::Constant(states, -shift_);
  poles_.head(motions) = spectrum->eigenvalues;
  modes_ = ComplexMatrix::Identity(states, states);
  modes_.topLeftCorner(motions, motions) = spectrum->modes;
  active_modes_.resize(num_active(), states);
  for (int a = 0; a < num_active(); ++a) {
    active_modes_.row(a) = modes_.row(active_[static_cast<size_t>(a)]);
  }
  Matrix actions(motions, outputs + 2);
  actions.leftCols(outputs) = laws_.OutputMap(prepared_);
  actions.rightCols(2).setZero();
  actions.col(outputs).tail(n) = prepared_.linear.input_map * input_.mean;
  actions.col(outputs + 1).tail(n) =
      prepared_.linear.input_map * input_.amplitude;
  const ComplexMatrix modal = spectrum->inverse_modes * actions;
  right_ = ComplexMatrix::Zero(states, outputs + internal + 2);
  right_.topLeftCorner(motions, outputs) = modal.leftCols(outputs);
  right_.topRightCorner(motions, 2) = modal.rightCols(2);
  right_.block(motions, outputs, internal, internal).setIdentity();

  // A mode a + i b with the coordinate (p - i q) / 2 beside its conjugate is a
  // p + b q.
  const int laws = outputs + internal;
  real_active_ = active_modes_.real();
  real_actions_ = right_.leftCols(laws).real();
  for (int m = 0; m < motions; ++m) {
    if (!BeginsPair(m)) continue;
    real_active_.col(m + 1) = active_modes_.col(m).imag();
    real_actions_.row(m) = 2.0 * right_.row(m).head(laws).real();
    real_actions_.row(m + 1) = -2.0 * right_.row(m).head(laws).imag();
    ++m;
  }
  return true;
}

bool HarmonicBalance::EvaluateLaws(double phase, const Vector& active,
                                   double* results, double* slopes) {
  const Eigen::Index outputs = laws_.num_outputs();
  const Eigen::Index internal = laws_.num_internal();
  for (Eigen::Index a = 0; a < active.size(); ++a) {
    state_[active_[static_cast<size_t>(a)]] = active[a];
  }
  const Vector input =
      input_.mean + scale_ * std::cos(phase) * input_.amplitude;
  laws_.Linearize(prepared_, 0.0, input.data(), state_.data(), results,
                  &law_slopes_);
  Eigen::Map<Vector> result(results, outputs + internal);
  Eigen::Map<Matrix> slope(slopes, outputs + internal, active.size());
  slope = law_slopes_.leftCols(active.size());
  // The part of z that is in F is added back.
  result.tail(internal) += shift_ * active.tail(internal);
  slope.bottomRightCorner(internal, internal).diagonal().array() += shift_;
  return result.allFinite() && slope.allFinite();
}

bool HarmonicBalance::Sample(int harmonics, int samples, const Vector& unknowns,
                             Matrix* results, Matrix* slopes) {
  const Eigen::Index active = num_active();
  const Matrix path =
      Eigen::Map<const Matrix>(unknowns.data(), active, 2 * harmonics + 1) *
      Basis(harmonics, samples);
  results->resize(real_actions_.cols(), samples);
  slopes->resize(real_actions_.cols() * active, samples);
  bool finite = true;
  for (int j = 0; j < samples; ++j) {
    finite &= EvaluateLaws(kTwoPi * j / samples, path.col(j),
                           results->col(j).data(), slopes->col(j).data());
  }
  return finite;
}

ComplexMatrix HarmonicBalance::Solve(int k, double omega,
                                     const ComplexMatrix& right) const {
  const ComplexVector inverse =
      (Complex(0.0, k * omega) - poles_.array()).inverse();
  return inverse.asDiagonal() * right;
}

bool HarmonicBalance::Evaluate(int harmonics, double omega,
                               const Vector& unknowns, Equations* equations) {
  const Eigen::Index active = num_active();
  const Eigen::Index laws = real_actions_.cols();
  Matrix results, slopes;
  if (!Sample(harmonics, NumSamples(harmonics), unknowns, &results, &slopes)) {
    return false;
  }
  // The next harmonics too, to say how much they would add.
  const int more = 2 * harmonics + 1;
  const Matrix forces = CoefficientsOf(results, more);
  const Eigen::Map<const Matrix> w(unknowns.data(), active, more);
  Matrix answer(active, more), by_omega = Matrix::Zero(active, more);
  Matrix neglected = Matrix::Zero(active, 2 * more + 1);
  equations->jacobian.setIdentity(num_unknowns(harmonics),
                                  num_unknowns(harmonics));
  std::unique_ptr<SlopeHarmonics> by_w;
  if (active > 0) {
    by_w = std::make_unique<SlopeHarmonics>(slopes, laws, harmonics);
  }
  for (int k = 0; k <= more && active > 0; ++k) {
    ComplexVector factors = ComplexVector::Zero(laws + 2);
    factors.head(laws) = Harmonic(forces, k);
    if (k == 0) factors[laws] = 1.0;
    if (k == 1) factors[laws + 1] = scale_;
    const ComplexMatrix solved = Solve(k, omega, right_);
    if (k > harmonics) {
      SetHarmonic(k, active_modes_ * (solved * factors), &neglected);
      continue;
    }
    SetHarmonic(k, active_modes_ * (solved * factors), &answer);
    if (k > 0) {
      SetHarmonic(
          k,
          Complex(0.0, k) * (active_modes_ * Solve(k, omega, solved * factors)),
          &by_omega);
    }
    const ComplexMatrix reaches = active_modes_ * solved.leftCols(laws);
    const int first = std::max(2 * k - 1, 0);
    for (int m = 0; m < more; ++m) {
      const ComplexMatrix part = reaches * by_w->By(k, m);
      equations->jacobian.block(first * active, m * active, active, active) -=
          part.real();
      if (k == 0) continue;
      equations->jacobian.block((first + 1) * active, m * active, active,
                                active) += part.imag();
    }
  }
  equations->residual = (w - answer).reshaped();
  equations->by_omega = by_omega.reshaped();
  const double size = w.norm();
  equations->neglected = size > 0.0 ? neglected.norm() / size : 0.0;
  return equations->residual.allFinite();
}

Matrix HarmonicBalance::StateCoefficients(int harmonics, double omega,
                                          const Vector& unknowns) {
  const Eigen::Index laws = real_actions_.cols();
  Matrix results, slopes;
  if (!Sample(harmonics, NumSamples(harmonics), unknowns, &results, &slopes)) {
    return Matrix::Constant(dynamics_.num_states(), 2 * harmonics + 1, kNaN);
  }
  const Matrix forces = CoefficientsOf(results, harmonics);
  Matrix states(dynamics_.num_states(), 2 * harmonics + 1);
  for (int k = 0; k <= harmonics; ++k) {
    ComplexVector factors = ComplexVector::Zero(laws + 2);
    factors.head(laws) = Harmonic(forces, k);
    if (k == 0) factors[laws] = 1.0;
    if (k == 1) factors[laws + 1] = scale_;
    SetHarmonic(k, modes_ * Solve(k, omega, right_ * factors), &states);
  }
  return states;
}

double HarmonicBalance::LargestMultiplier(int harmonics, double omega,
                                          const Vector& unknowns) {
  // Steps are halved until the distance from the limit of 1 has been settled
  // twice: two lengths may step over the same kink of a law.
  constexpr int kMostSteps = 8192;
  constexpr double kSettled = 0.1;
  constexpr double kNoDistance = 1e-7;
  double before = kNaN;
  bool settled = false;
  for (int steps = NumSamples(harmonics); steps <= kMostSteps; steps *= 2) {
    const double now = LargestMultiplierWith(harmonics, omega, steps, unknowns);
    if (std::isnan(now)) return now;
    const double change = std::abs(now - before);
    const bool agrees =
        change < kSettled * std::abs(now - 1.0) || change < kNoDistance;
    // The error falls with the square of the step.
    if (agrees && settled) return now + (now - before) / 3.0;
    settled = agrees;
    before = now;
  }
  return kNaN;
}

double HarmonicBalance::LargestMultiplierWith(int harmonics, double omega,
                                              int steps,
                                              const Vector& unknowns) {
  // So often the motion is brought to the norm 1.
  constexpr int kStepsOfOneScale = 4;
  // Its logarithm is at most this, which a file can hold.
  constexpr double kMostGrowth = 690.0;
  const Eigen::Index states = poles_.size();
  const Eigen::Index active = num_active();
  const double dt = kTwoPi / omega / steps;
  // The exact linear motion over a step, mode by mode, and the laws in between
  // by the trapezoidal rule, which no slope makes unstable.
  const ComplexVector flow = (dt * poles_.array()).exp();
  const Matrix loop = real_active_ * real_actions_;
  const Eigen::Map<const Matrix> coefficients(unknowns.data(), active,
                                              2 * harmonics + 1);
  Vector result(real_actions_.cols());
  Matrix slope(real_actions_.cols(), active);
  // Transposed: a state is a column, which is contiguous.
  Matrix motion = Matrix::Identity(states, states);
  Matrix turned(states, states);
  double log_size = 0.0;
  for (int j = 0; j < steps; ++j) {
    const double phase = kTwoPi * j / steps;
    if (active > 0) {
      if (!EvaluateLaws(phase, ValueAt(coefficients, phase), result.data(),
                        slope.data())) {
        return kNaN;
      }
      const Matrix kick =
          dt * slope *
          (Matrix::Identity(active, active) - 0.5 * dt * loop * slope)
              .inverse();
      motion.noalias() += (motion * real_active_.transpose()).eval() *
                          (real_actions_ * kick).transpose();
    }
    for (int m = 0; m < states; ++m) {
      if (!BeginsPair(m)) {
        turned.col(m) = flow[m].real() * motion.col(m);
        continue;
      }
      turned.col(m) =
          flow[m].real() * motion.col(m) + flow[m].imag() * motion.col(m + 1);
      turned.col(m + 1) =
          flow[m].real() * motion.col(m + 1) - flow[m].imag() * motion.col(m);
      ++m;
    }
    motion.swap(turned);
    if (j % kStepsOfOneScale != 0) continue;
    const double size = motion.norm();
    if (!std::isfinite(size)) return kNaN;
    if (!(size > 0.0)) return 0.0;
    motion /= size;
    log_size += std::log(size);
  }
  // Growth of the powers of the motion: A^(2^p) grows as the largest
  // multiplier to the power 2^p.
  constexpr int kMostSquarings = 24;
  constexpr double kSame = 1e-8;
  double power = 1.0, before = kNaN;
  for (int p = 0; p < kMostSquarings; ++p) {
    const double size = motion.norm();
    if (!std::isfinite(size)) return kNaN;
    if (!(size > 0.0)) return 0.0;
    motion /= size;
    log_size += std::log(size);
    turned.noalias() = motion * motion;
    const double next = std::log(turned.norm());
    if (std::isnan(next)) return kNaN;
    if (std::isinf(next)) return 0.0;
    // log |A^(2^(p+1))| = 2 log_size + next, less log |A^(2^p)| = log_size.
    const double growth = (log_size + next) / power;
    motion.swap(turned);
    log_size *= 2.0;
    power *= 2.0;
    if (std::abs(growth - before) < kSame) {
      return std::exp(std::min(growth, kMostGrowth));
    }
    before = growth;
  }
  return std::exp(std::min(before, kMostGrowth));
}

Vector ValueAt(const Matrix& coefficients, double phase) {
  Vector value = coefficients.col(0);
  for (int k = 1; 2 * k < coefficients.cols(); ++k) {
    value += std::cos(k * phase) * coefficients.col(2 * k - 1) +
             std::sin(k * phase) * coefficients.col(2 * k);
  }
  return value;
}

Matrix DerivativeCoefficients(const Matrix& coefficients, double omega) {
  Matrix result = Matrix::Zero(coefficients.rows(), coefficients.cols());
  for (int k = 1; 2 * k < coefficients.cols(); ++k) {
    result.col(2 * k - 1) = k * omega * coefficients.col(2 * k);
    result.col(2 * k) = -k * omega * coefficients.col(2 * k - 1);
  }
  return result;
}

}  // namespace pinode
