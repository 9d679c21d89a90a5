// Files that a store knows by their path, size and times.

#include "pinode/watch/store.h"
#include "pinode/watch/store_statement.h"

namespace pinode {

bool Store::Files(int64_t structure, std::vector<StoredFile>* files,
                  std::string* error) {
  files->clear();
  // A file whose record was deleted is read again.
  Statement read(database_,
                 "SELECT path, size, written, changed, file.content FROM file "
                 "JOIN record ON record.structure = file.structure AND "
                 "record.content = file.content WHERE file.structure = ? "
                 "ORDER BY path");
  read.Bind(structure);
  while (read.Step()) {
    files->push_back({read.Text(0), read.Integer(1), read.Integer(2),
                      read.Integer(3), read.Text(4)});
  }
  return read.IsAtEnd() || Fail(error);
}

bool Store::RememberFiles(int64_t structure,
                          const std::vector<StoredFile>& files,
                          std::string* error) {
  if (files.empty()) return true;
  Transaction transaction(this);
  if (!transaction.Begin(error)) return false;
  Statement insert(database_,
                   "INSERT OR REPLACE INTO file VALUES (?, ?, ?, ?, ?, ?)");
  for (const StoredFile& file : files) {
    if (!insert.Bind(structure)
             .Bind(file.path)
             .Bind(file.size)
             .Bind(file.written)
             .Bind(file.changed)
             .Bind(file.content)
             .Run()) {
      return Fail(error);
    }
  }
  return transaction.Commit(error);
}

}  // namespace pinode
