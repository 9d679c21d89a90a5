// A profile that one rank has made, made known to all.

#ifndef PINODE_ESTIMATE_CERTAINTY_PROFILE_EXCHANGE_H_
#define PINODE_ESTIMATE_CERTAINTY_PROFILE_EXCHANGE_H_

#include "pinode/base/communicator.h"
#include "pinode/problem/parameter_profile.h"

namespace pinode {

// *done and, where it is not 0, the profile of rank `owner`. False where a rank
// does not answer.
[[nodiscard]] bool BroadcastProfile(int owner, Communicator* communicator,
                                    char* done, ParameterProfile* profile);

}  // namespace pinode

#endif  // PINODE_ESTIMATE_CERTAINTY_PROFILE_EXCHANGE_H_
