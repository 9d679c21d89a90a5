#include "pinode/problem/parameter_profile.h"

#include <cmath>

namespace pinode {

const char* DeterminationName(Determination determination) {
  switch (determination) {
    case Determination::kDetermined:
      return "determined";
    case Determination::kOneSided:
      return "one-sided";
    case Determination::kNotHere:
      return "not determined by these data";
    case Determination::kNotAtAll:
      return "not determined at all";
  }
  return "";
}

bool ParameterProfile::DiffersFromLinear() const {
  constexpr double kShare = 0.2;
  const auto differs = [this](double end, double linear) {
    if (!std::isfinite(end) || !std::isfinite(linear)) {
      return std::isfinite(end) != std::isfinite(linear);
    }
    return std::abs(end - linear) > kShare * std::abs(linear - estimate);
  };
  return differs(lower95, linear_lower95) || differs(upper95, linear_upper95);
}

}  // namespace pinode
