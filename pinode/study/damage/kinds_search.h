// Search for changes of other kinds than groups: masses, damping, stiffness
// outside of groups, nonlinear forces.

#ifndef PINODE_STUDY_DAMAGE_KINDS_SEARCH_H_
#define PINODE_STUDY_DAMAGE_KINDS_SEARCH_H_

#include <cstddef>
#include <string>
#include <utility>
#include <vector>

#include "pinode/damage/change.h"
#include "pinode/problem/identification_options.h"
#include "pinode/problem/verdict.h"
#include "pinode/study/damage/change_candidates.h"
#include "pinode/study/damage/healthy_records.h"
#include "pinode/study/damage/wide_state.h"
#include "pinode/study/problem/inner_fit.h"

namespace pinode {

// Share of the false-alarm rate that other kinds of change may use up.
inline constexpr double kShareOfKinds = 0.2;

// Options for `num_groups` groups and then `candidates`.
ChangeOptions OptionsFor(const ChangeOptions& options, size_t num_groups,
                         const std::vector<ChangeCandidate>& candidates,
                         double rate);

// Candidates of `all` that are not among `taken`, by name.
std::vector<ChangeCandidate> Without(const std::vector<ChangeCandidate>& all,
                                     const std::vector<ChangeCandidate>& taken);

// Looks for candidates that changed between the healthy records and new ones.
// Groups and all candidates are compared at fits of both, the candidates that
// differ become unknowns of the fit of the new records, and so on until no
// other ones differ. Dampers follow where motion is left unexplained.
class KindsSearch {
 public:
  // All arguments but the last must outlive this object. `fit_of_groups`: the
  // fit of the new records with groups alone.
  KindsSearch(const std::vector<std::string>& groups,
              const ChangeOptions& options,
              const IdentificationOptions& identification,
              HealthyRecords* healthy_records, InnerFit* inner,
              const FitOfRecords& fit_of_groups,
              std::vector<ChangeCandidate> candidates);

  // `explanations` are those of the fit with groups alone; `usable`: its
  // verdict. Returns false, with *error, if kinds cannot be told apart, or a
  // fit was interrupted.
  [[nodiscard]] bool Run(const std::vector<Explanation>& explanations,
                         bool usable, std::string* error);

  // All candidates, with dampers that were found.
  const std::vector<ChangeCandidate>& candidates() const { return candidates_; }
  const std::vector<ChangeCandidate>& found() const { return found_; }
  // Gives away the fit of the new records with what was found.
  FitOfRecords TakeFit() { return std::move(fit_of_new_); }
  // Groups and all candidates, and the flags of their entries, see
  // ToLogarithms.
  const std::vector<GroupState>& healthy() const { return healthy_; }
  const GroupState& current() const { return current_; }
  const std::vector<bool>& is_logarithm() const { return is_logarithm_; }
  // Options for these, of which changes of logarithms are taken.
  ChangeOptions WideOptions(double rate) const;

 private:
  // Result of the search so far, before the baselines are fitted with it.
  struct State {
    std::vector<ChangeCandidate> found;
    FitOfRecords fit;
  };

  bool WideStates(std::string* error);
  bool LookForKinds(const std::vector<Explanation>& explanations, bool usable,
                    std::string* error);
  bool LookForDampers(std::string* error);
  bool TakeDampers();
  bool IsDrivenByDamping() const;
  void Return(const State& state);
  bool FitWith(const std::vector<ChangeCandidate>& candidates,
               std::string* error);
  bool FitNewWith(const std::vector<ChangeCandidate>& candidates,
                  std::string* error);
  void RefitBaselines();

  const std::vector<std::string>& groups_;
  const ChangeOptions& options_;
  const IdentificationOptions& identification_;
  HealthyRecords& healthy_records_;
  InnerFit& inner_;
  const FitOfRecords& fit_of_groups_;
  std::vector<ChangeCandidate> candidates_, found_;
  // Candidates that the healthy records have too, and the model has not.
  std::vector<ChangeCandidate> in_both_;
  FitOfRecords fit_of_new_;
  bool interrupted_ = false;
  std::vector<GroupState> healthy_;
  GroupState current_;
  std::vector<bool> is_logarithm_;
};

}  // namespace pinode

#endif  // PINODE_STUDY_DAMAGE_KINDS_SEARCH_H_
