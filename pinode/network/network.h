// Evaluation of a network and of its derivatives, which are coded by hand.

#ifndef PINODE_NETWORK_NETWORK_H_
#define PINODE_NETWORK_NETWORK_H_

#include <vector>

#include "pinode/base/types.h"
#include "pinode/network/network_architecture.h"

namespace pinode {

class Network;

// Values of one sweep through the layers of a network. All vectors have their
// final size after construction. Layer l has the symbols of
// NetworkArchitecture.
class NetworkSweep {
 public:
  // Allocates the sweep. `last_entry` is the factor of the biases, 1 or 0.
  NetworkSweep(const NetworkArchitecture& architecture, double last_entry);

  // Values of one layer.
  struct Layer {
    // Input a_{l-1}. If the layer has a bias, `last_entry` follows as one more
    // entry, so that [W_l, b_l] acts as one matrix.
    Vector input;
    // Argument of the activation function, and the function's slope there.
    // Empty for the last layer.
    Vector preactivation;
    Vector slope;
    // Second derivative of the activation function. The backward sweep
    // multiplies it by the preactivation of the rate sweep.
    Vector curvature;
    // Derivative D_l = dy/d(preactivation), num_outputs x rows of W_l. Empty
    // for the last layer, where it is plus or minus the identity.
    Matrix adjoint;
  };
  std::vector<Layer> layers;
};

// Network linearised at one point: its value, its slope, and the factors D_l
// and a_{l-1} of its derivative with respect to the weights,
//
//   dy_o / dW_l(i, j) = D_l(o, i) a_{l-1}(j),    dy_o / db_l(i) = D_l(o, i).
//
// The products are not stored. The gauged form has up to three such products
// per layer: at the point, at rest, and for the rate of change from rest
// towards the point.
class NetworkTangent {
 public:
  explicit NetworkTangent(const Network& network);

  // Value y, num_outputs entries in the outputs' units.
  const Vector& value() const { return value_; }
  // Slope dy/dq, num_outputs x num_inputs.
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

// Working memory of one thread.
class NetworkWorkspace {
 public:
  // Allocates memory for AddWeightTangents with at most `max_rows` rows and at
  // most `max_stages` tangents at a time. Evaluate() alone needs no rows.
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

// Network of a fixed architecture; NetworkArchitecture has its equations. It
// stores no weights: callers pass them as one block of num_weights() entries in
// the order of WeightLayout. One object therefore serves several threads and
// several sets of weights. Its methods allocate no memory, unless stated.
class Network {
 public:
  // Creates the network. The architecture must be valid.
  explicit Network(NetworkArchitecture architecture);

  const NetworkArchitecture& architecture() const { return architecture_; }
  const WeightLayout& layout() const { return layout_; }
  int num_inputs() const { return architecture_.num_inputs; }
  int num_outputs() const { return architecture_.num_outputs; }
  int num_weights() const { return layout_.size; }

  // Computes y = g(q), or the gauged y(q). `q` has num_inputs() entries in the
  // features' units. `y` has num_outputs() entries in the outputs' units.
  void Evaluate(const double* q, const double* weights, double* y,
                NetworkWorkspace* workspace) const;

  // Computes value, slope and factors at q (num_inputs() entries).
  void Linearize(const double* q, const double* weights,
                 NetworkTangent* tangent) const;

  // Adds left * dy/dweights to B. `left` is m x num_outputs(). `B` is m x
  // num_weights(), stored by columns without gaps. m is at most the workspace's
  // max_rows.
  void AddWeightTangent(const NetworkTangent& tangent, const Matrix& left,
                        NetworkWorkspace* workspace, double* B) const;

  // Adds sum_s lefts[s] * (dy/dweights at stages[s]) to B, for `count` stages
  // in one pass over B. `count` is at most the workspace's max_stages. All
  // `lefts` have the same number of rows.
  void AddWeightTangents(const NetworkTangent* const* stages,
                         const Matrix* const* lefts, int count,
                         NetworkWorkspace* workspace, double* B) const;

  // Returns dy/dweights, num_outputs() x num_weights(). Allocates memory.
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
