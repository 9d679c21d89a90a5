// Fits of new records in which only a few subjects have changed.

#ifndef PINODE_STUDY_DAMAGE_CHANGE_REFIT_H_
#define PINODE_STUDY_DAMAGE_CHANGE_REFIT_H_

#include <functional>
#include <map>
#include <string>
#include <vector>

#include "pinode/base/constants.h"
#include "pinode/base/types.h"
#include "pinode/damage/change.h"
#include "pinode/study/damage/change_candidates.h"
#include "pinode/study/damage/wide_state.h"
#include "pinode/study/problem/inner_fit.h"

namespace pinode {

// Cost of new records near `at` as a function of the compared values (groups,
// then candidates), all other unknowns eliminated:
//
//   cost + gradient' d + 1/2 d' information d,   d = values - at.
struct ComparedCost {
  Vector at;
  Vector gradient;
  Matrix information;
  double cost = 0.0;
};

// Values in the new records with their uncertainty, if a given set has changed
// and everything else is as expected from the baselines.
struct ChangePosterior {
  Vector values;
  Matrix covariance;
  // Minus the logarithm of the probability density of the new records times
  // that of `values`, up to a constant that all sets share.
  double cost = 0.0;
  // Logarithm of the probability of the new records, all values integrated out
  // (Laplace), up to the same constant.
  double log_evidence = 0.0;
};

// Expected values of groups and candidates in new records without a change,
// and the sets of changes that are compared.
class ChangeModel {
 public:
  // `expected`: groups, then candidates (see PoolBaselines). `absolute`: marks
  // entries whose change is no fraction; as long as the values.
  ChangeModel() = default;
  ChangeModel(const PooledBaselines& expected, std::vector<bool> absolute);

  Eigen::Index size() const { return expected_.state.values.size(); }
  const Vector& values() const { return expected_.state.values; }
  const Matrix& covariance() const { return expected_.state.covariance; }

  // Finds the values if the entries `changed` have changed. With the expected
  // values m, their covariance P, and a change of about 1 (Scale) in each
  // changed entry, the values are normal with mean m and covariance
  //
  //   Q = P + sum over changed j of scale_j^2 e_j e_j',
  //
  // to which the new records are added.
  ChangePosterior PosteriorOf(const ComparedCost& cost,
                              const std::vector<int>& changed) const;
  // Returns the values without the changes that agree with `posterior`.
  Vector BeforeOf(const ChangePosterior& posterior,
                  const std::vector<int>& changed) const;
  // Replaces the expected values.
  void Expect(const PooledBaselines& expected) { expected_ = expected; }
  // Returns the part of a posterior's cost that the expected values cause, at
  // `at`.
  double DistanceOf(const Vector& at, const std::vector<int>& changed) const;
  // Returns what a change of each single entry beside `changed` gains, in the
  // logarithm of the likelihood: r_j^2 / (2 W_jj) with the gradient r and the
  // curvature W of the cost by the expected values. Zero for `changed`.
  Vector GainsOf(const ComparedCost& cost,
                 const std::vector<int>& changed) const;
  // Returns the changes of the entries `changed`. The value without the change
  // follows from `posterior` by what the other entries say of it. A change
  // that is a fraction has its interval in logarithms, log (1 + value).
  std::vector<GroupChange> ChangesOf(const ChangePosterior& posterior,
                                     const std::vector<int>& changed,
                                     double threshold) const;

 private:
  Matrix PriorOf(const std::vector<int>& changed) const;

  PooledBaselines expected_;
  std::vector<bool> absolute_;
};

// Expected values near given values of the groups, where the baselines are not
// linear.
using BaselinesNear = std::function<bool(const Vector&, PooledBaselines*)>;

// A fit with the entries `changed` free. All others are held at values that
// agree with the baselines and, within their uncertainty, with the new records.
struct ChangeRefit {
  ChangeModel model;
  std::vector<int> changed;  // entries of `model`
  ComparedCost cost;         // near the end of the fit
  ChangePosterior posterior;
  Vector before;  // values without the changes near which `model` was found
  std::map<std::string, double> parameters;
};

// Refits new records with chosen changes.
class ChangeRefitter {
 public:
  // `fit`: the fit of the new records with all of `groups` free. `with_all`:
  // that with all that was found, which gives the noise. All must outlive this
  // object.
  ChangeRefitter(const FitOfRecords& fit, const FitOfRecords& with_all,
                 const std::vector<std::string>& groups,
                 const IdentificationOptions& options, InnerFit* inner);

  // Returns the reason why nothing can be refitted, as half a sentence; empty:
  // it can.
  std::string WhyNot() const;

  // Fits with `changed` (entries of `model`: all groups, then `candidates`).
  // Each round fits the changed entries, then moves the others by one
  // Gauss-Newton step of the whole. `near` (may be empty) gives `model` anew in
  // each round. `begin`: parameters by name; nullptr: those of the fit, with
  // candidates that with all that was found. Returns false if a fit fails.
  [[nodiscard]] bool Refit(const ChangeModel& model,
                           const std::vector<ChangeCandidate>& candidates,
                           const std::vector<int>& changed,
                           const BaselinesNear& near,
                           const std::map<std::string, double>* begin,
                           ChangeRefit* result);
  // Computes the cost of the groups near the fit with all of them free.
  [[nodiscard]] bool AllFree(ComparedCost* cost) const;
  // Cost of the new records with all that was found; NaN without records.
  double cost_with_all() const { return cost_with_all_; }
  bool interrupted() const { return interrupted_; }

 private:
  // The compared values as parameters.
  struct Names;
  // The new records with the compared values free, and with all but `changed`
  // held.
  struct Problems;
  Names NamesWith(const std::vector<ChangeCandidate>& candidates) const;
  bool MakeProblems(const std::vector<ChangeCandidate>& candidates,
                    const std::vector<int>& changed, const Vector& held,
                    Problems* problems) const;
  bool Linearize(const Names& names, const IdentificationProblem& open,
                 const IdentifiedModel& at,
                 const std::vector<RecordScore>& scores,
                 ComparedCost* cost) const;
  bool RunRound(const std::vector<ChangeCandidate>& candidates,
                const std::vector<int>& changed, const Vector& held,
                std::map<std::string, double>* parameters, ComparedCost* cost);

  const FitOfRecords& fit_;
  const FitOfRecords& with_all_;
  const std::vector<std::string>& groups_;
  IdentificationOptions options_;
  InnerFit& inner_;
  // Factor between the cost and minus a log-likelihood, see FittedCost::memory;
  // for modes alone, the variance of their residuals.
  double memory_ = 1.0;
  double cost_with_all_ = kNaN;
  bool known_ = false;
  bool interrupted_ = false;
};

}  // namespace pinode

#endif  // PINODE_STUDY_DAMAGE_CHANGE_REFIT_H_
