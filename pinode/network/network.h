// Evaluates a network and its derivatives, which are coded by hand.

#ifndef PINODE_NETWORK_NETWORK_H_
#define PINODE_NETWORK_NETWORK_H_

#include <vector>

#include "pinode/base/types.h"
#include "pinode/network/network_architecture.h"

namespace pinode {

class Network;

// One sweep through the layers of a network. All vectors have their final size
// after construction.
class NetworkSweep {
 public:
  // `last_entry` is the factor of the biases.
  NetworkSweep(const NetworkArchitecture& architecture, double last_entry);

  struct Layer {
    // a_{l-1}. If the layer has a bias, one more entry, `last_entry`, follows:
    // W_l and b_l lie side by side and are used as one matrix.
    Vector input;
    // Input of the activation function of this layer. Empty for the last layer.
    Vector preactivation;
    Vector slope;
    // Second derivative of the activation function. The backward sweep
    // multiplies it by the rate's preactivation.
    Vector curvature;
    // D_l = dy/d(preactivation), num_outputs x rows; empty for the last layer,
    // where it is plus or minus the identity.
    Matrix adjoint;
  };
  std::vector<Layer> layers;
};

// A network linearised at one point: its value, its slope, and its derivative
// with respect to the weights in factors,
//
//   dy_o / dW_l(i, j) = D_l(o, i) a_{l-1}(j),    dy_o / db_l(i) = D_l(o, i).
//
// The product is never formed. The gauged form has up to three such products
// per layer: at the point, at rest, and along the rate of change from rest
// towards the point.
class NetworkTangent {
 public:
  explicit NetworkTangent(const Network& network);

  const Vector& value() const { return value_; }
  // dy/dq, num_outputs x num_inputs.
  const Matrix& input_jacobian() const { return input_jacobian_; }

 private:
  friend class Network;

  Vector value_;
  Matrix input_jacobian_;
  // Adjoint of W_1 (q / s) over all sweeps. Only its product with W_1 is
  // stored.
  Matrix first_adjoint_;
  NetworkSweep point_;
  // Sweeps of gauged networks only.
  NetworkSweep rest_;
  NetworkSweep rate_;
};

// Scratch memory of one thread.
class NetworkWorkspace {
 public:
  // Sizes the workspace for products with at most `max_rows` rows and at most
  // `max_stages` tangents at a time. Evaluation alone needs no such memory.
  explicit NetworkWorkspace(const Network& network, int max_rows = 0,
                            int max_stages = 4);

 private:
  friend class Network;

  int max_rows_;
  int max_stages_;
  NetworkSweep point_;
  NetworkSweep rest_;
  NetworkSweep rate_;
  // Products of the factors: one slice per factor of a layer.
  Vector products_;
  int slice_;
  std::vector<const double*> lefts_;
  std::vector<const double*> rights_;
  // Left factors times the outputs' scales, one after the other.
  Vector scaled_lefts_;
  std::vector<const double*> stage_lefts_;
};

// A network of a fixed architecture; see network_architecture.h for its
// equations. It stores no weights. Callers pass them as one flat block in the
// order of WeightLayout, so one object serves every thread and every iterate.
// Its methods allocate no memory, unless stated.
class Network {
 public:
  // The architecture must be valid.
  explicit Network(NetworkArchitecture architecture);

  const NetworkArchitecture& architecture() const { return architecture_; }
  const WeightLayout& layout() const { return layout_; }
  int num_inputs() const { return architecture_.num_inputs; }
  int num_outputs() const { return architecture_.num_outputs; }
  int num_weights() const { return layout_.size; }

  // Computes y = g(q), or the gauged y(q). `q` has num_inputs entries, in the
  // features' units. `y` has num_outputs entries.
  void Evaluate(const double* q, const double* weights, double* y,
                NetworkWorkspace* workspace) const;

  // Computes value, slope and factors at q.
  void Linearize(const double* q, const double* weights,
                 NetworkTangent* tangent) const;

  // Computes B += left * dy/dweights. `left` is m x num_outputs. `B` is m x
  // num_weights, column-major, without gaps. m is at most the workspace's
  // max_rows.
  void AddWeightTangent(const NetworkTangent& tangent, const Matrix& left,
                        NetworkWorkspace* workspace, double* B) const;

  // Computes B += sum_s lefts[s] * dy/dweights at stages[s], for `count` stages
  // (at most the workspace's max_stages) in one pass over B. All `lefts` have
  // the same number of rows.
  void AddWeightTangents(const NetworkTangent* const* stages,
                         const Matrix* const* lefts, int count,
                         NetworkWorkspace* workspace, double* B) const;

  // Returns dy/dweights as one matrix, num_outputs x num_weights. Allocates.
  Matrix WeightJacobian(const NetworkTangent& tangent) const;

 private:
  // Sets the sweeps' inputs of every layer. With `tangent`, also sets the data
  // that the adjoints need.
  void SweepForward(const double* q, const double* weights, bool tangent,
                    NetworkSweep* point, NetworkSweep* rest,
                    NetworkSweep* rate) const;
  // Does the same for one of `point` and `rest`, whose first input is set.
  void SweepLayers(const double* weights, bool slope, bool curvature,
                   NetworkSweep* sweep) const;
  void EvaluateOutput(const NetworkSweep& point, const double* weights,
                      double* y) const;
  void SweepBackward(const double* weights, NetworkTangent* tangent) const;
  // Applies the scales of inputs and outputs to the Jacobian of the inner
  // network.
  void ScaleJacobian(Matrix* jacobian) const;
  // Points the workspace at `lefts`, multiplied by the outputs' scales.
  void ScaleLefts(const Matrix* const* lefts, int count,
                  NetworkWorkspace* workspace) const;

  NetworkArchitecture architecture_;
  WeightLayout layout_;
  Vector inverse_scale_;
};

}  // namespace pinode

#endif  // PINODE_NETWORK_NETWORK_H_
