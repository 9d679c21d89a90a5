#include "pinode/watch/watch.h"

#include <fnmatch.h>

#include <algorithm>
#include <chrono>
#include <ctime>
#include <filesystem>
#include <utility>

#include "pinode/base/file.h"
#include "pinode/watch/examine_record.h"

namespace pinode {
namespace {

namespace fs = std::filesystem;

// Loggers write a file in pieces that are closer than this.
constexpr auto kQuietTime = std::chrono::seconds(10);

bool ListFiles(const std::string& folder, const std::string& pattern,
               std::vector<fs::path>* files, std::string* error) {
  std::error_code failure;
  fs::directory_iterator entries(folder, failure);
  if (failure) {
    *error = folder + ": the folder of the records cannot be read (" +
             failure.message() + "); correct `folder` in [records]";
    return false;
  }
  for (; entries != fs::directory_iterator(); entries.increment(failure)) {
    const std::string name = entries->path().filename().string();
    std::error_code ignored;
    if (fnmatch(pattern.c_str(), name.c_str(), FNM_PERIOD) == 0 &&
        entries->is_regular_file(ignored)) {
      files->push_back(entries->path());
    }
    if (failure) break;
  }
  std::sort(files->begin(), files->end());
  return true;
}

bool IsGrowing(const fs::path& path) {
  std::error_code failure;
  const auto written = fs::last_write_time(path, failure);
  return !failure && fs::file_time_type::clock::now() - written < kQuietTime;
}

}  // namespace

bool StoreNewRecords(const WatchedStructure& structure,
                     const std::string& folder, bool skip_growing, int64_t id,
                     const WatchCalls& calls, Store* store, WatchCounts* counts,
                     std::string* error) {
  std::vector<fs::path> files;
  if (!ListFiles(folder, structure.records.pattern, &files, error)) {
    return false;
  }
  *counts = WatchCounts();
  counts->files = static_cast<int>(files.size());
  for (const fs::path& file : files) {
    if (calls.interrupted && calls.interrupted()) {
      counts->interrupted = true;
      return true;
    }
    if (skip_growing && IsGrowing(file)) {
      ++counts->growing;
      continue;
    }
    std::string content;
    std::string message;
    if (!ReadBinaryFile(file.string(), &content, &message)) {
      ++counts->unreadable;
      if (calls.unreadable) calls.unreadable(message);
      continue;
    }
    bool known = false;
    if (!store->Has(id, ContentIdentity(content), &known, error)) return false;
    if (known) {
      ++counts->known;
      continue;
    }
    const StoredRecord record =
        ExamineRecord(structure, file.string(), content);
    bool added = false;
    if (!store->Add(id, record, &added, error)) return false;
    ++(added ? counts->stored : counts->known);
    if (added && calls.stored) calls.stored(record);
  }
  return true;
}

bool AnalyseStore(const WatchedStructure& structure, int64_t id, Store* store,
                  WatchAnalysis* analysis, std::string* error) {
  std::vector<StoredRecord> records;
  std::vector<std::pair<size_t, std::string>> found;
  if (!store->Records(id, &records, error) ||
      !FillCovariates(structure, &records, &found, error)) {
    return false;
  }
  for (const auto& [record, name] : found) {
    const StoredRecord& of = records[record];
    if (!store->AddCovariate(id, of.content, name, of.Covariate(name), error)) {
      return false;
    }
  }
  *analysis = AnalyseRecords(structure, std::move(records));
  return store->SetEvents(id, analysis->events, error);
}

std::string DateText(double time) {
  const std::time_t seconds = static_cast<std::time_t>(time);
  std::tm fields = {};
  gmtime_r(&seconds, &fields);
  char text[32];
  std::strftime(text, sizeof(text), "%Y-%m-%d %H:%M", &fields);
  return text;
}

}  // namespace pinode
