// Tells people about alarms: each event once over each way.

#ifndef PINODE_WATCH_NOTIFY_H_
#define PINODE_WATCH_NOTIFY_H_

#include <cstdint>
#include <functional>
#include <string>

#include "pinode/watch/store.h"
#include "pinode/watch/structure_file.h"
#include "pinode/watch/watch_message.h"

namespace pinode {

// Ways of a message. Each returns false with one line if it was not taken.
struct Couriers {
  using Courier =
      std::function<bool(const WatchMessage& message, std::string* error)>;
  Courier webhook;
  Courier mail;
};

// Returns the couriers that [notify] asks for.
Couriers CouriersOf(const NotifyOptions& options);

// Sends one message about all events in the store that were not sent yet over a
// way, and remembers them. What is not taken is tried again by the next call.
// Returns false with one line about those that failed.
[[nodiscard]] bool SendNewEvents(const WatchedStructure& structure, int64_t id,
                                 const Couriers& couriers, Store* store,
                                 std::string* error);

}  // namespace pinode

#endif  // PINODE_WATCH_NOTIFY_H_
