// Texts of the messages that pinode_watch sends about alarms.

#ifndef PINODE_WATCH_WATCH_MESSAGE_H_
#define PINODE_WATCH_WATCH_MESSAGE_H_

#include <string>
#include <vector>

#include "pinode/watch/store.h"
#include "pinode/watch/structure_file.h"

namespace pinode {

struct WatchMessage {
  // One line of at most 150 characters, without control characters.
  std::string subject;
  // One line for each event, the newest first, at most twenty.
  std::string text;
  // The same as JSON: "structure", "text", "events" of "time", "kind", "text".
  // Chat services show "text".
  std::string json;
  // Equal for equal events, so that a message that is sent twice is noticed.
  std::string identity;
};

// Makes one message about events of a structure, at least one.
WatchMessage ComposeMessage(const std::string& structure,
                            std::vector<StoredEvent> events);

// Returns the mail, head and body, in the lines of RFC 5322. `now` is in s
// since 1970.
std::string MailText(const WatchMessage& message, const NotifyOptions& options,
                     double now);

}  // namespace pinode

#endif  // PINODE_WATCH_WATCH_MESSAGE_H_
