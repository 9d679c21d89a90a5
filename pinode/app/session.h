// The state that all tabs of the page share, and what they can do to it.

#ifndef PINODE_APP_SESSION_H_
#define PINODE_APP_SESSION_H_

#include <atomic>
#include <condition_variable>
#include <map>
#include <memory>
#include <mutex>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "pinode/app/work_folder.h"
#include "pinode/app/work_jobs.h"
#include "pinode/case/draft/log_file.h"
#include "pinode/case/results/folder_lock.h"
#include "pinode/problem/identification_options.h"

namespace pinode {

// A session works on one work of a folder at a time. Every function may be
// called from any thread. Long steps run in one thread of their own, one at a
// time.
class Session {
 public:
  Session() = default;
  // Stops the running step and waits for its end.
  ~Session();
  Session(const Session&) = delete;
  Session& operator=(const Session&) = delete;

  // Takes the folder `root`, which is created if necessary, and opens its last
  // work. False, with *error, if it cannot be written to or another pinode_app
  // holds it. `upload_bytes`: the limit that the page states.
  [[nodiscard]] bool Open(const std::string& root, std::int64_t upload_bytes,
                          std::string* error);

  // Reads the records that were not read yet. Takes as long as that does.
  void ReadRecords();

  // Returns the state as JSON (session_state.cc), or {"version": n} alone if
  // `known_version` is the present one.
  std::string State(std::int64_t known_version);

  // Returns the path to which an upload is written until it is complete, in
  // *path, and then takes it over as a record or a part of a deck.
  [[nodiscard]] bool BeginUpload(std::string* path, std::string* error);
  [[nodiscard]] bool EndUpload(const std::string& path, const std::string& name,
                               const std::string& use, std::string* error);

  // Sets answers and places: {"answers": {name: text}, "places": {column:
  // place}, "places_if_none": {column: place}}. Names that are not there keep
  // their values; the last part changes no column that has a place.
  [[nodiscard]] bool SetAnswers(const nlohmann::ordered_json& json,
                                std::string* error);
  // Does {"action": "check", "fit", "compare", "modes", "save_case", "stop",
  // "dismiss", "new", "open", "remove", "use"}; see session_actions.cc.
  [[nodiscard]] bool Act(const nlohmann::ordered_json& json,
                         std::string* error);

  // Returns the picture of a column as JSON; see ColumnView.
  [[nodiscard]] bool View(const std::string& file, const std::string& use,
                          const std::string& column, int width,
                          std::string* json, std::string* error);

  // Returns the structure of the deck as JSON; see DeckView.
  [[nodiscard]] bool Deck(std::string* json, std::string* error);

  // Returns {"text"} of the case, or of that of the later state, as JSON.
  [[nodiscard]] bool CaseText(bool is_later, std::string* json,
                              std::string* error);

  // Finds a file of the present work that the page may show, such as
  // "result/report.html".
  [[nodiscard]] bool FindFile(const std::string& relative, std::string* path);

  // Waits for the end of the running step. For tests.
  void WaitForJob();

 private:
  friend class JobWatch;

  // A record as it was read.
  struct ReadRecord {
    std::shared_ptr<const LogFile> log;                      // null: not read
    std::shared_ptr<const nlohmann::ordered_json> overview;  // of the log
    DraftQuestion question;
    std::string error;
  };
  using RecordKey = std::pair<FileUse, std::string>;

  // Running or last step.
  struct Job {
    std::string kind;  // an action that is a step; empty: none
    bool running = false;
    std::string detail;
    IdentificationProgress progress;  // without a model
    std::vector<std::string> troubles;
    std::string error;
    DraftQuestion question;
  };

  // A step, and the folder and case that it works on.
  struct Order {
    std::string kind;
    bool resume = false;  // of a fit: from its checkpoint
    bool anew = false;    // of a check: replaces cases that were edited
    std::string earlier;  // of a comparison: another work; empty: this one
    WorkState state;
    WorkFile file;                     // of modes
    std::vector<std::string> columns;  // of modes
    EditedCase edited;
  };

  // All below need mutex_.
  [[nodiscard]] bool OpenWork(const std::string& name, std::string* error);
  void Changed() { ++version_; }
  [[nodiscard]] bool SaveLocked(std::string* error);
  [[nodiscard]] bool FindFileLocked(const nlohmann::ordered_json& json,
                                    size_t* index, std::string* error) const;
  [[nodiscard]] bool ActOnFile(const std::string& action,
                               const nlohmann::ordered_json& json,
                               std::string* error);
  [[nodiscard]] bool StartJob(const std::string& action,
                              const nlohmann::ordered_json& json,
                              std::string* error);
  nlohmann::ordered_json FilesJson() const;
  nlohmann::ordered_json JobJson() const;
  nlohmann::ordered_json ResultsJson() const;
  std::map<std::string, std::string> GuessPlaces() const;
  // Completes the places before a check: columns of other quantities are not
  // used, and where one place was given, the others are as guessed. Returns the
  // columns that then have none.
  std::vector<std::string> CompletePlaces();

  // Completes the order from what the page has sent. False, with *error, if it
  // cannot be done.
  [[nodiscard]] bool ReadOrder(const nlohmann::ordered_json& json, Order* order,
                               std::string* error) const;
  // Works of the folder, other than the present one, with a result.
  std::vector<std::string> EarlierWorks() const;

  // Need no mutex.
  void RunJob(Order order);
  [[nodiscard]] bool DoOrder(const WorkFolder& folder, Order* order,
                             DraftQuestion* question, std::string* error);

  std::mutex mutex_;
  std::string root_;
  FolderLock lock_;
  std::int64_t upload_bytes_ = 0;
  std::int64_t version_ = 1;
  int uploads_ = 0;
  WorkFolder folder_;
  WorkState state_;
  std::map<RecordKey, ReadRecord> records_;
  Job job_;
  std::thread worker_;
  std::condition_variable job_ended_;
  std::atomic<bool> stop_{false};

  // One thread reads records at a time.
  std::mutex reading_;
};

}  // namespace pinode

#endif  // PINODE_APP_SESSION_H_
