#include "pinode/estimate/frf/frf_transfer.h"

#include <Eigen/LU>
#include <cmath>

#include "pinode/base/constants.h"
#include "pinode/structure/model/modal_analysis.h"

namespace pinode {
namespace {

// Damping between two modes that counts as none, as a share of the largest of
// any mode. It is above the rounding of the shapes.
constexpr double kUncoupledDamping = 1e-12;

int FrfDerivative(Quantity quantity) {
  return quantity == Quantity::kVelocity       ? 1
         : quantity == Quantity::kDisplacement ? 0
                                               : 2;
}

// a b for a complex a and a real b.
ComplexMatrix TimesRealMatrix(const ComplexMatrix& a, const Matrix& b) {
  ComplexMatrix product(a.rows(), b.cols());
  product.real().noalias() = a.real() * b;
  product.imag().noalias() = a.imag() * b;
  return product;
}

}  // namespace

// Both factors of dh, in the coordinates of the modes.
struct FrfTransfer::Solution {
  ComplexMatrix motion;   // n x references
  ComplexMatrix adjoint;  // n x responses
};

FrfTransfer::FrfTransfer(const FrfRecord& record,
                         const StructuralDynamics& dynamics,
                         const ParameterLayout& layout)
    : record_(record),
      dynamics_(dynamics),
      layout_(layout),
      groups_(FindFreeGroups(dynamics_, layout)) {
  sensors_.resize(record.num_responses(), dynamics_.num_dofs());
  derivatives_.resize(record.num_responses());
  for (Eigen::Index o = 0; o < record.num_responses(); ++o) {
    const Observation& response = record.responses[static_cast<size_t>(o)];
    sensors_.row(o) = response.weights.transpose();
    derivatives_[o] = FrfDerivative(response.quantity);
  }
  AddColumns();
}

FrfTransfer::SensorValue FrfTransfer::SensorAt(int index, double ideal,
                                               const Vector& all) const {
  SensorValue sensor;
  sensor.value = ideal;
  if (index < 0) return sensor;
  const int parameter = layout_.num_dynamics() + index;
  sensor.value = all[parameter];
  const auto [free, factor] = layout_.DependenceOf(parameter);
  sensor.free = free;
  sensor.factor = factor;
  return sensor;
}

void FrfTransfer::AddColumns() {
  for (const FreeGroup& group : groups_) columns_.push_back(group.free);
  const Vector all = layout_.InitialValues();
  const auto add = [&](int index) {
    const int free = SensorAt(index, 0.0, all).free;
    if (free < 0) return -1;
    columns_.push_back(free);
    return static_cast<int>(columns_.size()) - 1;
  };
  for (const int index : record_.gains) gain_columns_.push_back(add(index));
  for (const int index : record_.delays) delay_columns_.push_back(add(index));
  gain_columns_.resize(record_.responses.size(), -1);
  delay_columns_.resize(record_.responses.size(), -1);
  loss_column_ = add(record_.loss_factor);
}

bool FrfTransfer::SetPoint(const Vector& free, std::string* error) {
  if (!free.allFinite()) {
    *error = "the parameters are not finite";
    return false;
  }
  Vector all = layout_.InitialValues();
  layout_.SetFree(free, &all);
  gains_.clear();
  delays_.clear();
  for (size_t o = 0; o < record_.responses.size(); ++o) {
    gains_.push_back(
        SensorAt(record_.gains.empty() ? -1 : record_.gains[o], 1.0, all));
    delays_.push_back(
        SensorAt(record_.delays.empty() ? -1 : record_.delays[o], 0.0, all));
  }
  loss_ = SensorAt(record_.loss_factor, 0.0, all);

  const StructuralModel model =
      dynamics_.CorrectedModel(all.head(layout_.num_dynamics()));
  UndampedModes modes;
  if (!ComputeUndampedModes(model.mass, model.stiffness, &modes, error)) {
    return false;
  }
  const Matrix& shapes = modes.shapes;
  eigenvalues_ = modes.eigenvalues;
  damping_ = shapes.transpose() * model.damping * shapes;
  const Vector own = damping_.diagonal();
  Matrix coupling = damping_;
  coupling.diagonal().setZero();
  if (coupling.cwiseAbs().maxCoeff() <=
      kUncoupledDamping * own.cwiseAbs().maxCoeff()) {
    damping_ = own;
  }
  seen_ = sensors_ * shapes;
  forces_ = shapes.transpose() * record_.references;
  lefts_.clear();
  rights_.clear();
  for (const FreeGroup& group : groups_) {
    const bool is_full = group.right.size() == 0;
    lefts_.push_back(shapes.transpose() *
                     (is_full ? Matrix(group.left * shapes) : group.left));
    rights_.push_back(is_full ? Matrix() : shapes.transpose() * group.right);
  }
  return true;
}

FrfTransfer::Solution FrfTransfer::Solve(double w, bool with_adjoint) const {
  Solution solution;
  ComplexVector own =
      Complex(1.0, loss_.value) * eigenvalues_.cast<Complex>().array() - w * w;
  if (damping_.cols() == 1) {
    own += Complex(0.0, w) * damping_.col(0).cast<Complex>();
    const ComplexVector inverse = own.cwiseInverse();
    solution.motion = inverse.asDiagonal() * forces_.cast<Complex>();
    if (with_adjoint) {
      solution.adjoint =
          inverse.asDiagonal() * seen_.transpose().cast<Complex>();
    }
    return solution;
  }
  ComplexMatrix z(damping_.rows(), damping_.cols());
  z.real().setZero();
  z.imag() = w * damping_;
  z.diagonal() += own;
  const Eigen::PartialPivLU<ComplexMatrix> factor(z);
  solution.motion = factor.solve(forces_.cast<Complex>());
  if (with_adjoint) {
    solution.adjoint =
        factor.transpose().solve(seen_.transpose().cast<Complex>());
  }
  return solution;
}

void FrfTransfer::Compute(Eigen::Index line, bool with_slopes,
                          Line* result) const {
  const double w = kTwoPi * record_.frequencies[line];
  const Eigen::Index responses = record_.num_responses();
  const Eigen::Index references = record_.num_references();
  const Solution solution = Solve(w, with_slopes);
  const ComplexMatrix ideal = seen_.cast<Complex>() * solution.motion;
  ComplexVector factors(responses);  // without gains
  ComplexVector gains(responses);
  for (Eigen::Index o = 0; o < responses; ++o) {
    const size_t index = static_cast<size_t>(o);
    const Complex turned = std::polar(1.0, -w * delays_[index].value);
    factors[o] = turned * (derivatives_[o] == 2.0   ? Complex(-w * w, 0.0)
                           : derivatives_[o] == 1.0 ? Complex(0.0, w)
                                                    : Complex(1.0, 0.0));
    gains[o] = gains_[index].value;
  }
  const ComplexMatrix unscaled = factors.asDiagonal() * ideal;
  result->values = (gains.asDiagonal() * unscaled).reshaped();
  if (!with_slopes) return;
  result->slopes.setZero(record_.num_pairs(),
                         static_cast<Eigen::Index>(columns_.size()));
  DifferentiateByMatrices(w, solution, factors.cwiseProduct(gains), result);
  for (Eigen::Index o = 0; o < responses; ++o) {
    const size_t index = static_cast<size_t>(o);
    for (Eigen::Index j = 0; j < references; ++j) {
      const Eigen::Index pair = o + responses * j;
      if (gain_columns_[index] >= 0) {
        result->slopes(pair, gain_columns_[index]) =
            gains_[index].factor * unscaled(o, j);
      }
      if (delay_columns_[index] >= 0) {
        result->slopes(pair, delay_columns_[index]) =
            Complex(0.0, -w) * delays_[index].factor * result->values[pair];
      }
    }
  }
}

void FrfTransfer::DifferentiateByMatrices(double w, const Solution& solution,
                                          const ComplexVector& factors,
                                          Line* result) const {
  const ComplexMatrix adjoint = solution.adjoint.transpose();
  const ComplexMatrix motion = solution.motion.transpose();
  for (size_t g = 0; g < groups_.size(); ++g) {
    const MatrixGroup::Target target = groups_[g].target;
    const Complex by =
        target == MatrixGroup::Target::kStiffness ? Complex(1.0, loss_.value)
        : target == MatrixGroup::Target::kDamping ? Complex(0.0, w)
                                                  : Complex(-w * w, 0.0);
    const ComplexMatrix left = TimesRealMatrix(adjoint, lefts_[g]);
    const ComplexMatrix change =
        rights_[g].size() == 0
            ? ComplexMatrix(left * solution.motion)
            : ComplexMatrix(left *
                            TimesRealMatrix(motion, rights_[g]).transpose());
    result->slopes.col(static_cast<Eigen::Index>(g)) =
        (-by * (factors.asDiagonal() * change)).reshaped();
  }
  if (loss_column_ < 0) return;
  const ComplexMatrix change =
      adjoint * (eigenvalues_.cast<Complex>().asDiagonal() * solution.motion);
  result->slopes.col(loss_column_) =
      (Complex(0.0, -loss_.factor) * (factors.asDiagonal() * change))
          .reshaped();
}

}  // namespace pinode
