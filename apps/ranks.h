// A program as one of several ranks, started by mpirun.

#ifndef PINODE_APPS_RANKS_H_
#define PINODE_APPS_RANKS_H_

#include <memory>
#include <string>

#include "pinode/base/communicator.h"
#include "pinode/case/results/result_folder.h"
#include "pinode/case/sections/case_file.h"
#include "pinode/case/sections/shared_tables.h"

namespace pinode {

// Takes part in the job for as long as it lives. All ranks read the same input
// and run through the same program; the first one alone writes, to files as to
// the console. Alone, where the program was started as usual.
class Ranks {
 public:
  // After ParseFlags. Does not return where a launcher has started several and
  // this program cannot be one of them.
  Ranks();
  ~Ranks();
  Ranks(const Ranks&) = delete;
  Ranks& operator=(const Ranks&) = delete;

  bool is_first() const;
  // Fits are made by all ranks together, each with its share of the threads.
  void ShareWork(IdentificationOptions* options);

  // For ReadCase: each reads a share of the case's tables.
  SharedTables* tables() { return tables_.get(); }
  // Whether all ranks have read the case, and the same one; where not, *error
  // says what the first one that has not has to say.
  [[nodiscard]] bool Agree(bool ok, const Case& c, std::string* error);
  // Opens the folder of the first one, which the others follow.
  [[nodiscard]] bool Open(const std::string& path, bool overwrite, bool resume,
                          ResultFolder* folder, std::string* error);
  // Whether one of them was interrupted: they end together.
  bool Interrupted();

 private:
  struct Mpi;

  // nullptr where there is one.
  Communicator* communicator() const;
  // The same, of what has an identity.
  [[nodiscard]] bool Agree(bool ok, const std::string& identity,
                           std::string* error);

  std::unique_ptr<Mpi> mpi_;
  std::unique_ptr<SharedTables> tables_;
};

}  // namespace pinode

#endif  // PINODE_APPS_RANKS_H_
