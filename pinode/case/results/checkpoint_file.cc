#include "pinode/case/results/checkpoint_file.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <utility>
#include <vector>

#include "pinode/base/file.h"
#include "pinode/case/results/choice_json.h"
#include "pinode/problem/parameter_layout.h"

namespace pinode {
namespace {

using Json = nlohmann::ordered_json;

constexpr char kSchema[] = "pinode-checkpoint-1";

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

// The ends of a profile's intervals, infinite ones as null.
struct NamedEnd {
  const char* name;
  double ParameterProfile::*end;
};
constexpr NamedEnd kEnds[] = {
    {"lower95", &ParameterProfile::lower95},
    {"upper95", &ParameterProfile::upper95},
    {"lower99", &ParameterProfile::lower99},
    {"upper99", &ParameterProfile::upper99},
    {"linear_lower95", &ParameterProfile::linear_lower95},
    {"linear_upper95", &ParameterProfile::linear_upper95},
};

Json ToJson(const std::vector<ParameterProfile>& profiles) {
  Json array = Json::array();
  for (const ParameterProfile& profile : profiles) {
    Json points = Json::array();
    for (const ParameterProfile::Point& point : profile.points) {
      points.push_back({point.value, point.ratio});
    }
    Json one = {{"name", profile.name},
                {"unit", profile.unit},
                {"estimate", profile.estimate},
                {"points", points},
                {"threshold95", profile.threshold95},
                {"threshold99", profile.threshold99},
                {"determination", DeterminationName(profile.determination)},
                {"combinations", profile.combinations},
                {"found_lower", profile.found_lower},
                {"unsettled", profile.unsettled},
                {"linearizations", profile.linearizations}};
    for (const NamedEnd& end : kEnds) {
      const double value = profile.*end.end;
      one[end.name] = std::isfinite(value) ? Json(value) : Json(nullptr);
    }
    array.push_back(std::move(one));
  }
  return array;
}

bool FromJson(const Json& json, Determination* determination) {
  for (const Determination known :
       {Determination::kDetermined, Determination::kOneSided,
        Determination::kNotHere, Determination::kNotAtAll}) {
    if (json == DeterminationName(known)) {
      *determination = known;
      return true;
    }
  }
  return false;
}

// Throws where a key is missing or of another type.
bool ParseProfile(const Json& json, ParameterProfile* profile) {
  profile->name = json.at("name").get<std::string>();
  profile->unit = json.at("unit").get<std::string>();
  profile->estimate = json.at("estimate").get<double>();
  for (const Json& point : json.at("points")) {
    profile->points.push_back(
        {point.at(0).get<double>(), point.at(1).get<double>()});
  }
  profile->threshold95 = json.at("threshold95").get<double>();
  profile->threshold99 = json.at("threshold99").get<double>();
  profile->combinations =
      json.at("combinations").get<std::vector<std::string>>();
  profile->found_lower = json.at("found_lower").get<bool>();
  profile->unsettled = json.at("unsettled").get<bool>();
  profile->linearizations = json.at("linearizations").get<int>();
  for (const NamedEnd& end : kEnds) {
    const Json& value = json.at(end.name);
    if (!value.is_null()) profile->*end.end = value.get<double>();
  }
  return FromJson(json.at("determination"), &profile->determination);
}

bool FromJson(const Json& json, std::vector<ParameterProfile>* profiles) {
  if (!json.is_array()) return false;
  profiles->assign(json.size(), ParameterProfile());
  try {
    for (size_t i = 0; i < json.size(); ++i) {
      if (!ParseProfile(json[i], &(*profiles)[i])) return false;
    }
  } catch (const Json::exception&) {
    return false;
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
  checkpoint->model.resume_stage = json["stage"].get<int>();
  checkpoint->cost = json["cost"].get<double>();
  IdentifiedModel& model = checkpoint->model;
  if (json.contains("profiles") &&
      !FromJson(json["profiles"], &checkpoint->profiles)) {
    return false;
  }
  if (json.contains("choice") &&
      !ChoiceFromJson(json["choice"], &checkpoint->choice)) {
    return false;
  }
  return FromJson(json["parameters"], &model.parameters) &&
         FromJson(json["sigmas"], &model.sigmas) &&
         FromJson(json["starts"], &model.starts) &&
         FromJson(json["decays"], &model.decays);
}

// Those that the problem has and `left_out` does not name.
int NumParametersWithout(const IdentificationProblem& problem,
                         const std::vector<std::string>& left_out) {
  const ParameterLayout layout(problem);
  int count = 0;
  for (int i = 0; i < layout.num_parameters(); ++i) {
    count += std::find(left_out.begin(), left_out.end(),
                       layout.parameter(i).name) == left_out.end();
  }
  return count;
}

}  // namespace

bool WriteCheckpoint(const std::string& path, const std::string& problem_hash,
                     const Checkpoint& checkpoint, std::string* error) {
  Json json;
  json["schema"] = kSchema;
  json["problem"] = problem_hash;
  json["iteration"] = checkpoint.iteration;
  json["stage"] = checkpoint.model.resume_stage;
  json["cost"] = std::isfinite(checkpoint.cost) ? checkpoint.cost : 0.0;
  json["parameters"] = ToJson(checkpoint.model.parameters);
  json["sigmas"] = ToJson(checkpoint.model.sigmas);
  json["starts"] = ToJson(checkpoint.model.starts);
  json["decays"] = ToJson(checkpoint.model.decays);
  if (!checkpoint.profiles.empty()) {
    json["profiles"] = ToJson(checkpoint.profiles);
  }
  if (!checkpoint.choice.empty()) {
    json["choice"] = ChoiceToJson(checkpoint.choice);
  }
  return WriteFileAtomically(path, json.dump() + "\n", error);
}

bool ReadCheckpoint(const std::string& path,
                    const IdentificationProblem& problem,
                    Checkpoint* checkpoint, std::string* error) {
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
  if (json["problem"] != ProblemIdentity(problem)) {
    *error = path +
             ": belongs to another case, to an earlier state of this case or "
             "its data, or to an older pinode; only options may change. Run "
             "pinode_update again";
    return false;
  }
  Checkpoint result;
  if (!ParseCheckpoint(json, &result)) {
    *error = path + ": a key is missing or has a wrong value";
    return false;
  }
  const int expected =
      NumParametersWithout(problem, result.choice.left_out_parameters);
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
  checkpoint.choice = choice_;
  checkpoint.profiles = profiles_;
  return WriteCheckpoint(path_, problem_hash_, checkpoint, error);
}

}  // namespace pinode
