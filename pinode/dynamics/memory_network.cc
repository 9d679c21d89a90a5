#include "pinode/dynamics/memory_network.h"

#include <ceres/jet.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "pinode/base/strings.h"

namespace pinode {
namespace {

// Rounding of |y| and of the direction y / |y|, in units of the rate scale.
constexpr double kRounding = 0.02;

// log(1 + exp(x)), without overflow.
template <typename T>
T Softplus(const T& x) {
  using std::exp;
  using std::log1p;
  return x > T(0.0) ? T(x + log1p(exp(-x))) : T(log1p(exp(x)));
}

double Sigmoid(double x) { return 0.5 * (1.0 + std::tanh(0.5 * x)); }

// Positions of the parameters.
struct Layout {
  explicit Layout(const MemoryNetworkShape& shape)
      : m(shape.sliders),
        h(shape.width),
        inputs(m + 3),
        softening(m),
        creep(2 * m),
        dashpot(3 * m),
        bias(dashpot + 1),
        hidden(bias + h),
        constant(hidden + h * inputs),
        output(constant + m),
        size(output + m * h) {}

  int m, h, inputs;
  int softening, creep, dashpot, bias, hidden, constant, output, size;
};

// Values on the way from the point to the rates.
template <typename T>
struct Sweep {
  T inputs[MemoryNetwork::kMostSliders + 3];
  T units[MemoryNetwork::kMostUnits];
  T y, direction, travel;                    // travel: |y|
  T energy;                                  // e, not negative
  T flow[MemoryNetwork::kMostSliders];       // c_i + V_i u
  T stiffness[MemoryNetwork::kMostSliders];  // k_i
  T slip[MemoryNetwork::kMostSliders];       // r_i
};

template <typename T>
void Evaluate(const MemoryNetworkShape& shape, const T* q, const T* z,
              const T* p, Sweep<T>* sweep, T* result) {
  using std::log1p;
  using std::sqrt;
  using std::tanh;
  const Layout at(shape);
  Sweep<T>& s = *sweep;
  s.y = q[1] / shape.rate;
  s.direction = s.y / sqrt(s.y * s.y + kRounding * kRounding);
  s.travel = s.y * s.direction;
  // A shooting segment may start from less than no energy.
  s.energy = z[at.m] > T(0.0) ? z[at.m] : T(0.0);
  s.inputs[0] = q[0] / shape.deformation;
  s.inputs[1] = s.direction;
  for (int i = 0; i < at.m; ++i) s.inputs[2 + i] = z[i];
  s.inputs[2 + at.m] = log1p(s.energy);
  for (int j = 0; j < at.h; ++j) {
    T sum = p[at.bias + j];
    for (int k = 0; k < at.inputs; ++k) {
      sum += p[at.hidden + k * at.h + j] * s.inputs[k];
    }
    s.units[j] = tanh(sum);
  }
  T force = p[at.dashpot] * p[at.dashpot] * s.y;
  T dissipated(0.0);
  for (int i = 0; i < at.m; ++i) {
    s.flow[i] = p[at.constant + i];
    for (int j = 0; j < at.h; ++j) {
      s.flow[i] += p[at.output + j * at.m + i] * s.units[j];
    }
    const T& a = p[at.softening + i];
    s.stiffness[i] = Softplus(p[i]) / (a * a * s.energy + 1.0);
    s.slip[i] =
        s.travel * Softplus(s.flow[i]) + p[at.creep + i] * p[at.creep + i];
    force += s.stiffness[i] * z[i];
    dissipated += s.stiffness[i] * s.slip[i] * z[i] * z[i];
    result[1 + i] = (s.y - s.slip[i] * z[i]) * (shape.rate / shape.deformation);
  }
  result[0] = force * shape.force;
  result[1 + at.m] = dissipated * (shape.rate / shape.deformation);
}

}  // namespace

bool MemoryNetworkShape::IsValid(std::string* error) const {
  if (sliders < 1 || sliders > MemoryNetwork::kMostSliders) {
    *error = "'memory' is " + std::to_string(sliders) + ", expected 1 to " +
             std::to_string(MemoryNetwork::kMostSliders);
    return false;
  }
  if (width < 1 || width > MemoryNetwork::kMostUnits) {
    *error = "a network with memory has " + std::to_string(width) +
             " hidden units, expected 1 to " +
             std::to_string(MemoryNetwork::kMostUnits);
    return false;
  }
  for (const auto& [name, scale] :
       {std::pair("deformation", deformation), std::pair("rate", rate),
        std::pair("force", force)}) {
    if (!(scale >= 0.0) || !std::isfinite(scale)) {
      *error = std::string("the ") + name +
               " scale of a network with memory is " + FormatNumber(scale, 3) +
               ", expected a positive number";
      return false;
    }
  }
  return true;
}

MemoryNetwork::MemoryNetwork(const MemoryNetworkShape& shape)
    : given_(shape), shape_(shape) {
  for (double* scale : {&shape_.deformation, &shape_.rate, &shape_.force}) {
    if (!(*scale > 0.0)) *scale = 1.0;
  }
}

int MemoryNetwork::num_parameters() const { return Layout(shape_).size; }

void MemoryNetwork::Evaluate(const double* features, const double* internal,
                             const double* parameters, double* result) const {
  Sweep<double> sweep;
  pinode::Evaluate(shape_, features, internal, parameters, &sweep, result);
}

void MemoryNetwork::Evaluate(const WideJet* features, const WideJet* internal,
                             const WideJet* parameters, WideJet* result) const {
  Sweep<WideJet> sweep;
  pinode::Evaluate(shape_, features, internal, parameters, &sweep, result);
}

void MemoryNetwork::Linearize(const double* features, const double* internal,
                              const double* parameters, double* result,
                              double* jacobian) const {
  const Layout at(shape_);
  const double* p = parameters;
  const double* z = internal;
  Sweep<double> s;
  pinode::Evaluate(shape_, features, internal, parameters, &s, result);
  const int arguments = num_arguments();
  std::fill_n(jacobian, num_results() * arguments, 0.0);
  const int first_internal = 2;
  const int first = first_internal + num_internal();  // parameter
  double* of_force = jacobian;
  double* of_energy = jacobian + (1 + at.m) * arguments;
  const double frequency = shape_.rate / shape_.deformation;
  const double round = std::sqrt(s.y * s.y + kRounding * kRounding);
  // d direction / d y, and d travel / d y.
  const double turn = kRounding * kRounding / (round * round * round);
  const double travels = s.direction + s.y * turn;
  const bool counted = z[at.m] > 0.0;
  const double energy_slope = counted ? 1.0 / (1.0 + s.energy) : 0.0;

  of_force[1] = p[at.dashpot] * p[at.dashpot] * shape_.force / shape_.rate;
  of_force[first + at.dashpot] = 2.0 * p[at.dashpot] * s.y * shape_.force;
  for (int i = 0; i < at.m; ++i) {
    double* of_spring = jacobian + (1 + i) * arguments;
    const double k = s.stiffness[i];
    const double a = p[at.softening + i];
    const double soft = 1.0 + a * a * s.energy;
    // d k / d (kappa, a, e).
    const double by_kappa = Sigmoid(p[i]) / soft;
    const double by_a = -k * 2.0 * a * s.energy / soft;
    const double by_energy = counted ? -k * a * a / soft : 0.0;
    of_force[first_internal + i] = k * shape_.force;
    of_force[first_internal + at.m] += by_energy * z[i] * shape_.force;
    of_force[first + i] = by_kappa * z[i] * shape_.force;
    of_force[first + at.softening + i] = by_a * z[i] * shape_.force;
    const double power = s.slip[i] * z[i] * z[i] * frequency;
    of_energy[first_internal + at.m] += by_energy * power;
    of_energy[first + i] = by_kappa * power;
    of_energy[first + at.softening + i] = by_a * power;
    of_energy[first_internal + i] += 2.0 * k * s.slip[i] * z[i] * frequency;
    of_spring[1] += 1.0 / shape_.deformation;  // y
    of_spring[first_internal + i] -= s.slip[i] * frequency;

    // The slip rate acts on its spring and on the energy.
    const double on_spring = -z[i] * frequency;
    const double on_energy = k * z[i] * z[i] * frequency;
    const auto add = [&](int argument, double slope) {
      of_spring[argument] += on_spring * slope;
      of_energy[argument] += on_energy * slope;
    };
    add(first + at.creep + i, 2.0 * p[at.creep + i]);
    add(1, travels * Softplus(s.flow[i]) / shape_.rate);
    const double by_flow = s.travel * Sigmoid(s.flow[i]);
    add(first + at.constant + i, by_flow);
    for (int j = 0; j < at.h; ++j) {
      const double v = p[at.output + j * at.m + i];
      add(first + at.output + j * at.m + i, by_flow * s.units[j]);
      const double by_sum = by_flow * v * (1.0 - s.units[j] * s.units[j]);
      add(first + at.bias + j, by_sum);
      for (int n = 0; n < at.inputs; ++n) {
        const int weight = at.hidden + n * at.h + j;
        add(first + weight, by_sum * s.inputs[n]);
        const double by_input = by_sum * p[weight];
        if (n == 0) {
          add(0, by_input / shape_.deformation);
        } else if (n == 1) {
          add(1, by_input * turn / shape_.rate);
        } else if (n < 2 + at.m) {
          add(first_internal + n - 2, by_input);
        } else {
          add(first_internal + at.m, by_input * energy_slope);
        }
      }
    }
  }
}

double MemoryNetwork::StoredEnergy(const double* internal,
                                   const double* parameters) const {
  const Layout at(shape_);
  const double energy = std::max(internal[at.m], 0.0);
  double sum = 0.0;
  for (int i = 0; i < at.m; ++i) {
    const double a = parameters[at.softening + i];
    sum += Softplus(parameters[i]) / (1.0 + a * a * energy) * internal[i] *
           internal[i];
  }
  return 0.5 * sum * shape_.force * shape_.deformation;
}

Vector MemoryNetwork::DrawWeights(std::uint64_t seed) const {
  // Sums of uniform numbers are the same on every platform, unlike
  // std::normal_distribution.
  std::mt19937_64 random(seed);
  const auto draw = [&random]() {
    double sum = 0.0;
    for (int k = 0; k < 12; ++k) {
      sum += static_cast<double>(random() >> 11) * 0x1.0p-53;
    }
    return sum - 6.0;
  };
  const Layout at(shape_);
  Vector weights = Vector::Zero(at.size);
  const double of_inputs = std::sqrt(1.0 / at.inputs);
  const double of_units = 0.3 * std::sqrt(1.0 / at.h);
  for (int i = 0; i < at.m; ++i) {
    weights[at.softening + i] = 0.1;
    weights[at.creep + i] = 0.05;
    // Slips at about 1, 1/2, 1/3 ... of the deformation scale.
    weights[at.constant + i] = std::log(std::expm1(1.0 + i));
  }
  weights[at.dashpot] = 0.1;
  for (int j = 0; j < at.h * (1 + at.inputs); ++j) {
    weights[at.bias + j] = of_inputs * draw();
  }
  for (int j = 0; j < at.h * at.m; ++j) {
    weights[at.output + j] = of_units * draw();
  }
  return weights;
}

const char kMemoryNetworkType[] = "memory_network";

LawTerm MakeMemoryNetwork(const std::string& name,
                          const MemoryNetworkShape& shape,
                          const std::vector<Feature>& features, int num_dofs,
                          const Vector& weights, double prior_sigma) {
  LawTerm term;
  term.name = name;
  term.type = kMemoryNetworkType;
  term.law = std::make_shared<MemoryNetwork>(shape);
  term.identity = std::to_string(shape.sliders) + " sliders, " +
                  std::to_string(shape.width) + " units";
  term.features = features;
  term.outputs = features.front().Selector(num_dofs).transpose();
  term.parameters.name = name;
  term.parameters.named = false;
  for (Eigen::Index i = 0; i < weights.size(); ++i) {
    Parameter parameter;
    parameter.name = name + "[" + std::to_string(i) + "]";
    parameter.value = weights[i];
    parameter.prior_sigma = prior_sigma;
    term.parameters.parameters.push_back(std::move(parameter));
  }
  return term;
}

const MemoryNetwork* AsMemoryNetwork(const LawTerm& term) {
  return dynamic_cast<const MemoryNetwork*>(term.law.get());
}

bool HasMemoryNetwork(const StructuralDynamics& dynamics) {
  const auto& laws = dynamics.laws();
  return std::any_of(laws.begin(), laws.end(), AsMemoryNetwork);
}

bool HasFreeMemoryNetwork(const StructuralDynamics& dynamics) {
  const auto& laws = dynamics.laws();
  return std::any_of(laws.begin(), laws.end(), [](const LawTerm& term) {
    const std::vector<Parameter>& weights = term.parameters.parameters;
    return AsMemoryNetwork(term) != nullptr &&
           std::any_of(
               weights.begin(), weights.end(),
               [](const Parameter& parameter) { return parameter.free; });
  });
}

}  // namespace pinode
