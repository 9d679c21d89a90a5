#include "pinode/estimate/ambient/ambient_cost.h"

#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <complex>
#include <utility>

#include "pinode/base/constants.h"
#include "pinode/base/parallel_for.h"
#include "pinode/base/statistics.h"
#include "pinode/estimate/solver/information_solver.h"
#include "pinode/structure/model/modal_analysis.h"

namespace pinode {
namespace {

using Complex = std::complex<double>;

// Of the model's lowest and highest frequency, and of half the sampling rate.
constexpr double kBelowLowest = 0.3;
constexpr double kAboveHighest = 1.5;
constexpr double kBelowNyquist = 0.8;
// Of the largest pivot of a group's matrix: nothing below it.
constexpr double kSmallestPivot = 1e-13;
// Modes up to so much of the band's end are loaded each for itself, if no more
// than these. At the end an acceleration has of a mode r times as high 1 / (r^2
// - 1) of what it would have of a rigid one: 0.8 at 1.5, a third at 2.
constexpr double kNearBand = 2.0;
constexpr Eigen::Index kMostModalLoads = 24;
// Damping ratios for which lines are taken together: half that of the model's
// least damped mode, within these.
constexpr double kLeastDampingOfLines = 5e-4;
constexpr double kMostDampingOfLines = 0.01;
// Of a channel's density over that of the band: noise below it makes no
// difference.
constexpr double kSmallestNoise = 1e-7;
// Room below the cost of neighbours' means; where measured loads are taken off,
// neighbours' combinations of them leave more than the model does.
constexpr double kRoom = 3.0;
constexpr double kRoomOfRest = 12.0;

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

// G = left right^T with as few columns as G has rank, or G itself.
void FindFactors(const Matrix& g, Matrix* left, Matrix* right) {
  Eigen::ColPivHouseholderQR<Matrix> factor(g.rows(), g.cols());
  factor.setThreshold(kSmallestPivot);
  factor.compute(g);
  const Eigen::Index rank = factor.rank();
  if (2 * rank < g.rows()) {
    const Matrix upper =
        factor.matrixR().topRows(rank).triangularView<Eigen::Upper>();
    *left = factor.householderQ() * Matrix::Identity(g.rows(), rank);
    *right = factor.colsPermutation() * upper.transpose();
  } else {
    *left = g;
    right->resize(0, 0);
  }
}

// Stretches of neighbouring lines over which a mean says something.
Eigen::Index StretchOf(Eigen::Index channels, Eigen::Index inputs) {
  return 2 * channels + 8 + 2 * inputs;
}

// What the best combination of inputs leaves of lines, stretch by stretch.
ComplexMatrix WithoutInputs(const ComplexMatrix& values,
                            const ComplexMatrix& inputs) {
  ComplexMatrix rest = values;
  const Eigen::Index stretch = StretchOf(values.rows(), inputs.rows());
  for (Eigen::Index first = 0; first < values.cols(); first += stretch) {
    const Eigen::Index count = std::min(stretch, values.cols() - first);
    const ComplexMatrix u = inputs.middleCols(first, count).adjoint();
    auto y = rest.middleCols(first, count);
    y -= (u * u.colPivHouseholderQr().solve(y.adjoint())).adjoint().eval();
  }
  return rest;
}

// The cost of a model as good as the means of neighbouring lines, and `room`
// below for each channel and line: what makes all costs positive.
double OffsetOf(const ComplexMatrix& lines, double tied, double room) {
  const Eigen::Index channels = lines.rows();
  const Eigen::Index stretch = StretchOf(channels, 0);
  double cost = 0.0;
  for (Eigen::Index first = 0; first < lines.cols(); first += stretch) {
    const Eigen::Index count = std::min(stretch, lines.cols() - first);
    const auto y = lines.middleCols(first, count);
    ComplexMatrix mean = y * y.adjoint() / static_cast<double>(count);
    mean.diagonal().array() += 1e-9 * mean.diagonal().real().mean() + 1e-300;
    const Eigen::LLT<ComplexMatrix> factor(mean);
    const Matrix diagonal = factor.matrixLLT().diagonal().real();
    cost += static_cast<double>(count) *
            (2.0 * diagonal.array().max(1e-300).log().sum() +
             static_cast<double>(channels));
  }
  return (room * static_cast<double>(channels * lines.cols()) - cost) / tied;
}

// What of a record is looked at where it does not say; `frequencies`: of the
// model's modes.
void FindBand(const AmbientRecord& record, const Vector& frequencies,
              double* lowest, double* highest) {
  *lowest = record.lowest_frequency;
  *highest = record.highest_frequency;
  const double nyquist = 0.5 / record.sampling_step;
  const double ten_lines = 10.0 / (static_cast<double>(record.samples.cols()) *
                                   record.sampling_step);
  if (*lowest == 0.0) {
    *lowest = ten_lines;
    for (const double f : frequencies) {
      if (f > 0.0) {
        *lowest = std::max(ten_lines, kBelowLowest * f);
        break;
      }
    }
    *lowest = std::min(*lowest, 0.1 * nyquist);
  }
  if (*highest == 0.0) {
    *highest = kBelowNyquist * nyquist;
    if (frequencies.size() > 0 && frequencies.tail(1)[0] > 0.0) {
      *highest = std::min(*highest, kAboveHighest * frequencies.tail(1)[0]);
    }
    *highest = std::max(*highest, 2.0 * *lowest);
  }
}

}  // namespace

AmbientCost::AmbientCost(const AmbientRecord& record,
                         const StructuralDynamics& dynamics,
                         const ParameterLayout& layout, int num_threads,
                         Communicator* communicator)
    : record_(record),
      dynamics_(record.AveragedDynamics(dynamics)),
      layout_(layout),
      num_threads_(num_threads),
      communicator_(CommunicatorOrSingle(communicator)) {
  const Eigen::Index channels =
      static_cast<Eigen::Index>(record.channels.size());
  sensors_.resize(channels, dynamics.num_dofs());
  derivatives_.resize(channels);
  scales_.resize(channels);
  for (Eigen::Index c = 0; c < channels; ++c) {
    const Observation& channel = record.channels[static_cast<size_t>(c)];
    sensors_.row(c) = channel.weights.transpose();
    derivatives_[c] = DerivativeOf(channel.quantity);
  }
  for (const MatrixChange& change : dynamics_.linear_dynamics().changes()) {
    Column column;
    column.free = layout.FreeIndex(change.parameter);
    column.target = change.group->target;
    if (column.free < 0 || change.group->matrix.isZero(0.0)) continue;
    FindFactors(change.group->matrix, &column.left, &column.right);
    columns_.push_back(std::move(column));
  }
  const StructuralModel model =
      dynamics_.CorrectedModel(dynamics_.Parameters());
  ModalProperties modes;
  std::string ignored;
  Vector frequencies;
  if (ComputeModes(model.mass, model.damping, model.stiffness, &modes,
                   &ignored)) {
    frequencies = modes.frequency_hz;
  }
  double lowest = 0.0;
  double highest = 0.0;
  FindBand(record, frequencies, &lowest, &highest);
  SetLoads(modes, highest);
  num_nodes_ = loads_.cols() < channels ? 2 : 1;
  LineTransform transform(record.samples, record.sampling_step, lowest,
                          highest);
  SpectralLines lines = transform.Apply(record.samples);
  total_lines_ = static_cast<double>(lines.frequency.size());
  for (Eigen::Index c = 0; c < channels; ++c) {
    scales_[c] = std::sqrt(std::max(
        lines.values.row(c).squaredNorm() / std::max(1.0, total_lines_),
        1e-300));
    lines.values.row(c) /= scales_[c];
  }
  double ratio = kMostDampingOfLines;
  for (const double found : modes.damping_ratio) {
    if (found > 0.0) ratio = std::min(ratio, 0.5 * found);
  }
  lines_ = GroupLines(lines, 0.25 * std::max(ratio, kLeastDampingOfLines));
  const int knots = record.knots > 0
                        ? record.knots
                        : std::max(2, 1 + static_cast<int>(std::lround(
                                              std::log2(highest / lowest))));
  spectrum_ = std::make_unique<LoadSpectrum>(lowest, highest, knots,
                                             static_cast<int>(loads_.cols()),
                                             record.correlated);
  smallest_noise_ = Vector::Constant(channels, kSmallestNoise);
  const Matrix measured_loads = record.MeasuredLoads(dynamics);
  if (measured_loads.rows() == 0) {
    offset_ = OffsetOf(lines.values, lines.tied, kRoom);
    return;
  }
  const ComplexMatrix rest =
      WithoutInputs(lines.values, transform.Values(measured_loads));
  for (Eigen::Index c = 0; c < channels; ++c) {
    smallest_noise_[c] *= std::clamp(
        rest.row(c).squaredNorm() / lines.values.row(c).squaredNorm(),
        kSmallestNoise, 1.0);
  }
  offset_ = OffsetOf(rest, lines.tied, kRoomOfRest);
  mean_ = std::make_unique<AmbientMean>(record, dynamics_, std::move(transform),
                                        scales_, num_threads);
}

void AmbientCost::SetLoads(const ModalProperties& modes, double highest) {
  const StructuralModel& model = dynamics_.model();
  loads_ = record_.loads;
  if (loads_.size() == 0 && record_.base.size() == 0) {
    // Modes far above the band take part in little but its stiffness.
    const Eigen::Index near =
        (modes.frequency_hz.array() < kNearBand * highest).count();
    loads_ = record_.correlated && near > 0 && near <= kMostModalLoads
                 ? Matrix(model.mass * modes.mode_shapes.leftCols(near))
                 : Matrix(sensors_.transpose());
  }
  loads_.colwise().normalize();
  const Eigen::Index forces = loads_.cols();
  base_ = record_.base;
  if (base_.size() == 0) base_.resize(dynamics_.num_dofs(), 0);
  const Eigen::Index directions = base_.cols();
  loads_.conservativeResize(dynamics_.num_dofs(), forces + directions);
  direct_ = Matrix::Zero(scales_.size(), forces + directions);
  for (Eigen::Index d = 0; d < directions; ++d) {
    const Vector load = -model.mass * base_.col(d);
    const double unit = 1.0 / std::max(load.norm(), 1e-300);
    base_.col(d) *= unit;
    loads_.col(forces + d) = unit * load;
    for (Eigen::Index c = 0; c < scales_.size(); ++c) {
      if (record_.channels[static_cast<size_t>(c)].quantity ==
          Quantity::kAbsoluteAcceleration) {
        direct_(c, forces + d) = sensors_.row(c).dot(base_.col(d));
      }
    }
  }
}

bool AmbientCost::SetModel(const Vector& free) {
  if (!free.allFinite()) {
    failure_ = "the parameters are not finite";
    return false;
  }
  Vector all = layout_.InitialValues();
  layout_.SetFree(free, &all);
  const Vector theta = all.head(layout_.num_dynamics());
  StructuralDynamics::Prepared prepared;
  if (!dynamics_.Prepare(theta, &prepared, &failure_)) return false;
  const StructuralModel model = dynamics_.CorrectedModel(theta);
  mass_ = model.mass;
  damping_ = model.damping;
  stiffness_ = model.stiffness;
  loads_.rightCols(base_.cols()) = -mass_ * base_;
  if (mean_ != nullptr) {
    if (!mean_->SetPoint(free, &failure_)) return false;
    lines_.SetProducts(mean_->rest());
  }
  return true;
}

Eigen::PartialPivLU<ComplexMatrix> AmbientCost::DynamicStiffness(
    double frequency) const {
  const double w = kTwoPi * frequency;
  ComplexMatrix z(mass_.rows(), mass_.cols());
  z.real() = stiffness_ - w * w * mass_;
  z.imag() = w * damping_;
  return z.partialPivLu();
}

double AmbientCost::NodeFrequency(Eigen::Index line, int node) const {
  if (num_nodes_ == 1) return lines_.frequency[line];
  return lines_.frequency[line] +
         (node == 0 ? -lines_.spread[line] : lines_.spread[line]);
}

ComplexVector AmbientCost::ChannelFactors(double frequency) const {
  const double w = kTwoPi * frequency;
  ComplexVector factors(scales_.size());
  for (Eigen::Index c = 0; c < factors.size(); ++c) {
    const Complex factor = derivatives_[c] == 2.0   ? Complex(-w * w, 0.0)
                           : derivatives_[c] == 1.0 ? Complex(0.0, w)
                                                    : Complex(1.0, 0.0);
    factors[c] = factor / scales_[c];
  }
  return factors;
}

void AmbientCost::FindTransfer(bool all) {
  transfer_.resize(static_cast<size_t>(num_lines()));
  const ComplexMatrix loads = loads_.cast<Complex>();
  const ComplexMatrix direct =
      (scales_.cwiseInverse().asDiagonal() * direct_).cast<Complex>();
  ParallelFor(kPieces, num_threads_, [&](int piece, int) {
    if (!all && RankOf(piece) != communicator_.rank()) return;
    for (Eigen::Index k = FirstLine(piece); k < FirstLine(piece + 1); ++k) {
      ComplexMatrix& h = transfer_[static_cast<size_t>(k)];
      h.resize(scales_.size(), num_nodes_ * loads.cols());
      for (int node = 0; node < num_nodes_; ++node) {
        const double f = NodeFrequency(k, node);
        h.middleCols(node * loads.cols(), loads.cols()) =
            ChannelFactors(f).asDiagonal() *
                (sensors_ * DynamicStiffness(f).solve(loads)) +
            direct;
      }
      h /= std::sqrt(static_cast<double>(num_nodes_));
    }
  });
}

std::vector<Matrix> AmbientCost::KnotCovariances() const {
  std::vector<Matrix> covariances;
  for (int b = 0; b < spectrum_->num_knots(); ++b) {
    const Matrix root = spectrum_->Root(unknowns_, b);
    covariances.push_back(root * root.transpose());
  }
  return covariances;
}

Matrix AmbientCost::LoadCovariance(double frequency,
                                   const std::vector<Matrix>& at_knots) const {
  double below = 0.0;
  double above = 0.0;
  const size_t knot =
      static_cast<size_t>(spectrum_->Weigh(frequency, &below, &above));
  Matrix covariance = below * at_knots[knot];
  if (above > 0.0) covariance += above * at_knots[knot + 1];
  return covariance;
}

bool AmbientCost::FactorizeLine(Eigen::Index line, const Matrix& loads,
                                Eigen::LLT<ComplexMatrix>* factor) const {
  const ComplexMatrix& h = transfer_[static_cast<size_t>(line)];
  const auto rows = RealRows(h);
  const Eigen::Index areas = loads.cols();
  Matrix half(rows.rows(), rows.cols());
  for (int node = 0; node < num_nodes_; ++node) {
    half.middleCols(node * areas, areas).noalias() =
        rows.middleCols(node * areas, areas) * loads;
  }
  const Matrix product = half * rows.transpose();
  ComplexMatrix s(h.rows(), h.rows());
  for (Eigen::Index j = 0; j < h.rows(); ++j) {
    for (Eigen::Index i = j; i < h.rows(); ++i) {
      s(i, j) = {product(2 * i, 2 * j) + product(2 * i + 1, 2 * j + 1),
                 product(2 * i + 1, 2 * j) - product(2 * i, 2 * j + 1)};
    }
    s(j, j) += std::exp(2.0 * unknowns_[spectrum_->num_unknowns() + j]);
  }
  factor->compute(s);
  return factor->info() == Eigen::Success;
}

bool AmbientCost::Evaluate(const Vector& free, double* cost) {
  if (unknowns_known_ && evaluated_at_.size() == free.size() &&
      evaluated_at_ == free) {
    *cost = evaluated_cost_;
    return true;
  }
  evaluated_at_.resize(0);
  if (!SetModel(free)) return false;
  // The first guess looks at all lines.
  FindTransfer(/*all=*/!unknowns_known_);
  if (!unknowns_known_) {
    if (!FirstUnknowns(cost)) return false;
  } else {
    if (linearized_at_.size() == free.size()) {
      unknowns_ = Moved(unknowns_there_, follow_ * (free - linearized_at_));
    }
    if (!FitUnknowns(cost)) {
      if (linearized_at_.size() != free.size()) return false;
      // Too far away for a straight line.
      unknowns_ = unknowns_there_;
      if (!FitUnknowns(cost)) return false;
    }
  }
  evaluated_at_ = free;
  evaluated_cost_ = *cost;
  return true;
}

bool AmbientCost::Linearize(const Vector& free, CondensedSystem* system) {
  if (linearized_at_.size() == free.size() && linearized_at_ == free) {
    *system = linearized_;
    return true;
  }
  double cost = 0.0;
  double ignored = 0.0;
  Sums sums;
  if (!Evaluate(free, &cost) ||
      (mean_ != nullptr && !mean_->SetSlopes(free, &failure_)) ||
      !Accumulate(true, &ignored, &sums)) {
    return false;
  }
  HoldNoise(&sums);
  const Eigen::Index nuisance = num_nuisance();
  const Eigen::Index groups = static_cast<Eigen::Index>(columns_.size());
  const Matrix cross = sums.information.bottomLeftCorner(groups, nuisance);
  const InformationSolver solver(
      sums.information.topLeftCorner(nuisance, nuisance));
  if (!solver.ok()) {
    failure_ = "the information on loads and noise is not positive definite";
    return false;
  }
  FindInformationLeft(sums.information);
  // Rows: what a group's score owes to loads and noise.
  const Matrix owed = solver.Solve(cross.transpose()).transpose();
  const Vector gradient =
      sums.gradient.tail(groups) - owed * sums.gradient.head(nuisance);
  Matrix hessian = sums.information.bottomRightCorner(groups, groups) -
                   owed * cross.transpose();
  hessian = (0.5 * (hessian + hessian.transpose())).eval();
  Matrix projection(groups, nuisance + groups);
  projection << -owed, Matrix::Identity(groups, groups);
  const Matrix products = projection * sums.products * projection.transpose();
  const int num_free = layout_.num_free();
  system->cost = cost;
  system->gradient = Vector::Zero(num_free);
  system->hessian = Matrix::Zero(num_free, num_free);
  score_products_ = Matrix::Zero(num_free, num_free);
  follow_ = Matrix::Zero(nuisance, num_free);
  for (Eigen::Index i = 0; i < groups; ++i) {
    const int a = columns_[static_cast<size_t>(i)].free;
    system->gradient[a] = gradient[i];
    follow_.col(a) = -owed.row(i).transpose();
    for (Eigen::Index j = 0; j < groups; ++j) {
      const int b = columns_[static_cast<size_t>(j)].free;
      system->hessian(a, b) = hessian(i, j);
      score_products_(a, b) = products(i, j);
    }
  }
  if (!system->gradient.allFinite() || !system->hessian.allFinite()) {
    return false;
  }
  information_ = system->hessian;
  linearized_at_ = free;
  linearized_ = *system;
  unknowns_there_ = unknowns_;
  return true;
}

}  // namespace pinode
