// Responses of linear dynamics and their derivatives as combinations of a few
// histories.

#ifndef PINODE_INTEGRATE_MODAL_RESPONSE_H_
#define PINODE_INTEGRATE_MODAL_RESPONSE_H_

#include <Eigen/Core>
#include <utility>
#include <vector>

#include "pinode/base/types.h"
#include "pinode/dynamics/observation.h"
#include "pinode/dynamics/structural_dynamics.h"
#include "pinode/integrate/integration_grid.h"
#include "pinode/integrate/linear_rate.h"
#include "pinode/integrate/modal_basis.h"

namespace pinode {

// Responses of linear dynamics in modal form. With F = V diag(lambda) V^-1, a
// channel of a run from h(0) at its first sample is
//
//   y = sum_m c_m (sum_u b_mu z_mu + s_m z_m0) + D u,
//
// with c = (H_h + H_a F) V, b = V^-1 G and s = V^-1 h(0). z_mu is mode m's
// response to input u alone, and z_m0 is its response to a start at 1. The
// derivatives with respect to the parameters use p = d z / d lambda of each
// mode. With E = V^-1 F_j V
//
//   d/d theta_j [V z(lambda) V^-1] = V (E o Z) V^-1,
//   Z_km = (z_k - z_m) / (lambda_k - lambda_m),  Z_mm = p_m
//
// (Y. L. Daletskii and S. G. Krein, AMS Translations 47 (1965) 1-30; for two
// nearly equal eigenvalues the mean of their p). Every channel and every
// derivative is therefore a combination, constant in time, of the same
// histories: real and imaginary parts of z and p, the inputs, and 1. Their
// number, and the work per sample, does not depend on the number of parameters
// and channels.
class ModalResponse {
 public:
  // Selection of histories: `with_slopes` adds those of p, `with_start` adds
  // the responses to a start.
  struct Contents {
    bool with_slopes = false;
    bool with_start = false;
  };

  // State of the histories at a sample. All later histories depend only on it.
  struct State {
    ComplexMatrix z;  // kept modes x sources: the inputs, then the start
    ComplexMatrix p;
  };

  // Computes the modes of the dynamics at `prepared`. Reuses the existing ones
  // if the dynamics are the same. Returns false if the modes do not span the
  // states, see ModalBasis.
  [[nodiscard]] bool Prepare(const StructuralDynamics& dynamics,
                             const StructuralDynamics::Prepared& prepared,
                             const IntegrationGrid& grid, bool with_parameters);

  // Returns R, the number of histories.
  int NumRows(const Contents& contents) const;
  // Returns the last row, which is constantly 1.
  int ConstantRow(const Contents& contents) const {
    return NumRows(contents) - 1;
  }

  // Returns the state at the first sample: at rest, and with a start of 1.
  State Begin(const Contents& contents) const;
  // Computes the histories at samples first ... first + count - 1, R x count,
  // from the state at sample `first`. Leaves the state at sample first + count,
  // or at the grid's last sample if that comes first. nullptr: computes the
  // state alone, at a fraction of the work.
  void Advance(const Contents& contents, const IntegrationGrid& grid,
               Eigen::Index first, Eigen::Index count, State* state,
               Matrix* histories) const;

  // Returns R x channels: the channels of a run from `start` are values' *
  // histories.
  Matrix Values(const Contents& contents, const ObservationMap& observation,
                const Vector& start) const;
  // Returns R x columns for each channel: its derivatives with respect to the
  // start (num_states columns, in units of the states) and to the free
  // parameters, whose computation threads share. The latter need the slopes.
  std::vector<Matrix> Derivatives(const Contents& contents,
                                  const ObservationMap& observation,
                                  const Vector& start, bool by_start,
                                  bool by_parameters,
                                  int num_threads = 1) const;
  // Returns R x num_states: the states of a run from `start` are states' *
  // histories.
  Matrix States(const Contents& contents, const Vector& start) const;

 private:
  int num_sources(const Contents& contents) const {
    return num_inputs_ + (contents.with_start ? 1 : 0);
  }
  int rows_per_source(const Contents& contents) const {
    return (contents.with_slopes ? 4 : 2) * basis_.num_kept();
  }
  int first_input_row(const Contents& contents) const {
    return rows_per_source(contents) * num_sources(contents);
  }
  // Returns V^-1 [G h(0)], all modes x sources.
  ComplexMatrix Participation(const Contents& contents,
                              const Vector& start) const;
  // Returns c: (H_h + H_a F) V, channels x all modes.
  ComplexMatrix ChannelModes(const ObservationMap& observation) const;
  // Adds to a combination sum_m Re(weight_m a_m z_m) of one source's kept
  // modes, or the same with their p.
  void AddCombination(const Contents& contents, int source, bool slopes,
                      const ComplexVector& a,
                      Eigen::Ref<Vector> combination) const;
  // Adds sum_m modes_km (sum_source participation_m,source z_m,source) to
  // combination k, for all rows of `modes` (all modes as columns).
  void AddModes(const Contents& contents, const ComplexMatrix& modes,
                const ComplexMatrix& participation, Matrix* combinations) const;
  // Adds the derivatives by parameter `j` as column `column` of each table.
  void AddParameter(const Contents& contents, const ObservationMap& observation,
                    const ComplexMatrix& channel_modes,
                    const ComplexMatrix& participation, int j,
                    Eigen::Index column, std::vector<Matrix>* tables) const;

  Vector theta_;
  double step_ = 0.0;
  int substeps_ = 0;
  Integrator integrator_ = Integrator::kRungeKutta;
  bool has_parameters_ = false;
  bool ok_ = false;
  int num_inputs_ = 0;
  ParameterizedMap rate_;
  ModalBasis basis_;
  // 1 / (lambda_k - lambda_m), or 0 for nearly equal eigenvalues. near_ lists
  // the places of the latter (without the diagonal).
  ComplexMatrix inverse_gaps_;
  std::vector<std::pair<int, int>> near_;
};

}  // namespace pinode

#endif  // PINODE_INTEGRATE_MODAL_RESPONSE_H_
