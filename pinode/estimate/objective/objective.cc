#include "pinode/estimate/objective/objective.h"

namespace pinode {

MultipleShooting::Options ShootingOptions(
    const IdentificationOptions& options) {
  MultipleShooting::Options shooting;
  shooting.derivatives = options.derivatives;
  shooting.loss = options.loss;
  shooting.loss_scale = options.loss_scale;
  shooting.num_threads = options.num_threads;
  shooting.communicator = options.communicator;
  shooting.starts = options.tuning.starts;
  return shooting;
}

Objective::Objective(const IdentificationProblem& problem,
                     const ParameterLayout& layout,
                     const MultipleShooting::Options& options)
    : shooting_(problem, layout, options), priors_(layout) {
  if (!problem.modal.empty()) {
    modes_ =
        std::make_unique<ModalCost>(problem.modal, *problem.dynamics, layout);
  }
  for (const AmbientRecord& record : problem.ambient) {
    ambient_.push_back(std::make_unique<AmbientCost>(
        record, *problem.dynamics, layout, options.num_threads,
        options.communicator));
    spectra_.push_back(ambient_.back().get());
  }
  for (const FrfRecord& record : problem.frfs) {
    frfs_.push_back(std::make_unique<FrfCost>(record, *problem.dynamics, layout,
                                              options.num_threads));
    spectra_.push_back(frfs_.back().get());
  }
}

bool Objective::Evaluate(const Vector& free, double* cost) {
  double modes = 0.0;
  double priors = 0.0;
  if ((modes_ != nullptr && !modes_->Evaluate(free, &modes)) ||
      !shooting_.Evaluate(free, cost) || !priors_.Evaluate(free, &priors)) {
    return false;
  }
  *cost += priors + modes;
  for (CostPart* record : spectra_) {
    double part = 0.0;
    if (!record->Evaluate(free, &part)) return false;
    *cost += part;
  }
  return true;
}

bool Objective::Linearize(const Vector& free, CondensedSystem* system) {
  CondensedSystem modes, priors;
  if ((modes_ != nullptr && !modes_->Linearize(free, &modes)) ||
      !shooting_.Linearize(free, system) || !priors_.Linearize(free, &priors)) {
    return false;
  }
  system->Add(priors);
  if (modes_ != nullptr) system->Add(modes);
  other_information_ = modes.hessian;
  for (CostPart* record : spectra_) {
    CondensedSystem part;
    if (!record->Linearize(free, &part)) return false;
    system->Add(part);
    if (other_information_.size() == 0) {
      other_information_ = part.hessian;
    } else {
      other_information_ += part.hessian;
    }
  }
  return true;
}

std::string Objective::Failure() const {
  if (modes_ != nullptr && !modes_->Failure().empty()) {
    return modes_->Failure();
  }
  for (const CostPart* record : spectra_) {
    if (!record->Failure().empty()) return record->Failure();
  }
  return shooting_.Failure();
}

}  // namespace pinode
