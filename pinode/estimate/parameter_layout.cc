#include "pinode/estimate/parameter_layout.h"

#include <string>

#include "pinode/base/logging.h"

namespace pinode {

ParameterLayout::ParameterLayout(const IdentificationProblem& problem) {
  const StructuralDynamics& dynamics = *problem.dynamics;
  const auto add = [this](const ParameterBlock& block, int network) {
    for (int i = 0; i < block.size(); ++i) {
      const size_t entry = static_cast<size_t>(i);
      const bool decays = !block.decays.empty() && block.decays[entry];
      const int index = num_parameters();
      all_.push_back(block.parameters[entry]);
      named_.push_back(block.named);
      decay_group_.push_back(decays ? network : -1);
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
