#include "pinode/estimate/ambient/ambient_transfer.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <utility>

#include "pinode/base/constants.h"
#include "pinode/problem/ambient_spectrum.h"

namespace pinode {
namespace {

using Complex = std::complex<double>;

// Modes up to this multiple of the band's end are loaded each for itself, if no
// more than these. At the end an acceleration has of a mode r times as high 1 /
// (r^2 - 1) of what it would have of a rigid one: 0.8 at 1.5, a third at 2.
constexpr double kNearBand = 2.0;
constexpr Eigen::Index kMostModalLoads = 24;

int DerivativeOf(Quantity quantity) {
  switch (quantity) {
    case Quantity::kVelocity:
      return 1;
    case Quantity::kRelativeAcceleration:
    case Quantity::kAbsoluteAcceleration:
      return 2;
    default:
      return 0;
  }
}

ComplexMatrix TimesReal(const ComplexMatrix& a, const Matrix& b) {
  ComplexMatrix product(a.rows(), b.cols());
  Eigen::Map<Matrix>(reinterpret_cast<double*>(product.data()), 2 * a.rows(),
                     b.cols())
      .noalias() = RealRows(a) * b;
  return product;
}

}  // namespace

AmbientTransfer::AmbientTransfer(const AmbientRecord& record,
                                 const StructuralDynamics& averaged,
                                 const ModalProperties& modes,
                                 const ParameterLayout& layout,
                                 const AmbientLines& lines,
                                 const LinePieces& pieces)
    : lines_(lines), pieces_(pieces) {
  const Eigen::Index channels =
      static_cast<Eigen::Index>(record.channels.size());
  sensors_.resize(channels, averaged.num_dofs());
  derivatives_.resize(channels);
  for (Eigen::Index c = 0; c < channels; ++c) {
    const Observation& channel = record.channels[static_cast<size_t>(c)];
    sensors_.row(c) = channel.weights.transpose();
    derivatives_[c] = DerivativeOf(channel.quantity);
  }
  groups_ = FindFreeGroups(averaged, layout);
  SetLoads(record, averaged.model(), modes);
  num_nodes_ = loads_.cols() < channels ? 2 : 1;
}

void AmbientTransfer::SetLoads(const AmbientRecord& record,
                               const StructuralModel& model,
                               const ModalProperties& modes) {
  const Eigen::Index dofs = sensors_.cols();
  const Eigen::Index channels = sensors_.rows();
  loads_ = record.loads;
  if (loads_.size() == 0 && record.base.size() == 0) {
    // Modes far above the band take part in little but its stiffness.
    const Eigen::Index near =
        (modes.frequency_hz.array() < kNearBand * lines_.highest()).count();
    loads_ = record.correlated && near > 0 && near <= kMostModalLoads
                 ? Matrix(model.mass * modes.mode_shapes.leftCols(near))
                 : Matrix(sensors_.transpose());
  }
  loads_.colwise().normalize();
  const Eigen::Index forces = loads_.cols();
  base_ = record.base;
  if (base_.size() == 0) base_.resize(dofs, 0);
  const Eigen::Index directions = base_.cols();
  loads_.conservativeResize(dofs, forces + directions);
  direct_ = Matrix::Zero(channels, forces + directions);
  for (Eigen::Index d = 0; d < directions; ++d) {
    const Vector load = -model.mass * base_.col(d);
    const double unit = 1.0 / std::max(load.norm(), 1e-300);
    base_.col(d) *= unit;
    loads_.col(forces + d) = unit * load;
    for (Eigen::Index c = 0; c < channels; ++c) {
      if (record.channels[static_cast<size_t>(c)].quantity ==
          Quantity::kAbsoluteAcceleration) {
        direct_(c, forces + d) = sensors_.row(c).dot(base_.col(d));
      }
    }
  }
}

void AmbientTransfer::SetModel(StructuralModel model) {
  model_ = std::move(model);
  loads_.rightCols(base_.cols()) = -model_.mass * base_;
}

Eigen::PartialPivLU<ComplexMatrix> AmbientTransfer::DynamicStiffness(
    double frequency) const {
  const double w = kTwoPi * frequency;
  ComplexMatrix z(model_.mass.rows(), model_.mass.cols());
  z.real() = model_.stiffness - w * w * model_.mass;
  z.imag() = w * model_.damping;
  return z.partialPivLu();
}

double AmbientTransfer::NodeFrequency(Eigen::Index line, int node) const {
  const double frequency = lines_.frequency(line);
  if (num_nodes_ == 1) return frequency;
  const double spread = lines_.groups().spread[line];
  return frequency + (node == 0 ? -spread : spread);
}

ComplexVector AmbientTransfer::ChannelFactors(double frequency) const {
  const double w = kTwoPi * frequency;
  ComplexVector factors(derivatives_.size());
  for (Eigen::Index c = 0; c < factors.size(); ++c) {
    const Complex factor = derivatives_[c] == 2.0   ? Complex(-w * w, 0.0)
                           : derivatives_[c] == 1.0 ? Complex(0.0, w)
                                                    : Complex(1.0, 0.0);
    factors[c] = factor / lines_.scales()[c];
  }
  return factors;
}

void AmbientTransfer::FindOwn() {
  transfer_.resize(static_cast<size_t>(lines_.size()));
  pieces_.ForOwn([this](int piece) { Find(piece); });
}

void AmbientTransfer::FindAll() {
  transfer_.resize(static_cast<size_t>(lines_.size()));
  pieces_.ForAll([this](int piece) { Find(piece); });
}

void AmbientTransfer::Find(int piece) {
  const ComplexMatrix loads = loads_.cast<Complex>();
  const ComplexMatrix direct =
      (lines_.scales().cwiseInverse().asDiagonal() * direct_).cast<Complex>();
  for (Eigen::Index k = pieces_.First(piece); k < pieces_.First(piece + 1);
       ++k) {
    ComplexMatrix& h = transfer_[static_cast<size_t>(k)];
    h.resize(sensors_.rows(), num_nodes_ * loads.cols());
    for (int node = 0; node < num_nodes_; ++node) {
      const double f = NodeFrequency(k, node);
      h.middleCols(node * loads.cols(), loads.cols()) =
          ChannelFactors(f).asDiagonal() *
              (sensors_ * DynamicStiffness(f).solve(loads)) +
          direct;
    }
    h /= std::sqrt(static_cast<double>(num_nodes_));
  }
}

void AmbientTransfer::AddDerivatives(Eigen::Index line,
                                     const Matrix& covariance,
                                     const ComplexMatrix& whitened,
                                     const ComplexFactor& factor,
                                     std::vector<ComplexMatrix>* sums) const {
  const Eigen::Index areas = loads_.cols();
  const Eigen::Index channels = sensors_.rows();
  for (int node = 0; node < num_nodes_; ++node) {
    const double f = NodeFrequency(line, node);
    const double w = kTwoPi * f;
    // Forces that go with each whitened channel, with the motion they cause;
    // then the motion that each channel sees.
    const ComplexMatrix right =
        covariance * whitened.middleCols(node * areas, areas).adjoint() /
        std::sqrt(static_cast<double>(num_nodes_));
    ComplexMatrix both_sides(sensors_.cols(), 2 * channels);
    both_sides.leftCols(channels) = loads_ * right;
    both_sides.rightCols(channels) = sensors_.transpose().cast<Complex>();
    both_sides = DynamicStiffness(f).solve(both_sides);
    const ComplexMatrix moved = both_sides.leftCols(channels).transpose();
    ComplexMatrix left = ChannelFactors(f).asDiagonal() *
                         both_sides.rightCols(channels).transpose();
    factor.matrixL().solveInPlace(left);
    const ComplexMatrix based =
        (base_ * right.bottomRows(base_.cols())).transpose();
    for (size_t g = 0; g < groups_.size(); ++g) {
      const FreeGroup& group = groups_[g];
      if (group.left.cols() == 0) continue;
      const bool mass = group.target == MatrixGroup::Target::kMass;
      const Complex by = group.target == MatrixGroup::Target::kStiffness
                             ? Complex(1.0, 0.0)
                         : group.target == MatrixGroup::Target::kDamping
                             ? Complex(0.0, w)
                             : Complex(-w * w, 0.0);
      const ComplexMatrix pushed = mass ? ComplexMatrix(-by * moved - based)
                                        : ComplexMatrix(-by * moved);
      (*sums)[g].noalias() +=
          TimesReal(left, group.left) *
          (group.right.size() > 0 ? TimesReal(pushed, group.right) : pushed)
              .transpose();
    }
  }
}

}  // namespace pinode
