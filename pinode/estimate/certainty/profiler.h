// Profile of one parameter: a walk along the minima of the cost.

#ifndef PINODE_ESTIMATE_CERTAINTY_PROFILER_H_
#define PINODE_ESTIMATE_CERTAINTY_PROFILER_H_

#include <functional>
#include <vector>

#include "pinode/base/types.h"
#include "pinode/estimate/certainty/held_minimum.h"
#include "pinode/estimate/objective/objective.h"
#include "pinode/problem/fit_summary.h"
#include "pinode/problem/identification_options.h"
#include "pinode/problem/identification_problem.h"
#include "pinode/problem/identified_model.h"
#include "pinode/problem/parameter_layout.h"
#include "pinode/problem/parameter_profile.h"

namespace pinode {

// Common origin of all profiles of a fit: its minimum, solved more accurately
// than the fit's own tolerances ask.
struct ProfileOrigin {
  Vector free;  // num_free
  CondensedSystem system;
  Vector variances;  // of the inverse Hessian; 0 where it has none
  bool converged = true;
  double radius = 0.0;  // HeldMinimizer::radius there
};

// Holds the state of the fit; one object per thread.
class Profiler {
 public:
  // Keeps references to `layout` and `stop` (see ProfileOptions).
  Profiler(const IdentificationProblem& problem, const ParameterLayout& layout,
           const IdentificationOptions& options,
           const std::function<bool()>& stop);

  // Sets the objective to the fit. Returns false if the cost cannot be
  // evaluated there.
  [[nodiscard]] bool Place(const IdentificationProblem& problem,
                           const IdentifiedModel& model,
                           const std::vector<RecordScore>& scores);

  // Finds the minimum. `fit`: the free parameters of the fit. Returns false if
  // it was stopped, or there is no cost.
  [[nodiscard]] bool FindOrigin(const Vector& fit, ProfileOrigin* origin);

  // Computes the profile of column j, with the linear deviation (0: unknown)
  // and half-width in deviations of the summary. Returns false if it was
  // stopped.
  [[nodiscard]] bool Run(const ProfileOrigin& origin, int j, double sigma,
                         double quantile, ParameterProfile* profile);

 private:
  struct Point {
    double value = 0.0;
    double cost = 0.0;
    Vector free;
  };

  // Minimises as HeldMinimizer does, from `start`. Counts linearisations, and
  // records failures to converge.
  bool Minimize(const Vector& start, int held, HeldMinimum* minimum);
  // Returns the square root of the likelihood ratio.
  double RootOf(double cost) const;
  double Size() const;
  bool IsFar(double value) const;
  bool IsFlatFor(double root, double value) const;
  double Guess(const Point& from, const CondensedSystem& system, double value,
               Vector* best);
  Vector AlongProducts(const Point& from, const Vector& direction,
                       double value) const;
  bool Walk(double side, std::vector<Point>* path);
  bool Refine(double side, std::vector<Point>* path);
  void ClampToBounds(Vector* free) const;
  double EndOf(double side, double aim, const std::vector<Point>& path) const;
  void Conclude(const std::vector<Point>& path);
  void NameCombinations(const std::vector<Point>& path);

  const ParameterLayout& layout_;
  const std::function<bool()>& stop_;
  Objective objective_;
  HeldMinimizer minimizer_;
  const ProfileOrigin* origin_ = nullptr;
  Point center_;
  ParameterProfile* profile_ = nullptr;
  int j_ = 0;
  double memory_ = 1.0;
  double step_ = 0.0;
};

}  // namespace pinode

#endif  // PINODE_ESTIMATE_CERTAINTY_PROFILER_H_
