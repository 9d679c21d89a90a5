#include "pinode/case/results/result_folder.h"

#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <system_error>
#include <vector>

#include "pinode/base/logging.h"
#include "pinode/base/strings.h"
#include "pinode/case/results/folder_lock.h"

namespace pinode {
namespace {

namespace fs = std::filesystem;

constexpr char kCheckpoint[] = "checkpoint.json";
constexpr char kPartial[] = ".partial-";
// Files by which a folder is recognised as one of pinode's.
constexpr const char* kMarkers[] = {
    "result.json", "discover.json", "modes.json",
    "damage.json", "simulate.json", "check.json",
    "plan.json",   "watch.json",    kCheckpoint};

// Returns the absolute path, without links, dots and a final slash.
fs::path Canonical(const std::string& path) {
  std::error_code status;
  fs::path result = fs::weakly_canonical(fs::absolute(path, status), status);
  if (result.filename().empty()) result = result.parent_path();
  return result;
}

bool HasMarker(const fs::path& folder) {
  std::error_code status;
  for (const char* marker : kMarkers) {
    if (fs::exists(folder / marker, status)) return true;
  }
  return false;
}

struct Leftover {
  fs::path path;
  FolderHolder holder;
  bool IsDead() const { return holder.state == FolderHolder::State::kNone; }
};

// Returns the partial folders of `final_path`, oldest first.
std::vector<Leftover> FindLeftovers(const fs::path& final_path) {
  std::vector<Leftover> found;
  const std::string prefix = final_path.filename().string() + kPartial;
  std::error_code status;
  for (const auto& entry :
       fs::directory_iterator(final_path.parent_path(), status)) {
    const std::string name = entry.path().filename().string();
    int process = 0;
    if (name.rfind(prefix, 0) == 0 &&
        ParseInt(name.substr(prefix.size()), &process) && process > 0) {
      found.push_back({entry.path(), HolderOf(entry.path().string(), process)});
    }
  }
  std::sort(found.begin(), found.end(),
            [](const Leftover& a, const Leftover& b) {
              std::error_code ignored;
              return fs::last_write_time(a.path, ignored) <
                     fs::last_write_time(b.path, ignored);
            });
  return found;
}

// Returns why the folder that `leftover` is for cannot be written to.
std::string WhyHeld(const std::string& path, const Leftover& leftover) {
  if (leftover.holder.state == FolderHolder::State::kHeld) {
    return path + ": " + leftover.holder.name +
           " is writing to this folder; wait for it or give another folder";
  }
  return path + ": " + leftover.holder.name +
         " has begun to write to this folder, and pinode cannot see from here "
         "whether it still does. Give another folder; if it has ended, "
         "delete " +
         (leftover.path / kFolderLock).string();
}

// Removes everything but the checkpoint and the lock.
void KeepCheckpoint(const fs::path& folder) {
  std::error_code status;
  std::vector<fs::path> rest;
  for (const auto& entry : fs::directory_iterator(folder, status)) {
    const fs::path name = entry.path().filename();
    if (name != kCheckpoint && name != kFolderLock) {
      rest.push_back(entry.path());
    }
  }
  for (const fs::path& file : rest) fs::remove_all(file, status);
}

}  // namespace

bool CheckOutputFolder(const std::string& path, bool overwrite, bool resume,
                       std::string* error) {
  if (path.empty()) {
    *error = "the name of the output folder is empty; give --output_dir=FOLDER";
    return false;
  }
  const fs::path folder = Canonical(path);
  std::error_code status;
  if (fs::exists(folder, status)) {
    if (!fs::is_directory(folder, status)) {
      *error = path + ": is not a folder; give a folder or a new name";
      return false;
    }
    const bool empty = fs::is_empty(folder, status);
    if (status) {
      *error = path + ": cannot be read (" + status.message() + ")";
      return false;
    }
    if (!empty && !overwrite && !resume) {
      *error = path +
               ": the output folder exists and is not empty; give a new one, "
               "--overwrite, or --resume to continue a fit";
      return false;
    }
    if (!empty && !HasMarker(folder)) {
      *error =
          path +
          ": has no results of pinode and is not replaced; give another folder";
      return false;
    }
  }
  // The rename needs the parent, which is created if necessary.
  fs::path existing = fs::absolute(path, status).lexically_normal();
  if (existing.filename().empty()) existing = existing.parent_path();
  bool is_folder = true;
  while (is_folder || !fs::exists(existing, status)) {
    if (!fs::exists(existing, status) &&
        fs::is_symlink(fs::symlink_status(existing, status))) {
      *error = path + ": " + existing.string() +
               " is a link to something that does not exist, expected a new "
               "name: delete the link, or make its target";
      return false;
    }
    is_folder = false;
    if (existing == existing.parent_path()) break;
    existing = existing.parent_path();
  }
  if (!fs::is_directory(existing, status) ||
      ::access(existing.c_str(), W_OK | X_OK) != 0) {
    *error = path + ": the output folder cannot be created in " +
             existing.string() + ", expected a writable folder";
    return false;
  }
  return true;
}

ResultFolder::~ResultFolder() {
  if (working_.empty()) return;
  if (is_whole_) {
    lock_.Release(working_);
    return;
  }
  KeepCheckpoint(working_);
  lock_.Release(working_);
  std::error_code status;
  if (fs::is_empty(working_, status)) fs::remove(working_, status);
}

std::string ResultFolder::checkpoint_path() const {
  return (fs::path(working_) / kCheckpoint).string();
}

bool ResultFolder::Open(const std::string& path, bool overwrite, bool resume,
                        std::string* error) {
  CHECK(working_.empty()) << "Open is called once";
  if (!CheckOutputFolder(path, overwrite, resume, error)) return false;
  const fs::path final_path = Canonical(path);
  std::error_code status;
  fs::create_directories(final_path.parent_path(), status);
  const fs::path working(final_path.string() + kPartial +
                         std::to_string(::getpid()));

  const std::vector<Leftover> leftovers = FindLeftovers(final_path);
  for (const Leftover& leftover : leftovers) {
    if (leftover.IsDead()) continue;
    *error = WhyHeld(path, leftover);
    return false;
  }
  bool taken_over = false;
  for (auto it = leftovers.rbegin(); resume && it != leftovers.rend(); ++it) {
    if (!fs::exists(it->path / kCheckpoint, status)) continue;
    if (!lock_.Take(it->path.string())) continue;
    fs::rename(it->path, working, status);
    if (status) {
      lock_.Release(it->path.string());
      continue;
    }
    taken_over = true;
    // The dead process may have begun to write results.
    KeepCheckpoint(working);
    break;
  }
  if (!taken_over) {
    // A dead process of another container may have had this one's number.
    const bool was_left =
        std::any_of(leftovers.begin(), leftovers.end(),
                    [&](const Leftover& l) { return l.path == working; });
    if (was_left) fs::remove_all(working, status);
    if (!fs::create_directory(working, status) || status ||
        !lock_.Take(working.string())) {
      *error = path + ": the output folder cannot be created (" +
               (status ? status.message() : "another process has just begun") +
               "), expected a writable folder";
      return false;
    }
  }
  final_ = final_path.string();
  working_ = working.string();
  if (taken_over) {
    resume_path_ = checkpoint_path();
  } else if (resume && fs::exists(final_path / kCheckpoint, status)) {
    resume_path_ = (final_path / kCheckpoint).string();
  }
  return true;
}

bool ResultFolder::Commit(std::string* error) {
  CHECK(!working_.empty()) << "Open comes before Commit";
  is_whole_ = true;
  const fs::path final_path(final_);
  const fs::path old(final_ + ".old-" + std::to_string(::getpid()));
  std::error_code status;
  const bool replace =
      fs::exists(final_path, status) && !fs::is_empty(final_path, status);
  if (replace) {
    fs::rename(final_path, old, status);
    if (status) {
      *error = final_ + ": cannot be replaced (" + status.message() +
               "); the results are in " + working_;
      return false;
    }
  }
  fs::rename(working_, final_path, status);
  if (status) {
    *error = final_ + ": cannot be put in place (" + status.message() +
             "); the results are in " + working_;
    std::error_code ignored;
    if (replace) fs::rename(old, final_path, ignored);
    return false;
  }
  lock_.Release(final_);
  working_.clear();
  if (replace) fs::remove_all(old, status);
  for (const Leftover& leftover : FindLeftovers(final_path)) {
    if (leftover.IsDead()) fs::remove_all(leftover.path, status);
  }
  return true;
}

}  // namespace pinode
