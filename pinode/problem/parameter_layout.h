// Order of a problem's parameters in one vector, and of the free ones in
// another.

#ifndef PINODE_PROBLEM_PARAMETER_LAYOUT_H_
#define PINODE_PROBLEM_PARAMETER_LAYOUT_H_

#include <string>
#include <vector>

#include "pinode/base/parameter_block.h"
#include "pinode/base/types.h"
#include "pinode/problem/identification_problem.h"

namespace pinode {

// Order of a problem's parameters. One vector has all parameters, first those
// of the dynamics, then those of sensors. A second vector has the free ones in
// the same order. The second vector is the parameter block that Ceres changes.
//
// Names in this layer of code: `parameters` is the vector of all, `theta` its
// first part with all parameters of the dynamics, `free` the vector of free
// ones. An `index` counts in `parameters`. `j`, and the columns of derivatives,
// count in `free`.
class ParameterLayout {
 public:
  // Copies the parameters of `problem`, which must be valid.
  explicit ParameterLayout(const IdentificationProblem& problem);

  // Numbers of all parameters, of those of the dynamics, and of free ones.
  int num_parameters() const { return static_cast<int>(all_.size()); }
  int num_dynamics() const { return num_dynamics_; }
  int num_free() const { return static_cast<int>(free_.size()); }

  // The parameter with this index in `parameters`.
  const Parameter& parameter(int index) const {
    return all_[static_cast<size_t>(index)];
  }
  // True if reports list the parameter by name; false for network weights.
  bool IsNamed(int index) const { return named_[static_cast<size_t>(index)]; }

  // Group of parameters whose Gaussian priors of mean zero share one precision.
  // A network has one group for the weights of each input, of each output and
  // of each layer in between. The hidden biases are a further group. A network
  // of time alone has one for the weights of each output. Unknown forces and
  // curves have the groups of their CombinationPrior.
  //
  // The evidence can choose the precisions. For networks this is automatic
  // relevance determination (R. M. Neal, Bayesian Learning for Neural Networks,
  // 1996): weights of inputs and outputs that are not needed shrink to zero.
  struct DecayGroup {
    enum class Kind { kInput, kLayer, kOutput, kBiases, kForce, kCurve };
    int network = -1;  // index; -1: not of a network
    std::string name;
    Kind kind = Kind::kLayer;
    double given = -1.0;  // precision; negative: chosen by the evidence

    bool IsGiven() const { return given >= 0.0; }
  };
  const std::vector<DecayGroup>& decay_groups() const { return decay_groups_; }
  int num_decay_groups() const {
    return static_cast<int>(decay_groups_.size());
  }
  // True if there is a group of a network, or of an unknown force.
  bool HasNetworkDecay() const;
  bool HasForceDecay() const;

  // Prior of one combination of free parameters. The sum of `weights` times the
  // free parameters from `first` on has mean zero and the precision of its
  // group. A network's weight is a combination of its own.
  struct DecayRow {
    int group = -1;
    int first = 0;  // index in `free`
    Vector weights;

    double Value(const Vector& free) const {
      return weights.dot(free.segment(first, weights.size()));
    }
  };
  const std::vector<DecayRow>& decay_rows() const { return decay_rows_; }

  // Returns the decay group of a network's weight; -1 for any other parameter.
  int DecayGroupOf(int index) const {
    return decay_group_[static_cast<size_t>(index)];
  }

  // Indices of the free parameters in `parameters`, num_free() entries.
  const std::vector<int>& free() const { return free_; }
  // The j-th free parameter.
  const Parameter& free_parameter(int j) const {
    return parameter(free_[static_cast<size_t>(j)]);
  }
  // Number of free parameters of the dynamics. They come first and are in the
  // order of the dynamics' tangent columns. Sensors' parameters follow.
  int num_free_dynamics() const { return num_free_dynamics_; }
  // Returns the position of a parameter in `free`; -1 if it is fixed.
  int FreeIndex(int index) const {
    return free_index_[static_cast<size_t>(index)];
  }
  // Position in `free` that a parameter depends on, and the derivative. A free
  // parameter depends on itself, a tied one on its source, a fixed one on none.
  struct Dependence {
    int free = -1;
    double factor = 1.0;
  };
  Dependence DependenceOf(int index) const;
  // Tied parameters, by indices in `parameters`.
  const std::vector<ParameterTie>& ties() const { return ties_; }
  // Returns the position in `free` of the parameter with this name. -1: it is
  // fixed, or there is none.
  int FreeIndex(const std::string& name) const;

  // Returns the initial values of all parameters, in their units. Tied ones
  // have the values that follow from their sources.
  Vector InitialValues() const;
  // Returns the free entries of `all` (num_parameters() entries).
  Vector Free(const Vector& all) const;
  // Replaces the free entries of `all` by `free` (num_free() entries), and sets
  // the tied ones.
  void SetFree(const Vector& free, Vector* all) const;

 private:
  std::vector<Parameter> all_;
  std::vector<bool> named_;
  // Decay group of each weight of a network, -1 where no decay applies.
  std::vector<int> GroupWeights(const NetworkTerm& term, int network);
  void AddCombinations(const std::string& name, const CombinationPrior& prior,
                       DecayGroup::Kind kind, int first_parameter);

  std::vector<DecayGroup> decay_groups_;
  std::vector<int> decay_group_;
  std::vector<DecayRow> decay_rows_;
  std::vector<int> free_;
  std::vector<int> free_index_;
  std::vector<ParameterTie> ties_;
  int num_dynamics_ = 0;
  int num_free_dynamics_ = 0;
};

}  // namespace pinode

#endif  // PINODE_PROBLEM_PARAMETER_LAYOUT_H_
