#include <algorithm>
#include <limits>
#include <memory>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "pinode/base/strings.h"
#include "pinode/case/sections/feature_text.h"
#include "pinode/case/sections/memory_network_section.h"
#include "pinode/case/sections/terms_section.h"
#include "pinode/case/text/parameter_keys.h"
#include "pinode/dynamics/spanned_terms.h"
#include "pinode/network/activation.h"
#include "pinode/network/initialize_weights.h"
#include "pinode/network/network.h"
#include "pinode/network/network_json.h"

namespace pinode {
namespace {

// Largest number of weights. The normal matrix of their fit then takes 3.2 GB.
constexpr int kMostWeights = 20000;

// Compares the keys of a weights file; they are not overwritten.
template <typename T>
bool Agrees(const TomlTable& table, const char* key, const T& in_case,
            const T& in_file, bool with_file) {
  if (!with_file || !table.Has(key) || in_case == in_file) return true;
  return table.Fail(key, std::string("'") + key +
                             "' differs from that of the network in '" +
                             table.String("weights") +
                             "', expected the same, or the key left out");
}

std::vector<double> ToStd(const Vector& values) {
  return {values.data(), values.data() + values.size()};
}

class NetworkReader {
 public:
  NetworkReader(const TomlTable& table, const TermsContext& context,
                const StructuralDynamics& dynamics)
      : table_(table), context_(context), dynamics_(dynamics) {}

  bool Read(NetworkTerm* term) {
    return ReadInputsAndOutputs(term) && ReadWeightsFile(*term) &&
           ReadArchitecture() && ReadGauge(term) && MakeNetwork(term);
  }

 private:
  bool ReadInputsAndOutputs(NetworkTerm* term) {
    const std::vector<std::string> inputs = table_.Strings("inputs");
    const std::vector<std::string> outputs = table_.Strings("outputs");
    if (!table_.errors()->ok()) return false;
    if (inputs.empty() || outputs.empty()) {
      const char* key = inputs.empty() ? "inputs" : "outputs";
      return table_.Fail(key, std::string("'") + key +
                                  "' is missing or empty, expected at least "
                                  "one");
    }
    const int n = dynamics_.num_dofs();
    for (const std::string& text : inputs) {
      Feature feature;
      if (!ParseFeature(table_, "inputs", dynamics_, text, &feature))
        return false;
      term->features.push_back(feature);
      input_names_.push_back(
          feature.Name(dynamics_.model().dof_names, InputNames(dynamics_)));
    }
    term->outputs.resize(n, static_cast<Eigen::Index>(outputs.size()));
    for (size_t j = 0; j < outputs.size(); ++j) {
      Vector column;
      if (!ParseOutput(table_, "outputs", dynamics_.model(), outputs[j],
                       &column)) {
        return false;
      }
      term->outputs.col(static_cast<Eigen::Index>(j)) = column;
    }
    term->output_names = outputs;
    term->acts_as = table_.Choice("acts_as", {"acceleration", "force"},
                                  "acceleration") == "force"
                        ? NetworkTerm::ActsAs::kForce
                        : NetworkTerm::ActsAs::kAcceleration;
    return table_.errors()->ok();
  }

  bool ReadWeightsFile(const NetworkTerm& term) {
    architecture_.num_inputs = static_cast<int>(input_names_.size());
    architecture_.num_outputs = static_cast<int>(term.output_names.size());
    architecture_.hidden_widths = {20};
    if (!table_.Has("weights")) return true;
    const std::string path =
        ResolvePath(table_.errors()->path(), table_.RequiredString("weights"));
    std::string error;
    if (!table_.errors()->ok()) return false;
    if (!ReadNetwork(path, &saved_, &error)) {
      return table_.Fail("weights", error);
    }
    if (saved_.inputs != input_names_ || saved_.outputs != term.output_names) {
      return table_.Fail("weights",
                         "the network in '" + path + "' maps [" +
                             Join(saved_.inputs, ", ") + "] to [" +
                             Join(saved_.outputs, ", ") +
                             "], expected the inputs and outputs given here");
    }
    has_file_ = true;
    architecture_ = saved_.architecture;
    return true;
  }

  bool ReadArchitecture() {
    if (table_.Has("layers")) {
      architecture_.hidden_widths = table_.Integers("layers", 1, 10000);
    }
    if (table_.Has("activation")) {
      std::string error;
      if (!ParseActivation(table_.String("activation"),
                           &architecture_.activation, &error)) {
        return table_.Fail("activation", error);
      }
    }
    architecture_.bias = table_.Boolean("bias", architecture_.bias);
    architecture_.skip = table_.Boolean("skip", architecture_.skip);
    if (table_.Has("input_scale")) {
      const std::vector<double> scale = table_.Numbers(
          "input_scale", architecture_.num_inputs, "input of the network");
      if (!table_.errors()->ok()) return false;
      architecture_.input_scale = ToVector(scale);
    }
    if (table_.Has("output_scale")) {
      const std::vector<double> scale = table_.Numbers(
          "output_scale", architecture_.num_outputs, "output of the network");
      if (!table_.errors()->ok()) return false;
      architecture_.output_scale = ToVector(scale);
    }
    if (!table_.errors()->ok()) return false;
    const NetworkArchitecture& file = saved_.architecture;
    return Agrees(table_, "layers", architecture_.hidden_widths,
                  file.hidden_widths, has_file_) &&
           Agrees(table_, "activation", architecture_.activation,
                  file.activation, has_file_) &&
           Agrees(table_, "bias", architecture_.bias, file.bias, has_file_) &&
           Agrees(table_, "input_scale", ToStd(architecture_.input_scale),
                  ToStd(file.input_scale), has_file_) &&
           Agrees(table_, "output_scale", ToStd(architecture_.output_scale),
                  ToStd(file.output_scale), has_file_);
  }

  bool ReadGauge(NetworkTerm* term) {
    const std::string gauge =
        table_.Choice("gauge", {"auto", "on", "off"}, "auto");
    if (!table_.errors()->ok()) return false;
    const bool skip_given = table_.Has("skip") && architecture_.skip;
    if (has_file_) {
      architecture_.gauge =
          gauge == "auto" ? saved_.architecture.gauge : gauge == "on";
      if (!Agrees(table_, "gauge", architecture_.gauge,
                  saved_.architecture.gauge, true) ||
          !Agrees(table_, "skip", architecture_.skip, saved_.architecture.skip,
                  true)) {
        return false;
      }
      return true;
    }
    if (gauge == "off") return true;
    const std::vector<std::string> spanned = SpannedTerms(dynamics_, *term);
    if (gauge == "on") {
      if (skip_given) {
        return table_.Fail("skip",
                           "skip = true contradicts gauge = \"on\", which "
                           "leaves no linear path; set skip = false");
      }
      if (architecture_.hidden_widths.empty()) {
        return table_.Fail("gauge",
                           "gauge = \"on\" leaves nothing of a linear network, "
                           "expected at least one hidden layer");
      }
    } else if (spanned.empty()) {
      return true;
    } else if (architecture_.hidden_widths.empty()) {
      context_.remarks->push_back("network '" + term->name +
                                  "' is linear and spans " +
                                  Join(spanned, ", ") +
                                  ": these values cannot be told apart from "
                                  "the network; leave one of them out.");
      return true;
    }
    architecture_.gauge = true;
    architecture_.skip = false;
    std::string remark = "network '" + term->name +
                         "' is gauged: its value and slope at rest are zero";
    if (!spanned.empty()) {
      remark += ", so that " + Join(spanned, ", ") + " mean" +
                (spanned.size() == 1 ? "s" : "") + " the tangent there";
    }
    if (skip_given) remark += "; its linear path is left out";
    context_.remarks->push_back(remark + ".");
    return true;
  }

  bool MakeNetwork(NetworkTerm* term) {
    std::string error;
    if (!architecture_.IsValid(&error)) return table_.Fail("name", error);
    if (architecture_.NumWeights() > kMostWeights) {
      return table_.Fail(
          "layers", "the network has " +
                        std::to_string(architecture_.NumWeights()) +
                        " weights, expected at most " +
                        std::to_string(kMostWeights) + ": use narrower layers");
    }
    if (table_.Has("decay") &&
        table_.Find("decay")->type == TomlValue::Type::kString) {
      term->decay =
          table_.Choice("decay", {"evidence", "none"}, "evidence") == "none"
              ? 0.0
              : -1.0;
    } else {
      term->decay = table_.NonNegativeNumber("decay", -1.0);
    }
    const bool free = table_.Boolean("free", true);
    const auto seed = static_cast<std::uint64_t>(
        table_.Integer("seed", static_cast<int>(context_.default_seed), 0,
                       std::numeric_limits<int>::max()));
    if (!table_.errors()->ok()) return false;

    const StructuralModel& model = dynamics_.model();
    const bool physics =
        !model.stiffness.isZero(0.0) || !model.damping.isZero(0.0) ||
        !dynamics_.groups().empty() || !dynamics_.laws().empty();
    const Vector weights =
        has_file_ ? saved_.weights
                  : InitializeWeights(architecture_, seed,
                                      physics || architecture_.HasSkipPath());
    // Networks of time alone are spread over the record, see
    // SpreadNetworksOfTime, and stay so.
    term->drawn =
        !has_file_ && std::any_of(term->features.begin(), term->features.end(),
                                  [](const Feature& feature) {
                                    return feature.kind != Feature::Kind::kTime;
                                  });
    term->network = std::make_shared<Network>(architecture_);
    term->weights.name = term->name;
    term->weights.named = false;
    term->weights.decays = architecture_.NonlinearWeights();
    for (Eigen::Index i = 0; i < weights.size(); ++i) {
      Parameter parameter;
      parameter.name = term->name + "[" + std::to_string(i) + "]";
      parameter.value = weights[i];
      parameter.free = free;
      term->weights.parameters.push_back(std::move(parameter));
    }
    return true;
  }

  const TomlTable& table_;
  const TermsContext& context_;
  const StructuralDynamics& dynamics_;
  std::vector<std::string> input_names_;  // in canonical spelling
  NetworkArchitecture architecture_;
  SavedNetwork saved_;
  bool has_file_ = false;
};

}  // namespace

bool ReadNetworks(const TomlTable& root, const TermsContext& context,
                  StructuralDynamics* dynamics) {
  std::set<std::string> seen;
  for (const LawTerm& law : dynamics->laws()) seen.insert(law.name);
  for (TomlTable& table : root.Tables("network")) {
    if (!table.AllowKeys()) {
      return false;
    }
    NetworkTerm term;
    term.name = table.RequiredString("name");
    if (!root.errors()->ok()) return false;
    table.set_name("network '" + term.name + "'");
    if (!CheckName(table, "name", term.name)) return false;
    if (!seen.insert(term.name).second) {
      return table.Fail("name",
                        "this name is used twice, expected different names");
    }
    if (table.Has("memory")) {
      if (!ReadMemoryNetwork(table, term.name, context, dynamics)) return false;
      continue;
    }
    if (table.Has("values")) {
      return table.Fail("values",
                        "'values' are the weights of a network with 'memory'; "
                        "give 'memory', or a file of 'weights'");
    }
    if (!NetworkReader(table, context, *dynamics).Read(&term)) return false;
    std::string error;
    if (!dynamics->AddNetwork(std::move(term), &error)) {
      return table.Fail("name", error);
    }
  }
  return root.errors()->ok();
}

}  // namespace pinode
