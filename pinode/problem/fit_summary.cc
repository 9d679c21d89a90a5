#include "pinode/problem/fit_summary.h"

#include <algorithm>
#include <cmath>

namespace pinode {

void FollowSources(std::vector<ParameterEstimate>* parameters) {
  for (ParameterEstimate& tied : *parameters) {
    if (tied.tie.empty()) continue;
    const auto source = std::find_if(
        parameters->begin(), parameters->end(),
        [&tied](const ParameterEstimate& p) { return p.name == tied.tie; });
    if (source == parameters->end() || !source->tie.empty()) continue;
    const double factor = tied.tie_factor;
    tied.value = factor * source->value;
    tied.sigma = std::abs(factor) * source->sigma;
    tied.half_width95 = std::abs(factor) * source->half_width95;
    tied.lower95 = factor * (factor > 0.0 ? source->lower95 : source->upper95);
    tied.upper95 = factor * (factor > 0.0 ? source->upper95 : source->lower95);
    tied.at_bound = source->at_bound;
  }
}

}  // namespace pinode
