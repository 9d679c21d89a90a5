#include "pinode/app/work_folder.h"

#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <system_error>
#include <utility>

#include "pinode/base/file.h"
#include "pinode/base/strings.h"

namespace pinode {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr char kStateFile[] = "work.json";
constexpr char kSchema[] = "pinode-app-1";
constexpr char kWorkPrefix[] = "work_";
constexpr char kForcePrefix[] = "force:";

// An answer: its name, the member, and its label on the page.
struct AnswerField {
  const char* name;
  std::string DraftRequest::*member;
  const char* label;
};

const std::vector<AnswerField>& AnswerFields() {
  static const auto* const kFields = new std::vector<AnswerField>{
      {"title", &DraftRequest::title, "Title"},
      {"storeys", &DraftRequest::storeys, "Storeys"},
      {"weights", &DraftRequest::weights, "Weights"},
      {"stiffness", &DraftRequest::stiffness, "Stiffnesses"},
      {"first_mode_hz", &DraftRequest::first_mode_hz, "First mode"},
      {"damping_ratio", &DraftRequest::damping_ratio, "Damping"},
      {"deck_units", &DraftRequest::deck_units, "Units of the deck"},
      {"factor", &DraftRequest::factor, "Factor of the exports"},
      {"force_unit", &DraftRequest::force_unit, "Unit of the forces"},
      {"base_direction", &DraftRequest::base_direction,
       "Direction of the base"},
      {"unit", &DraftRequest::unit, "Unit of the columns"},
      {"holdout", &DraftRequest::holdout, "Held-out record"}};
  return *kFields;
}

// Answers on the time of the records.
constexpr char kTime[] = "time";
constexpr char kTimeUnit[] = "time_unit";
constexpr char kSamplingRate[] = "sampling_rate_hz";

std::string AnswerOf(const WorkState& state, const std::string& name) {
  const auto found = state.answers.find(name);
  return found == state.answers.end() ? "" : found->second;
}

const char* FolderOfUse(FileUse use) {
  switch (use) {
    case FileUse::kBaseline:
      return "records";
    case FileUse::kLater:
      return "later";
    case FileUse::kDeck:
      return "deck";
  }
  return "records";
}

int NumberOfWork(const std::string& name) {
  int number = 0;
  const std::string prefix = kWorkPrefix;
  return name.rfind(prefix, 0) == 0 &&
                 ParseInt(name.substr(prefix.size()), &number) && number > 0
             ? number
             : 0;
}

void AppendPart(const std::string& part, std::string* list) {
  *list += (list->empty() ? "" : ",") + part;
}

// Sets base, sensors and force from the places of columns. Without a place they
// are found by the columns' names.
void SetPlaces(const WorkState& state, DraftRequest* request) {
  const std::string force_prefix = kForcePrefix;
  bool any = false;
  for (const auto& [column, place] : state.places) {
    if (place.empty()) continue;
    if (place == "base") {
      request->base = column;
    } else if (place == "none") {
      AppendPart(column, &request->ignore);
    } else if (place.rfind(force_prefix, 0) == 0) {
      AppendPart(column + "=" + place.substr(force_prefix.size()),
                 &request->force);
    } else {
      AppendPart(column + "=" + place, &request->sensors);
      any = true;
    }
  }
  // All columns have a place: there is no base to look for.
  if (any && request->base.empty()) request->base = "none";
}

std::vector<std::string> StringsOf(const Json& json, const char* key) {
  std::vector<std::string> texts;
  if (!json.contains(key) || !json[key].is_array()) return texts;
  for (const Json& text : json[key]) {
    if (text.is_string()) texts.push_back(text.get<std::string>());
  }
  return texts;
}

std::map<std::string, std::string> TextsOf(const Json& json, const char* key) {
  std::map<std::string, std::string> texts;
  if (!json.contains(key) || !json[key].is_object()) return texts;
  for (const auto& [name, text] : json[key].items()) {
    if (text.is_string()) texts[name] = text.get<std::string>();
  }
  return texts;
}

bool IsTrue(const Json& json, const char* key) {
  return json.contains(key) && json[key].is_boolean() && json[key].get<bool>();
}

}  // namespace

const char* FileUseName(FileUse use) {
  switch (use) {
    case FileUse::kBaseline:
      return "baseline";
    case FileUse::kLater:
      return "later";
    case FileUse::kDeck:
      return "deck";
  }
  return "baseline";
}

bool FindFileUse(const std::string& name, FileUse* use) {
  for (const FileUse one :
       {FileUse::kBaseline, FileUse::kLater, FileUse::kDeck}) {
    if (name != FileUseName(one)) continue;
    *use = one;
    return true;
  }
  return false;
}

const std::vector<std::string>& AnswerNames() {
  static const auto* const kNames = [] {
    auto* names = new std::vector<std::string>{kTime, kTimeUnit, kSamplingRate};
    for (const AnswerField& field : AnswerFields()) {
      names->emplace_back(field.name);
    }
    return names;
  }();
  return *kNames;
}

WorkFolder::WorkFolder(const std::string& root, const std::string& name)
    : name_(name), path_((fs::path(root) / name).string()) {}

std::string WorkFolder::At(const std::string& relative) const {
  return (fs::path(path_) / relative).string();
}

std::string WorkFolder::PathOf(const WorkFile& file) const {
  return (fs::path(path_) / FolderOfUse(file.use) / file.name).string();
}

bool WorkFolder::Create(std::string* error) const {
  std::error_code status;
  for (const FileUse use :
       {FileUse::kBaseline, FileUse::kLater, FileUse::kDeck}) {
    const std::string folder = At(FolderOfUse(use));
    fs::create_directories(folder, status);
    if (!fs::is_directory(folder, status)) {
      *error = folder + " cannot be created; give a writable folder with " +
               "--folder";
      return false;
    }
  }
  return true;
}

bool WorkFolder::Load(WorkState* state, std::string* error) const {
  *state = WorkState();
  std::error_code status;
  const std::string path = At(kStateFile);
  if (!fs::exists(path, status)) return true;
  std::string text;
  if (!ReadBinaryFile(path, &text, error)) return false;
  const Json json = Json::parse(text, nullptr, false);
  if (!json.is_object() || !json.contains("schema") ||
      json["schema"] != kSchema) {
    *error = path + " is not a file of this version of pinode_app; move it " +
             "away to begin anew with the same records";
    return false;
  }
  if (json.contains("files") && json["files"].is_array()) {
    for (const Json& entry : json["files"]) {
      WorkFile file;
      file.name = entry.value("name", "");
      if (!FindFileUse(entry.value("use", ""), &file.use)) continue;
      if (fs::is_regular_file(PathOf(file), status)) {
        state->files.push_back(file);
      }
    }
  }
  for (const auto& [name, value] : TextsOf(json, "answers")) {
    const auto& known = AnswerNames();
    if (std::find(known.begin(), known.end(), name) != known.end()) {
      state->answers[name] = value;
    }
  }
  state->places = TextsOf(json, "places");
  state->written = TextsOf(json, "written");
  state->is_checked =
      IsTrue(json, "is_checked") && fs::exists(case_path(), status);
  state->is_result_old = IsTrue(json, "is_result_old");
  state->is_damage_old = IsTrue(json, "is_damage_old");
  if (json.contains("compared_with") && json["compared_with"].is_string()) {
    state->compared_with = json["compared_with"].get<std::string>();
  }
  state->assumptions = StringsOf(json, "assumptions");
  state->remarks = StringsOf(json, "remarks");
  return true;
}

bool WorkFolder::Save(const WorkState& state, std::string* error) const {
  Json files = Json::array();
  for (const WorkFile& file : state.files) {
    files.push_back({{"name", file.name}, {"use", FileUseName(file.use)}});
  }
  const Json json = {{"schema", kSchema},
                     {"files", files},
                     {"answers", state.answers},
                     {"places", state.places},
                     {"is_checked", state.is_checked},
                     {"written", state.written},
                     {"is_result_old", state.is_result_old},
                     {"is_damage_old", state.is_damage_old},
                     {"compared_with", state.compared_with},
                     {"assumptions", state.assumptions},
                     {"remarks", state.remarks}};
  return WriteFileAtomically(
      At(kStateFile),
      json.dump(1, ' ', false, Json::error_handler_t::replace) + "\n", error);
}

bool WorkFolder::HasUnfinishedFit(const std::string& relative) const {
  const std::string prefix = relative + ".partial-";
  std::error_code status;
  for (const auto& entry : fs::directory_iterator(path_, status)) {
    if (entry.path().filename().string().rfind(prefix, 0) == 0 &&
        fs::exists(entry.path() / "checkpoint.json", status)) {
      return true;
    }
  }
  return false;
}

std::string WorkFolder::ForReader(std::string text) const {
  for (const FileUse use :
       {FileUse::kBaseline, FileUse::kLater, FileUse::kDeck}) {
    ReplaceAll(At(FolderOfUse(use)) + "/", "", &text);
  }
  ReplaceAll(path_ + "/", "", &text);
  std::vector<std::pair<std::string, std::string>> labels = {
      {"--sampling_rate_hz", "\"Sampling rate\""},
      {"--time_unit", "\"Unit of the time\""},
      {"--time", "\"Column of the time\""},
      {"--sensors", "the places of the sensors"},
      {"--force_unit", "\"Unit of the forces\""},
      {"--force", "the places of the forces"},
      {"--base_direction", "\"Direction of the base\""},
      {"--base", "the place of the base"}};
  for (const AnswerField& field : AnswerFields()) {
    labels.emplace_back(std::string("--") + field.name,
                        std::string("\"") + field.label + "\"");
  }
  // The longest first: --unit is not the beginning of another.
  std::stable_sort(labels.begin(), labels.end(),
                   [](const auto& a, const auto& b) {
                     return a.first.size() > b.first.size();
                   });
  for (const auto& [flag, label] : labels) ReplaceAll(flag, label, &text);
  return text;
}

std::vector<std::string> ListWorks(const std::string& root) {
  std::vector<std::string> works;
  std::error_code status;
  for (const auto& entry : fs::directory_iterator(root, status)) {
    const std::string name = entry.path().filename().string();
    if (NumberOfWork(name) > 0 && fs::is_directory(entry.path(), status)) {
      works.push_back(name);
    }
  }
  std::sort(works.begin(), works.end(),
            [](const std::string& a, const std::string& b) {
              return NumberOfWork(a) < NumberOfWork(b);
            });
  return works;
}

std::string NextWork(const std::string& root) {
  const std::vector<std::string> works = ListWorks(root);
  const int last = works.empty() ? 0 : NumberOfWork(works.back());
  return kWorkPrefix + std::to_string(last + 1);
}

LogOptions LogOptionsOf(const WorkState& state) {
  LogOptions options;
  options.time = AnswerOf(state, kTime);
  options.time_unit = AnswerOf(state, kTimeUnit);
  double rate = 0.0;
  if (ParseDouble(AnswerOf(state, kSamplingRate), &rate) && rate > 0.0) {
    options.sampling_rate_hz = rate;
  }
  return options;
}

DraftRequest RequestOf(const WorkFolder& folder, const WorkState& state) {
  DraftRequest request;
  for (const WorkFile& file : state.files) {
    switch (file.use) {
      case FileUse::kBaseline:
        request.logs.push_back(folder.PathOf(file));
        break;
      case FileUse::kLater:
        request.later_logs.push_back(folder.PathOf(file));
        break;
      case FileUse::kDeck:
        if (fs::path(file.name).extension() == ".inp") {
          request.deck = folder.PathOf(file);
        }
        break;
    }
  }
  for (const AnswerField& field : AnswerFields()) {
    const std::string answer = AnswerOf(state, field.name);
    if (!answer.empty()) request.*field.member = answer;
  }
  if (!request.deck.empty()) {
    // They describe storeys.
    for (auto* member : {&request.storeys, &request.weights, &request.stiffness,
                         &request.first_mode_hz}) {
      member->clear();
    }
  }
  SetPlaces(state, &request);
  request.case_path = folder.case_path();
  request.later_case_path = folder.later_case_path();
  request.time = LogOptionsOf(state);
  return request;
}

std::string ShellWord(const std::string& text) {
  std::string word = text;
  ReplaceAll("'", "'\\''", &word);
  return "'" + word + "'";
}

std::string CommandOf(const WorkFolder& folder, const WorkState& state) {
  const DraftRequest request = RequestOf(folder, state);
  const auto relative = [&](const std::string& path) {
    return path.substr(folder.path().size() + 1);
  };
  std::string command = "pinode_new";
  for (const std::string& log : request.logs) {
    command += " " + ShellWord(relative(log));
  }
  const auto add = [&](const std::string& flag, const std::string& value) {
    if (!value.empty()) command += " --" + flag + "=" + ShellWord(value);
  };
  std::string later;
  for (const std::string& log : request.later_logs) {
    AppendPart(relative(log), &later);
  }
  add("later", later);
  if (!request.deck.empty()) add("deck", relative(request.deck));
  for (const AnswerField& field : AnswerFields()) {
    add(field.name, request.*field.member);
  }
  add("base", request.base);
  add("sensors", request.sensors);
  add("force", request.force);
  add("ignore", request.ignore);
  for (const char* name : {kTime, kTimeUnit, kSamplingRate}) {
    add(name, AnswerOf(state, name));
  }
  return command;
}

}  // namespace pinode
