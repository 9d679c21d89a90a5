#include "pinode/estimate/ambient_cost.h"

#include <algorithm>
#include <cmath>
#include <complex>

#include "pinode/base/constants.h"
#include "pinode/base/parallel_for.h"
#include "pinode/base/statistics.h"
#include "pinode/structure/modal_analysis.h"

namespace pinode {
namespace {

using Complex = std::complex<double>;
using ComplexMatrix = Eigen::MatrixXcd;
using ComplexVector = Eigen::VectorXcd;

// Of the model's lowest and highest frequency, and of half the sampling rate.
constexpr double kBelowLowest = 0.3;
constexpr double kAboveHighest = 1.5;
constexpr double kBelowNyquist = 0.8;
// Neighbouring lines that share a score: the taper ties them together.
constexpr Eigen::Index kStretch = 8;
// Pieces that threads take; a fixed number, so that sums are the same.
constexpr int kPieces = 16;
// Of the fit of loads and noise: iterations, and what it may leave of the cost.
constexpr int kMostIterations = 60;
constexpr double kCostLeft = 1e-6;
// Of a channel's density over that of the band: noise below it makes no
// difference.
constexpr double kSmallestNoise = 1e-7;
// Damping ratios for which lines are taken together: half that of the model's
// least damped mode, within these.
constexpr double kLeastDamping = 5e-4;
constexpr double kMostDamping = 0.01;
// Parts of the band that are looked at for themselves, and points of a figure.
constexpr Eigen::Index kMostParts = 40;
constexpr Eigen::Index kGridPoints = 400;
// By how much the taper makes powers of neighbouring lines fluctuate together:
// sum h^4 / (sum h^2)^2 times the samples.
constexpr double kTaperedLines = 1.06;

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

// b_i >= 0 of (A + ridge) x = b for an information matrix of any units.
Eigen::LDLT<Matrix> Factorize(const Matrix& information, double damping) {
  Matrix matrix = information;
  const double floor = 1e-12 * information.diagonal().maxCoeff();
  matrix.diagonal().array() +=
      (damping + 1e-10) * information.diagonal().array() + floor;
  return matrix.ldlt();
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

// By loads and noise, then groups.
struct AmbientCost::Sums {
  Vector gradient;
  Matrix information;
  Matrix products;

  explicit Sums(int size = 0)
      : gradient(Vector::Zero(size)),
        information(Matrix::Zero(size, size)),
        products(Matrix::Zero(size, size)) {}
  void Add(const Sums& other) {
    gradient += other.gradient;
    information += other.information;
    products += other.products;
  }
};

AmbientCost::AmbientCost(const AmbientRecord& record,
                         const StructuralDynamics& dynamics,
                         const ParameterLayout& layout, int num_threads)
    : record_(record),
      dynamics_(dynamics),
      layout_(layout),
      num_threads_(num_threads) {
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
  loads_ =
      record.loads.size() > 0 ? record.loads : Matrix(sensors_.transpose());
  loads_.colwise().normalize();
  for (size_t j = 0; j < dynamics.groups().size(); ++j) {
    const GroupTerm& term = dynamics.groups()[j];
    const int free = layout.FreeIndex(static_cast<int>(j));
    if (free < 0 || term.follows != GroupTerm::Follows::kNothing) continue;
    columns_.push_back({free, term.group.target, &term.group.matrix});
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

void AmbientCost::FindTransfer() {
  transfer_.resize(static_cast<size_t>(num_lines()));
  const ComplexMatrix loads = loads_.cast<Complex>();
  ParallelFor(kPieces, num_threads_, [&](int piece, int) {
    const size_t last =
        transfer_.size() * static_cast<size_t>(piece + 1) / kPieces;
    for (size_t k = transfer_.size() * static_cast<size_t>(piece) / kPieces;
         k < last; ++k) {
      const double f = lines_.frequency[static_cast<Eigen::Index>(k)];
      transfer_[k] = ChannelFactors(f).asDiagonal() *
                     (sensors_ * DynamicStiffness(f).solve(loads));
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

bool AmbientCost::AccumulateLines(Eigen::Index first, Eigen::Index last,
                                  bool with_groups, double* cost,
                                  Sums* sums) const {
  const Eigen::Index channels = scales_.size();
  const Eigen::Index square = channels * channels;
  const int per_knot = spectrum_->per_knot();
  const int loads = spectrum_->num_unknowns();
  const Eigen::Index groups =
      with_groups ? static_cast<Eigen::Index>(columns_.size()) : 0;
  const Eigen::Index active = 2 * per_knot + channels + groups;
  Matrix rows(square * kStretch, active);
  Vector misfit(square * kStretch);
  std::vector<int> places(static_cast<size_t>(active));
  *cost = 0.0;
  const ComplexMatrix load_columns = loads_.cast<Complex>();
  const ComplexMatrix sensor_columns = sensors_.transpose().cast<Complex>();
  Eigen::LLT<ComplexMatrix> factor;
  Eigen::Index begin = first;
  while (begin < last) {
    // Lines between the same two knots.
    double below = 0.0;
    double above = 0.0;
    const int knot = spectrum_->Weigh(lines_.frequency[begin], &below, &above);
    Eigen::Index end = begin;
    while (end < std::min(last, begin + kStretch) &&
           spectrum_->Weigh(lines_.frequency[end], &below, &above) == knot) {
      ++end;
    }
    const Matrix root = spectrum_->Root(unknowns_, knot);
    const bool two = spectrum_->num_knots() > 1;
    const Matrix next_root =
        two ? spectrum_->Root(unknowns_, knot + 1) : Matrix(root);
    for (Eigen::Index k = begin; k < end; ++k) {
      if (!FactorizeLine(k, &factor)) return false;
      const auto lower = factor.matrixL();
      const double count = lines_.count[k];
      // L^-1 (sum Y Y^H) L^-H.
      ComplexMatrix powers =
          lower.solve(lines_.products[static_cast<size_t>(k)]);
      powers = lower.solve(powers.adjoint().eval());
      *cost += 2.0 * count *
                   factor.matrixLLT().diagonal().real().array().log().sum() +
               powers.diagonal().real().sum();
      if (sums == nullptr) continue;
      spectrum_->Weigh(lines_.frequency[k], &below, &above);
      const ComplexMatrix h = lower.solve(transfer_[static_cast<size_t>(k)]);
      const ComplexMatrix inverse =
          lower.solve(ComplexMatrix::Identity(channels, channels));
      const Eigen::Index place = (k - begin) * square;
      const double weight_of_lines = std::sqrt(count);
      Flatten((count * ComplexMatrix::Identity(channels, channels) - powers) /
                  weight_of_lines,
              misfit.segment(place, square));
      Eigen::Index column = 0;
      const auto set = [&](const ComplexMatrix& w) {
        Flatten(weight_of_lines * w, rows.col(column++).segment(place, square));
      };
      for (int side = 0; side < 2; ++side) {
        const double weight = side == 0 ? below : (two ? above : 0.0);
        const ComplexMatrix g = h * (side == 0 ? root : next_root);
        for (const auto& [i, j] : spectrum_->entries()) {
          const ComplexMatrix half = weight * h.col(i) * g.col(j).adjoint();
          set(half + half.adjoint());
        }
      }
      for (Eigen::Index c = 0; c < channels; ++c) {
        set(2.0 * std::exp(2.0 * unknowns_[loads + c]) * inverse.col(c) *
            inverse.col(c).adjoint());
      }
      if (groups == 0) continue;
      const double f = lines_.frequency[k];
      const double w = kTwoPi * f;
      const auto stiffness = DynamicStiffness(f);
      const ComplexMatrix by_loads = stiffness.solve(load_columns);
      const ComplexMatrix by_sensors = stiffness.solve(sensor_columns);
      ComplexMatrix covariance =
          below * (root * root.transpose()).cast<Complex>();
      if (two) {
        covariance +=
            above * (next_root * next_root.transpose()).cast<Complex>();
      }
      const ComplexMatrix right = covariance * h.adjoint();
      const ComplexMatrix left = lower.solve(ComplexMatrix(
          ChannelFactors(f).asDiagonal() * by_sensors.transpose()));
      const ComplexMatrix moved = by_loads * right;
      for (const Column& group : columns_) {
        const Complex by = group.target == MatrixGroup::Target::kStiffness
                               ? Complex(1.0, 0.0)
                           : group.target == MatrixGroup::Target::kDamping
                               ? Complex(0.0, w)
                               : Complex(-w * w, 0.0);
        const ComplexMatrix half =
            -by * (left * (group.matrix->cast<Complex>() * moved));
        set(half + half.adjoint());
      }
    }
    if (sums != nullptr) {
      size_t at = 0;
      for (int side = 0; side < 2; ++side) {
        // Without a second knot its rows are zero.
        const int from = (two ? knot + side : 0) * per_knot;
        for (int e = 0; e < per_knot; ++e) places[at++] = from + e;
      }
      for (Eigen::Index i = 0; i < channels + groups; ++i) {
        places[at++] = loads + static_cast<int>(i);
      }
      const auto part = rows.topRows((end - begin) * square);
      const Vector score =
          part.transpose() * misfit.head((end - begin) * square);
      const Matrix information = part.transpose() * part;
      for (size_t i = 0; i < places.size(); ++i) {
        sums->gradient[places[i]] += score[static_cast<Eigen::Index>(i)];
        for (size_t j = 0; j < places.size(); ++j) {
          const Eigen::Index a = static_cast<Eigen::Index>(i);
          const Eigen::Index b = static_cast<Eigen::Index>(j);
          sums->information(places[i], places[j]) += information(a, b);
          sums->products(places[i], places[j]) += score[a] * score[b];
        }
      }
    }
    begin = end;
  }
  return std::isfinite(*cost);
}

bool AmbientCost::Accumulate(bool with_groups, double* cost, Sums* sums) const {
  const int size =
      num_nuisance() + (with_groups ? static_cast<int>(columns_.size()) : 0);
  std::vector<Sums> parts(kPieces, Sums(sums != nullptr ? size : 0));
  std::vector<double> costs(kPieces, 0.0);
  std::vector<char> ok(kPieces, 1);
  const Eigen::Index lines = num_lines();
  ParallelFor(kPieces, num_threads_, [&](int piece, int) {
    const size_t p = static_cast<size_t>(piece);
    ok[p] = AccumulateLines(lines * piece / kPieces,
                            lines * (piece + 1) / kPieces, with_groups,
                            &costs[p], sums != nullptr ? &parts[p] : nullptr);
  });
  *cost = offset_;
  if (sums != nullptr) *sums = Sums(size);
  for (size_t p = 0; p < kPieces; ++p) {
    if (!ok[p]) return false;
    *cost += costs[p];
    if (sums != nullptr) sums->Add(parts[p]);
  }
  return std::isfinite(*cost);
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
  unknowns_ << spectrum_->Uniform(0.5 * measured / std::max(unit, 1e-300)),
      Vector::Zero(scales_.size());
  for (Eigen::Index c = 0; c < scales_.size(); ++c) {
    std::vector<double> powers;
    for (Eigen::Index k = 0; k < num_lines(); ++k) {
      powers.push_back(lines_.products[static_cast<size_t>(k)](c, c).real() /
                       lines_.count[k]);
    }
    const auto middle = powers.begin() + static_cast<long>(powers.size() / 2);
    std::nth_element(powers.begin(), middle, powers.end());
    unknowns_[spectrum_->num_unknowns() + c] =
        0.5 * std::log(std::max(0.1 * *middle, kSmallestNoise));
  }
  unknowns_known_ = true;
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
    sums->products.row(c).setZero();
    sums->products.col(c).setZero();
  }
}

bool AmbientCost::FitUnknowns(double* cost) {
  failure_ = "the spectrum of the channels is not positive definite";
  Sums sums;
  if (!Accumulate(false, cost, &sums)) return false;
  double damping = 1e-4;
  const double smallest = SmallestNoise();
  const Eigen::Index noise = scales_.size();
  for (int iteration = 0; iteration < kMostIterations; ++iteration) {
    HoldNoise(&sums);
    const Vector step =
        Factorize(sums.information, damping).solve(-sums.gradient);
    const double promised = -0.5 * sums.gradient.dot(step);
    if (!(promised > kCostLeft) && damping <= 1e-4) break;
    const Vector before = unknowns_;
    unknowns_ += step;
    unknowns_.tail(noise) = unknowns_.tail(noise).cwiseMax(smallest);
    double next = 0.0;
    Sums next_sums;
    if (unknowns_.allFinite() && Accumulate(false, &next, &next_sums) &&
        next <= *cost) {
      const bool done = *cost - next < kCostLeft && damping <= 1e-2;
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

bool AmbientCost::Evaluate(const Vector& free, double* cost) {
  if (!SetModel(free)) return false;
  FindTransfer();
  if (!unknowns_known_) {
    StartUnknowns();
    if (!FitUnknowns(cost)) {
      unknowns_known_ = false;
      return false;
    }
    spectrum_->SetPowers(unknowns_);
  } else if (linearized_at_.size() == free.size()) {
    unknowns_ = unknowns_there_ + follow_ * (free - linearized_at_);
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
  const Eigen::LDLT<Matrix> factor =
      Factorize(sums.information.topLeftCorner(nuisance, nuisance), 0.0);
  // Rows: what a group's score owes to loads and noise.
  const Matrix owed = factor.solve(cross.transpose()).transpose();
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

bool AmbientCost::Score(const Vector& free, AmbientScore* score) {
  double cost = 0.0;
  if (!Evaluate(free, &cost)) return false;
  const Eigen::Index channels = scales_.size();
  const Eigen::Index lines = num_lines();
  *score = AmbientScore();
  score->name = record_.name;
  score->lowest_frequency = lines_.frequency[0];
  score->highest_frequency = lines_.frequency[lines - 1];
  score->num_lines = static_cast<int>(total_lines_);
  score->explained = Vector::Zero(channels);
  const Eigen::Index parts =
      std::clamp<Eigen::Index>(lines / (8 * channels + 40), 1, kMostParts);
  const Eigen::Index points = std::min<Eigen::Index>(lines, kGridPoints);
  score->frequencies = Vector::Zero(points);
  score->measured = Matrix::Zero(channels, points);
  score->modelled = Matrix::Zero(channels, points);
  score->lines = Vector::Zero(points);
  std::vector<ComplexMatrix> products(static_cast<size_t>(parts),
                                      ComplexMatrix::Zero(channels, channels));
  std::vector<double> counts(static_cast<size_t>(parts), 0.0);
  std::vector<double> starts(static_cast<size_t>(parts), kInfinity);
  std::vector<double> ends(static_cast<size_t>(parts), 0.0);
  double seen = 0.0;
  Vector total = Vector::Zero(channels);
  Eigen::LLT<ComplexMatrix> factor;
  for (Eigen::Index k = 0; k < lines; ++k) {
    if (!FactorizeLine(k, &factor)) return false;
    const ComplexMatrix& y = lines_.products[static_cast<size_t>(k)];
    const ComplexMatrix half = factor.matrixL().solve(y);
    const size_t part = std::min(
        products.size() - 1,
        static_cast<size_t>(seen * static_cast<double>(parts) / total_lines_));
    const double count = lines_.count[k];
    seen += count;
    products[part] += factor.matrixL().solve(half.adjoint().eval());
    counts[part] += count;
    starts[part] = std::min(starts[part], lines_.frequency[k]);
    ends[part] = std::max(ends[part], lines_.frequency[k]);
    const Eigen::Index point = k * points / lines;
    const Vector power = factor.reconstructedMatrix().diagonal().real();
    score->frequencies[point] += count * lines_.frequency[k];
    score->measured.col(point) += y.diagonal().real();
    score->modelled.col(point) += count * power;
    score->lines[point] += count;
    total += count * power;
    for (Eigen::Index c = 0; c < channels; ++c) {
      score->explained[c] +=
          count *
          (power[c] - std::exp(2.0 * unknowns_[spectrum_->num_unknowns() + c]));
    }
  }
  score->frequencies.array() /= score->lines.array();
  for (Matrix* density : {&score->measured, &score->modelled}) {
    for (Eigen::Index point = 0; point < points; ++point) {
      density->col(point) =
          density->col(point).cwiseProduct(scales_.cwiseAbs2()) /
          score->lines[point];
    }
  }
  score->explained.array() /= total.array();
  score->noise_sigma.resize(channels);
  for (Eigen::Index c = 0; c < channels; ++c) {
    score->channels.push_back(record_.channels[static_cast<size_t>(c)].name);
    // A one-sided density up to half the sampling rate.
    score->noise_sigma[c] = scales_[c] *
                            std::exp(unknowns_[spectrum_->num_unknowns() + c]) *
                            std::sqrt(0.5 / record_.sampling_step);
  }
  // n |Q - I|^2 of the mean Q of n products z z^H has the expectation
  // channels^2, and the variance 2 channels^2 of a chi^2, where n is large.
  const double square = static_cast<double>(channels * channels);
  for (size_t p = 0; p < products.size(); ++p) {
    if (counts[p] == 0.0) continue;
    const ComplexMatrix off =
        products[p] / counts[p] - ComplexMatrix::Identity(channels, channels);
    const double value = counts[p] / kTaperedLines * off.squaredNorm();
    score->chi_square += value;
    const double deviation = (value - square) / std::sqrt(2.0 * square);
    if (p == 0 || deviation > score->worst_deviation) {
      score->worst_deviation = deviation;
      score->worst_from = starts[p];
      score->worst_to = ends[p];
    }
  }
  score->degrees_of_freedom =
      std::max(1, static_cast<int>(square * static_cast<double>(parts)) -
                      num_nuisance() - static_cast<int>(columns_.size()));
  score->probability =
      ChiSquareProbability(score->chi_square, score->degrees_of_freedom);
  return true;
}

}  // namespace pinode
