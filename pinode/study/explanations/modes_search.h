// Refits of measured modes with what a model may lack among their unknowns.

#ifndef PINODE_STUDY_EXPLANATIONS_MODES_SEARCH_H_
#define PINODE_STUDY_EXPLANATIONS_MODES_SEARCH_H_

#include <set>
#include <string>
#include <vector>

#include "pinode/problem/fit_summary.h"
#include "pinode/problem/identification_options.h"
#include "pinode/problem/identification_problem.h"
#include "pinode/problem/identified_model.h"
#include "pinode/study/explanations/refit.h"
#include "pinode/study/explanations/suspect.h"
#include "pinode/study/problem/inner_fit.h"

namespace pinode {

// True for problems of measured modes alone, all with standard deviations.
bool IsOfModes(const IdentificationProblem& problem);

// True for the same problems, and for measured modes alone that have no
// standard deviations: their residuals have one unknown size.
bool HasModesAlone(const IdentificationProblem& problem);

// Number of measured numbers of a mode: a shape has no scale.
int NumbersOf(const MeasuredMode& mode);

// Returns measured modes as suspects that are left out, the worst `most` of
// those whose squared errors at `model` are above four times what their
// standard deviations allow. Nothing if they have none, or there is but one.
std::vector<Suspect> WorstModes(const IdentificationProblem& problem,
                                const FitSummary& fit,
                                const IdentifiedModel& model, size_t most);

// Looks for the suspects that describe measured modes better than the fit does
// without them. Modes are few and their fits short, so that every suspect is
// refitted, singly and added to the best: masses, stiffness outside of groups,
// modes left out, and faults of the sensors (MakeShapeSuspects, gains). It does
// nothing where the errors of the modes are what their standard deviations
// allow, unless the initial model has no mode like a measured one: then faults
// of sensors alone are tried. The same holds without standard deviations where
// a MAC is below 0.98, for models of up to 200 DOFs.
//
// The log odds of a refit with k unknowns among n candidates are those of
// Explain (n is larger for a fault that was chosen among more than that, as two
// of 60 sensors swapped),
//
//   N / 2 log(s / s') - k / 2 log N - log n,
//
// with the number N of measured numbers that the fit uses and their mean
// squared errors s, s' in standard deviations before and after. Less than 1
// counts as 1. The numbers of a mode that is left out are unknowns. A number
// that a fit cannot use and the refit describes adds log(r / (e sqrt(2 pi exp
// 1))): the range r that it might have had against its error e in the refit.
// Ranges are 2 for the entries of a shape with a largest of one, and a factor
// of exp 0.3 either way for a frequency, beyond which the mode counts as lost.
// Without standard deviations, a fit or refit with less than one degree of
// freedom left has no odds.
class ModesSearch {
 public:
  // Refers to all arguments.
  ModesSearch(const IdentificationProblem& problem,
              const IdentificationOptions& options, const FitSummary& fit,
              const IdentifiedModel& model, InnerFit* inner);

  // Returns false if there is nothing to explain.
  bool Run();

  // True if the errors are larger than the standard deviations allow.
  bool IsBeyondDeviations() const;

  const std::vector<Suspect>& suspects() const { return suspects_; }
  // Best first.
  const std::vector<Refit>& refits() const { return refits_; }
  // Mean squared error in standard deviations, per degree of freedom that is
  // left.
  double SquaredErrorLeft() const;

 private:
  void AddCatalogue();
  void AddModes();
  void AddGains();
  void Try(const Refit& from, std::vector<size_t> suspects);
  double LogOdds(const Refit& refit) const;
  double LogWorthOfRegained(const Refit& refit, double mean_square) const;
  bool IsAnyShapeUnlike() const;
  int NumMeasuredIn(const IdentificationProblem& problem,
                    const FitSummary& fit) const;
  const Refit* Best() const;

  const IdentificationProblem& problem_;
  IdentificationOptions options_;
  const FitSummary& fit_;
  const IdentifiedModel& model_;
  InnerFit& inner_;
  std::vector<Suspect> suspects_;
  int num_measured_ = 0;
  double left_ = 0.0;  // degrees of freedom; 0 or less: none
  std::vector<Refit> refits_;
  std::set<std::set<size_t>> tried_;
  bool interrupted_ = false;
};

}  // namespace pinode

#endif  // PINODE_STUDY_EXPLANATIONS_MODES_SEARCH_H_
