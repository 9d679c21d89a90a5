#include "pinode/estimate/parameter_layout.h"

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
    decay_groups_.push_back({network, term.name + ", " + name, kind});
    return num_decay_groups() - 1;
  };
  const auto set = [&groups](const WeightLayout::Part& part, int row, int col,
                             int group) {
    groups[static_cast<size_t>(part.offset + col * part.rows + row)] = group;
  };
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
      if (all_.back().free) free_.push_back(index);
    }
  };
  const int first_network = static_cast<int>(dynamics.blocks().size()) -
                            static_cast<int>(dynamics.networks().size());
  for (int b = 0; b < static_cast<int>(dynamics.blocks().size()); ++b) {
    add(dynamics.blocks()[static_cast<size_t>(b)],
        b >= first_network ? b - first_network : -1);
  }
  num_dynamics_ = num_parameters();
  add(problem.sensors, -1);

  const std::vector<int>& columns = dynamics.tangent_columns();
  for (size_t j = 0; j < columns.size(); ++j) {
    if (FreeIndex(columns[j]) >= 0) {
      tangent_columns_.push_back(static_cast<int>(j));
    }
  }
}

Vector ParameterLayout::InitialValues() const {
  Vector values(num_parameters());
  for (int i = 0; i < num_parameters(); ++i) values[i] = parameter(i).value;
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
}

}  // namespace pinode
