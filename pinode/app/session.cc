#include "pinode/app/session.h"

#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <system_error>

#include "pinode/app/deck_view.h"
#include "pinode/app/record_view.h"
#include "pinode/app/request_guard.h"
#include "pinode/base/file.h"
#include "pinode/base/strings.h"

namespace pinode {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr char kUploadPrefix[] = ".upload-";

// Files of a work that the page may show.
constexpr const char* kShownFiles[] = {
    "case.toml",          "case_later.toml",      "result/report.html",
    "damage/report.html", "modes/report.html",    "result/result.json",
    "damage/damage.json", "result/parameters.csv"};

bool SameOptions(const LogOptions& a, const LogOptions& b) {
  return a.time == b.time && a.time_unit == b.time_unit &&
         a.sampling_rate_hz == b.sampling_rate_hz;
}

// Removes parts of uploads that were cut off.
void RemoveCutUploads(const std::string& root) {
  std::error_code status;
  std::vector<fs::path> cut;
  for (const auto& entry : fs::directory_iterator(root, status)) {
    if (entry.path().filename().string().rfind(kUploadPrefix, 0) == 0) {
      cut.push_back(entry.path());
    }
  }
  for (const fs::path& path : cut) fs::remove(path, status);
}

}  // namespace

Session::~Session() {
  stop_ = true;
  if (worker_.joinable()) worker_.join();
  if (!root_.empty()) lock_.Release(root_);
}

bool Session::Open(const std::string& root, std::int64_t upload_bytes,
                   std::string* error) {
  const std::lock_guard<std::mutex> lock(mutex_);
  std::error_code status;
  const std::string absolute =
      fs::absolute(root, status).lexically_normal().string();
  fs::create_directories(absolute, status);
  if (!fs::is_directory(absolute, status)) {
    *error = root + ": the folder cannot be created; give another one with " +
             "--folder";
    return false;
  }
  if (!lock_.Take(absolute)) {
    *error = root + ": another pinode_app uses this folder; go on there, or " +
             "give another folder with --folder";
    return false;
  }
  root_ = absolute;
  upload_bytes_ = upload_bytes;
  RemoveCutUploads(root_);
  const std::vector<std::string> works = ListWorks(root_);
  return OpenWork(works.empty() ? NextWork(root_) : works.back(), error);
}

bool Session::OpenWork(const std::string& name, std::string* error) {
  const WorkFolder folder(root_, name);
  WorkState state;
  if (!folder.Create(error) || !folder.Load(&state, error)) return false;
  folder_ = folder;
  state_ = std::move(state);
  records_.clear();
  job_ = Job();
  Changed();
  return true;
}

bool Session::SaveLocked(std::string* error) {
  Changed();
  return folder_.Save(state_, error);
}

void Session::ReadRecords() {
  const std::lock_guard<std::mutex> reading(reading_);
  for (;;) {
    RecordKey key;
    WorkFolder folder;
    LogOptions options;
    {
      const std::lock_guard<std::mutex> lock(mutex_);
      folder = folder_;
      options = LogOptionsOf(state_);
      const auto unread = std::find_if(
          state_.files.begin(), state_.files.end(), [&](const WorkFile& file) {
            return file.use != FileUse::kDeck &&
                   records_.count({file.use, file.name}) == 0;
          });
      if (unread == state_.files.end()) return;
      key = {unread->use, unread->name};
    }
    ReadRecord record;
    LogFile log;
    const std::string path = folder.PathOf({key.second, key.first});
    if (ReadLogFile(path, options, &log, &record.question, &record.error)) {
      record.overview = std::make_shared<const Json>(LogOverview(log));
      record.log = std::make_shared<const LogFile>(std::move(log));
    }
    record.error = folder.ForReader(record.error);
    record.question.text = folder.ForReader(record.question.text);
    const std::lock_guard<std::mutex> lock(mutex_);
    // The answers may have changed meanwhile.
    if (folder.path() == folder_.path() &&
        SameOptions(options, LogOptionsOf(state_))) {
      records_[key] = std::move(record);
      Changed();
    }
  }
}

bool Session::BeginUpload(std::string* path, std::string* error) {
  const std::lock_guard<std::mutex> lock(mutex_);
  if (job_.running && job_.kind == "check") {
    *error = "the check is running; add the file when it has ended";
    return false;
  }
  *path =
      (fs::path(root_) / (kUploadPrefix + std::to_string(++uploads_))).string();
  return true;
}

bool Session::EndUpload(const std::string& path, const std::string& name,
                        const std::string& use, std::string* error) {
  const std::lock_guard<std::mutex> lock(mutex_);
  std::error_code status;
  WorkFile file;
  file.name = SafeFileName(name);
  if (!FindFileUse(use, &file.use)) {
    fs::remove(path, status);
    *error = "it is not stated for which state the file is";
    return false;
  }
  fs::rename(path, folder_.PathOf(file), status);
  if (status) {
    *error = file.name + " cannot be stored: " + status.message();
    fs::remove(path, status);
    return false;
  }
  records_.erase({file.use, file.name});
  const auto same = [&](const WorkFile& other) {
    return other.use == file.use && other.name == file.name;
  };
  if (std::none_of(state_.files.begin(), state_.files.end(), same)) {
    state_.files.push_back(file);
  }
  state_.is_checked = false;
  return SaveLocked(error);
}

bool Session::SetAnswers(const Json& json, std::string* error) {
  const std::lock_guard<std::mutex> lock(mutex_);
  const LogOptions before = LogOptionsOf(state_);
  for (const std::string part : {"answers", "places", "places_if_none"}) {
    if (!json.contains(part) || !json[part].is_object()) continue;
    auto& texts = part == "answers" ? state_.answers : state_.places;
    for (const auto& [name, value] : json[part].items()) {
      const auto& known = AnswerNames();
      if (!value.is_string() ||
          (&texts == &state_.answers &&
           std::find(known.begin(), known.end(), name) == known.end())) {
        *error = "'" + name + "' is not an answer to a question of the page";
        return false;
      }
      if (part == "places_if_none" && texts.count(name) > 0) continue;
      const std::string text(StripBlanks(value.get<std::string>()));
      if (text.empty()) {
        texts.erase(name);
      } else {
        texts[name] = text;
      }
    }
  }
  state_.is_checked = false;
  if (!SameOptions(before, LogOptionsOf(state_))) records_.clear();
  return SaveLocked(error);
}

bool Session::View(const std::string& file, const std::string& use,
                   const std::string& column, int width, std::string* json,
                   std::string* error) {
  RecordKey key;
  key.second = file;
  std::shared_ptr<const LogFile> log;
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    if (FindFileUse(use, &key.first)) {
      const auto found = records_.find(key);
      if (found != records_.end()) log = found->second.log;
    }
  }
  const LogColumn* wanted = log == nullptr ? nullptr : log->Find(column);
  if (wanted == nullptr) {
    *error = "there is no such column";
    return false;
  }
  *json = ColumnView(*log, *wanted, width)
              .dump(-1, ' ', false, Json::error_handler_t::replace);
  return true;
}

bool Session::Deck(std::string* json, std::string* error) {
  WorkFolder folder;
  std::string path;
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    folder = folder_;
    path = RequestOf(folder_, state_).deck;
  }
  Json view;
  if (path.empty()) {
    *error = "there is no deck";
    return false;
  }
  if (!ReadDeckView(path, &view, error)) {
    *error = folder.ForReader(*error);
    return false;
  }
  *json = view.dump(-1, ' ', false, Json::error_handler_t::replace);
  return true;
}

bool Session::CaseText(bool is_later, std::string* json, std::string* error) {
  const std::lock_guard<std::mutex> lock(mutex_);
  const std::string path =
      is_later ? folder_.later_case_path() : folder_.case_path();
  std::string text;
  if (!ReadBinaryFile(path, &text, error)) return false;
  *json =
      Json{{"text", text}}.dump(-1, ' ', false, Json::error_handler_t::replace);
  return true;
}

bool Session::FindFile(const std::string& relative, std::string* path) {
  const std::lock_guard<std::mutex> lock(mutex_);
  const bool shown = std::find(std::begin(kShownFiles), std::end(kShownFiles),
                               relative) != std::end(kShownFiles);
  std::error_code status;
  *path = folder_.At(relative);
  return shown && fs::is_regular_file(*path, status);
}

void Session::WaitForJob() {
  std::unique_lock<std::mutex> lock(mutex_);
  job_ended_.wait(lock, [this] { return !job_.running; });
}

}  // namespace pinode
