#include "pinode/estimate/objective.h"

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
}

bool Objective::Evaluate(const Vector& free, double* cost) {
  double modes = 0.0;
  double priors = 0.0;
  if ((modes_ != nullptr && !modes_->Evaluate(free, &modes)) ||
      !shooting_.Evaluate(free, cost) || !priors_.Evaluate(free, &priors)) {
    return false;
  }
  *cost += priors + modes;
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
  modal_information_ = modes.hessian;
  return true;
}

std::string Objective::Failure() const {
  if (modes_ != nullptr && !modes_->Failure().empty()) {
    return modes_->Failure();
  }
  return shooting_.Failure();
}

}  // namespace pinode
