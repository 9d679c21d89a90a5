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

// With F = V diag(lambda) V^-1 a channel of a run from h(0) at its first sample
// is
//
//   y = sum_m c_m (sum_u b_mu z_mu + s_m z_m0) + D u,
//
// c = (H_h + H_a F) V, b = V^-1 G, s = V^-1 h(0); z_mu is mode m's response to
// input u alone, z_m0 the one to a start at 1. By a parameter the response of a
// mode goes along with its p = d z / d lambda, and with E = V^-1 F_j V
//
//   d/d theta_j [V z(lambda) V^-1] = V (E o Z) V^-1,
//   Z_km = (z_k - z_m) / (lambda_k - lambda_m),  Z_mm = p_m
//
// (Y. L. Daletskii and S. G. Krein, AMS Translations 47 (1965) 1-30; for two
// eigenvalues that are all but equal the mean of their p). So every channel and
// every derivative of it is a combination, constant in time, of the same
// histories: real and imaginary parts of z and p, the inputs, and 1. Their
// number does not depend on that of parameters and channels, nor does the work
// for a sample.
class ModalResponse {
 public:
  // Which histories there are: `with_slopes` those of p as well; `with_start`
  // the responses to a start.
  struct Contents {
    bool with_slopes = false;
    bool with_start = false;
  };

  // State of the histories at a sample; what comes behind it depends on nothing
  // else.
  struct State {
    ComplexMatrix z;  // kept modes x sources: the inputs, then the start
    ComplexMatrix p;
  };

  // Takes apart the dynamics at `prepared`; keeps what it has where they are
  // the same. False where the modes do not span the states, see ModalBasis.
  [[nodiscard]] bool Prepare(const StructuralDynamics& dynamics,
                             const StructuralDynamics::Prepared& prepared,
                             const IntegrationGrid& grid, bool with_parameters);

  // R: of the histories.
  int NumRows(const Contents& contents) const;
  // The last row, which is 1 throughout.
  int ConstantRow(const Contents& contents) const {
    return NumRows(contents) - 1;
  }

  // At rest, and with a start of 1, at the first sample.
  State Begin(const Contents& contents) const;
  // The histories at samples first ... first + count - 1, R x count, from the
  // state at sample `first`; leaves the state at sample first + count, or at
  // the grid's last sample where that is behind it. nullptr: the state alone,
  // which takes a fraction of the work.
  void Advance(const Contents& contents, const IntegrationGrid& grid,
               Eigen::Index first, Eigen::Index count, State* state,
               Matrix* histories) const;

  // R x channels, the channels of a run from `start`: values' * histories.
  Matrix Values(const Contents& contents, const ObservationMap& observation,
                const Vector& start) const;
  // R x columns for each channel: its derivatives by the start (num_states
  // columns, in units of the states) and by the free parameters, which threads
  // share. The latter need the slopes.
  std::vector<Matrix> Derivatives(const Contents& contents,
                                  const ObservationMap& observation,
                                  const Vector& start, bool by_start,
                                  bool by_parameters,
                                  int num_threads = 1) const;
  // R x num_states, the states of a run from `start`: states' * histories.
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
  // V^-1 [G h(0)], all modes x sources.
  ComplexMatrix Participation(const Contents& contents,
                              const Vector& start) const;
  // c: (H_h + H_a F) V, channels x all modes.
  ComplexMatrix ChannelModes(const ObservationMap& observation) const;
  // Adds to a combination sum_m Re(weight_m a_m z_m) of one source's kept
  // modes, or of their p.
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
  // 1 / (lambda_k - lambda_m), 0 for those that are all but equal, whose places
  // are in near_ (without the diagonal).
  ComplexMatrix inverse_gaps_;
  std::vector<std::pair<int, int>> near_;
};

}  // namespace pinode

#endif  // PINODE_INTEGRATE_MODAL_RESPONSE_H_
