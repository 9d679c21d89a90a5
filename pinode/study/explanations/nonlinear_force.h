// Forms of a nonlinear force that may act at a spring.

#ifndef PINODE_STUDY_EXPLANATIONS_NONLINEAR_FORCE_H_
#define PINODE_STUDY_EXPLANATIONS_NONLINEAR_FORCE_H_

#include <string>
#include <vector>

#include "pinode/base/types.h"
#include "pinode/dynamics/feature.h"
#include "pinode/problem/fit_summary.h"
#include "pinode/structure/model/structural_model.h"
#include "pinode/study/terms/library_term.h"

namespace pinode {

// Deformation and its rate of a spring between two DOFs, or a DOF and the
// ground
// (`from` is Feature::kGround), as features of a force.
std::vector<Feature> FeaturesOfSpring(int from, int to);

// They along the training records of a fit, at every sample.
struct SpringMotion {
  std::vector<std::string>
      names;  // of the two features, as functions have them
  Vector deformation;
  Vector rate;

  // Values of a function of the two, such as "x[u1]^3".
  Vector Values(const std::string& basis) const;
};

// `fit` has the states of its training records.
SpringMotion MotionOfSpring(const StructuralModel& model, const FitSummary& fit,
                            int from, int to);

// A force between two DOFs, or a DOF and the ground (Feature::kGround), as a
// term of one unknown coefficient that begins at zero.
struct NonlinearForce {
  std::string form;  // "hardening", "friction", "opening", "drag"
  LibrarySpec spec;
  // Coefficient with which it is as large (RMS) as the spring's own force along
  // the motion.
  double unit = 1.0;
};

// Returns the forms at a spring of this stiffness along the motion of `fit`,
// whose training records have states. None if the spring does not move.
std::vector<NonlinearForce> NonlinearForcesAt(const StructuralModel& model,
                                              const FitSummary& fit, int from,
                                              int to, double stiffness,
                                              const std::string& name);

}  // namespace pinode

#endif  // PINODE_STUDY_EXPLANATIONS_NONLINEAR_FORCE_H_
