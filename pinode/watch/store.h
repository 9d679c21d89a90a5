// Store of pinode_watch: what was found in each record of each structure, in
// one SQLite file.
//
// A record is known by its content, so it is stored once under whatever names
// it arrives. It is stored in one transaction. A process that dies at any time
// leaves every record either whole or absent. Histories, models and the chart
// are not stored: they are computed from the records in the order of their
// times, so the order of arrival does not matter.

#ifndef PINODE_WATCH_STORE_H_
#define PINODE_WATCH_STORE_H_

#include <cstdint>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "pinode/base/constants.h"
#include "pinode/base/types.h"

struct sqlite3;

namespace pinode {

struct StoredChannel {
  std::string name;
  // Reason for leaving it out, a sentence; empty: it was used.
  std::string fault;
};

struct StoredMode {
  double frequency_hz = 0.0;
  double frequency_sigma = 0.0;  // Hz
  double damping_ratio = 0.0;
  double damping_sigma = 0.0;
  // Displacements at the channels that were used, in their order.
  ComplexVector shape;
};

struct StoredRecord {
  // Identity of the content, see ContentIdentity().
  std::string content;
  // File name, for people.
  std::string name;
  // Time of the first sample in s since 1970, UTC; NaN: not known.
  double time = kNaN;
  double duration = 0.0;  // s
  // Reason why no modes were looked for; empty: they were.
  std::string refusal;
  std::vector<StoredChannel> channels;
  std::vector<StoredMode> modes;
  // Means over the record, by name.
  std::vector<std::pair<std::string, double>> covariates;

  // Value of a covariate; NaN: missing.
  double Covariate(const std::string& covariate) const;
};

// Change of the light, or a remark, as the last analysis found it.
struct StoredEvent {
  double time = 0.0;  // s since 1970
  std::string kind;   // "alarm", "notice" or "all-clear"
  std::string text;
};

// File whose content is in the store. It is not read again as long as its size
// and times are the same.
struct StoredFile {
  std::string path;  // absolute
  int64_t size = 0;
  // Times of the last write and of the last change of its entry, ns since 1970.
  int64_t written = 0;
  int64_t changed = 0;
  std::string content;  // see ContentIdentity()
};

// Decision of a person. It is stored beside the results of the program and
// changes none of them in the store.
struct StoredMend {
  double time = 0.0;  // when it was made, s since 1970
  std::string person;
  std::string reason;
  // "reject" or "accept" a record, "name" a mode, or "acknowledge" an alarm.
  std::string kind;
  // Content of the record, frequency in Hz, or time of the alarm in s.
  std::string subject;
  // Name of the file or of the mode, or the alarm's time as a date.
  std::string value;
};

// Column of the histories, a value for each record.
struct StoredColumn {
  std::string name;
  Vector values;
};

// Returns a text that distinguishes contents: their size and a hash.
std::string ContentIdentity(const std::string& content);

// Connection to a store, for one thread. Several processes may have one. A
// process waits up to ten seconds for another one that writes. All functions
// return false with one line in *error that names the file.
class Store {
 public:
  enum class Access { kReadAndWrite, kReadOnly };

  // Opens the file, or makes it. Refuses a file that is no store, or one of
  // another schema.
  [[nodiscard]] static bool Open(const std::string& path, Access access,
                                 std::unique_ptr<Store>* store,
                                 std::string* error);
  ~Store();
  Store(const Store&) = delete;
  Store& operator=(const Store&) = delete;

  // Finds the structure, or adds it. Refuses `settings` that differ from those
  // of its records. If all of them were refused, they are deleted and may be
  // read again.
  [[nodiscard]] bool OpenStructure(const std::string& name,
                                   const std::string& settings, int64_t* id,
                                   std::string* error);

  // Finds a structure that must be there.
  [[nodiscard]] bool FindStructure(const std::string& name, int64_t* id,
                                   std::string* error);

  [[nodiscard]] bool Has(int64_t structure, const std::string& content,
                         bool* has, std::string* error);
  // Adds a record as a whole. *added is false if another process has done so.
  [[nodiscard]] bool Add(int64_t structure, const StoredRecord& record,
                         bool* added, std::string* error);
  // Reads all records by time; records of one time by content.
  [[nodiscard]] bool Records(int64_t structure,
                             std::vector<StoredRecord>* records,
                             std::string* error);

  // Reads the files whose records are in the store.
  [[nodiscard]] bool Files(int64_t structure, std::vector<StoredFile>* files,
                           std::string* error);
  // Adds files, or replaces those of the same path.
  [[nodiscard]] bool RememberFiles(int64_t structure,
                                   const std::vector<StoredFile>& files,
                                   std::string* error);

  // Adds a decision, and reads all in their order. A later one counts more.
  [[nodiscard]] bool AddMend(int64_t structure, const StoredMend& mend,
                             std::string* error);
  [[nodiscard]] bool Mends(int64_t structure, std::vector<StoredMend>* mends,
                           std::string* error);

  // Replaces the events of the structure, and the columns of its histories.
  [[nodiscard]] bool SetEvents(int64_t structure,
                               const std::vector<StoredEvent>& events,
                               const std::vector<StoredColumn>& histories,
                               std::string* error);
  [[nodiscard]] bool Events(int64_t structure, std::vector<StoredEvent>* events,
                            std::string* error);
  // Reads the events that no message over `way` ("mail") has told of, and
  // remembers events as told. Time and kind identify an event.
  [[nodiscard]] bool UnsentEvents(int64_t structure, const std::string& way,
                                  std::vector<StoredEvent>* events,
                                  std::string* error);
  [[nodiscard]] bool MarkSent(int64_t structure, const std::string& way,
                              const std::vector<StoredEvent>& events,
                              std::string* error);

 private:
  class Transaction;
  class Statement;

  Store(std::string path, sqlite3* database);

  bool Fail(std::string* error) const;
  bool Execute(const char* sql, std::string* error);
  bool MakeSchema(Access access, std::string* error);
  // Readers and the writer do not wait for each other then.
  bool UseLog(std::string* error);
  // Gives a structure without a usable record new settings.
  bool Restart(int64_t id, const std::string& settings, bool* done,
               std::string* error);
  bool AddParts(int64_t id, const StoredRecord& record, std::string* error);
  bool ReadParts(int64_t structure, std::vector<StoredRecord>* records,
                 std::string* error);

  std::string path_;
  sqlite3* database_;
};

}  // namespace pinode

#endif  // PINODE_WATCH_STORE_H_
