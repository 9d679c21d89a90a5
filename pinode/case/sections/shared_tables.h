// Tables of a case, shared between ranks.

#ifndef PINODE_CASE_SECTIONS_SHARED_TABLES_H_
#define PINODE_CASE_SECTIONS_SHARED_TABLES_H_

#include <map>
#include <string>
#include <vector>

#include "pinode/base/communicator.h"
#include "pinode/record/files/text_format.h"
#include "pinode/record/table.h"

namespace pinode {

// Reads tables once for all ranks. One rank reads each table, while other ranks
// read other tables. All ranks receive it, including an error message, when
// they need it. A case of many records is thus read from disk once, and each
// rank reads a share of it.
class SharedTables {
 public:
  struct Wanted {
    std::string path;
    std::vector<std::string> columns;  // as for ReadTable
    TextFormat format;
    bool operator==(const Wanted& other) const {
      return path == other.path && columns == other.columns &&
             format.AsText() == other.format.AsText();
    }
  };

  // Keeps a reference to `communicator` (nullptr: a single process), which must
  // outlive the object.
  explicit SharedTables(Communicator* communicator);

  // Announces all tables that will be read, in that order. If all ranks
  // announce the same, each reads its share; otherwise each reads everything
  // itself.
  void Plan(std::vector<Wanted> wanted);
  // Tells the other ranks not to wait for this one, if it ends without a plan;
  // no effect after Plan.
  void Finish();

  // Reads as ReadTable. A planned table is received from the rank that has read
  // it.
  [[nodiscard]] bool Read(const Wanted& wanted, Table* table,
                          std::string* error);

  // Number of tables that this rank has read from files.
  int num_read() const { return num_read_; }

 private:
  // Result of reading a file.
  struct Result {
    bool ok = false;
    Table table;
    std::string error;
  };

  int OwnerOf(size_t index) const {
    return static_cast<int>(index) % communicator_.size();
  }
  Result ReadFile(const Wanted& wanted);
  // Sends a result from the owner to all. Returns false if a rank does not
  // answer.
  [[nodiscard]] bool Pass(int owner, Result* result);

  Communicator& communicator_;
  bool has_planned_ = false;
  std::vector<Wanted> planned_;  // empty if the ranks do not agree
  size_t next_ = 0;
  std::map<size_t, Result> own_;  // read, but not yet used
  int num_read_ = 0;
};

}  // namespace pinode

#endif  // PINODE_CASE_SECTIONS_SHARED_TABLES_H_
