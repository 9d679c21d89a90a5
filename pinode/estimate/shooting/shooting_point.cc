#include "pinode/estimate/shooting/shooting_point.h"

#include <string>

namespace pinode {

bool PreparePoint(const IdentificationProblem& problem,
                  const ParameterLayout& layout, const Vector& free,
                  ShootingPoint* point) {
  point->parameters = layout.InitialValues();
  layout.SetFree(free, &point->parameters);
  std::string error;
  return point->parameters.allFinite() &&
         problem.dynamics->Prepare(
             point->parameters.head(layout.num_dynamics()), &point->prepared,
             &error);
}

}  // namespace pinode
