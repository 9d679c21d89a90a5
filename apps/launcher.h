// Detection of an MPI launcher. It is separate from ranks.h, so that programs
// that never run as several ranks do not get its flags.

#ifndef PINODE_APPS_LAUNCHER_H_
#define PINODE_APPS_LAUNCHER_H_

namespace pinode {

// Returns the number of ranks that an MPI launcher has started; 1 without one.
int NumLaunchedRanks();

}  // namespace pinode

#endif  // PINODE_APPS_LAUNCHER_H_
