// Events, histories and decisions in a store.

#include "pinode/watch/store.h"
#include "pinode/watch/store_statement.h"

namespace pinode {

bool Store::AddMend(int64_t structure, const StoredMend& mend,
                    std::string* error) {
  Statement insert(database_,
                   "INSERT INTO mend (structure, time, person, reason, kind, "
                   "subject, value) VALUES (?, ?, ?, ?, ?, ?, ?)");
  return insert.Bind(structure)
             .Bind(mend.time)
             .Bind(mend.person)
             .Bind(mend.reason)
             .Bind(mend.kind)
             .Bind(mend.subject)
             .Bind(mend.value)
             .Run() ||
         Fail(error);
}

bool Store::Mends(int64_t structure, std::vector<StoredMend>* mends,
                  std::string* error) {
  mends->clear();
  Statement read(database_,
                 "SELECT time, person, reason, kind, subject, value FROM mend "
                 "WHERE structure = ? ORDER BY id");
  read.Bind(structure);
  while (read.Step()) {
    mends->push_back({read.Number(0), read.Text(1), read.Text(2), read.Text(3),
                      read.Text(4), read.Text(5)});
  }
  return read.IsAtEnd() || Fail(error);
}

bool Store::SetEvents(int64_t structure, const std::vector<StoredEvent>& events,
                      const std::vector<StoredColumn>& histories,
                      std::string* error) {
  Transaction transaction(this);
  if (!transaction.Begin(error)) return false;
  Statement clear(database_, "DELETE FROM event WHERE structure = ?");
  if (!clear.Bind(structure).Run()) return Fail(error);
  Statement insert(database_, "INSERT INTO event VALUES (?, ?, ?, ?, ?)");
  int64_t number = 0;
  for (const StoredEvent& event : events) {
    if (!insert.Bind(structure)
             .Bind(number++)
             .Bind(event.time)
             .Bind(event.kind)
             .Bind(event.text)
             .Run()) {
      return Fail(error);
    }
  }
  Statement remove(database_, "DELETE FROM history WHERE structure = ?");
  if (!remove.Bind(structure).Run()) return Fail(error);
  Statement column(database_, "INSERT INTO history VALUES (?, ?, ?, ?)");
  number = 0;
  for (const StoredColumn& history : histories) {
    if (!column.Bind(structure)
             .Bind(number++)
             .Bind(history.name)
             .Bind(history.values)
             .Run()) {
      return Fail(error);
    }
  }
  return transaction.Commit(error);
}

bool Store::UnsentEvents(int64_t structure, const std::string& way,
                         std::vector<StoredEvent>* events, std::string* error) {
  events->clear();
  Statement read(database_,
                 "SELECT time, kind, text FROM event WHERE structure = ? AND "
                 "NOT EXISTS (SELECT 1 FROM sent WHERE sent.structure = "
                 "event.structure AND way = ? AND sent.time = event.time AND "
                 "sent.kind = event.kind) ORDER BY number");
  read.Bind(structure).Bind(way);
  while (read.Step()) {
    events->push_back({read.Number(0), read.Text(1), read.Text(2)});
  }
  return read.IsAtEnd() || Fail(error);
}

bool Store::MarkSent(int64_t structure, const std::string& way,
                     const std::vector<StoredEvent>& events,
                     std::string* error) {
  Transaction transaction(this);
  if (!transaction.Begin(error)) return false;
  Statement insert(database_, "INSERT OR IGNORE INTO sent VALUES (?, ?, ?, ?)");
  for (const StoredEvent& event : events) {
    if (!insert.Bind(structure)
             .Bind(way)
             .Bind(event.time)
             .Bind(event.kind)
             .Run()) {
      return Fail(error);
    }
  }
  return transaction.Commit(error);
}

bool Store::Events(int64_t structure, std::vector<StoredEvent>* events,
                   std::string* error) {
  events->clear();
  Statement read(database_,
                 "SELECT time, kind, text FROM event WHERE structure = ? "
                 "ORDER BY number");
  read.Bind(structure);
  while (read.Step()) {
    events->push_back({read.Number(0), read.Text(1), read.Text(2)});
  }
  return read.IsAtEnd() || Fail(error);
}

}  // namespace pinode
