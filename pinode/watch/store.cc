#include "pinode/watch/store.h"

#include <sqlite3.h>

#include <cmath>
#include <cstdio>
#include <unordered_map>

#include "pinode/base/fnv.h"
#include "pinode/watch/store_statement.h"

namespace pinode {
namespace {

// Marks the file as a store ("pnde"), and its tables.
constexpr int kApplication = 0x706e6465;
constexpr int kSchema = 1;
constexpr int kBusyMilliseconds = 10000;

constexpr char kTables[] = R"sql(
CREATE TABLE structure (
  id INTEGER PRIMARY KEY,
  name TEXT NOT NULL UNIQUE,
  settings TEXT NOT NULL);
CREATE TABLE record (
  id INTEGER PRIMARY KEY,
  structure INTEGER NOT NULL REFERENCES structure(id),
  content TEXT NOT NULL,
  name TEXT NOT NULL,
  time REAL,
  duration REAL NOT NULL,
  refusal TEXT NOT NULL,
  UNIQUE (structure, content));
CREATE INDEX record_time ON record (structure, time);
CREATE TABLE channel (
  record INTEGER NOT NULL REFERENCES record(id),
  number INTEGER NOT NULL,
  name TEXT NOT NULL,
  fault TEXT NOT NULL,
  PRIMARY KEY (record, number)) WITHOUT ROWID;
CREATE TABLE mode (
  record INTEGER NOT NULL REFERENCES record(id),
  number INTEGER NOT NULL,
  frequency_hz REAL NOT NULL,
  frequency_sigma REAL NOT NULL,
  damping_ratio REAL NOT NULL,
  damping_sigma REAL NOT NULL,
  shape BLOB NOT NULL,
  PRIMARY KEY (record, number)) WITHOUT ROWID;
CREATE TABLE covariate (
  record INTEGER NOT NULL REFERENCES record(id),
  name TEXT NOT NULL,
  value REAL NOT NULL,
  PRIMARY KEY (record, name)) WITHOUT ROWID;
CREATE TABLE event (
  structure INTEGER NOT NULL REFERENCES structure(id),
  number INTEGER NOT NULL,
  time REAL NOT NULL,
  kind TEXT NOT NULL,
  text TEXT NOT NULL,
  PRIMARY KEY (structure, number)) WITHOUT ROWID;
)sql";

// Tables that came later. Stores without them get them when they are opened for
// writing, and programs that do not know them leave them alone.
constexpr char kLaterTables[] = R"sql(
CREATE TABLE IF NOT EXISTS file (
  structure INTEGER NOT NULL REFERENCES structure(id),
  path TEXT NOT NULL,
  size INTEGER NOT NULL,
  written INTEGER NOT NULL,
  changed INTEGER NOT NULL,
  content TEXT NOT NULL,
  PRIMARY KEY (structure, path)) WITHOUT ROWID;
CREATE TABLE IF NOT EXISTS mend (
  id INTEGER PRIMARY KEY,
  structure INTEGER NOT NULL REFERENCES structure(id),
  time REAL NOT NULL,
  person TEXT NOT NULL,
  reason TEXT NOT NULL,
  kind TEXT NOT NULL,
  subject TEXT NOT NULL,
  value TEXT NOT NULL);
CREATE TABLE IF NOT EXISTS sent (
  structure INTEGER NOT NULL REFERENCES structure(id),
  way TEXT NOT NULL,
  time REAL NOT NULL,
  kind TEXT NOT NULL,
  PRIMARY KEY (structure, way, time, kind)) WITHOUT ROWID;
CREATE TABLE IF NOT EXISTS history (
  structure INTEGER NOT NULL REFERENCES structure(id),
  number INTEGER NOT NULL,
  name TEXT NOT NULL,
  "values" BLOB NOT NULL,
  PRIMARY KEY (structure, number));
)sql";

}  // namespace

double StoredRecord::Covariate(const std::string& covariate) const {
  for (const auto& [key, value] : covariates) {
    if (key == covariate) return value;
  }
  return kNaN;
}

std::string ContentIdentity(const std::string& content) {
  char text[48];
  std::snprintf(
      text, sizeof(text), "%zu-%016llx", content.size(),
      static_cast<unsigned long long>(Fnv1a(content.data(), content.size())));
  return text;
}

Store::Store(std::string path, sqlite3* database)
    : path_(std::move(path)), database_(database) {}

Store::~Store() { sqlite3_close(database_); }

bool Store::Fail(std::string* error) const {
  const int code = sqlite3_errcode(database_);
  if (code == SQLITE_BUSY || code == SQLITE_LOCKED) {
    *error = path_ +
             ": another process has locked the store; end it, or try again "
             "when it is done";
  } else if (code == SQLITE_READONLY || code == SQLITE_CANTOPEN) {
    *error = path_ +
             ": the store cannot be written; its file and folder must be "
             "writable";
  } else if (code == SQLITE_NOTADB || code == SQLITE_CORRUPT) {
    *error = path_ + ": not a store of pinode_watch, or damaged (" +
             sqlite3_errmsg(database_) + "); use another file";
  } else if (code == SQLITE_FULL) {
    *error = path_ + ": the disk is full; free some space and run again";
  } else {
    *error = path_ + ": " + sqlite3_errmsg(database_);
  }
  return false;
}

bool Store::Execute(const char* sql, std::string* error) {
  return sqlite3_exec(database_, sql, nullptr, nullptr, nullptr) == SQLITE_OK ||
         Fail(error);
}

bool Store::Open(const std::string& path, Access access,
                 std::unique_ptr<Store>* store, std::string* error) {
  const int flags = access == Access::kReadOnly
                        ? SQLITE_OPEN_READONLY
                        : SQLITE_OPEN_READWRITE | SQLITE_OPEN_CREATE;
  sqlite3* database = nullptr;
  const int code = sqlite3_open_v2(path.c_str(), &database, flags, nullptr);
  std::unique_ptr<Store> opened(new Store(path, database));
  if (database == nullptr) {
    *error = path + ": no memory for a store";
    return false;
  }
  if (code != SQLITE_OK) {
    *error = path + ": the store cannot be opened (" +
             sqlite3_errmsg(database) + "); check the path and its folder";
    return false;
  }
  sqlite3_busy_timeout(database, kBusyMilliseconds);
  if (!opened->MakeSchema(access, error)) return false;
  *store = std::move(opened);
  return true;
}

bool Store::MakeSchema(Access access, std::string* error) {
  const auto pragma = [this](const char* sql, int64_t* value) {
    Statement statement(database_, sql);
    if (!statement.Step()) return false;
    *value = statement.Integer(0);
    return true;
  };
  // Read under the lock, or two new processes would both make the tables.
  Transaction transaction(this);
  if (access == Access::kReadAndWrite && !transaction.Begin(error)) {
    return false;
  }
  int64_t application = 0;
  int64_t schema = 0;
  int64_t num_tables = 0;
  if (!pragma("PRAGMA application_id", &application) ||
      !pragma("PRAGMA user_version", &schema) ||
      !pragma("SELECT count(*) FROM sqlite_master", &num_tables)) {
    return Fail(error);
  }
  if (application == 0 && schema == 0 && num_tables == 0 &&
      access == Access::kReadAndWrite) {
    const std::string marks =
        "PRAGMA application_id = " + std::to_string(kApplication) +
        "; PRAGMA user_version = " + std::to_string(kSchema);
    if (!Execute(kTables, error) || !Execute(kLaterTables, error) ||
        !Execute(marks.c_str(), error) || !transaction.Commit(error)) {
      return false;
    }
    return UseLog(error);
  }
  if (application != kApplication) {
    *error = path_ +
             ": a database, but not a store of pinode_watch; use another file";
    return false;
  }
  if (schema != kSchema) {
    *error = path_ + ": the store has schema " + std::to_string(schema) +
             ", but this pinode_watch has schema " + std::to_string(kSchema) +
             "; use the version that wrote it, or fill a new store by "
             "--backfill";
    return false;
  }
  if (access == Access::kReadOnly) return true;
  // A process that made the tables may have died before the last step.
  return Execute(kLaterTables, error) && transaction.Commit(error) &&
         UseLog(error);
}

bool Store::UseLog(std::string* error) {
  return Execute("PRAGMA journal_mode = WAL", error);
}

bool Store::Restart(int64_t id, const std::string& settings, bool* done,
                    std::string* error) {
  Statement usable(database_,
                   "SELECT 1 FROM record WHERE structure = ? AND refusal = '' "
                   "LIMIT 1");
  *done = !usable.Bind(id).Step();
  if (!*done) return true;
  if (!usable.IsAtEnd()) return Fail(error);
  for (const char* part : {"channel", "mode", "covariate"}) {
    const std::string sql =
        std::string("DELETE FROM ") + part +
        " WHERE record IN (SELECT id FROM record WHERE structure = ?)";
    if (!Statement(database_, sql.c_str()).Bind(id).Run()) return Fail(error);
  }
  Statement clear(database_, "DELETE FROM record WHERE structure = ?");
  Statement update(database_, "UPDATE structure SET settings = ? WHERE id = ?");
  return (clear.Bind(id).Run() && update.Bind(settings).Bind(id).Run()) ||
         Fail(error);
}

bool Store::OpenStructure(const std::string& name, const std::string& settings,
                          int64_t* id, std::string* error) {
  Transaction transaction(this);
  if (!transaction.Begin(error)) return false;
  Statement insert(database_,
                   "INSERT OR IGNORE INTO structure (name, settings) "
                   "VALUES (?, ?)");
  if (!insert.Bind(name).Bind(settings).Run()) return Fail(error);
  Statement find(database_,
                 "SELECT id, settings FROM structure WHERE name = ?");
  if (!find.Bind(name).Step()) return Fail(error);
  *id = find.Integer(0);
  bool same = find.Text(1) == settings;
  if (!same && !Restart(*id, settings, &same, error)) return false;
  if (!same) {
    *error = path_ + ": the records of structure '" + name +
             "' were read with other settings in [records], [modes] or the "
             "covariates; restore them, or use a new store";
    return false;
  }
  return transaction.Commit(error);
}

bool Store::FindStructure(const std::string& name, int64_t* id,
                          std::string* error) {
  Statement find(database_, "SELECT id FROM structure WHERE name = ?");
  if (find.Bind(name).Step()) {
    *id = find.Integer(0);
    return true;
  }
  if (!find.IsAtEnd()) return Fail(error);
  *error = path_ + ": no structure '" + name +
           "' is in this store; run pinode_watch without --mend first";
  return false;
}

bool Store::Has(int64_t structure, const std::string& content, bool* has,
                std::string* error) {
  Statement find(database_,
                 "SELECT 1 FROM record WHERE structure = ? AND content = ?");
  *has = find.Bind(structure).Bind(content).Step();
  return *has || find.IsAtEnd() || Fail(error);
}

bool Store::Add(int64_t structure, const StoredRecord& record, bool* added,
                std::string* error) {
  *added = false;
  Transaction transaction(this);
  if (!transaction.Begin(error)) return false;
  Statement insert(database_,
                   "INSERT OR IGNORE INTO record (structure, content, name, "
                   "time, duration, refusal) VALUES (?, ?, ?, ?, ?, ?)");
  if (!insert.Bind(structure)
           .Bind(record.content)
           .Bind(record.name)
           .Bind(record.time)
           .Bind(record.duration)
           .Bind(record.refusal)
           .Run()) {
    return Fail(error);
  }
  if (sqlite3_changes(database_) == 0) return true;
  if (!AddParts(sqlite3_last_insert_rowid(database_), record, error) ||
      !transaction.Commit(error)) {
    return false;
  }
  *added = true;
  return true;
}

bool Store::AddParts(int64_t id, const StoredRecord& record,
                     std::string* error) {
  Statement channel(database_, "INSERT INTO channel VALUES (?, ?, ?, ?)");
  int64_t number = 0;
  for (const StoredChannel& entry : record.channels) {
    if (!channel.Bind(id)
             .Bind(number++)
             .Bind(entry.name)
             .Bind(entry.fault)
             .Run()) {
      return Fail(error);
    }
  }
  Statement mode(database_, "INSERT INTO mode VALUES (?, ?, ?, ?, ?, ?, ?)");
  number = 0;
  for (const StoredMode& entry : record.modes) {
    if (!mode.Bind(id)
             .Bind(number++)
             .Bind(entry.frequency_hz)
             .Bind(entry.frequency_sigma)
             .Bind(entry.damping_ratio)
             .Bind(entry.damping_sigma)
             .Bind(entry.shape)
             .Run()) {
      return Fail(error);
    }
  }
  Statement covariate(database_, "INSERT INTO covariate VALUES (?, ?, ?)");
  for (const auto& [name, value] : record.covariates) {
    if (std::isnan(value)) continue;
    if (!covariate.Bind(id).Bind(name).Bind(value).Run()) return Fail(error);
  }
  return true;
}

bool Store::Records(int64_t structure, std::vector<StoredRecord>* records,
                    std::string* error) {
  records->clear();
  // One view of the tables, whatever is written meanwhile.
  if (!Execute("BEGIN", error)) return false;
  const bool read = ReadParts(structure, records, error);
  sqlite3_exec(database_, "ROLLBACK", nullptr, nullptr, nullptr);
  return read;
}

bool Store::ReadParts(int64_t structure, std::vector<StoredRecord>* records,
                      std::string* error) {
  std::unordered_map<int64_t, size_t> places;
  Statement record(database_,
                   "SELECT id, content, name, time, duration, refusal FROM "
                   "record WHERE structure = ? ORDER BY time, content");
  record.Bind(structure);
  while (record.Step()) {
    places.emplace(record.Integer(0), records->size());
    StoredRecord entry;
    entry.content = record.Text(1);
    entry.name = record.Text(2);
    entry.time = record.Number(3);
    entry.duration = record.Number(4);
    entry.refusal = record.Text(5);
    records->push_back(std::move(entry));
  }
  if (!record.IsAtEnd()) return Fail(error);
  const auto each = [&](const char* sql, const auto& take) {
    Statement statement(database_, sql);
    statement.Bind(structure);
    while (statement.Step()) {
      take(statement, &(*records)[places.at(statement.Integer(0))]);
    }
    return statement.IsAtEnd() || Fail(error);
  };
  return each(
             "SELECT record, channel.name, fault FROM channel JOIN record ON "
             "record.id = record WHERE structure = ? ORDER BY record, number",
             [](const Statement& row, StoredRecord* into) {
               into->channels.push_back({row.Text(1), row.Text(2)});
             }) &&
         each(
             "SELECT record, frequency_hz, frequency_sigma, damping_ratio, "
             "damping_sigma, shape FROM mode JOIN record ON record.id = record "
             "WHERE structure = ? ORDER BY record, number",
             [](const Statement& row, StoredRecord* into) {
               into->modes.push_back({row.Number(1), row.Number(2),
                                      row.Number(3), row.Number(4),
                                      row.Shape(5)});
             }) &&
         each(
             "SELECT record, covariate.name, value FROM covariate JOIN record "
             "ON record.id = record WHERE structure = ? ORDER BY record, "
             "covariate.name",
             [](const Statement& row, StoredRecord* into) {
               into->covariates.emplace_back(row.Text(1), row.Number(2));
             });
}

}  // namespace pinode
