// The cost of an ambient record.

#ifndef PINODE_ESTIMATE_AMBIENT_AMBIENT_COST_H_
#define PINODE_ESTIMATE_AMBIENT_AMBIENT_COST_H_

#include <Eigen/Core>
#include <string>

#include "pinode/base/communicator.h"
#include "pinode/base/types.h"
#include "pinode/dynamics/structural_dynamics.h"
#include "pinode/estimate/ambient/ambient_likelihood.h"
#include "pinode/estimate/ambient/ambient_lines.h"
#include "pinode/estimate/ambient/ambient_loads.h"
#include "pinode/estimate/ambient/ambient_transfer.h"
#include "pinode/estimate/ambient/line_pieces.h"
#include "pinode/estimate/ambient/load_fit.h"
#include "pinode/estimate/solver/cost_part.h"
#include "pinode/problem/ambient_record.h"
#include "pinode/problem/parameter_layout.h"
#include "pinode/structure/model/modal_analysis.h"

namespace pinode {

// Minus the logarithm of Whittle's likelihood of a record's lines Y,
//
//   sum over lines of  log det S_y + Y^H S_y^-1 Y,
//
// as a function of the free groups. A group that follows a covariate has the
// covariate's mean over the record. The spectrum of the loads and the noise of
// the channels are chosen for each value of the groups: those that make the
// cost smallest. With W_p = S^-1/2 (dS/dp) S^-H/2 and z = S^-1/2 Y,
//
//   gradient  sum tr W_p - z^H W_p z,     information  sum tr(W_p W_q),
//
// by groups, loads and noise together, from which loads and noise are
// eliminated. Measured loads make Y the record's lines minus those of the
// response m to them, and add -2 Re dm^H S^-1 Y and 2 Re dm^H S^-1 dm.
//
// AmbientLines has the lines Y, AmbientTransfer the transfer functions in S_y,
// AmbientLoads the spectrum of loads and noise in it, LoadFit their choice, and
// AmbientLikelihood the sum. Work per line: that of AmbientTransfer, and
// areas^4 for the loads.
//
// The cost is in the frequency domain rather than of innovations in time. An
// unknown spectrum needs no filter there, modes beyond the band need no model,
// and a long record costs no more than its lines.
//
// Sources: P. Whittle (1953); for structures J. L. Beck and L. S. Katafygiotis,
// J. Eng. Mech. 124 (1998) 455, L. S. Katafygiotis and K.-V. Yuen, Earthquake
// Eng. Struct. Dyn. 30 (2001) 1129 (spectral density approach).
class AmbientCost final : public CostPart {
 public:
  // The information on the groups that is left where the loads are unknown, as
  // a part of that with known loads.
  struct InformationLeft {
    Vector by_group;
    double most = 1.0;  // of any combination of groups
  };

  // `record` is valid; it and `layout` must outlive this object. The ranks of
  // `communicator` (nullptr: a single process) share the lines, and get the
  // same bits as a single process.
  AmbientCost(const AmbientRecord& record, const StructuralDynamics& dynamics,
              const ParameterLayout& layout, int num_threads,
              Communicator* communicator = nullptr);

  [[nodiscard]] bool Evaluate(const Vector& free, double* cost) override;
  [[nodiscard]] bool Linearize(const Vector& free,
                               CondensedSystem* system) override;
  std::string Failure() const override { return failure_; }

  // Linearizes at `free` and makes `free` the point of lines(), loads() and
  // likelihood(). False where the model fails there.
  [[nodiscard]] bool SetPoint(const Vector& free);
  // Computes the transfer functions of all lines at the last point. Without it
  // each rank has those of its own lines.
  void CompleteTransfer();

  const AmbientRecord& record() const { return record_; }
  const AmbientLines& lines() const { return lines_; }
  const AmbientTransfer& transfer() const { return transfer_; }
  const AmbientLikelihood& likelihood() const { return likelihood_; }
  const AmbientLoads& loads() const { return fit_.loads(); }

  // The information on the free parameters, with loads and noise eliminated, at
  // the last Linearize.
  const Matrix& information() const { return linear_.system.hessian; }
  // Sum of score score^T over short stretches of neighbouring lines, in the
  // place of the information: the middle of a sandwich covariance.
  const Matrix& score_products() const { return linear_.score_products; }
  const InformationLeft& information_left() const { return linear_.left; }

 private:
  struct InitialModel {
    StructuralDynamics averaged;  // over the record
    ModalProperties modes;
  };
  // The result of the last Linearize.
  struct Linearization {
    Vector at;
    CondensedSystem system;
    // Loads and noise there, and their derivatives by the free parameters.
    Vector unknowns;
    Matrix follow;
    Matrix score_products;
    InformationLeft left;
  };

  static InitialModel MakeInitialModel(const AmbientRecord& record,
                                       const StructuralDynamics& dynamics);
  AmbientCost(const AmbientRecord& record, InitialModel initial,
              const Matrix& measured_loads, const ParameterLayout& layout,
              int num_threads, Communicator* communicator);

  // Sets the model at `free`. False, with failure_, where there is none.
  [[nodiscard]] bool SetModel(const Vector& free);
  // Fits the loads at the present model.
  [[nodiscard]] bool FitLoads(const Vector& free, double* cost);
  // Eliminates loads and noise from `sums`.
  [[nodiscard]] bool Eliminate(const LikelihoodSums& sums,
                               Linearization* linear);

  const AmbientRecord& record_;
  const ParameterLayout& layout_;
  const StructuralDynamics dynamics_;  // averaged over the record
  AmbientLines lines_;
  const LinePieces pieces_;
  AmbientTransfer transfer_;
  const AmbientLikelihood likelihood_;
  LoadFit fit_;
  // The point where transfer_ and fit_ are those of the least cost.
  Vector evaluated_at_;
  double evaluated_cost_ = 0.0;
  Linearization linear_;
  std::string failure_;
};

}  // namespace pinode

#endif  // PINODE_ESTIMATE_AMBIENT_AMBIENT_COST_H_
