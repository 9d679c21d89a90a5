#include <algorithm>
#include <cmath>
#include <map>
#include <sstream>

#include "pinode/base/parameter_block.h"
#include "pinode/base/strings.h"

namespace pinode {
namespace {

// Parameters of all blocks by index, and the indices of those with names.
struct NamedParameters {
  explicit NamedParameters(const std::vector<const ParameterBlock*>& blocks) {
    for (const ParameterBlock* block : blocks) {
      for (const Parameter& parameter : block->parameters) {
        if (block->named) {
          index.emplace(parameter.name, static_cast<int>(all.size()));
        }
        all.push_back(&parameter);
      }
    }
  }

  std::vector<const Parameter*> all;
  std::map<std::string, int> index;
};

bool HasTies(const std::vector<const ParameterBlock*>& blocks) {
  return std::any_of(
      blocks.begin(), blocks.end(), [](const ParameterBlock* block) {
        return std::any_of(block->parameters.begin(), block->parameters.end(),
                           [](const Parameter& p) { return p.IsTied(); });
      });
}

// Checks the values that `tied` gets within the bounds of its source.
bool StaysInBounds(const Parameter& tied, const Parameter& source,
                   std::string* error) {
  for (const double bound : {source.lower, source.upper, source.value}) {
    const double value = tied.tie_factor * bound;
    if (value >= tied.lower && value <= tied.upper) continue;
    std::ostringstream message;
    message << "it may become " << FormatNumber(value, 6) << ", expected ["
            << FormatNumber(tied.lower, 6) << ", "
            << FormatNumber(tied.upper, 6)
            << "]; change 'tie_factor', or the bounds of '" << source.name
            << "'";
    *error = message.str();
    return false;
  }
  return true;
}

// Describes where else a chain of ties goes: back to its beginning, or to a
// parameter that is not tied.
std::string Chain(const NamedParameters& parameters, const Parameter& tied) {
  std::string text = "'" + tied.tie + "' is tied itself";
  const Parameter* at = &tied;
  for (size_t steps = 0; steps <= parameters.all.size(); ++steps) {
    const auto found = parameters.index.find(at->tie);
    if (found == parameters.index.end()) return text;
    at = parameters.all[static_cast<size_t>(found->second)];
    if (at == &tied)
      return text + ", and ties go in a circle; free one of them";
    if (!at->IsTied()) return text + "; tie to '" + at->name + "'";
  }
  return text + ", and ties go in a circle; free one of them";
}

}  // namespace

std::vector<ParameterTie> FindTies(
    const std::vector<const ParameterBlock*>& blocks) {
  std::vector<ParameterTie> ties;
  if (!HasTies(blocks)) return ties;
  const NamedParameters parameters(blocks);
  for (size_t i = 0; i < parameters.all.size(); ++i) {
    const Parameter& parameter = *parameters.all[i];
    if (!parameter.IsTied()) continue;
    const auto found = parameters.index.find(parameter.tie);
    if (found == parameters.index.end() ||
        parameters.all[static_cast<size_t>(found->second)]->IsTied()) {
      continue;
    }
    ties.push_back({static_cast<int>(i), found->second, parameter.tie_factor});
  }
  return ties;
}

bool AreTiesValid(const std::vector<const ParameterBlock*>& blocks,
                  std::string* parameter, std::string* error) {
  if (!HasTies(blocks)) return true;
  const NamedParameters parameters(blocks);
  for (const Parameter* tied : parameters.all) {
    if (!tied->IsTied()) continue;
    *parameter = tied->name;
    const auto found = parameters.index.find(tied->tie);
    if (found == parameters.index.end()) {
      std::vector<std::string> free;
      for (const Parameter* other : parameters.all) {
        const auto named = parameters.index.find(other->name);
        if (other->free && named != parameters.index.end()) {
          free.push_back(other->name);
        }
      }
      *error = "no unknown is named '" + tied->tie + "'" +
               (free.empty() ? std::string()
                             : ", expected one of " + Join(free, ", "));
      return false;
    }
    const Parameter& source =
        *parameters.all[static_cast<size_t>(found->second)];
    if (&source == tied) {
      *error = "it is tied to itself; name another unknown";
      return false;
    }
    if (source.IsTied()) {
      *error = Chain(parameters, *tied);
      return false;
    }
    if (tied->tie_factor == 0.0 || !std::isfinite(tied->tie_factor)) {
      *error = "'tie_factor' is " + FormatNumber(tied->tie_factor) +
               ", expected a number that is not zero";
      return false;
    }
    if (!StaysInBounds(*tied, source, error)) return false;
  }
  return true;
}

}  // namespace pinode
