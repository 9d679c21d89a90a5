#include "pinode/problem/parameter_layout.h"

#include <algorithm>
#include <string>

#include "pinode/base/logging.h"

namespace pinode {

std::vector<int> ParameterLayout::GroupWeights(const NetworkTerm& term,
                                               int network) {
  const NetworkArchitecture& architecture = term.network->architecture();
  const WeightLayout& layout = term.network->layout();
  std::vector<int> groups(static_cast<size_t>(layout.size), -1);
  if (architecture.IsLinear()) return groups;
  using Kind = DecayGroup::Kind;
  const auto add_group = [&](const std::string& name, Kind kind) {
    decay_groups_.push_back(
        {network, term.name + ", " + name, kind, term.decay});
    return num_decay_groups() - 1;
  };
  const auto set = [&groups](const WeightLayout::Part& part, int row, int col,
                             int group) {
    groups[static_cast<size_t>(part.offset + col * part.rows + row)] = group;
  };
  // The hidden units of a network of time are a basis, spread over the record.
  // A prior that draws them to t = 0 would move them away from their places.
  const bool of_time = std::all_of(
      term.features.begin(), term.features.end(), [](const Feature& feature) {
        return feature.kind == Feature::Kind::kTime;
      });
  if (of_time) {
    const WeightLayout::Part& outputs = layout.weights.back();
    for (int i = 0; i < outputs.rows; ++i) {
      const int group =
          add_group("output " + std::to_string(i + 1), Kind::kOutput);
      for (int j = 0; j < outputs.cols; ++j) set(outputs, i, j, group);
    }
    return groups;
  }
  const WeightLayout::Part& first = layout.weights.front();
  for (int j = 0; j < first.cols; ++j) {
    const int group = add_group("input " + std::to_string(j + 1), Kind::kInput);
    for (int i = 0; i < first.rows; ++i) set(first, i, j, group);
  }
  for (int l = 1; l + 1 < layout.num_layers(); ++l) {
    const WeightLayout::Part& part = layout.weights[static_cast<size_t>(l)];
    const int group = add_group("layer " + std::to_string(l + 1), Kind::kLayer);
    for (int j = 0; j < part.cols; ++j) {
      for (int i = 0; i < part.rows; ++i) set(part, i, j, group);
    }
  }
  const WeightLayout::Part& last = layout.weights.back();
  for (int i = 0; i < last.rows; ++i) {
    const int group =
        add_group("output " + std::to_string(i + 1), Kind::kOutput);
    for (int j = 0; j < last.cols; ++j) set(last, i, j, group);
  }
  if (architecture.bias) {
    const int group = add_group("biases", Kind::kBiases);
    for (int l = 0; l + 1 < layout.num_layers(); ++l) {
      const WeightLayout::Part& part = layout.biases[static_cast<size_t>(l)];
      for (int i = 0; i < part.rows; ++i) set(part, i, 0, group);
    }
  }
  return groups;
}

void ParameterLayout::AddCombinations(const std::string& name,
                                      const CombinationPrior& prior,
                                      DecayGroup::Kind kind,
                                      int first_parameter) {
  if (prior.combinations.empty()) return;
  // Either all of its parameters are free, or none.
  const int first = FreeIndex(first_parameter);
  if (first < 0) return;
  const int first_group = num_decay_groups();
  for (int g = 0; g < prior.num_groups(); ++g) {
    decay_groups_.push_back({-1, name + ", part " + std::to_string(g + 1), kind,
                             prior.precisions[static_cast<size_t>(g)]});
  }
  for (const CombinationPrior::Combination& c : prior.combinations) {
    decay_rows_.push_back({first_group + c.group, first + c.first, c.weights});
  }
}

bool ParameterLayout::HasNetworkDecay() const {
  return std::any_of(
      decay_groups_.begin(), decay_groups_.end(),
      [](const DecayGroup& group) { return group.network >= 0; });
}

bool ParameterLayout::HasForceDecay() const {
  return std::any_of(decay_groups_.begin(), decay_groups_.end(),
                     [](const DecayGroup& group) {
                       return group.kind == DecayGroup::Kind::kForce;
                     });
}

ParameterLayout::ParameterLayout(const IdentificationProblem& problem) {
  const StructuralDynamics& dynamics = *problem.dynamics;
  const auto add = [&](const ParameterBlock& block, int network) {
    std::vector<int> groups(static_cast<size_t>(block.size()), -1);
    if (network >= 0) {
      groups = GroupWeights(dynamics.networks()[static_cast<size_t>(network)],
                            network);
    }
    for (int i = 0; i < block.size(); ++i) {
      const size_t entry = static_cast<size_t>(i);
      const int index = num_parameters();
      all_.push_back(block.parameters[entry]);
      named_.push_back(block.named);
      decay_group_.push_back(groups[entry]);
      free_index_.push_back(all_.back().free ? num_free() : -1);
      if (!all_.back().free) continue;
      if (groups[entry] >= 0) {
        decay_rows_.push_back({groups[entry], num_free(), Vector::Ones(1)});
      }
      free_.push_back(index);
    }
  };
  const int first_network = dynamics.network_block(0);
  for (int b = 0; b < static_cast<int>(dynamics.blocks().size()); ++b) {
    add(dynamics.blocks()[static_cast<size_t>(b)],
        b >= first_network ? b - first_network : -1);
  }
  num_dynamics_ = num_parameters();
  for (size_t j = 0; j < dynamics.unknown_forces().size(); ++j) {
    const UnknownForceTerm& term = dynamics.unknown_forces()[j];
    AddCombinations(term.name, term.prior, DecayGroup::Kind::kForce,
                    dynamics.block_offset(
                        dynamics.unknown_force_block(static_cast<int>(j))));
  }
  for (size_t j = 0; j < dynamics.group_curves().size(); ++j) {
    const GroupCurve& curve = dynamics.group_curves()[j];
    AddCombinations(
        curve.parameters.name, curve.prior, DecayGroup::Kind::kCurve,
        dynamics.block_offset(dynamics.group_curve_block(static_cast<int>(j))));
  }
  add(problem.sensors, -1);
  ties_ = FindTies(problem.ParameterBlocks());
  num_free_dynamics_ = dynamics.num_tangent_columns();
}

ParameterLayout::Dependence ParameterLayout::DependenceOf(int index) const {
  for (const ParameterTie& tie : ties_) {
    if (tie.parameter == index) return {FreeIndex(tie.source), tie.factor};
  }
  return {FreeIndex(index), 1.0};
}

int ParameterLayout::FreeIndex(const std::string& name) const {
  for (int i = 0; i < num_parameters(); ++i) {
    if (parameter(i).name == name) return FreeIndex(i);
  }
  return -1;
}

Vector ParameterLayout::InitialValues() const {
  Vector values(num_parameters());
  for (int i = 0; i < num_parameters(); ++i) values[i] = parameter(i).value;
  ApplyTies(ties_, values.data());
  return values;
}

Vector ParameterLayout::Free(const Vector& all) const {
  CHECK_EQ(all.size(), num_parameters());
  Vector free(num_free());
  for (int j = 0; j < num_free(); ++j) {
    free[j] = all[free_[static_cast<size_t>(j)]];
  }
  return free;
}

void ParameterLayout::SetFree(const Vector& free, Vector* all) const {
  CHECK_EQ(free.size(), num_free());
  CHECK_EQ(all->size(), num_parameters());
  for (int j = 0; j < num_free(); ++j) {
    (*all)[free_[static_cast<size_t>(j)]] = free[j];
  }
  ApplyTies(ties_, all->data());
}

}  // namespace pinode
