// Actions of the page: steps that run in their own thread, and changes of the
// list of files and works.

#include <algorithm>
#include <exception>
#include <filesystem>
#include <new>
#include <nlohmann/json.hpp>
#include <system_error>
#include <utility>

#include "pinode/app/session.h"
#include "pinode/base/strings.h"

namespace pinode {

namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

std::string TextOf(const Json& json, const char* key) {
  return json.is_object() && json.contains(key) && json[key].is_string()
             ? json[key].get<std::string>()
             : "";
}

bool IsSet(const Json& json, const char* key) {
  return json.contains(key) && json[key] == true;
}

bool IsStep(const std::string& action) {
  return action == "check" || action == "fit" || action == "compare" ||
         action == "modes" || action == "save_case";
}

}  // namespace

// Shows the progress of a step to the page, and stops it on request.
class JobWatch : public CaseWatch {
 public:
  explicit JobWatch(Session* session) : session_(*session) {}

  bool OnIteration(const std::string& what, const IdentificationProblem&,
                   const IdentificationProgress& progress) override {
    const std::lock_guard<std::mutex> lock(session_.mutex_);
    session_.job_.detail = what;
    session_.job_.progress = progress;
    session_.job_.progress.model = nullptr;
    session_.Changed();
    return !session_.stop_;
  }
  void OnProfile(const std::vector<ParameterProfile>& done, int of) override {
    const std::lock_guard<std::mutex> lock(session_.mutex_);
    session_.job_.detail =
        "profile " + std::to_string(done.size()) + " of " + std::to_string(of);
    session_.Changed();
  }
  bool StopsProfiles() override { return session_.stop_; }
  void OnTrouble(const std::string& sentence) override {
    const std::lock_guard<std::mutex> lock(session_.mutex_);
    session_.job_.troubles.push_back(session_.folder_.ForReader(sentence));
    session_.Changed();
  }

 private:
  Session& session_;
};

bool Session::DoOrder(const WorkFolder& folder, Order* order,
                      DraftQuestion* question, std::string* error) {
  JobWatch watch(this);
  if (order->kind == "check") {
    return CheckWork(folder, order->anew, &order->state, question, error);
  }
  if (order->kind == "save_case") {
    return SaveCaseOfWork(folder, order->edited, &order->state, error);
  }
  if (order->kind == "fit") {
    return FitWork(folder, order->resume, &watch, error);
  }
  if (order->kind == "modes") {
    return FindModesOfWork(folder, order->state, order->file, order->columns,
                           error);
  }
  if (order->earlier.empty()) {
    return CompareWork(folder, folder.At(kResultFolder), order->resume, &watch,
                       error);
  }
  const WorkFolder earlier(root_, order->earlier);
  return (order->resume ||
          DraftLaterOf(earlier, folder, &order->state, question, error)) &&
         CompareWork(folder, earlier.At(kResultFolder), order->resume, &watch,
                     error);
}

void Session::RunJob(Order order) {
  WorkFolder folder;
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    folder = folder_;
  }
  DraftQuestion question;
  std::string error;
  bool good = false;
  try {
    good = DoOrder(folder, &order, &question, &error);
  } catch (const std::bad_alloc&) {
    error = "there is not enough memory; use fewer samples or sensors";
  } catch (const std::exception& exception) {
    error = std::string("the step failed: ") + exception.what();
  }
  const std::string& kind = order.kind;
  const WorkState& state = order.state;
  const std::lock_guard<std::mutex> lock(mutex_);
  if (kind == "check" || kind == "compare") state_.written = state.written;
  if (good) {
    if (kind == "save_case") {
      state_.is_checked = state.is_checked;
      state_.is_result_old = state.is_result_old;
      state_.is_damage_old = state.is_damage_old;
    } else if (kind == "check") {
      state_.is_checked = true;
      state_.is_result_old = state.is_result_old;
      state_.is_damage_old = state.is_damage_old;
      state_.assumptions = state.assumptions;
      state_.remarks = state.remarks;
    } else if (kind == "fit") {
      state_.is_result_old = false;
      state_.is_damage_old = true;
    } else if (kind == "compare") {
      state_.is_damage_old = false;
      // The later case is now that of another work's model.
      if (!order.earlier.empty()) state_.is_checked = false;
    }
  } else if (question.flag.empty()) {
    job_.error = folder.ForReader(error);
  } else {
    question.text = folder.ForReader(question.text);
    job_.question = question;
  }
  std::string unsaved;
  if (!SaveLocked(&unsaved)) job_.troubles.push_back(unsaved);
  job_.running = false;
  job_ended_.notify_all();
}

std::vector<std::string> Session::CompletePlaces() {
  std::map<std::string, std::string> quantities;
  for (const auto& [key, record] : records_) {
    if (record.overview == nullptr) continue;
    for (const Json& column : (*record.overview)["columns"]) {
      quantities[TextOf(column, "name")] = TextOf(column, "quantity");
    }
  }
  bool any = false;
  for (const auto& [column, quantity] : quantities) {
    const bool is_other =
        !quantity.empty() && quantity != "acceleration" && quantity != "force";
    if (is_other && state_.places.count(column) == 0) {
      state_.places[column] = "none";
    }
    const auto place = state_.places.find(column);
    any = any || (place != state_.places.end() && place->second != "none");
  }
  std::vector<std::string> without;
  if (!any) return without;
  const std::map<std::string, std::string> guessed = GuessPlaces();
  for (const auto& [column, quantity] : quantities) {
    if (state_.places.count(column) > 0) continue;
    const auto guess = guessed.find(column);
    if (guess == guessed.end()) {
      without.push_back(column);
    } else {
      state_.places[column] = guess->second;
    }
  }
  return without;
}

std::vector<std::string> Session::EarlierWorks() const {
  std::vector<std::string> earlier;
  for (const std::string& work : ListWorks(root_)) {
    std::error_code status;
    if (work != folder_.name() &&
        fs::exists(fs::path(root_) / work / kResultFolder / "result.json",
                   status)) {
      earlier.push_back(work);
    }
  }
  return earlier;
}

bool Session::ReadOrder(const Json& json, Order* order,
                        std::string* error) const {
  const std::string& action = order->kind;
  std::error_code status;
  order->resume = IsSet(json, "resume");
  order->anew = IsSet(json, "anew");
  if (action == "compare") {
    order->earlier =
        order->resume ? state_.compared_with : TextOf(json, "earlier");
  }
  const std::vector<std::string> works = EarlierWorks();
  if (!order->earlier.empty() &&
      std::find(works.begin(), works.end(), order->earlier) == works.end()) {
    *error = "there is no such work with a result";
    return false;
  }
  if ((action == "fit" || action == "compare") && order->earlier.empty() &&
      !state_.is_checked) {
    *error = "check the case first: files or answers have changed";
    return false;
  }
  if (action == "compare" && order->earlier.empty() &&
      !fs::exists(folder_.later_case_path(), status)) {
    *error = "there is no record of a later state; add one and check the case";
    return false;
  }
  if (action == "save_case") {
    order->edited = {TextOf(json, "text"), TextOf(json, "before"),
                     IsSet(json, "is_later")};
  }
  if (action == "modes") {
    size_t index = 0;
    if (!FindFileLocked(json, &index, error)) return false;
    order->file = state_.files[index];
    if (json.contains("columns") && json["columns"].is_array()) {
      for (const Json& column : json["columns"]) {
        if (column.is_string()) {
          order->columns.push_back(column.get<std::string>());
        }
      }
    }
    if (order->columns.empty()) order->columns.emplace_back("all");
  }
  return true;
}

bool Session::StartJob(const std::string& action, const Json& json,
                       std::string* error) {
  if (job_.running) {
    *error = "another step is running; wait for its end or stop it";
    return false;
  }
  Order order;
  order.kind = action;
  if (!ReadOrder(json, &order, error)) return false;
  if (worker_.joinable()) worker_.join();
  job_ = Job();
  job_.kind = action;
  if (action == "check") {
    const std::vector<std::string> without = CompletePlaces();
    if (!without.empty()) {
      job_.question = {"sensors",
                       "These columns have no place: " + Join(without, ", "),
                       "a floor, the base, or 'not used'"};
      Changed();
      return true;
    }
  }
  job_.running = true;
  stop_ = false;
  Changed();
  if (action == "compare") state_.compared_with = order.earlier;
  order.state = state_;
  worker_ = std::thread(&Session::RunJob, this, std::move(order));
  return true;
}

bool Session::FindFileLocked(const Json& json, size_t* index,
                             std::string* error) const {
  const std::string name = TextOf(json, "name");
  FileUse use;
  if (FindFileUse(TextOf(json, "use"), &use)) {
    for (size_t i = 0; i < state_.files.size(); ++i) {
      if (state_.files[i].name == name && state_.files[i].use == use) {
        *index = i;
        return true;
      }
    }
  }
  *error = "there is no such file";
  return false;
}

bool Session::ActOnFile(const std::string& action, const Json& json,
                        std::string* error) {
  size_t index = 0;
  if (!FindFileLocked(json, &index, error)) return false;
  const WorkFile file = state_.files[index];
  std::error_code status;
  if (action == "remove") {
    fs::remove(folder_.PathOf(file), status);
    state_.files.erase(state_.files.begin() +
                       static_cast<std::ptrdiff_t>(index));
  } else {
    WorkFile moved = file;
    if (!FindFileUse(TextOf(json, "to"), &moved.use)) {
      *error = "it is not stated for which state the file is";
      return false;
    }
    if (fs::exists(folder_.PathOf(moved), status)) {
      *error = "there is a file of this name for that state already";
      return false;
    }
    fs::rename(folder_.PathOf(file), folder_.PathOf(moved), status);
    if (status) {
      *error = file.name + " cannot be moved: " + status.message();
      return false;
    }
    state_.files[index] = moved;
  }
  records_.erase({file.use, file.name});
  state_.is_checked = false;
  return SaveLocked(error);
}

bool Session::Act(const Json& json, std::string* error) {
  const std::lock_guard<std::mutex> lock(mutex_);
  const std::string action = TextOf(json, "action");
  if (IsStep(action)) return StartJob(action, json, error);
  if (action == "stop") {
    stop_ = true;
    Changed();
    return true;
  }
  if (job_.running) {
    *error = "a step is running; wait for its end or stop it";
    return false;
  }
  if (action == "dismiss") {
    job_ = Job();
    Changed();
    return true;
  }
  if (action == "remove" || action == "use") {
    return ActOnFile(action, json, error);
  }
  if (action == "new") return OpenWork(NextWork(root_), error);
  if (action == "open") {
    const std::string name = TextOf(json, "work");
    const std::vector<std::string> works = ListWorks(root_);
    if (std::find(works.begin(), works.end(), name) != works.end()) {
      return OpenWork(name, error);
    }
    *error = "there is no such work";
    return false;
  }
  *error = "the page asked for an unknown action";
  return false;
}

}  // namespace pinode
