// What the terms of the identified model did during a record.

#ifndef PINODE_REPORT_RESTORING_FORCE_H_
#define PINODE_REPORT_RESTORING_FORCE_H_

#include <string>
#include <vector>

#include "pinode/base/types.h"
#include "pinode/report/report.h"

namespace pinode {

// One output of a force law or network along the predicted states of a record:
// y(t) = g(q(t), z(t); p), with the identified parameters p. Of a term with a
// known curve beside it always the force that resists: for an acceleration y of
// a mass m, -m y.
struct RestoringForceLoop {
  std::string term;
  std::string type;    // "cubic", ..., or "network"
  std::string output;  // of a network: where it acts; empty otherwise
  int record = -1;     // index into the problem's records
  // Resists positive deformation; or, for a network that acts as an
  // acceleration, is added to dv/dt.
  bool is_acceleration = false;
  std::string deformation_name, deformation_unit;
  std::string rate_name, rate_unit;
  std::string force_unit;
  Vector time;
  // First displacement-like feature; where the term has none, its first one.
  Vector deformation;
  // First velocity-like feature; empty where the term has none or where it is
  // already the abscissa.
  Vector rate;
  Vector force;
  const ReferenceCurve* known = nullptr;  // of the problem, if there is one
};

// One entry per output of every law and network (linear networks of more than
// two inputs left out), in the model's order, each on
// the record with a finite free run on which its deformation ranges widest.
// Empty where there is no identified model or no finite free run.
std::vector<RestoringForceLoop> ComputeRestoringForceLoops(
    const ReportInput& input);

}  // namespace pinode

#endif  // PINODE_REPORT_RESTORING_FORCE_H_
