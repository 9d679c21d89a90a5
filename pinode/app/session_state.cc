// The state of a session as the page reads it:
//
// {"version", "folder", "work", "works": [...], "upload_mb",
//  "files": [{"name", "use", "size", "state": "reading", "read", "failed" or
//             "stored", "question", "error", and what LogOverview returns}],
//  "answers": {name: text}, "places": {column: place},
//  "guessed": {column: place},
//  "job": {"kind", "running", "stopping", "detail", "stage", "num_stages",
//          "iteration", "error_percent", "seconds", "troubles", "problem",
//          "question": {"flag", "text", "example"}},
//  "is_checked", "is_result_old", "is_damage_old", "compared_with",
//  "assumptions", "remarks",
//  "has_deck", "has_later", "check", "check_later": check.json of pinode_check,
//  "result": {"usable", "verdict", "findings", "interrupted", "parameters"},
//  "damage": damage.json, "has_case_later", "earlier_works", "has_modes",
//  "unfinished": ["result", "damage"]}
// Parts that are not there are null.

#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <system_error>

#include "pinode/app/record_view.h"
#include "pinode/app/session.h"
#include "pinode/base/file.h"
#include "pinode/base/strings.h"
#include "pinode/case/draft/sensor_places.h"

namespace pinode {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

// Returns the JSON in a file, null if there is none.
Json ReadJson(const std::string& path) {
  std::error_code status;
  std::string text;
  std::string unused;
  if (!fs::exists(path, status) || !ReadBinaryFile(path, &text, &unused)) {
    return nullptr;
  }
  Json json = Json::parse(text, nullptr, false);
  return json.is_discarded() ? Json(nullptr) : json;
}

Json QuestionJson(const DraftQuestion& question) {
  if (question.flag.empty()) return nullptr;
  return {{"flag", question.flag},
          {"text", question.text},
          {"example", question.example}};
}

// Returns the parts of result.json that the page shows.
Json ResultJson(const std::string& path) {
  const Json whole = ReadJson(path);
  if (!whole.is_object()) return nullptr;
  Json json = Json::object();
  for (const char* key : {"usable", "verdict", "findings", "termination",
                          "message", "parameters"}) {
    if (whole.contains(key)) json[key] = whole[key];
  }
  return json;
}

}  // namespace

std::map<std::string, std::string> Session::GuessPlaces() const {
  std::map<std::string, std::string> guessed;
  int storeys = 0;
  const auto answer = state_.answers.find("storeys");
  bool knows_storeys = answer != state_.answers.end() &&
                       ParseInt(answer->second, &storeys) && storeys > 0;
  const bool has_deck = std::any_of(
      state_.files.begin(), state_.files.end(),
      [](const WorkFile& file) { return file.use == FileUse::kDeck; });
  knows_storeys = knows_storeys && !has_deck;
  // Without it, the base alone is found.
  if (!knows_storeys) storeys = 1;
  for (const auto& [key, record] : records_) {
    if (record.log == nullptr) continue;
    const std::vector<std::string> names = record.log->ColumnNames();
    const PlacesByName found = FindPlacesByName(names, storeys);
    for (size_t i = 0; i < names.size(); ++i) {
      if (found.places[i] == kPlaceUnclear ||
          (!knows_storeys && found.places[i] > 0)) {
        continue;
      }
      guessed[names[i]] =
          found.places[i] == 0 ? "base" : std::to_string(found.places[i]);
    }
  }
  return guessed;
}

Json Session::FilesJson() const {
  Json files = Json::array();
  for (const WorkFile& file : state_.files) {
    std::error_code status;
    const auto bytes = fs::file_size(folder_.PathOf(file), status);
    Json json = {{"name", file.name},
                 {"use", FileUseName(file.use)},
                 {"size", status ? Json(nullptr) : Json(bytes)},
                 {"state", "stored"}};
    const auto found = records_.find({file.use, file.name});
    if (file.use != FileUse::kDeck) {
      const bool is_here = found != records_.end();
      json["state"] = !is_here                       ? "reading"
                      : found->second.log != nullptr ? "read"
                                                     : "failed";
      if (is_here && found->second.log != nullptr) {
        json.update(*found->second.overview);
      } else if (is_here) {
        json["question"] = QuestionJson(found->second.question);
        json["error"] = found->second.error;
      }
    }
    files.push_back(std::move(json));
  }
  return files;
}

Json Session::JobJson() const {
  if (job_.kind.empty()) return nullptr;
  return {{"kind", job_.kind},
          {"running", job_.running},
          {"stopping", job_.running && stop_},
          {"detail", job_.detail},
          {"stage", job_.progress.stage},
          {"num_stages", job_.progress.num_stages},
          {"iteration", job_.progress.iteration},
          {"error_percent", NumberOrNull(100.0 * job_.progress.free_run_error)},
          {"seconds", NumberOrNull(job_.progress.elapsed_seconds)},
          {"troubles", job_.troubles},
          {"problem", job_.error},
          {"question", QuestionJson(job_.question)}};
}

Json Session::ResultsJson() const {
  std::error_code status;
  Json unfinished = Json::array();
  Json json = {
      {"check",
       ReadJson(folder_.At(std::string(kCheckFolder) + "/check.json"))},
      {"check_later",
       ReadJson(folder_.At(std::string(kLaterCheckFolder) + "/check.json"))},
      {"result",
       ResultJson(folder_.At(std::string(kResultFolder) + "/result.json"))},
      {"damage",
       ReadJson(folder_.At(std::string(kDamageFolder) + "/damage.json"))},
      {"has_modes",
       fs::exists(folder_.At(std::string(kModesFolder) + "/report.html"),
                  status)},
      {"has_case", fs::exists(folder_.case_path(), status)},
      {"has_case_later", fs::exists(folder_.later_case_path(), status)},
      {"earlier_works", EarlierWorks()}};
  for (const char* name : {kResultFolder, kDamageFolder}) {
    if (!job_.running && folder_.HasUnfinishedFit(name)) {
      unfinished.push_back(name);
    }
  }
  json["unfinished"] = std::move(unfinished);
  return json;
}

std::string Session::State(std::int64_t known_version) {
  const std::lock_guard<std::mutex> lock(mutex_);
  Json json = {{"version", version_}};
  if (known_version == version_) return json.dump();
  const auto has = [&](FileUse use) {
    return std::any_of(state_.files.begin(), state_.files.end(),
                       [&](const WorkFile& file) { return file.use == use; });
  };
  json.update({{"folder", folder_.path()},
               {"work", folder_.name()},
               {"works", ListWorks(root_)},
               {"upload_mb", upload_bytes_ / 1000000},
               {"files", FilesJson()},
               {"answers", state_.answers},
               {"places", state_.places},
               {"guessed", GuessPlaces()},
               {"job", JobJson()},
               {"is_checked", state_.is_checked},
               {"is_result_old", state_.is_result_old},
               {"is_damage_old", state_.is_damage_old},
               {"compared_with", state_.compared_with},
               {"assumptions", state_.assumptions},
               {"remarks", state_.remarks},
               {"has_deck", has(FileUse::kDeck)},
               {"has_later", has(FileUse::kLater)}});
  json.update(ResultsJson());
  return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

}  // namespace pinode
