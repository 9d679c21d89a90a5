#include "pinode/dynamics/unknown_force.h"

#include <ceres/jet.h>

#include <algorithm>
#include <cmath>
#include <sstream>

#include "pinode/base/constants.h"
#include "pinode/base/logging.h"

namespace pinode {
namespace {

template <typename T>
T HalfSine(double time, const T* parameters) {
  using std::sin;
  const T phase = (time - parameters[0]) / parameters[1];
  if (!(phase > T(0.0)) || !(phase < T(1.0))) return T(0.0);
  return parameters[2] * sin(kPi * phase);
}

}  // namespace

SplineForce::SplineForce(const Options& options) : options_(options) {
  std::string error;
  CHECK(AreValid(options, &error)) << error;
}

bool SplineForce::AreValid(const Options& options, std::string* error) {
  if (options.degree != 1 && options.degree != 3) {
    *error = "a spline of degree " + std::to_string(options.degree) +
             ", expected 1 or 3";
  } else if (!(options.spacing > 0.0) || !std::isfinite(options.spacing)) {
    *error = "the spacing of a spline's knots is not positive";
  } else if (options.num_knots < 1) {
    *error = "a spline without knots";
  } else if (!std::isfinite(options.start) || !std::isfinite(options.scale)) {
    *error = "the start or the scale of a spline is not finite";
  } else {
    return true;
  }
  return false;
}

ForceHistory::Local SplineForce::Basis(double time) const {
  Local local;
  const double place = (time - options_.start) / options_.spacing;
  // Far outside, the conversion to int below would be undefined.
  if (!(place > -2.0) || !(place < options_.num_knots + 1.0)) return local;
  const double left = std::floor(place);
  const double s = place - left;  // within the interval, 0 to 1
  double basis[kMostLocal];
  int first = static_cast<int>(left);
  int count = 2;
  if (options_.degree == 1) {
    basis[0] = 1.0 - s;
    basis[1] = s;
  } else {
    const double r = 1.0 - s;
    basis[0] = r * r * r / 6.0;
    basis[1] = (4.0 - 6.0 * s * s + 3.0 * s * s * s) / 6.0;
    basis[2] = (4.0 - 6.0 * r * r + 3.0 * r * r * r) / 6.0;
    basis[3] = s * s * s / 6.0;
    first -= 1;
    count = 4;
  }
  const int from = std::max(first, 0);
  const int to = std::min(first + count, options_.num_knots);
  local.first = from;
  local.count = std::max(0, to - from);
  for (int i = 0; i < local.count; ++i) {
    local.derivatives[i] = options_.scale * basis[from - first + i];
  }
  return local;
}

ForceHistory::Local SplineForce::Evaluate(double time,
                                          const double* parameters) const {
  Local local = Basis(time);
  for (int i = 0; i < local.count; ++i) {
    local.value += local.derivatives[i] * parameters[local.first + i];
  }
  return local;
}

WideJet SplineForce::Evaluate(double time, const WideJet* parameters) const {
  const Local local = Basis(time);
  WideJet value(0.0);
  for (int i = 0; i < local.count; ++i) {
    value += local.derivatives[i] * parameters[local.first + i];
  }
  return value;
}

std::string SplineForce::Description() const {
  std::ostringstream text;
  text.precision(17);
  text << "spline of degree " << options_.degree << ", " << options_.num_knots
       << " knots every " << options_.spacing << " from " << options_.start
       << ", scale " << options_.scale;
  return text.str();
}

ForceHistory::Local HalfSinePulse::Evaluate(double time,
                                            const double* parameters) const {
  using Jet = ceres::Jet<double, 3>;
  const Jet arguments[] = {Jet(parameters[0], 0), Jet(parameters[1], 1),
                           Jet(parameters[2], 2)};
  const Jet result = HalfSine(time, arguments);
  Local local;
  local.value = result.a;
  local.count = 3;
  for (int i = 0; i < 3; ++i) local.derivatives[i] = result.v[i];
  return local;
}

WideJet HalfSinePulse::Evaluate(double time, const WideJet* parameters) const {
  return HalfSine(time, parameters);
}

bool CombinationPrior::IsValid(int num_parameters, int num_free,
                               std::string* error) const {
  if (!std::all_of(combinations.begin(), combinations.end(),
                   [this, num_parameters](const Combination& c) {
                     return c.first >= 0 && c.group >= 0 &&
                            c.group < num_groups() &&
                            c.first + c.weights.size() <= num_parameters;
                   })) {
    *error = "its prior does not fit its parameters";
    return false;
  }
  if (!combinations.empty() && num_free > 0 && num_free < num_parameters) {
    *error = "all of its parameters are free, or none, where it has a prior";
    return false;
  }
  return true;
}

double CombinationPrior::ShareToBeChosen() const {
  const auto chosen = std::count_if(
      combinations.begin(), combinations.end(), [this](const Combination& c) {
        return precisions[static_cast<size_t>(c.group)] < 0.0;
      });
  return combinations.empty() ? 1.0
                              : static_cast<double>(chosen) /
                                    static_cast<double>(combinations.size());
}

CombinationPrior SmoothnessPrior(int num_knots, int neighbourhood,
                                 double relaxation) {
  CHECK_GT(num_knots, 0);
  CHECK_GT(neighbourhood, 0);
  CombinationPrior prior;
  for (int k = 0; k < num_knots; ++k) {
    CombinationPrior::Combination combination;
    combination.group = k / neighbourhood;
    combination.first = std::max(0, k - 1);
    const int last = std::min(num_knots - 1, k + 1);
    combination.weights = Vector::Ones(last - combination.first + 1);
    combination.weights[k - combination.first] = -2.0 - relaxation * relaxation;
    prior.combinations.push_back(std::move(combination));
  }
  prior.precisions.assign(
      static_cast<size_t>(prior.combinations.back().group) + 1, -1.0);
  return prior;
}

CombinationPrior BandPrior(int num_knots, double spacing, double lowest,
                           double highest, double outside) {
  CHECK_GT(num_knots, 0);
  CHECK_GT(spacing, 0.0);
  CombinationPrior prior;
  prior.precisions = {-1.0, outside};
  for (int m = 0; m < num_knots; ++m) {
    const double frequency = m / (2.0 * num_knots * spacing);
    CombinationPrior::Combination combination;
    combination.group = frequency >= lowest && frequency <= highest ? 0 : 1;
    combination.weights.resize(num_knots);
    const double norm = std::sqrt((m == 0 ? 1.0 : 2.0) / num_knots);
    for (int k = 0; k < num_knots; ++k) {
      combination.weights[k] = norm * std::cos(kPi * m * (k + 0.5) / num_knots);
    }
    prior.combinations.push_back(std::move(combination));
  }
  return prior;
}

}  // namespace pinode
