// Switch for code that a case brings.

#ifndef PINODE_DYNAMICS_OWN_CODE_H_
#define PINODE_DYNAMICS_OWN_CODE_H_

namespace pinode {

// Makes LoadElementLibrary refuse every library from now on, in this process.
void RefuseOwnCode();

// True after RefuseOwnCode, or if the environment variable PINODE_NO_CODE is
// set and not empty.
bool IsOwnCodeRefused();

}  // namespace pinode

#endif  // PINODE_DYNAMICS_OWN_CODE_H_
