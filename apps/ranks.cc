#include "apps/ranks.h"

#include <gflags/gflags.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>

#include "apps/launcher.h"
#include "apps/print.h"
#include "apps/program.h"
#include "pinode/base/logging.h"
#include "pinode/study/problem/checkpoint.h"
#ifdef PINODE_MPI
#include "pinode/mpi/mpi_communicator.h"
#endif

DEFINE_double(rank_timeout, 300.0,
              "under mpirun: end the run if a rank has not answered for this "
              "time, in seconds");

namespace pinode {

#ifdef PINODE_MPI

struct Ranks::Mpi {
  std::unique_ptr<MpiCommunicator> communicator;
};

Ranks::Ranks() {
  if (NumLaunchedRanks() == 1) {
    tables_ = std::make_unique<SharedTables>(nullptr);
    return;
  }
  mpi_ = std::make_unique<Mpi>();
  MpiCommunicator::Options options;
  options.timeout_seconds = FLAGS_rank_timeout;
  options.interrupted = pinode::Interrupted;
  options.on_failure = [this](const std::string& what) {
    PrintError("%s; the last checkpoint is kept, continue with --resume",
               what.c_str());
    std::fflush(nullptr);
    mpi_->communicator->Abort(kExitInterrupted);
  };
  std::string error;
  mpi_->communicator = MpiCommunicator::Begin(options, &error);
  if (mpi_->communicator == nullptr) std::exit(Refuse(error));
  if (!is_first() && (std::freopen("/dev/null", "w", stdout) == nullptr ||
                      std::freopen("/dev/null", "w", stderr) == nullptr)) {
    mpi_->communicator->Abort(kExitBadInput);
  }
  tables_ = std::make_unique<SharedTables>(communicator());
}

Communicator* Ranks::communicator() const {
  return mpi_ != nullptr ? mpi_->communicator.get() : nullptr;
}

void Ranks::ShareWork(IdentificationOptions* options) {
  if (mpi_ == nullptr) return;
  options->communicator = communicator();
  const auto all = static_cast<int>(sysconf(_SC_NPROCESSORS_ONLN));
  const int share = all / mpi_->communicator->num_local_ranks();
  options->num_threads = std::max(1, std::min(options->num_threads, share));
}

#else

struct Ranks::Mpi {};

Ranks::Ranks() : tables_(std::make_unique<SharedTables>(nullptr)) {
  if (NumLaunchedRanks() == 1) return;
  std::exit(Refuse("started as one of " + std::to_string(NumLaunchedRanks()) +
                   " ranks, but built without MPI; build with "
                   "-DPINODE_MPI=ON"));
}

Communicator* Ranks::communicator() const { return nullptr; }

void Ranks::ShareWork(IdentificationOptions*) {}

#endif

Ranks::~Ranks() = default;

bool Ranks::is_first() const {
  return communicator() == nullptr || communicator()->rank() == 0;
}

bool Ranks::Agree(bool ok, const Case& c, std::string* error) {
  tables_->Finish();
  return Agree(ok, ok ? ProblemIdentity(c.problem) : "", error);
}

bool Ranks::Agree(bool ok, const std::string& identity, std::string* error) {
  if (communicator() == nullptr) return ok;
  Communicator& ranks = *communicator();
  std::string expected = ok ? identity : "";
  if (!ranks.Broadcast(0, &expected)) return false;
  if (ok && !expected.empty() && identity != expected) {
    ok = false;
    *error =
        "its case or data differ from those of the first rank; give all "
        "ranks the same files";
  }
  Vector failed = Vector::Zero(ranks.size());
  failed[ranks.rank()] = ok ? 0.0 : 1.0;
  if (!ranks.Sum(&failed)) return false;
  int first = 0;
  if (failed.maxCoeff(&first) == 0.0) return true;
  std::string message =
      (first > 0 ? "rank " + std::to_string(first) + ": " : "") + *error;
  if (!ranks.Broadcast(first, &message)) return false;
  *error = message;
  return false;
}

bool Ranks::Open(const std::string& path, bool overwrite, bool resume,
                 ResultFolder* folder, std::string* error) {
  if (communicator() == nullptr) {
    return folder->Open(path, overwrite, resume, error);
  }
  const bool ok = !is_first() || folder->Open(path, overwrite, resume, error);
  if (!Agree(ok, std::string(), error)) return false;
  std::string resume_path = folder->resume_path();
  if (!communicator()->Broadcast(0, &resume_path)) return false;
  if (!is_first()) folder->Follow(resume_path);
  return true;
}

bool Ranks::Interrupted() {
  if (communicator() == nullptr) return pinode::Interrupted();
  return !communicator()->AllTrue(!pinode::Interrupted());
}

}  // namespace pinode
