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

// Member of an MPI job during its lifetime. All ranks read the same input and
// run the same program; only the first one writes, to files and to the console.
// A program that was started without a launcher is the only rank.
class Ranks {
 public:
  // Joins the job; call it after ParseFlags. Does not return if a launcher has
  // started several ranks and this program cannot be one of them.
  Ranks();
  ~Ranks();
  Ranks(const Ranks&) = delete;
  Ranks& operator=(const Ranks&) = delete;

  bool is_first() const;
  // Makes all ranks work on fits together, each with its share of the threads.
  void ShareWork(IdentificationOptions* options);

  // Tables for ReadCase: each rank reads a share of the case's tables.
  SharedTables* tables() { return tables_.get(); }
  // True if all ranks have read the same case. If not, *error is the message of
  // the first rank that failed.
  [[nodiscard]] bool Agree(bool ok, const Case& c, std::string* error);
  // Opens the folder of the first rank, which the others follow.
  [[nodiscard]] bool Open(const std::string& path, bool overwrite, bool resume,
                          ResultFolder* folder, std::string* error);
  // True if one of the ranks was interrupted: they end together.
  bool Interrupted();

 private:
  struct Mpi;

  // Communicator of the ranks; nullptr if there is only one.
  Communicator* communicator() const;
  // Checks the same for anything with an identity.
  [[nodiscard]] bool Agree(bool ok, const std::string& identity,
                           std::string* error);

  std::unique_ptr<Mpi> mpi_;
  std::unique_ptr<SharedTables> tables_;
};

}  // namespace pinode

#endif  // PINODE_APPS_RANKS_H_
