#include "pinode/estimate/ambient/ambient_cost.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <utility>

#include "pinode/estimate/solver/information_solver.h"

namespace pinode {
namespace {

// Information on a combination of groups below this part of the largest is
// none.
constexpr double kNoInformation = 1e-12;
// The part of the prior's weight that stays where it should take no part.
constexpr double kPriorLeft = 0.01;

// The spectrum of the record's loads: as many knots as it says, or one an
// octave of the band.
LoadSpectrum SpectrumOf(const AmbientRecord& record, const AmbientLines& lines,
                        int areas) {
  const int knots =
      record.knots > 0
          ? record.knots
          : std::max(2, 1 + static_cast<int>(std::lround(
                                std::log2(lines.highest() / lines.lowest()))));
  return LoadSpectrum(lines.lowest(), lines.highest(), knots, areas,
                      record.correlated);
}

// The information on the groups that is left where loads and noise are unknown
// and have no prior. `information` is that on loads, noise and groups, with the
// prior.
AmbientCost::InformationLeft FindInformationLeft(const Matrix& information,
                                                 const AmbientLoads& loads) {
  const Eigen::Index nuisance = loads.num_unknowns();
  const Eigen::Index groups = information.rows() - nuisance;
  AmbientCost::InformationLeft result;
  result.by_group = Vector::Zero(groups);
  result.most = groups > 0 ? 0.0 : 1.0;
  if (groups == 0) return result;
  const Matrix known = information.bottomRightCorner(groups, groups);
  const Matrix cross = information.bottomLeftCorner(groups, nuisance);
  // A little of the prior stays, for what no channel sees.
  const InformationSolver solver(information.topLeftCorner(nuisance, nuisance) -
                                 (1.0 - kPriorLeft) *
                                     loads.PriorSums(nullptr).information);
  if (!solver.ok()) return result;
  const Matrix left = known - cross * solver.Solve(cross.transpose());
  // In units in which the known information is one, but for what no load at
  // all would tell.
  const Vector scale = known.diagonal().cwiseMax(1e-300).cwiseSqrt();
  const Eigen::SelfAdjointEigenSolver<Matrix> eigen(
      Matrix(scale.cwiseInverse().asDiagonal() * known *
             scale.cwiseInverse().asDiagonal()));
  const Vector& values = eigen.eigenvalues();
  const Eigen::Index seen = (values.array() > kNoInformation).count();
  if (seen == 0) return result;
  const Matrix basis =
      scale.cwiseInverse().asDiagonal() * eigen.eigenvectors().rightCols(seen) *
      values.tail(seen).cwiseSqrt().cwiseInverse().asDiagonal();
  const Matrix part = basis.transpose() * left * basis;
  const Eigen::SelfAdjointEigenSolver<Matrix> parts(
      Matrix(0.5 * (part + part.transpose())));
  result.most = std::clamp(parts.eigenvalues()[seen - 1], 0.0, 1.0);
  const Vector variances =
      parts.eigenvalues().cwiseMax(kNoInformation).cwiseInverse();
  const Matrix by_part = basis * parts.eigenvectors();
  for (Eigen::Index g = 0; g < groups; ++g) {
    const Vector row = by_part.row(g).transpose().cwiseAbs2();
    const double with_loads = row.dot(variances);
    result.by_group[g] =
        with_loads > 0.0 ? std::min(1.0, row.sum() / with_loads) : 0.0;
  }
  return result;
}

}  // namespace

AmbientCost::InitialModel AmbientCost::MakeInitialModel(
    const AmbientRecord& record, const StructuralDynamics& dynamics) {
  InitialModel initial{record.AveragedDynamics(dynamics), {}};
  const StructuralModel model =
      initial.averaged.CorrectedModel(initial.averaged.Parameters());
  std::string ignored;
  if (!ComputeModes(model.mass, model.damping, model.stiffness, &initial.modes,
                    &ignored)) {
    initial.modes = {};
  }
  return initial;
}

AmbientCost::AmbientCost(const AmbientRecord& record,
                         const StructuralDynamics& dynamics,
                         const ParameterLayout& layout, int num_threads,
                         Communicator* communicator)
    : AmbientCost(record, MakeInitialModel(record, dynamics),
                  record.MeasuredLoads(dynamics), layout, num_threads,
                  communicator) {}

AmbientCost::AmbientCost(const AmbientRecord& record, InitialModel initial,
                         const Matrix& measured_loads,
                         const ParameterLayout& layout, int num_threads,
                         Communicator* communicator)
    : record_(record),
      layout_(layout),
      dynamics_(std::move(initial.averaged)),
      lines_(record, dynamics_, initial.modes, measured_loads, num_threads),
      pieces_(lines_.size(), num_threads, communicator),
      transfer_(record, dynamics_, initial.modes, layout, lines_, pieces_),
      likelihood_(lines_, transfer_, pieces_),
      fit_(likelihood_, SpectrumOf(record, lines_, transfer_.num_areas())) {}

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
  transfer_.SetModel(dynamics_.CorrectedModel(theta));
  return lines_.SetPoint(free, &failure_);
}

bool AmbientCost::FitLoads(const Vector& free, double* cost) {
  if (!fit_.known()) {
    // The first guess looks at all lines.
    transfer_.FindAll();
    return fit_.FindFirst(cost);
  }
  transfer_.FindOwn();
  if (linear_.at.size() != free.size()) {
    return fit_.FindFrom(loads().unknowns(), cost);
  }
  const Vector followed =
      loads().Moved(linear_.unknowns, linear_.follow * (free - linear_.at));
  // The second start is for points too far away for a straight line.
  return fit_.FindFrom(followed, cost) || fit_.FindFrom(linear_.unknowns, cost);
}

bool AmbientCost::Evaluate(const Vector& free, double* cost) {
  if (fit_.known() && evaluated_at_.size() == free.size() &&
      evaluated_at_ == free) {
    *cost = evaluated_cost_;
    return true;
  }
  evaluated_at_.resize(0);
  if (!SetModel(free)) return false;
  if (!FitLoads(free, cost)) {
    failure_ = "the spectrum of the channels is not positive definite";
    return false;
  }
  failure_.clear();
  evaluated_at_ = free;
  evaluated_cost_ = *cost;
  return true;
}

bool AmbientCost::Eliminate(const LikelihoodSums& sums, Linearization* linear) {
  const Eigen::Index nuisance = loads().num_unknowns();
  const Eigen::Index groups = transfer_.num_groups();
  const Matrix cross = sums.information.bottomLeftCorner(groups, nuisance);
  const InformationSolver solver(
      sums.information.topLeftCorner(nuisance, nuisance));
  if (!solver.ok()) {
    failure_ = "the information on loads and noise is not positive definite";
    return false;
  }
  // Rows: the part of a group's score that loads and noise explain.
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
  CondensedSystem& system = linear->system;
  system.gradient = Vector::Zero(num_free);
  system.hessian = Matrix::Zero(num_free, num_free);
  linear->score_products = Matrix::Zero(num_free, num_free);
  linear->follow = Matrix::Zero(nuisance, num_free);
  for (Eigen::Index i = 0; i < groups; ++i) {
    const int a = transfer_.groups()[static_cast<size_t>(i)].free;
    system.gradient[a] += gradient[i];
    linear->follow.col(a) -= owed.row(i).transpose();
    for (Eigen::Index j = 0; j < groups; ++j) {
      const int b = transfer_.groups()[static_cast<size_t>(j)].free;
      system.hessian(a, b) += hessian(i, j);
      linear->score_products(a, b) += products(i, j);
    }
  }
  return system.gradient.allFinite() && system.hessian.allFinite();
}

bool AmbientCost::Linearize(const Vector& free, CondensedSystem* system) {
  if (linear_.at.size() == free.size() && linear_.at == free) {
    *system = linear_.system;
    return true;
  }
  Linearization linear;
  double ignored = 0.0;
  LikelihoodSums sums;
  if (!Evaluate(free, &linear.system.cost) ||
      !lines_.SetSlopes(free, &failure_) ||
      !likelihood_.Sum(loads(), AmbientDerivatives::kScores, &ignored, &sums)) {
    return false;
  }
  loads().HoldNoise(&sums);
  if (!Eliminate(sums, &linear)) return false;
  linear.left = FindInformationLeft(sums.information, loads());
  linear.at = free;
  linear.unknowns = loads().unknowns();
  *system = linear.system;
  linear_ = std::move(linear);
  return true;
}

bool AmbientCost::SetPoint(const Vector& free) {
  CondensedSystem ignored;
  double cost = 0.0;
  return Linearize(free, &ignored) && Evaluate(free, &cost);
}

void AmbientCost::CompleteTransfer() {
  // A single process has all lines.
  if (pieces_.communicator().size() > 1) transfer_.FindAll();
}

}  // namespace pinode
