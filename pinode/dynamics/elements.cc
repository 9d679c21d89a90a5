#include "pinode/dynamics/elements.h"

#include <cmath>
#include <utility>

#include "pinode/base/constants.h"
#include "pinode/base/logging.h"
#include "pinode/base/strings.h"
#include "pinode/dynamics/autodiff_law.h"
#include "pinode/dynamics/memory_laws.h"

namespace pinode {
namespace {

// Marks a parameter without a default: the case must give it.
constexpr double kRequired = kNaN;

struct Linear {
  template <typename T>
  void operator()(const T* q, const T*, const T* p, T* force) const {
    force[0] = p[0] * q[0] + p[1] * q[1];
  }
};

struct Cubic {
  template <typename T>
  void operator()(const T* q, const T*, const T* p, T* force) const {
    force[0] = p[0] * q[0] * q[0] * q[0];
  }
};

struct QuadraticStiffness {
  template <typename T>
  void operator()(const T* q, const T*, const T* p, T* force) const {
    force[0] = p[0] * Magnitude(q[0]) * q[0];
  }
};

struct AmplitudeDamping {
  template <typename T>
  void operator()(const T* q, const T*, const T* p, T* force) const {
    force[0] = p[0] * Magnitude(q[0]) * q[1];
  }
};

struct Bilinear {
  template <typename T>
  void operator()(const T* q, const T*, const T* p, T* force) const {
    force[0] = p[0] * BeyondGap(q[0], p[1]);
  }
};

struct Coulomb {
  template <typename T>
  void operator()(const T* q, const T*, const T* p, T* force) const {
    using std::tanh;
    force[0] = p[0] * tanh(q[1] / p[1]);
  }
};

struct PowerDamper {
  template <typename T>
  void operator()(const T* q, const T*, const T* p, T* force) const {
    const T power = SafePower(Magnitude(q[1]), p[1]);
    force[0] = q[1] < T(0.0) ? T(-p[0] * power) : T(p[0] * power);
  }
};

// Half of x + |x|, rounded over a length of about `width` about x = 0.
template <typename T>
T RoundedRamp(const T& x, const T& width) {
  using std::sqrt;
  return T(0.5) * (x + sqrt(x * x + width * width + 1e-60));
}

struct Play {
  template <typename T>
  void operator()(const T* q, const T*, const T* p, T* force) const {
    const T from_centre = q[0] - p[2];
    force[0] = p[0] * (RoundedRamp(T(from_centre - p[1]), p[3]) -
                       RoundedRamp(T(-from_centre - p[1]), p[3]));
  }
};

struct ElementType {
  std::string name;
  std::unique_ptr<Law> (*create)();
  std::vector<ElementParameterInfo> parameters;
};

template <typename Functor, int kInternal, int kParameters>
std::unique_ptr<Law> Create() {
  return std::make_unique<AutoDiffLaw<Functor, 2, kInternal, kParameters, 1>>();
}

const std::vector<ElementType>& Catalogue() {
  static const auto* catalogue = new std::vector<ElementType>{
      {"linear",
       &Create<Linear, 0, 2>,
       {{"k", 1, -1, 0, -kInfinity, kInfinity, 0.0},
        {"c", 1, -1, 1, -kInfinity, kInfinity, 0.0}}},
      {"cubic",
       &Create<Cubic, 0, 1>,
       {{"k3", 1, -3, 0, -kInfinity, kInfinity, 0.0}}},
      {"quadratic_stiffness",
       &Create<QuadraticStiffness, 0, 1>,
       {{"k2", 1, -2, 0, -kInfinity, kInfinity, 0.0}}},
      {"amplitude_damping",
       &Create<AmplitudeDamping, 0, 1>,
       {{"c2", 1, -2, 1, -kInfinity, kInfinity, 0.0}}},
      {"bilinear",
       &Create<Bilinear, 0, 2>,
       {{"k", 1, -1, 0, -kInfinity, kInfinity, 0.0},
        {"gap", 0, 1, 0, 0.0, kInfinity, kRequired}}},
      {"coulomb",
       &Create<Coulomb, 0, 2>,
       {{"f", 1, 0, 0, -kInfinity, kInfinity, 0.0},
        {"v0", 0, 1, -1, 1e-12, kInfinity, kRequired}}},
      {"power_damper",
       &Create<PowerDamper, 0, 2>,
       {{"c", 1, 0, 0, -kInfinity, kInfinity, 0.0},
        {"p", 0, 0, 0, 0.05, 5.0, 1.0}}},
      {"bouc_wen",
       &Create<BoucWen, 1, 6>,
       {{"k", 1, -1, 0, -kInfinity, kInfinity, kRequired},
        {"a", 0, 0, 0, -kInfinity, kInfinity, 1.0},
        {"b", 0, 0, 0, -kInfinity, kInfinity, kRequired},
        {"g", 0, 0, 0, -kInfinity, kInfinity, kRequired},
        {"n", 0, 0, 0, 1.0, 10.0, 1.0},
        {"beta", 0, 0, 0, -kInfinity, kInfinity, 1.0}}},
      {"backlash_friction",
       &Create<BacklashFriction, 1, 4>,
       {{"k", 1, -1, 0, 1e-12, kInfinity, kRequired},
        {"f", 1, 0, 0, 1e-12, kInfinity, kRequired},
        {"gap", 0, 1, 0, 0.0, kInfinity, kRequired},
        {"n", 0, 0, 0, 1.0, 50.0, 10.0}}},
      {"play",
       &Create<Play, 0, 4>,
       {{"k", 1, -1, 0, -kInfinity, kInfinity, kRequired},
        {"gap", 0, 1, 0, 0.0, kInfinity, kRequired},
        {"centre", 0, 1, 0, -kInfinity, kInfinity, 0.0},
        {"width", 0, 1, 0, 0.0, kInfinity, 0.0}}},
      {"maxwell",
       &Create<Maxwell, 1, 2>,
       {{"k", 1, -1, 0, 0.0, kInfinity, kRequired},
        {"c", 1, -1, 1, 1e-12, kInfinity, kRequired}}},
      {"lugre",
       &Create<LuGre, 1, 6>,
       {{"k", 1, -1, 0, 1e-12, kInfinity, kRequired},
        {"f", 1, 0, 0, 1e-12, kInfinity, kRequired},
        {"rise", 0, 0, 0, 0.0, 100.0, 0.0},
        {"v0", 0, 1, -1, 1e-12, kInfinity, 1.0},
        {"c1", 1, -1, 1, 0.0, kInfinity, 0.0},
        {"c", 1, -1, 1, -kInfinity, kInfinity, 0.0}}},
      {"iwan",
       &Create<Iwan, Iwan::kSliders + 1, 4>,
       {{"k", 1, -1, 0, 1e-12, kInfinity, kRequired},
        {"f", 1, 0, 0, 1e-12, kInfinity, kRequired},
        {"chi", 0, 0, 0, -0.95, 5.0, -0.5},
        {"beta", 0, 0, 0, 0.0, 100.0, 0.0}}},
      {"baber_noori",
       &Create<BaberNoori, 2, 12>,
       {{"k", 1, -1, 0, 1e-12, kInfinity, kRequired},
        {"f", 1, 0, 0, 1e-12, kInfinity, kRequired},
        {"s", 0, 0, 0, 0.0, 10.0, 0.5},
        {"n", 0, 0, 0, 1.0, 10.0, 1.0},
        {"strength", 0, 0, 0, 0.0, 10.0, 0.0},
        {"stiffness", 0, 0, 0, 0.0, 10.0, 0.0},
        {"pinch", 0, 0, 0, 0.0, 0.99, 0.0},
        {"pinch_rate", 0, 0, 0, 0.0, 100.0, 0.5},
        {"pinch_level", 0, 0, 0, -1.0, 1.0, 0.1},
        {"pinch_width", 0, 0, 0, 1e-3, 10.0, 0.2},
        {"pinch_spread", 0, 0, 0, 0.0, 10.0, 0.0},
        {"pinch_mix", 0, 0, 0, 1e-3, 10.0, 0.5}}},
  };
  return *catalogue;
}

const ElementType* Find(const std::string& type) {
  for (const ElementType& entry : Catalogue()) {
    if (entry.name == type) return &entry;
  }
  return nullptr;
}

}  // namespace

std::vector<std::string> ElementTypes() {
  std::vector<std::string> names;
  for (const ElementType& entry : Catalogue()) names.push_back(entry.name);
  return names;
}

std::unique_ptr<Law> CreateElement(const std::string& type,
                                   std::string* error) {
  const ElementType* entry = Find(type);
  if (entry == nullptr) {
    const std::string nearest = NearestName(type, ElementTypes());
    *error = "unknown element type '" + type + "'" +
             (nearest.empty() ? "" : ", did you mean '" + nearest + "'?");
    return nullptr;
  }
  return entry->create();
}

std::vector<ElementParameterInfo> ElementParameters(const std::string& type) {
  const ElementType* entry = Find(type);
  CHECK(entry != nullptr) << "unknown element type '" << type
                          << "'; ask CreateElement first";
  return entry->parameters;
}

bool MakeElement(const std::string& name, const std::string& type, int num_dofs,
                 int from, int to, const std::vector<double>& values,
                 LawTerm* term, std::string* error) {
  LawTerm made;
  made.name = name;
  made.type = type;
  made.law = CreateElement(type, error);
  if (made.law == nullptr) return false;
  const std::string prefix = "element '" + name + "' of type '" + type + "': ";
  if (from < Feature::kGround || from >= num_dofs || to < 0 || to >= num_dofs ||
      from == to) {
    *error = prefix + "its ends are " + std::to_string(from) + " and " +
             std::to_string(to) + ", expected two of 0 to " +
             std::to_string(num_dofs - 1) + ", the first of them or " +
             std::to_string(Feature::kGround) + " for the ground";
    return false;
  }
  const std::vector<ElementParameterInfo> infos = ElementParameters(type);
  size_t least = infos.size();
  while (least > 1 && !std::isnan(infos[least - 1].default_value)) --least;
  if (values.size() < least || values.size() > infos.size()) {
    *error = prefix + std::to_string(values.size()) + " values, expected " +
             (least < infos.size() ? std::to_string(least) + " to " : "") +
             std::to_string(infos.size());
    return false;
  }
  made.features = {Feature::Deformation(from, to),
                   Feature::DeformationRate(from, to)};
  // The force resists d = x[to] - x[from] at both ends.
  made.outputs = made.features[0].Selector(num_dofs).transpose();
  made.parameters.name = name;
  for (size_t i = 0; i < infos.size(); ++i) {
    Parameter parameter;
    parameter.name = name + "." + infos[i].name;
    parameter.free = i < values.size();
    parameter.value = parameter.free ? values[i] : infos[i].default_value;
    parameter.lower = infos[i].lower;
    parameter.upper = infos[i].upper;
    made.parameters.parameters.push_back(parameter);
  }
  if (!made.parameters.IsValid(error)) return false;
  *term = std::move(made);
  return true;
}

}  // namespace pinode
