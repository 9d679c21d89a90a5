#include "pinode/case/sections/memory_network_section.h"

#include <cmath>
#include <cstdint>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "pinode/base/strings.h"
#include "pinode/case/sections/feature_text.h"
#include "pinode/dynamics/memory_network.h"

namespace pinode {
namespace {

// Precision of the weights' prior where the case gives none: the weights are
// relative to the scales, so that numbers of about 3 are large.
constexpr double kDecay = 0.1;
constexpr int kUnits = 6;

std::string DofName(const StructuralDynamics& dynamics, int dof) {
  return dof == Feature::kGround
             ? "ground"
             : dynamics.model().dof_names[static_cast<size_t>(dof)];
}

// Reads a deformation and its rate. The device acts where it is deformed, or
// it could gain energy.
bool ReadDeformation(const TomlTable& table, const StructuralDynamics& dynamics,
                     std::vector<Feature>* features) {
  const std::vector<std::string> inputs = table.Strings("inputs");
  const std::vector<std::string> outputs = table.Strings("outputs");
  if (!table.errors()->ok()) return false;
  const int n = dynamics.num_dofs();
  const std::string expected =
      "expected a displacement and its velocity, such as [\"x[u1]\", "
      "\"v[u1]\"] or [\"d[u1,u2]\", \"w[u1,u2]\"]";
  for (const std::string& text : inputs) {
    Feature feature;
    if (!ParseFeature(table, "inputs", dynamics, text, &feature)) return false;
    features->push_back(feature);
  }
  if (features->size() != 2 || !(*features)[0].OnDisplacement() ||
      !(*features)[1].OnVelocity() ||
      (*features)[0].Selector(n) != (*features)[1].Selector(n)) {
    return table.Fail("inputs", "the network has a memory and the inputs [" +
                                    Join(inputs, ", ") + "], " + expected);
  }
  Vector column;
  if (outputs.size() == 1 &&
      !ParseOutput(table, "outputs", dynamics.model(), outputs[0], &column)) {
    return false;
  }
  const Feature& deformation = (*features)[0];
  if (outputs.size() == 1 && deformation.kind == Feature::Kind::kDeformation &&
      column == Vector(-deformation.Selector(n).transpose())) {
    const auto reversed = [&](const char* letter) {
      return letter + ("[" + DofName(dynamics, deformation.b) + "," +
                       DofName(dynamics, deformation.a) + "]");
    };
    return table.Fail("inputs", "the deformation " + inputs[0] +
                                    " is against the output '" + outputs[0] +
                                    "', write " + reversed("d") + " and " +
                                    reversed("w"));
  }
  if (outputs.size() != 1 ||
      column != Vector((*features)[0].Selector(n).transpose())) {
    return table.Fail(
        "outputs", "the network has a memory and the outputs [" +
                       Join(outputs, ", ") +
                       "], expected the DOF of its inputs, such as [\"u1\"], "
                       "or [\"u2-u1\"] for d[u1,u2]");
  }
  return true;
}

bool ReadShape(const TomlTable& table, MemoryNetworkShape* shape) {
  shape->sliders = table.Integer("memory", 1, 1, MemoryNetwork::kMostSliders);
  shape->width = kUnits;
  if (table.Has("layers")) {
    const std::vector<int> layers =
        table.Integers("layers", 1, MemoryNetwork::kMostUnits);
    if (!table.errors()->ok()) return false;
    if (layers.size() != 1) {
      return table.Fail("layers",
                        "a network with memory has " +
                            std::to_string(layers.size()) +
                            " hidden layers, expected one, such as [6]");
    }
    shape->width = layers[0];
  }
  if (table.Has("input_scale")) {
    const std::vector<double> scale =
        table.Numbers("input_scale", 2, "input of the network");
    if (!table.errors()->ok()) return false;
    shape->deformation = scale[0];
    shape->rate = scale[1];
  }
  if (table.Has("output_scale")) {
    const std::vector<double> scale =
        table.Numbers("output_scale", 1, "output of the network");
    if (!table.errors()->ok()) return false;
    shape->force = scale[0];
  }
  if (!table.errors()->ok()) return false;
  for (const char* key : {"input_scale", "output_scale"}) {
    if (!table.Has(key)) continue;
    const bool of_input = std::string(key) == "input_scale";
    if (of_input ? shape->deformation > 0.0 && shape->rate > 0.0
                 : shape->force > 0.0) {
      continue;
    }
    return table.Fail(key,
                      "a scale is not positive, expected positive "
                      "numbers, or the key left out");
  }
  std::string error;
  return shape->IsValid(&error) || table.Fail("memory", error);
}

bool ReadWeights(const TomlTable& table, const MemoryNetwork& network,
                 std::uint64_t default_seed, Vector* weights) {
  if (table.Has("values")) {
    // Scales from the records of this case are not those of the values.
    if (!network.shape().HasScales()) {
      return table.Fail("values",
                        "they are relative to scales, give 'input_scale' and "
                        "'output_scale' too");
    }
    const std::vector<double> values = table.Numbers(
        "values", network.num_parameters(), "weight of the network");
    if (!table.errors()->ok()) return false;
    *weights = ToVector(values);
    return true;
  }
  const auto seed = static_cast<std::uint64_t>(
      table.Integer("seed", static_cast<int>(default_seed), 0,
                    std::numeric_limits<int>::max()));
  if (!table.errors()->ok()) return false;
  *weights = network.DrawWeights(seed);
  return true;
}

}  // namespace

bool ReadMemoryNetwork(const TomlTable& table, const std::string& name,
                       const TermsContext& context,
                       StructuralDynamics* dynamics) {
  for (const char* key :
       {"activation", "bias", "skip", "gauge", "weights", "truth"}) {
    if (table.Has(key)) {
      return table.Fail(key, std::string("a network with memory has no '") +
                                 key + "', expected the key left out");
    }
  }
  if (table.Has("acts_as") && table.Choice("acts_as", {"acceleration", "force"},
                                           "acceleration") != "force") {
    return table.Fail("acts_as",
                      "a network with memory acts as a force, expected "
                      "\"force\", or the key left out");
  }
  std::vector<Feature> features;
  MemoryNetworkShape shape;
  if (!ReadDeformation(table, *dynamics, &features) ||
      !ReadShape(table, &shape)) {
    return false;
  }
  double decay = kDecay;
  if (table.Has("decay")) {
    if (table.Find("decay")->type == TomlValue::Type::kString) {
      return table.Fail("decay",
                        "a network with memory has a fixed weight decay, "
                        "expected a number, such as 0.1");
    }
    decay = table.NonNegativeNumber("decay", kDecay);
  }
  const bool free = table.Boolean("free", true);
  Vector weights;
  if (!table.errors()->ok() || !ReadWeights(table, MemoryNetwork(shape),
                                            context.default_seed, &weights)) {
    return false;
  }
  LawTerm term = MakeMemoryNetwork(name, shape, features, dynamics->num_dofs(),
                                   weights, 1.0 / std::sqrt(decay));
  for (Parameter& parameter : term.parameters.parameters) {
    parameter.free = free;
  }
  std::string error;
  return dynamics->AddLaw(std::move(term), &error) || table.Fail("name", error);
}

}  // namespace pinode
