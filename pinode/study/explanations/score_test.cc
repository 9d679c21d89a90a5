#include "pinode/study/explanations/score_test.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "pinode/estimate/certainty/fitted_cost.h"
#include "pinode/estimate/shooting/score.h"
#include "pinode/problem/parameter_layout.h"
#include "pinode/study/problem/growth.h"

namespace pinode {
namespace {

// Information within rounding of nothing, as a share of an unknown's own.
constexpr double kNoInformation = 1e-9;

bool IsAtBound(const FitSummary& fit, const std::string& name) {
  return std::any_of(fit.parameters.begin(), fit.parameters.end(),
                     [&name](const ParameterEstimate& estimate) {
                       return estimate.name == name && estimate.at_bound;
                     });
}

// The cost around the fit, scaled to a unit diagonal of its Hessian, with the
// problem's unknowns eliminated.
class Information {
 public:
  // `priors`: what the priors add to the diagonal of the Hessian.
  Information(const CondensedSystem& system, const Vector& priors,
              const std::vector<int>& base)
      : scale_(system.hessian.diagonal().cwiseMax(1e-300).cwiseSqrt()),
        gradient_(system.gradient.cwiseQuotient(scale_)),
        hessian_(scale_.cwiseInverse().asDiagonal() * system.hessian *
                 scale_.cwiseInverse().asDiagonal()),
        bare_(hessian_),
        base_(base) {
    bare_.diagonal() -= priors.cwiseQuotient(scale_.cwiseAbs2());
    const auto factor = [&base](const Matrix& of,
                                Eigen::LDLT<Matrix>* factored) {
      Matrix inner = of(base, base);
      inner.diagonal().array() += 1e-12;
      factored->compute(inner);
    };
    factor(hessian_, &factor_);
    factor(bare_, &bare_factor_);
  }

  // `directions`: of the suspect's unknowns, all free unknowns x count.
  SuspectScore Score(const Matrix& directions) const {
    SuspectScore score;
    score.num_unknowns = static_cast<int>(directions.cols());
    const Matrix t = scale_.asDiagonal() * directions;
    const Matrix ht = hessian_ * t;
    const Matrix cross = ht(base_, Eigen::all);
    const Matrix solved = factor_.solve(cross);
    const Matrix own = t.transpose() * ht;
    Matrix left = own - cross.transpose() * solved;
    const Vector right =
        t.transpose() * gradient_ - solved.transpose() * gradient_(base_);
    AddWhatRecordsSee(t.col(0), &score);
    // In units of each unknown's own information.
    const Vector unit = own.diagonal().cwiseMax(1e-300).cwiseSqrt();
    left = unit.cwiseInverse().asDiagonal() * left *
           unit.cwiseInverse().asDiagonal();
    const Vector g = right.cwiseQuotient(unit);
    // Directions without information gain nothing.
    const Eigen::SelfAdjointEigenSolver<Matrix> modes(left);
    if (modes.info() != Eigen::Success) return score;
    for (Eigen::Index i = 0; i < g.size(); ++i) {
      const double weight = modes.eigenvalues()[i];
      if (!(weight > kNoInformation)) continue;
      score.gain +=
          0.5 * std::pow(modes.eigenvectors().col(i).dot(g), 2) / weight;
    }
    return score;
  }

 private:
  // Deviation and slopes of direction `t`, without priors.
  void AddWhatRecordsSee(const Vector& t, SuspectScore* score) const {
    const Vector ht = bare_ * t;
    const Vector cross = ht(base_);
    const Vector solved = bare_factor_.solve(cross);
    const double left = t.dot(ht) - cross.dot(solved);
    score->deviation = 1.0 / std::sqrt(std::max(left, 1e-300));
    score->slopes = -solved.cwiseQuotient(scale_(base_));
  }

  const Vector scale_;
  const Vector gradient_;
  const Matrix hessian_;
  Matrix bare_;  // without priors
  const std::vector<int> base_;
  Eigen::LDLT<Matrix> factor_, bare_factor_;
};

// Fills the usual shifts and deviations.
void AddUsual(const FitSummary& fit, const ParameterLayout& layout,
              const CondensedSystem& system, const std::vector<int>& base,
              const std::vector<Suspect>& suspects, SuspectScores* scores) {
  const double weight = 1.0 / NoiseShareOfTraining(fit);
  std::vector<int> all = base;
  std::vector<double> prior(base.size(), 0.0);
  for (const Suspect& suspect : suspects) {
    if (suspect.IsDiscrete()) continue;
    for (const std::string& name : suspect.Unknowns()) {
      const int j = layout.FreeIndex(name);
      if (j < 0 || std::find(all.begin(), all.end(), j) != all.end()) continue;
      all.push_back(j);
      prior.push_back(1.0 / (suspect.usual * suspect.usual));
    }
  }
  Matrix hessian = weight * system.hessian(all, all);
  for (size_t i = 0; i < prior.size(); ++i) {
    hessian(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(i)) +=
        prior[i];
  }
  const Vector scale = hessian.diagonal().cwiseMax(1e-300).cwiseSqrt();
  hessian = scale.cwiseInverse().asDiagonal() * hessian *
            scale.cwiseInverse().asDiagonal();
  hessian.diagonal().array() += 1e-12;
  const Eigen::LDLT<Matrix> factor(hessian);
  if (factor.info() != Eigen::Success) return;
  const Vector gradient = weight * system.gradient(all);
  const Vector step =
      -factor.solve(gradient.cwiseQuotient(scale)).cwiseQuotient(scale);
  const Eigen::Index count = static_cast<Eigen::Index>(base.size());
  Matrix unit = Matrix::Zero(hessian.rows(), count);
  unit.topRows(count).setIdentity();
  const Matrix inverse = factor.solve(unit);
  scores->usual_shifts = step.head(count);
  scores->usual_deviations =
      inverse.topRows(count).diagonal().cwiseMax(0.0).cwiseSqrt().cwiseQuotient(
          scale.head(count));
}

}  // namespace

double NoiseShareOfTraining(const FitSummary& fit) {
  double share = 0.0;
  int count = 0;
  for (const RecordScore& score : fit.records) {
    if (score.role != IdentificationRecord::Role::kTrain) continue;
    const double own = NoiseShareOf(score);
    share += std::isfinite(own) ? own : 1.0;
    ++count;
  }
  constexpr double kLeast = 1e-6;
  return count == 0 ? 1.0 : std::max(share / count, kLeast);
}

bool ScoreSuspects(const IdentificationProblem& problem, const FitSummary& fit,
                   const IdentifiedModel& model,
                   const std::vector<Suspect>& suspects, int num_threads,
                   SuspectScores* scores, std::string* error) {
  std::vector<Suspect> added;
  for (const Suspect& suspect : suspects) {
    if (suspect.IsDiscrete()) continue;
    added.push_back(suspect);
    if (!suspect.tied.empty()) added.back().sensors.clear();
  }
  IdentificationProblem extended = problem;
  if (!AddSuspects(added, &extended, error)) return false;
  IdentifiedModel at =
      BeginFrom(ParametersByName(problem, model), model, extended);
  at.decays = model.decays;
  const ParameterLayout layout(extended);
  CondensedSystem system;
  if (!LinearizeAtFit(extended, layout, at, fit.records, num_threads,
                      &system)) {
    *error = "the model with other unknowns in it is not finite";
    return false;
  }
  *scores = SuspectScores();
  std::vector<int> base;
  const ParameterLayout own(problem);
  for (const int index : own.free()) {
    const std::string& name = own.parameter(index).name;
    const int j = layout.FreeIndex(name);
    if (j < 0 || IsAtBound(fit, name)) continue;
    base.push_back(j);
    scores->names.push_back(name);
  }
  AddUsual(fit, layout, system, base, suspects, scores);
  Vector priors = Vector::Zero(layout.num_free());
  for (int j = 0; j < layout.num_free(); ++j) {
    const Parameter& parameter = layout.free_parameter(j);
    if (parameter.HasPrior() && parameter.prior_sigma > 0.0) {
      priors[j] = 1.0 / (parameter.prior_sigma * parameter.prior_sigma);
    }
  }
  const Information information(system, priors, base);
  const auto column = [&layout](const std::string& name) {
    Vector direction = Vector::Zero(layout.num_free());
    const int j = layout.FreeIndex(name);
    if (j >= 0) direction[j] = 1.0;
    return direction;
  };
  for (const Suspect& suspect : suspects) {
    Matrix directions(layout.num_free(), 0);
    const auto append = [&directions](const Vector& direction) {
      directions.conservativeResize(Eigen::NoChange, directions.cols() + 1);
      directions.rightCols(1) = direction;
    };
    for (const std::string& name : suspect.Unknowns()) {
      // An unknown that is free already is one of the problem's.
      const Vector direction = column(name);
      const bool is_base = std::find(base.begin(), base.end(),
                                     layout.FreeIndex(name)) != base.end();
      if (!is_base && !direction.isZero()) append(direction);
    }
    if (!suspect.tied.empty()) {
      Vector together = Vector::Zero(layout.num_free());
      for (const std::string& name : suspect.tied) together += column(name);
      append(together);
    }
    scores->suspects.push_back(
        directions.cols() > 0 ? information.Score(directions) : SuspectScore());
  }
  return true;
}

}  // namespace pinode
