// The tables that a case names, read by ranks for each other.

#ifndef PINODE_CASE_SECTIONS_SHARED_TABLES_H_
#define PINODE_CASE_SECTIONS_SHARED_TABLES_H_

#include <map>
#include <string>
#include <vector>

#include "pinode/base/communicator.h"
#include "pinode/record/table.h"

namespace pinode {

// Each table is one rank's to read, while the others read theirs; from there
// all receive it when they come to it, with what its file made of it, a message
// as well. A case of many records is so read from the disk once, whatever the
// number of ranks, and by each only a share of it.
class SharedTables {
 public:
  struct Wanted {
    std::string path;
    std::vector<std::string> columns;  // as for ReadTable
    bool operator==(const Wanted& other) const {
      return path == other.path && columns == other.columns;
    }
  };

  // `communicator` (nullptr: a single process) must outlive the object.
  explicit SharedTables(Communicator* communicator);

  // Every table that will be asked for, in that order: the ranks agree on
  // whether they all want the same, and each reads its own. Where they do not,
  // each reads everything for itself.
  void Plan(std::vector<Wanted> wanted);
  // For a rank that has come to an end without a plan, that others need not
  // wait for it; after Plan nothing.
  void Finish();

  // As ReadTable. What was planned is received from the rank that has read it.
  [[nodiscard]] bool Read(const std::string& path,
                          const std::vector<std::string>& columns, Table* table,
                          std::string* error);

  // How many tables this rank has read from files.
  int num_read() const { return num_read_; }

 private:
  // What a file made of it.
  struct Result {
    bool ok = false;
    Table table;
    std::string error;
  };

  int OwnerOf(size_t index) const {
    return static_cast<int>(index) % communicator_.size();
  }
  Result ReadFile(const Wanted& wanted);
  // From the owner to all. False where a rank does not answer.
  [[nodiscard]] bool Pass(int owner, Result* result);

  Communicator& communicator_;
  bool has_planned_ = false;
  std::vector<Wanted> planned_;  // empty where the ranks do not agree
  size_t next_ = 0;
  std::map<size_t, Result> own_;  // read, and not yet asked for
  int num_read_ = 0;
};

}  // namespace pinode

#endif  // PINODE_CASE_SECTIONS_SHARED_TABLES_H_
