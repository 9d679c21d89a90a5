#include "pinode/watch/watch.h"

#include <fnmatch.h>
#include <sys/stat.h>

#include <algorithm>
#include <chrono>
#include <ctime>
#include <filesystem>
#include <unordered_map>
#include <utility>

#include "pinode/base/file.h"
#include "pinode/watch/examine_record.h"
#include "pinode/watch/mending.h"

namespace pinode {
namespace {

namespace fs = std::filesystem;

constexpr int64_t kQuietNanoseconds = kQuietSeconds * INT64_C(1000000000);
// Files that are remembered together. A crash before costs reading them again.
constexpr size_t kMostUnwritten = 1000;

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

// Reads size and times of a file. Returns false if it is gone.
bool ReadState(const fs::path& path, StoredFile* file) {
  struct stat state = {};
  if (stat(path.c_str(), &state) != 0) return false;
  const auto nanoseconds = [](const struct timespec& time) {
    return int64_t{1000000000} * time.tv_sec + time.tv_nsec;
  };
  std::error_code ignored;
  file->path = fs::absolute(path, ignored).lexically_normal().string();
  file->size = state.st_size;
  file->written = nanoseconds(state.st_mtim);
  file->changed = nanoseconds(state.st_ctim);
  return true;
}

bool IsSame(const StoredFile& a, const StoredFile& b) {
  return a.size == b.size && a.written == b.written && a.changed == b.changed;
}

// Returns true if the file was written a moment ago. It may grow within the
// resolution of its times, so that its state says nothing yet.
bool IsGrowing(const StoredFile& file) {
  const int64_t now = std::chrono::duration_cast<std::chrono::nanoseconds>(
                          std::chrono::system_clock::now().time_since_epoch())
                          .count();
  // A clock that is ahead must not keep a file away for long.
  const int64_t age = now - file.written;
  return age >= -kQuietNanoseconds && age < kQuietNanoseconds;
}

// New records of a folder, one file after the other.
class FolderReader {
 public:
  FolderReader(const WatchedStructure& structure, int64_t id,
               const WatchCalls& calls, Store* store, WatchCounts* counts)
      : structure_(structure),
        id_(id),
        calls_(calls),
        store_(*store),
        counts_(*counts) {}

  bool Run(const std::vector<fs::path>& files, bool skip_growing,
           std::string* error) {
    std::vector<StoredFile> known;
    if (!store_.Files(id_, &known, error)) return false;
    for (StoredFile& file : known) known_[file.path] = std::move(file);
    for (const fs::path& file : files) {
      if (calls_.interrupted && calls_.interrupted()) {
        counts_.interrupted = true;
        break;
      }
      if (!Read(file, skip_growing, error)) return false;
      if (seen_.size() >= kMostUnwritten && !WriteSeen(error)) return false;
    }
    return WriteSeen(error);
  }

 private:
  bool Read(const fs::path& path, bool skip_growing, std::string* error) {
    StoredFile file;
    std::string content;
    std::string message;
    const bool has_state = ReadState(path, &file);
    if (has_state) {
      if (skip_growing && IsGrowing(file)) {
        ++counts_.growing;
        return true;
      }
      const auto known = known_.find(file.path);
      if (known != known_.end() && IsSame(known->second, file)) {
        ++counts_.known;
        return true;
      }
    }
    ++counts_.read;
    if (!ReadBinaryFile(path.string(), &content, &message)) {
      ++counts_.unreadable;
      if (calls_.unreadable) calls_.unreadable(message);
      return true;
    }
    file.content = ContentIdentity(content);
    bool known = false;
    if (!store_.Has(id_, file.content, &known, error)) return false;
    if (known) {
      ++counts_.known;
    } else {
      const StoredRecord record =
          ExamineRecord(structure_, path.string(), content);
      // The examination opens the file again. Results of another content must
      // not be stored under this one.
      std::string after;
      if (!ReadBinaryFile(path.string(), &after, &message) ||
          after != content) {
        ++counts_.growing;
        return true;
      }
      bool added = false;
      if (!store_.Add(id_, record, &added, error)) return false;
      ++(added ? counts_.stored : counts_.known);
      if (added && calls_.stored) calls_.stored(record);
    }
    if (has_state && !IsGrowing(file)) seen_.push_back(std::move(file));
    return true;
  }

  bool WriteSeen(std::string* error) {
    if (!store_.RememberFiles(id_, seen_, error)) return false;
    seen_.clear();
    return true;
  }

  const WatchedStructure& structure_;
  int64_t id_;
  const WatchCalls& calls_;
  Store& store_;
  WatchCounts& counts_;
  std::unordered_map<std::string, StoredFile> known_;
  std::vector<StoredFile> seen_;
};

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
  return FolderReader(structure, id, calls, store, counts)
      .Run(files, skip_growing, error);
}

std::string CovariateFilesState(const WatchedStructure& structure) {
  std::string text;
  for (const WatchedCovariate& covariate : structure.covariates) {
    StoredFile file;
    if (covariate.file.empty() || !ReadState(covariate.file, &file)) continue;
    text += file.path + " " + std::to_string(file.size) + " " +
            std::to_string(file.written) + " " + std::to_string(file.changed) +
            "\n";
  }
  return text;
}

bool AnalyseStore(const WatchedStructure& structure, int64_t id, Store* store,
                  WatchAnalysis* analysis, std::string* error) {
  std::vector<StoredRecord> records;
  std::vector<StoredMend> mends;
  if (!store->Records(id, &records, error) ||
      !store->Mends(id, &mends, error) ||
      !FillCovariates(structure, &records, error)) {
    return false;
  }
  const int rejected = LeaveOutRejected(mends, &records);
  WatchedStructure named = structure;
  named.mode_names = NamesOfModes(mends);
  *analysis = AnalyseRecords(named, std::move(records));
  analysis->num_rejected = rejected;
  analysis->mends = std::move(mends);
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
