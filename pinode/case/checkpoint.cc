#include "pinode/case/checkpoint.h"

#include <cmath>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <utility>
#include <vector>

#include "pinode/base/file.h"
#include "pinode/estimate/parameter_layout.h"

namespace pinode {
namespace {

using Json = nlohmann::ordered_json;

constexpr char kSchema[] = "pinode-checkpoint-1";

// FNV-1a, 64 bits (G. Fowler, L. C. Noll, K.-P. Vo).
class Hash {
 public:
  void Add(const void* data, size_t size) {
    const auto* bytes = static_cast<const unsigned char*>(data);
    for (size_t i = 0; i < size; ++i) {
      state_ = (state_ ^ bytes[i]) * 0x100000001b3u;
    }
  }
  void Add(const std::string& text) {
    Add(static_cast<std::int64_t>(text.size()));
    Add(text.data(), text.size());
  }
  void Add(std::int64_t value) { Add(&value, sizeof(value)); }
  void Add(double value) { Add(&value, sizeof(value)); }
  void Add(const Matrix& matrix) {
    Add(static_cast<std::int64_t>(matrix.rows()));
    Add(static_cast<std::int64_t>(matrix.cols()));
    Add(matrix.data(), sizeof(double) * static_cast<size_t>(matrix.size()));
  }
  void Add(const ParameterBlock& block) {
    Add(block.name);
    Add(static_cast<std::int64_t>(block.size()));
    // Initial weights of a network depend on a seed, which may change.
    if (!block.named) return;
    for (const Parameter& p : block.parameters) {
      Add(p.name);
      for (const double value :
           {p.value, p.lower, p.upper, p.prior_mean, p.prior_sigma}) {
        Add(value);
      }
      Add(static_cast<std::int64_t>(p.free));
    }
  }

  std::string Text() const {
    constexpr char kDigits[] = "0123456789abcdef";
    std::string text;
    for (int shift = 60; shift >= 0; shift -= 4) {
      text += kDigits[(state_ >> shift) & 15];
    }
    return text;
  }

 private:
  std::uint64_t state_ = 0xcbf29ce484222325u;
};

Json ToJson(const Vector& values) {
  Json array = Json::array();
  for (const double value : values) array.push_back(value);
  return array;
}

Json ToJson(const std::vector<Vector>& vectors) {
  Json array = Json::array();
  for (const Vector& vector : vectors) array.push_back(ToJson(vector));
  return array;
}

bool FromJson(const Json& json, Vector* values) {
  if (!json.is_array()) return false;
  Vector result(static_cast<Eigen::Index>(json.size()));
  for (size_t i = 0; i < json.size(); ++i) {
    if (!json[i].is_number()) return false;
    result[static_cast<Eigen::Index>(i)] = json[i].get<double>();
  }
  *values = std::move(result);
  return values->allFinite();
}

bool FromJson(const Json& json, std::vector<Vector>* vectors) {
  if (!json.is_array()) return false;
  vectors->assign(json.size(), Vector());
  for (size_t i = 0; i < json.size(); ++i) {
    if (!FromJson(json[i], &(*vectors)[i])) return false;
  }
  return true;
}

bool ParseCheckpoint(const Json& json, Checkpoint* checkpoint) {
  for (const char* key : {"iteration", "stage", "cost", "parameters", "sigmas",
                          "starts", "decays"}) {
    if (!json.contains(key)) return false;
  }
  if (!json["iteration"].is_number_integer() ||
      !json["stage"].is_number_integer() || !json["cost"].is_number()) {
    return false;
  }
  checkpoint->iteration = json["iteration"].get<int>();
  checkpoint->model.stage = json["stage"].get<int>();
  checkpoint->cost = json["cost"].get<double>();
  IdentifiedModel& model = checkpoint->model;
  return FromJson(json["parameters"], &model.parameters) &&
         FromJson(json["sigmas"], &model.sigmas) &&
         FromJson(json["starts"], &model.starts) &&
         FromJson(json["decays"], &model.decays);
}

}  // namespace

std::string ProblemHash(const IdentificationProblem& problem) {
  Hash hash;
  const StructuralModel& model = problem.dynamics->model();
  for (const std::string& name : model.dof_names) hash.Add(name);
  hash.Add(model.mass);
  hash.Add(model.damping);
  hash.Add(model.stiffness);
  hash.Add(model.influence);
  hash.Add(model.support_mass_coupling);
  for (const GroupTerm& term : problem.dynamics->groups()) {
    hash.Add(static_cast<std::int64_t>(term.group.target));
    hash.Add(term.group.matrix);
  }
  for (const LawTerm& term : problem.dynamics->laws()) {
    hash.Add(term.type);
    hash.Add(term.outputs);
    hash.Add(static_cast<std::int64_t>(term.acts_as));
  }
  for (const UnknownForceTerm& term : problem.dynamics->unknown_forces()) {
    hash.Add(term.history->Description());
    hash.Add(Matrix(term.outputs));
    hash.Add(static_cast<std::int64_t>(term.input));
    for (const CombinationPrior::Combination& c : term.prior.combinations) {
      hash.Add(static_cast<std::int64_t>(c.group));
      hash.Add(Matrix(c.weights));
    }
    for (const double precision : term.prior.precisions) hash.Add(precision);
  }
  for (const NetworkTerm& term : problem.dynamics->networks()) {
    const NetworkArchitecture& architecture = term.network->architecture();
    for (const int width : architecture.hidden_widths) {
      hash.Add(static_cast<std::int64_t>(width));
    }
    hash.Add(static_cast<std::int64_t>(architecture.activation));
    hash.Add(static_cast<std::int64_t>(architecture.gauge));
    hash.Add(term.outputs);
  }
  for (const ParameterBlock& block : problem.dynamics->blocks()) {
    hash.Add(block);
  }
  hash.Add(problem.sensors);
  for (const IdentificationRecord& record : problem.records) {
    hash.Add(record.name);
    hash.Add(static_cast<std::int64_t>(record.role));
    hash.Add(static_cast<std::int64_t>(record.start));
    hash.Add(static_cast<std::int64_t>(record.substeps));
    hash.Add(record.sampling_step());
    hash.Add(record.excitation->samples());
    for (const MeasuredChannel& channel : record.channels) {
      hash.Add(channel.observation.name);
      hash.Add(static_cast<std::int64_t>(channel.observation.quantity));
      hash.Add(Matrix(channel.observation.weights));
      hash.Add(Matrix(channel.values));
      hash.Add(channel.sigma);
      hash.Add(static_cast<std::int64_t>(channel.fit));
    }
  }
  if (!problem.modal.empty()) {
    hash.Add(static_cast<std::int64_t>(problem.modal.form));
  }
  for (const MeasuredMode& mode : problem.modal.modes) {
    hash.Add(mode.name);
    for (const double value :
         {mode.frequency, mode.frequency_sigma, mode.frequency_weight,
          mode.shape_sigma, mode.shape_weight, mode.residual_weight}) {
      hash.Add(value);
    }
    for (const int dof : mode.dofs) hash.Add(static_cast<std::int64_t>(dof));
    hash.Add(Matrix(mode.shape));
  }
  return hash.Text();
}

std::string CaseHash(const Case& c) {
  return c.renewed_from.empty() ? ProblemHash(c.problem) : c.renewed_from;
}

bool WriteCheckpoint(const std::string& path, const std::string& problem_hash,
                     const Checkpoint& checkpoint, std::string* error) {
  Json json;
  json["schema"] = kSchema;
  json["problem"] = problem_hash;
  json["iteration"] = checkpoint.iteration;
  json["stage"] = checkpoint.model.stage;
  json["cost"] = std::isfinite(checkpoint.cost) ? checkpoint.cost : 0.0;
  json["parameters"] = ToJson(checkpoint.model.parameters);
  json["sigmas"] = ToJson(checkpoint.model.sigmas);
  json["starts"] = ToJson(checkpoint.model.starts);
  json["decays"] = ToJson(checkpoint.model.decays);
  return WriteFileAtomically(path, json.dump() + "\n", error);
}

bool ReadCheckpoint(const std::string& path, const Case& c,
                    Checkpoint* checkpoint, std::string* error) {
  const IdentificationProblem& problem = c.problem;
  std::string text;
  if (!ReadTextFile(path, &text, error)) return false;
  const Json json = Json::parse(text, nullptr, /*allow_exceptions=*/false);
  if (json.is_discarded() || !json.is_object() || !json.contains("schema") ||
      json["schema"] != kSchema || !json.contains("problem")) {
    *error = path +
             ": is not a checkpoint, expected a file with \"schema\": \"" +
             kSchema + "\"";
    return false;
  }
  if (json["problem"] != CaseHash(c)) {
    *error = path +
             ": belongs to another case, or the case or its data have "
             "changed since; expected the same case (options may change)";
    return false;
  }
  Checkpoint result;
  if (!ParseCheckpoint(json, &result)) {
    *error = path + ": a key is missing or holds something else than numbers";
    return false;
  }
  const int expected = ParameterLayout(problem).num_parameters();
  if (result.model.parameters.size() != expected) {
    *error = path + ": holds " +
             std::to_string(result.model.parameters.size()) +
             " parameters, expected " + std::to_string(expected);
    return false;
  }
  *checkpoint = std::move(result);
  return true;
}

CheckpointWriter::CheckpointWriter(std::string problem_hash, std::string path,
                                   std::chrono::milliseconds interval)
    : path_(std::move(path)),
      problem_hash_(std::move(problem_hash)),
      interval_(interval) {}

bool CheckpointWriter::Update(const IdentificationProgress& progress,
                              std::string* error) {
  const auto now = std::chrono::steady_clock::now();
  if (progress.model == nullptr || (written_ && now - last_ < interval_)) {
    return true;
  }
  written_ = true;
  last_ = now;
  Checkpoint checkpoint;
  checkpoint.iteration = progress.iteration;
  checkpoint.cost = progress.cost;
  checkpoint.model = *progress.model;
  return WriteCheckpoint(path_, problem_hash_, checkpoint, error);
}

}  // namespace pinode
