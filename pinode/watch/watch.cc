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
  }
  // An increment that fails ends the loop.
  if (failure) {
    *error = folder + ": the folder of the records was read in part only (" +
             failure.message() + "); try again";
    return false;
  }
  std::sort(files->begin(), files->end());
  return true;
}

bool IsGrowing(const fs::path& path) {
  std::error_code failure;
  const auto written = fs::last_write_time(path, failure);
  // A clock that is ahead must not keep a file away for long.
  const auto age = fs::file_time_type::clock::now() - written;
  return !failure && age >= -kQuietTime && age < kQuietTime;
}

}  // namespace

bool StoreNewRecords(const WatchedStructure& structure,
                     const std::string& folder, bool skip_growing, int64_t id,
                     const WatchCalls& calls, Store* store,
                     KnownFiles* known_files, WatchCounts* counts,
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
    std::error_code failure;
    const auto size = fs::file_size(file, failure);
    const auto written = fs::last_write_time(file, failure);
    const auto unchanged = known_files->find(file.string());
    if (!failure && unchanged != known_files->end() &&
        unchanged->second == std::make_pair(size, written)) {
      ++counts->known;
      continue;
    }
    std::string content;
    std::string message;
    if (!ReadBinaryFile(file.string(), &content, &message)) {
      ++counts->unreadable;
      if (calls.unreadable) calls.unreadable(message);
      continue;
    }
    const auto remember = [&] {
      if (!failure) (*known_files)[file.string()] = {size, written};
    };
    bool known = false;
    if (!store->Has(id, ContentIdentity(content), &known, error)) return false;
    if (known) {
      ++counts->known;
      remember();
      continue;
    }
    const StoredRecord record =
        ExamineRecord(structure, file.string(), content);
    // The examination opens the file again. What it found of another content
    // must not be stored under this one.
    std::string after;
    if (!ReadBinaryFile(file.string(), &after, &message) || after != content) {
      ++counts->growing;
      continue;
    }
    bool added = false;
    if (!store->Add(id, record, &added, error)) return false;
    ++(added ? counts->stored : counts->known);
    remember();
    if (added && calls.stored) calls.stored(record);
  }
  return true;
}

bool AnalyseStore(const WatchedStructure& structure, int64_t id, Store* store,
                  WatchAnalysis* analysis, std::string* error) {
  std::vector<StoredRecord> records;
  if (!store->Records(id, &records, error) ||
      !FillCovariates(structure, &records, error)) {
    return false;
  }
  *analysis = AnalyseRecords(structure, std::move(records));
  return true;
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
