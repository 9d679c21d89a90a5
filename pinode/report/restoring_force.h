// Forces of the identified model's terms during a record.

#ifndef PINODE_REPORT_RESTORING_FORCE_H_
#define PINODE_REPORT_RESTORING_FORCE_H_

#include <string>
#include <vector>

#include "pinode/base/types.h"
#include "pinode/report/report.h"

namespace pinode {

// Output of a force law or network along the predicted states of a record: y(t)
// = g(q(t), z(t); p), with the identified parameters p. For a term with a known
// curve it is always the force that resists: for an acceleration y of a mass m,
// -m y.
struct RestoringForceLoop {
  std::string term;
  std::string type;    // "cubic", ..., or "network"
  std::string output;  // where a network acts; empty otherwise
  int record = -1;     // index into the problem's records
  // True: a network that acts as an acceleration, which is added to dv/dt.
  // False: the force resists positive deformation.
  bool is_acceleration = false;
  std::string deformation_name, deformation_unit;
  std::string rate_name, rate_unit;
  std::string force_unit;
  Vector time;
  // First displacement-like feature; the first feature if there is none.
  Vector deformation;
  // First velocity-like feature; empty if the term has none or if it is already
  // the abscissa.
  Vector rate;
  Vector force;
  const ReferenceCurve* known = nullptr;  // of the problem, if any
};

// Computes one entry per output of every law and network (linear networks of
// more than two inputs left out), in the model's order. Each is on the record
// with a finite simulation on which its deformation ranges widest. Empty
// without an identified model or a finite simulation.
std::vector<RestoringForceLoop> ComputeRestoringForceLoops(
    const ReportInput& input);

}  // namespace pinode

#endif  // PINODE_REPORT_RESTORING_FORCE_H_
