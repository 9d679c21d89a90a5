// Whether an MPI launcher is at work. Apart from ranks.h, for programs that are
// none of several ranks have no flags of theirs.

#ifndef PINODE_APPS_LAUNCHER_H_
#define PINODE_APPS_LAUNCHER_H_

namespace pinode {

// How many ranks an MPI launcher has started this program as; 1 without one.
int NumLaunchedRanks();

}  // namespace pinode

#endif  // PINODE_APPS_LAUNCHER_H_
