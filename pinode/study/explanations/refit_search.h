// Refits with what a model may lack among their unknowns.

#ifndef PINODE_STUDY_EXPLANATIONS_REFIT_SEARCH_H_
#define PINODE_STUDY_EXPLANATIONS_REFIT_SEARCH_H_

#include <set>
#include <string>
#include <utility>
#include <vector>

#include "pinode/problem/fit_summary.h"
#include "pinode/problem/identification_options.h"
#include "pinode/problem/identification_problem.h"
#include "pinode/problem/identified_model.h"
#include "pinode/study/explanations/refit.h"
#include "pinode/study/explanations/refit_odds.h"
#include "pinode/study/explanations/score_test.h"
#include "pinode/study/explanations/suspect.h"
#include "pinode/study/problem/inner_fit.h"

namespace pinode {

// Looks for the suspects that describe the records better than the fit does
// without them. Score tests rank them; the best few are refitted, singly and
// added to the best of them.
class RefitSearch {
 public:
  // Refers to all arguments.
  RefitSearch(const IdentificationProblem& problem,
              const IdentificationOptions& options, const FitSummary& fit,
              const IdentifiedModel& model, InnerFit* inner);

  // False if the suspects have no scores at the fit.
  bool Run();

  const std::vector<Suspect>& suspects() const { return suspects_; }
  // At the fit.
  const SuspectScores& scores() const { return scores_; }
  // Best first.
  const std::vector<Refit>& refits() const { return refits_; }

 private:
  void AddSuspectsBeside();
  void TryGain(const Refit& from, size_t i);
  void TryRocking(const Refit& from);
  void TryDelays(const Refit& from);
  void KeepBest(const std::vector<size_t>& suspects);
  bool Score(const Refit& at, std::vector<Suspect> suspects,
             SuspectScores* scores) const;
  void AddForceSuspects(const Refit& own);
  std::vector<size_t> Promising(const SuspectScores& scores, size_t most,
                                const std::vector<size_t>& taken) const;
  std::vector<size_t> LikelyExchanges() const;
  double Agreement(const std::pair<int, int>& at, int predicted) const;
  bool IsHeld(const Suspect& suspect) const;
  bool Try(const Refit& from, std::vector<size_t> suspects, bool cold);
  bool AddToBest();
  bool HoldsNothing(const Refit& refit, size_t i) const;

  const IdentificationProblem& problem_;
  IdentificationOptions options_;
  const FitSummary& fit_;
  const IdentifiedModel& model_;
  InnerFit& inner_;
  const RefitOdds odds_;
  std::vector<Suspect> suspects_;
  SuspectScores scores_;
  std::vector<Refit> refits_;
  std::set<std::set<size_t>> tried_;
  bool interrupted_ = false;
};

// Squared error of the training records.
double SquaredError(const FitSummary& fit);

}  // namespace pinode

#endif  // PINODE_STUDY_EXPLANATIONS_REFIT_SEARCH_H_
