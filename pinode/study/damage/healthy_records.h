// States of all baselines, to compare with the state that new records show.

#ifndef PINODE_STUDY_DAMAGE_HEALTHY_RECORDS_H_
#define PINODE_STUDY_DAMAGE_HEALTHY_RECORDS_H_

#include <map>
#include <string>
#include <utility>
#include <vector>

#include "pinode/base/communicator.h"
#include "pinode/damage/change.h"
#include "pinode/problem/identification_options.h"
#include "pinode/problem/identification_problem.h"
#include "pinode/study/damage/baseline.h"
#include "pinode/study/damage/change_candidates.h"
#include "pinode/study/damage/held_followers.h"
#include "pinode/study/damage/wide_state.h"
#include "pinode/study/problem/inner_fit.h"

namespace pinode {

// Iterations after which a fit with other kinds of change in it is given up.
// Fits that converge take 2 to 40; one with hardening springs in a measured
// frame that has none crept along the edge of divergence for 1,080 and 7 min.
inline constexpr int kMostIterationsWithKinds = 100;

// Fits of the baselines and the states that follow from them. All arguments of
// the constructor must outlive this object.
class HealthyRecords {
 public:
  // `groups` are those to be compared in `problem`, the problem of the new
  // records.
  HealthyRecords(const std::vector<Baseline>& baselines,
                 const IdentificationProblem& problem,
                 const std::vector<std::string>& groups,
                 const IdentificationOptions& options);

  // Fits the baselines that have records but no parameters yet. Returns false,
  // with *error, if a baseline has no records or its fit does not converge.
  [[nodiscard]] bool Refit(InnerFit* inner, std::string* error);
  // Fits again, with `found` as unknowns, those whose unexplained motion these
  // describe: what the model lacks, and lacked before, has a value there too,
  // and one step from its absence may be far from it. `values`: those in the
  // new records. Returns true if there is a new fit.
  bool RefitWith(const std::vector<ChangeCandidate>& found,
                 const std::map<std::string, double>& values, InnerFit* inner);
  // True if the model leaves motion of a baseline unexplained. If RefitWith has
  // changed its fit, the answer is that of the new fit.
  bool LeavesMotion(size_t baseline) const;
  // Fits found by Refit, one per baseline.
  const std::vector<FitOfRecords>& fits() const { return fits_; }
  // Puts former fits back.
  void Restore(std::vector<FitOfRecords> fits) { fits_ = std::move(fits); }

  // Returns true if groups follow covariates that `problem` holds.
  bool MovesWithCovariates() const { return !held_.empty(); }

  // Finds the states of groups and `candidates` (in their units), one per
  // baseline; `of_new` is the fit of the new records. Candidates need fits.
  // Returns false, with *error, if a cost is not finite or a rank does not
  // answer.
  [[nodiscard]] bool States(const FitOfRecords& of_new,
                            const std::vector<ChangeCandidate>& candidates,
                            std::vector<GroupState>* states,
                            std::string* error);

 private:
  bool StatesNear(const FitOfRecords& of_new,
                  const std::vector<ChangeCandidate>& candidates,
                  std::vector<GroupState>* states, std::string* error);
  bool FindSlopes(const FitOfRecords& of_new,
                  const std::vector<ChangeCandidate>& candidates,
                  std::string* error);
  // Ranks share the baselines.
  int RankOfBaseline(size_t i, int num_ranks) const;
  bool ExchangeStates(Communicator* ranks, std::vector<GroupState>* states,
                      std::string* error) const;

  const std::vector<Baseline>& baselines_;
  const std::vector<std::string>& groups_;
  const IdentificationOptions& options_;
  HeldFollowers held_;
  std::vector<FitOfRecords> fits_;
};

}  // namespace pinode

#endif  // PINODE_STUDY_DAMAGE_HEALTHY_RECORDS_H_
