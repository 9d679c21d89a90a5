#include "pinode/estimate/ambient_cost.h"

#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <complex>

#include "pinode/base/constants.h"
#include "pinode/base/parallel_for.h"
#include "pinode/base/statistics.h"
#include "pinode/estimate/load_information.h"
#include "pinode/structure/modal_analysis.h"

namespace pinode {
namespace {

using Complex = std::complex<double>;

// Of the model's lowest and highest frequency, and of half the sampling rate.
constexpr double kBelowLowest = 0.3;
constexpr double kAboveHighest = 1.5;
constexpr double kBelowNyquist = 0.8;
// Of the fit of loads and noise: iterations, and what it may leave of the cost.
constexpr int kMostIterations = 40;
constexpr double kCostLeft = 0.01;
// Of a channel's density over that of the band: noise below it makes no
// difference.
constexpr double kSmallestNoise = 1e-7;
// Of the largest pivot of a group's matrix: nothing below it.
constexpr double kSmallestPivot = 1e-13;
// Modes up to so much of the band's end are loaded each for itself, if no more
// than these.
constexpr double kNearBand = 1.5;
constexpr Eigen::Index kMostModalLoads = 24;
// Lines over whose mean noise is looked for.
constexpr double kLinesOfNoise = 32.0;
// What the intensities that covariances are held to weigh, in lines; the least
// of one beside that at the next knot, and beside the mean of all.
constexpr double kPriorLines = 2.0;
constexpr double kLeastOfNeighbour = 0.1;
constexpr double kLeastOfMean = 1e-3;
// Damping ratios for which lines are taken together: half that of the model's
// least damped mode, within these.
constexpr double kLeastDamping = 5e-4;
constexpr double kMostDamping = 0.01;

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

// Solves with an information matrix whose unknowns have any units; `damping` is
// relative to its diagonal.
class InformationSolver {
 public:
  InformationSolver(const Matrix& information, double damping)
      : scale_(information.rows()) {
    for (Eigen::Index i = 0; i < scale_.size(); ++i) {
      const double own = information(i, i);
      scale_[i] = own > 0.0 ? 1.0 / std::sqrt(own) : 0.0;
    }
    Matrix scaled = scale_.asDiagonal() * information * scale_.asDiagonal();
    scaled.diagonal().setConstant(1.0 + damping + kRidge);
    factor_.compute(scaled);
  }
  // False where rounding has made it indefinite.
  bool ok() const { return factor_.info() == Eigen::Success; }
  Matrix Solve(const Matrix& right) const {
    return scale_.asDiagonal() *
           factor_.solve(Matrix(scale_.asDiagonal() * right));
  }

 private:
  static constexpr double kRidge = 1e-10;
  Vector scale_;
  Eigen::LLT<Matrix> factor_;
};

// G = left right^T with as few columns as G has rank, or G itself.
void FindFactors(const Matrix& g, ComplexMatrix* left, ComplexMatrix* right) {
  Eigen::ColPivHouseholderQR<Matrix> factor(g.rows(), g.cols());
  factor.setThreshold(kSmallestPivot);
  factor.compute(g);
  const Eigen::Index rank = factor.rank();
  if (2 * rank < g.rows()) {
    const Matrix q = factor.householderQ() * Matrix::Identity(g.rows(), rank);
    const Matrix upper =
        factor.matrixR().topRows(rank).triangularView<Eigen::Upper>();
    *left = q.cast<Complex>();
    *right = (factor.colsPermutation() * upper.transpose()).cast<Complex>();
  } else {
    *left = g.cast<Complex>();
    *right = ComplexMatrix::Identity(g.rows(), g.rows());
  }
}

// The cost of a model as good as the means of neighbouring lines, and room
// below: what makes all costs positive.
double OffsetOf(const SpectralLines& lines) {
  const Eigen::Index channels = lines.values.rows();
  const Eigen::Index stretch = 2 * channels + 8;
  double cost = 0.0;
  for (Eigen::Index first = 0; first < lines.values.cols(); first += stretch) {
    const Eigen::Index count = std::min(stretch, lines.values.cols() - first);
    const auto y = lines.values.middleCols(first, count);
    ComplexMatrix mean = y * y.adjoint() / static_cast<double>(count);
    mean.diagonal().array() += 1e-9 * mean.diagonal().real().mean() + 1e-300;
    const Eigen::LLT<ComplexMatrix> factor(mean);
    const Matrix diagonal = factor.matrixLLT().diagonal().real();
    cost += static_cast<double>(count) *
            (2.0 * diagonal.array().max(1e-300).log().sum() +
             static_cast<double>(channels));
  }
  return 3.0 * static_cast<double>(channels * lines.values.cols()) - cost;
}

}  // namespace

AmbientCost::AmbientCost(const AmbientRecord& record,
                         const StructuralDynamics& dynamics,
                         const ParameterLayout& layout, int num_threads,
                         Communicator* communicator)
    : record_(record),
      dynamics_(dynamics),
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
  for (size_t j = 0; j < dynamics.groups().size(); ++j) {
    const GroupTerm& term = dynamics.groups()[j];
    const int free = layout.FreeIndex(static_cast<int>(j));
    if (free < 0 || term.follows != GroupTerm::Follows::kNothing) continue;
    Column column;
    column.free = free;
    column.target = term.group.target;
    FindFactors(term.group.matrix, &column.left, &column.right);
    columns_.push_back(std::move(column));
  }
  double lowest = record.lowest_frequency;
  double highest = record.highest_frequency;
  const double nyquist = 0.5 / record.sampling_step;
  const StructuralModel model = dynamics.CorrectedModel(dynamics.Parameters());
  ModalProperties modes;
  std::string ignored;
  Vector frequencies;
  if (ComputeModes(model.mass, model.damping, model.stiffness, &modes,
                   &ignored)) {
    frequencies = modes.frequency_hz;
  }
  const double ten_lines = 10.0 / (static_cast<double>(record.samples.cols()) *
                                   record.sampling_step);
  if (lowest == 0.0) {
    lowest = ten_lines;
    for (const double f : frequencies) {
      if (f > 0.0) {
        lowest = std::max(ten_lines, kBelowLowest * f);
        break;
      }
    }
    lowest = std::min(lowest, 0.1 * nyquist);
  }
  if (highest == 0.0) {
    highest = kBelowNyquist * nyquist;
    if (frequencies.size() > 0 && frequencies.tail(1)[0] > 0.0) {
      highest = std::min(highest, kAboveHighest * frequencies.tail(1)[0]);
    }
    highest = std::max(highest, 2.0 * lowest);
  }
  SetLoads(modes, highest);
  SpectralLines lines =
      FindSpectralLines(record.samples, record.sampling_step, lowest, highest);
  total_lines_ = static_cast<double>(lines.frequency.size());
  for (Eigen::Index c = 0; c < channels; ++c) {
    scales_[c] = std::sqrt(std::max(
        lines.values.row(c).squaredNorm() / std::max(1.0, total_lines_),
        1e-300));
    lines.values.row(c) /= scales_[c];
  }
  double ratio = kMostDamping;
  for (const double found : modes.damping_ratio) {
    if (found > 0.0) ratio = std::min(ratio, 0.5 * found);
  }
  lines_ = GroupLines(lines, 0.25 * std::max(ratio, kLeastDamping));
  const int knots = record.knots > 0
                        ? record.knots
                        : std::max(2, 1 + static_cast<int>(std::lround(
                                              std::log2(highest / lowest))));
  spectrum_ = std::make_unique<LoadSpectrum>(lowest, highest, knots,
                                             static_cast<int>(loads_.cols()),
                                             record.correlated);
  offset_ = OffsetOf(lines);
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
      const double f = lines_.frequency[k];
      transfer_[static_cast<size_t>(k)] =
          ChannelFactors(f).asDiagonal() *
              (sensors_ * DynamicStiffness(f).solve(loads)) +
          direct;
    }
  });
}

bool AmbientCost::FactorizeLine(Eigen::Index line,
                                Eigen::LLT<ComplexMatrix>* factor) const {
  const ComplexMatrix& h = transfer_[static_cast<size_t>(line)];
  double first = 0.0;
  double above = 0.0;
  const int knot = spectrum_->Weigh(lines_.frequency[line], &first, &above);
  ComplexMatrix s = ComplexMatrix::Zero(h.rows(), h.rows());
  const ComplexMatrix below = h * spectrum_->Root(unknowns_, knot);
  s.noalias() += first * below * below.adjoint();
  if (above > 0.0) {
    const ComplexMatrix next = h * spectrum_->Root(unknowns_, knot + 1);
    s.noalias() += above * next * next.adjoint();
  }
  for (Eigen::Index c = 0; c < h.rows(); ++c) {
    s(c, c) += std::exp(2.0 * unknowns_[spectrum_->num_unknowns() + c]);
  }
  factor->compute(s);
  return factor->info() == Eigen::Success;
}

void AmbientCost::StartUnknowns() {
  double measured = 0.0;
  double unit = 0.0;
  for (size_t k = 0; k < transfer_.size(); ++k) {
    unit +=
        lines_.count[static_cast<Eigen::Index>(k)] * transfer_[k].squaredNorm();
    measured += lines_.products[k].diagonal().real().sum();
  }
  unknowns_.resize(spectrum_->num_unknowns() + scales_.size());
  unknowns_ << spectrum_->Intensities(
      Matrix::Constant(spectrum_->num_areas(), spectrum_->num_knots(),
                       0.5 * measured / std::max(unit, 1e-300))),
      Vector::Zero(scales_.size());
  // Noise is no more than the least of the density.
  for (Eigen::Index c = 0; c < scales_.size(); ++c) {
    double least = kInfinity;
    double sum = 0.0;
    double count = 0.0;
    for (Eigen::Index k = 0; k < num_lines(); ++k) {
      sum += lines_.products[static_cast<size_t>(k)](c, c).real();
      count += lines_.count[k];
      if (count < kLinesOfNoise) continue;
      least = std::min(least, sum / count);
      sum = count = 0.0;
    }
    if (!std::isfinite(least)) least = sum / std::max(1.0, count);
    unknowns_[spectrum_->num_unknowns() + c] =
        0.5 * std::log(std::max(0.5 * least, kSmallestNoise));
  }
}

double AmbientCost::SmallestNoise() const {
  return 0.5 * std::log(kSmallestNoise);
}

void AmbientCost::HoldNoise(Sums* sums) const {
  const Eigen::Index loads = spectrum_->num_unknowns();
  for (Eigen::Index c = loads; c < unknowns_.size(); ++c) {
    if (unknowns_[c] > SmallestNoise() || sums->gradient[c] < 0.0) continue;
    sums->gradient[c] = 0.0;
    sums->information.row(c).setZero();
    sums->information.col(c).setZero();
    sums->information(c, c) = 1.0;
    if (sums->products.size() == 0) continue;
    sums->products.row(c).setZero();
    sums->products.col(c).setZero();
  }
}

void AmbientCost::AddPrior(double* cost, Sums* sums) const {
  const Eigen::Index per_knot = spectrum_->per_knot();
  for (Eigen::Index b = 0; b < prior_.cols(); ++b) {
    const Matrix root = spectrum_->Root(unknowns_, static_cast<int>(b));
    const Matrix half = root.triangularView<Eigen::Lower>().solve(
        Matrix(prior_.col(b).cwiseSqrt().asDiagonal()));
    const Matrix inverse = root.triangularView<Eigen::Lower>().solve(
        Matrix::Identity(root.rows(), root.cols()));
    *cost += kPriorLines * (2.0 * root.diagonal().array().abs().log().sum() +
                            half.squaredNorm());
    if (sums == nullptr) continue;
    const Matrix precision = inverse.transpose() * inverse;
    const Matrix pull = precision * prior_.col(b).asDiagonal() * precision;
    sums->gradient.segment(b * per_knot, per_knot) +=
        ByLoadEntries(*spectrum_, root, kPriorLines * (precision - pull));
    LoadInformation information(*spectrum_);
    information.Add(precision.cast<Complex>(), kPriorLines, 1.0, 0.0);
    sums->information.block(b * per_knot, b * per_knot, per_knot, per_knot) +=
        information.Finish(root, root).topLeftCorner(per_knot, per_knot);
  }
}

Vector AmbientCost::Moved(const Vector& unknowns, const Vector& step) const {
  constexpr double kMostFall = 0.1;  // of a variance
  const Eigen::Index noise = scales_.size();
  const Eigen::Index loads = unknowns.size() - noise;
  Vector moved(unknowns.size());
  moved << spectrum_->Moved(unknowns.head(loads), step.head(loads)),
      (unknowns.tail(noise).array() +
       0.5 * (1.0 + 2.0 * step.tail(noise).array()).max(kMostFall).log())
          .max(SmallestNoise());
  return moved;
}

bool AmbientCost::FitUnknowns(double* cost) {
  failure_ = "the spectrum of the channels is not positive definite";
  Sums sums;
  if (!Accumulate(false, cost, &sums)) return false;
  double damping = 1e-4;
  for (int iteration = 0; iteration < kMostIterations; ++iteration) {
    HoldNoise(&sums);
    const InformationSolver solver(sums.information, damping);
    if (!solver.ok()) {
      damping = std::max(1e-6, 10.0 * damping);
      if (damping > 1e8) break;
      continue;
    }
    const Vector step = solver.Solve(-sums.gradient);
    const double promised = -0.5 * sums.gradient.dot(step);
    if (!(promised > kCostLeft)) break;
    const Vector before = unknowns_;
    unknowns_ = Moved(before, step);
    double next = 0.0;
    Sums next_sums;
    if (unknowns_.allFinite() && Accumulate(false, &next, &next_sums) &&
        next <= *cost) {
      const bool done = *cost - next < kCostLeft;
      *cost = next;
      sums = std::move(next_sums);
      damping = std::max(1e-9, 0.1 * damping);
      if (done) break;
    } else {
      unknowns_ = before;
      damping = std::max(1e-6, 10.0 * damping);
      if (damping > 1e8) break;
    }
  }
  failure_.clear();
  return true;
}

double AmbientCost::NumFitted() const {
  double ignored = 0.0;
  Sums sums;
  if (!Accumulate(false, &ignored, &sums)) return 0.0;
  Sums prior;
  prior.gradient = Vector::Zero(sums.gradient.size());
  prior.information =
      Matrix::Zero(sums.information.rows(), sums.information.cols());
  AddPrior(&ignored, &prior);
  const InformationSolver solver(sums.information, 0.0);
  const double held =
      solver.ok() ? solver.Solve(prior.information).trace() : 0.0;
  return static_cast<double>(num_nuisance()) - held +
         static_cast<double>(columns_.size());
}

bool AmbientCost::FirstUnknowns(double* cost) {
  prior_.resize(0, 0);
  LoadSpectrum correlated = *spectrum_;
  *spectrum_ = correlated.Uncorrelated();
  StartUnknowns();
  if (!FitUnknowns(cost)) {
    *spectrum_ = correlated;
    return false;
  }
  spectrum_->SetPowers(unknowns_);
  if (correlated.correlated()) {
    const int knots = spectrum_->num_knots();
    Matrix intensities(spectrum_->num_areas(), knots);
    for (int b = 0; b < knots; ++b) {
      intensities.col(b) = spectrum_->Root(unknowns_, b).diagonal().cwiseAbs2();
    }
    prior_ = intensities;
    for (int b = 0; b < knots; ++b) {
      prior_.col(b) =
          prior_.col(b).cwiseMax(kLeastOfMean * intensities.col(b).mean());
      for (const int next : {b - 1, b + 1}) {
        if (next < 0 || next == knots) continue;
        prior_.col(b) =
            prior_.col(b).cwiseMax(kLeastOfNeighbour * intensities.col(next));
      }
    }
    const Vector noise = unknowns_.tail(scales_.size());
    correlated.SetPowers(*spectrum_);
    *spectrum_ = correlated;
    unknowns_.resize(spectrum_->num_unknowns() + noise.size());
    unknowns_ << spectrum_->Intensities(prior_), noise;
  }
  unknowns_known_ = FitUnknowns(cost);
  return unknowns_known_;
}

bool AmbientCost::Evaluate(const Vector& free, double* cost) {
  if (!SetModel(free)) return false;
  // The first guess looks at all lines.
  FindTransfer(/*all=*/!unknowns_known_);
  if (!unknowns_known_) return FirstUnknowns(cost);
  if (linearized_at_.size() == free.size()) {
    unknowns_ = Moved(unknowns_there_, follow_ * (free - linearized_at_));
    double ignored = 0.0;
    // Too far away for a straight line.
    if (!Accumulate(false, &ignored, nullptr)) unknowns_ = unknowns_there_;
  }
  return FitUnknowns(cost);
}

bool AmbientCost::Linearize(const Vector& free, CondensedSystem* system) {
  double cost = 0.0;
  Sums sums;
  if (!Evaluate(free, &cost) || !Accumulate(true, &cost, &sums)) return false;
  HoldNoise(&sums);
  const Eigen::Index nuisance = num_nuisance();
  const Eigen::Index groups = static_cast<Eigen::Index>(columns_.size());
  const Matrix cross = sums.information.bottomLeftCorner(groups, nuisance);
  const InformationSolver solver(
      sums.information.topLeftCorner(nuisance, nuisance), 0.0);
  if (!solver.ok()) {
    failure_ = "the information on loads and noise is not positive definite";
    return false;
  }
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
  information_ = system->hessian;
  linearized_at_ = free;
  unknowns_there_ = unknowns_;
  return system->gradient.allFinite() && system->hessian.allFinite();
}

}  // namespace pinode
