#include "pinode/network/network_json.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <nlohmann/json.hpp>
#include <utility>

#include "pinode/base/file.h"
#include "pinode/base/logging.h"
#include "pinode/base/strings.h"
#include "pinode/network/activation.h"

namespace pinode {
namespace {

using Json = nlohmann::ordered_json;

constexpr char kSchema[] = "pinode-network-1";
// The one key that may be missing.
constexpr char kOutputScale[] = "output_scale";

// Returns the keys in the order in which they are written.
const std::vector<std::string>& Keys() {
  static const auto& keys = *new std::vector<std::string>{
      "schema",     "inputs",        "outputs",    "input_scale",
      kOutputScale, "hidden_widths", "activation", "bias",
      "skip",       "gauge",         "weights"};
  return keys;
}

std::vector<double> OnesWhereEmpty(const Vector& scale, int size) {
  if (scale.size() == 0) return std::vector<double>(size, 1.0);
  return std::vector<double>(scale.begin(), scale.end());
}

// Reads the values of a network file. Keeps the first failure.
class Reader {
 public:
  explicit Reader(const Json& json) : json_(json) {}

  const std::string& error() const { return error_; }

  std::vector<std::string> Strings(const char* key) {
    std::vector<std::string> values;
    if (!IsArray(key, "strings")) return values;
    for (const Json& entry : json_.at(key)) {
      if (!entry.is_string()) {
        Fail(key, values.size(), entry, "a string");
        return values;
      }
      values.push_back(entry.get<std::string>());
    }
    return values;
  }

  std::vector<int> Widths(const char* key) {
    std::vector<int> values;
    if (!IsArray(key, "positive integers")) return values;
    for (const Json& entry : json_.at(key)) {
      if (!entry.is_number_unsigned() || entry.get<std::uint64_t>() < 1 ||
          entry.get<std::uint64_t>() > std::numeric_limits<int>::max()) {
        Fail(key, values.size(), entry, "a positive integer");
        return values;
      }
      values.push_back(entry.get<int>());
    }
    return values;
  }

  Vector Numbers(const char* key) {
    if (!IsArray(key, "numbers")) return {};
    const Json& array = json_.at(key);
    Vector values(static_cast<Eigen::Index>(array.size()));
    for (size_t i = 0; i < array.size(); ++i) {
      if (!array[i].is_number()) {
        Fail(key, i, array[i], "a finite number");
        return {};
      }
      values[static_cast<Eigen::Index>(i)] = array[i].get<double>();
    }
    return values;
  }

  std::string String(const char* key) {
    const Json& value = json_.at(key);
    if (value.is_string()) return value.get<std::string>();
    Fail(key, value, "a string");
    return {};
  }

  bool Boolean(const char* key) {
    const Json& value = json_.at(key);
    if (value.is_boolean()) return value.get<bool>();
    Fail(key, value, "true or false");
    return false;
  }

 private:
  bool IsArray(const char* key, const char* of_what) {
    if (json_.at(key).is_array()) return true;
    Fail(key, json_.at(key), std::string("an array of ") + of_what);
    return false;
  }

  void Fail(const char* key, size_t index, const Json& value,
            const std::string& expected) {
    Fail(std::string(key) + "[" + std::to_string(index) + "]", value, expected);
  }

  void Fail(const std::string& where, const Json& value,
            const std::string& expected) {
    if (!error_.empty()) return;
    // Only scalars are quoted: others may be long, or nested without end.
    const std::string text = value.is_array()    ? "an array"
                             : value.is_object() ? "an object"
                                                 : value.dump();
    error_ = where + " is " + text + ", expected " + expected;
  }

  const Json& json_;
  std::string error_;
};

bool ParseJson(const std::string& text, const std::string& source, Json* json,
               std::string* error) {
  try {
    *json = Json::parse(text);
    return true;
  } catch (const Json::parse_error& e) {
    // `byte` counts from one and may be one past the end.
    const auto end =
        text.begin() + static_cast<std::ptrdiff_t>(std::min(
                           text.size(), e.byte > 0 ? e.byte - 1 : size_t{0}));
    *error = source + ":" +
             std::to_string(1 + std::count(text.begin(), end, '\n')) +
             ": not valid JSON, expected a network file as pinode writes it";
  } catch (const Json::exception&) {
    // The number does not fit into a double.
    *error = source + ": a number is out of range, expected finite numbers";
  }
  return false;
}

}  // namespace

bool SavedNetwork::IsValid(std::string* error) const {
  if (!architecture.IsValid(error)) return false;
  const auto has_size = [error](const char* what, size_t size, int expected) {
    if (size == static_cast<size_t>(expected)) return true;
    *error = std::string(what) + " has " + std::to_string(size) +
             " entries, expected " + std::to_string(expected);
    return false;
  };
  if (!has_size("inputs", inputs.size(), architecture.num_inputs) ||
      !has_size("outputs", outputs.size(), architecture.num_outputs) ||
      !has_size("weights", static_cast<size_t>(weights.size()),
                architecture.NumWeights())) {
    return false;
  }
  for (Eigen::Index i = 0; i < weights.size(); ++i) {
    if (!std::isfinite(weights[i])) {
      *error = "weights[" + std::to_string(i) + "] is " +
               FormatNumber(weights[i]) + ", expected a finite number";
      return false;
    }
  }
  return true;
}

bool FormatNetwork(const SavedNetwork& network, std::string* text,
                   std::string* error) {
  CHECK(text != nullptr);
  CHECK(error != nullptr);
  if (!network.IsValid(error)) return false;
  const NetworkArchitecture& architecture = network.architecture;
  Json json;
  json["schema"] = kSchema;
  json["inputs"] = network.inputs;
  json["outputs"] = network.outputs;
  json["input_scale"] =
      OnesWhereEmpty(architecture.input_scale, architecture.num_inputs);
  json[kOutputScale] =
      OnesWhereEmpty(architecture.output_scale, architecture.num_outputs);
  json["hidden_widths"] = architecture.hidden_widths;
  json["activation"] = ActivationName(architecture.activation);
  json["bias"] = architecture.bias;
  json["skip"] = architecture.skip;
  json["gauge"] = architecture.gauge;
  json["weights"] =
      std::vector<double>(network.weights.begin(), network.weights.end());
  try {
    *text = json.dump(1) + "\n";
  } catch (const Json::exception&) {
    *error = "a name of an input or output is not UTF-8, expected UTF-8";
    return false;
  }
  return true;
}

bool ParseNetwork(const std::string& text, const std::string& source,
                  SavedNetwork* network, std::string* error) {
  CHECK(network != nullptr);
  CHECK(error != nullptr);
  Json json;
  if (!ParseJson(text, source, &json, error)) return false;
  const auto fail = [&](const std::string& what) {
    *error = source + ": " + what;
    return false;
  };
  if (!json.is_object()) {
    return fail("not a JSON object, expected the keys " + Join(Keys(), " "));
  }
  // The schema is checked first, so that the message names a file of another
  // kind.
  if (!json.contains("schema") || json["schema"] != kSchema) {
    return fail(std::string("no key schema with the value \"") + kSchema +
                "\", expected a network file as pinode writes it");
  }
  for (const auto& item : json.items()) {
    if (std::find(Keys().begin(), Keys().end(), item.key()) == Keys().end()) {
      return fail("unknown key '" + item.key() + "'" +
                  NameHint(item.key(), Keys()));
    }
  }
  for (const std::string& key : Keys()) {
    if (!json.contains(key) && key != kOutputScale) {
      return fail("no key '" + key + "', expected " + Join(Keys(), " "));
    }
  }

  Reader reader(json);
  SavedNetwork read;
  read.inputs = reader.Strings("inputs");
  read.outputs = reader.Strings("outputs");
  NetworkArchitecture& architecture = read.architecture;
  architecture.num_inputs = static_cast<int>(read.inputs.size());
  architecture.num_outputs = static_cast<int>(read.outputs.size());
  architecture.input_scale = reader.Numbers("input_scale");
  architecture.output_scale = json.contains(kOutputScale)
                                  ? reader.Numbers(kOutputScale)
                                  : Vector::Ones(architecture.num_outputs);
  architecture.hidden_widths = reader.Widths("hidden_widths");
  const std::string activation = reader.String("activation");
  architecture.bias = reader.Boolean("bias");
  architecture.skip = reader.Boolean("skip");
  architecture.gauge = reader.Boolean("gauge");
  read.weights = reader.Numbers("weights");
  if (!reader.error().empty()) return fail(reader.error());

  std::string what;
  if (!ParseActivation(activation, &architecture.activation, &what) ||
      !read.IsValid(&what)) {
    return fail(what);
  }
  *network = std::move(read);
  return true;
}

bool ReadNetwork(const std::string& path, SavedNetwork* network,
                 std::string* error) {
  std::string text;
  return ReadTextFile(path, &text, error) &&
         ParseNetwork(text, path, network, error);
}

bool WriteNetwork(const std::string& path, const SavedNetwork& network,
                  std::string* error) {
  std::string text;
  if (!FormatNetwork(network, &text, error)) {
    *error = path + ": " + *error;
    return false;
  }
  return WriteFileAtomically(path, text, error);
}

}  // namespace pinode
