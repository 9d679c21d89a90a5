// The free unknowns of a problem, as one vector.

#ifndef PINODE_PROBLEM_PARAMETER_LAYOUT_H_
#define PINODE_PROBLEM_PARAMETER_LAYOUT_H_

#include <string>
#include <vector>

#include "pinode/base/types.h"
#include "pinode/problem/identification_problem.h"

namespace pinode {

// All parameters of a problem in one flat vector, dynamics first, then sensors.
// The free ones among them form a second vector, in the same order. This second
// vector is the parameter block that Ceres sees.
//
// Names in this layer: `parameters` are all of the problem's. `theta` are all
// of the dynamics', which come first among them. `free` are the free ones. An
// `index` counts among all of them; `j` and a column of a derivative count
// among the free ones.
class ParameterLayout {
 public:
  explicit ParameterLayout(const IdentificationProblem& problem);

  int num_parameters() const { return static_cast<int>(all_.size()); }
  int num_dynamics() const { return num_dynamics_; }
  int num_free() const { return static_cast<int>(free_.size()); }

  const Parameter& parameter(int index) const {
    return all_[static_cast<size_t>(index)];
  }
  // True if the entry is reported by name (not a network weight).
  bool IsNamed(int index) const { return named_[static_cast<size_t>(index)]; }

  // Group of parameters that share one decay precision. For a network: the
  // weights of each input, those of each output, the hidden biases, and each
  // layer in between. For a network of time alone: the weights of each output.
  // With precisions chosen by the evidence this is automatic relevance
  // determination (R. M. Neal, Bayesian Learning for Neural Networks, 1996):
  // unneeded inputs and outputs are shrunk away. For unknown forces and curves
  // of groups: the groups of their CombinationPrior.
  struct DecayGroup {
    enum class Kind { kInput, kLayer, kOutput, kBiases, kForce, kCurve };
    int network = -1;  // -1: not in any network
    std::string name;
    Kind kind = Kind::kLayer;
    double given = -1.0;  // negative: the evidence chooses

    bool IsGiven() const { return given >= 0.0; }
  };
  const std::vector<DecayGroup>& decay_groups() const { return decay_groups_; }
  int num_decay_groups() const {
    return static_cast<int>(decay_groups_.size());
  }
  // True if any of the groups is a network's, or an unknown force's.
  bool HasNetworkDecay() const;
  bool HasForceDecay() const;

  // Decay of a combination: weights . (free parameters from `first` on) is
  // normally distributed around zero with the precision of its group. A
  // network's weight forms a row of its own.
  struct DecayRow {
    int group = -1;
    int first = 0;  // among the free ones
    Vector weights;

    double Value(const Vector& free) const {
      return weights.dot(free.segment(first, weights.size()));
    }
  };
  const std::vector<DecayRow>& decay_rows() const { return decay_rows_; }

  // Index of the decay group of a network's weight; -1 for anything else.
  int DecayGroupOf(int index) const {
    return decay_group_[static_cast<size_t>(index)];
  }

  // Indices of the free parameters in the full vector.
  const std::vector<int>& free() const { return free_; }
  // The j-th free parameter.
  const Parameter& free_parameter(int j) const {
    return parameter(free_[static_cast<size_t>(j)]);
  }
  // Number of free parameters of the dynamics. They come first and are in the
  // order of the dynamics' tangent columns. Sensors' parameters follow.
  int num_free_dynamics() const { return num_free_dynamics_; }
  // Position among the free parameters, -1 where fixed.
  int FreeIndex(int index) const {
    return free_index_[static_cast<size_t>(index)];
  }
  // Position by name; -1 also if there is no such parameter.
  int FreeIndex(const std::string& name) const;

  Vector InitialValues() const;
  Vector Free(const Vector& all) const;
  // Replaces the free entries of `all`.
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
  int num_dynamics_ = 0;
  int num_free_dynamics_ = 0;
};

}  // namespace pinode

#endif  // PINODE_PROBLEM_PARAMETER_LAYOUT_H_
