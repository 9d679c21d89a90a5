// Sends messages by HTTP and by mail.

#ifndef PINODE_WATCH_COURIER_H_
#define PINODE_WATCH_COURIER_H_

#include <string>

#include "pinode/watch/structure_file.h"

namespace pinode {

// Posts a JSON text to the address of a webhook, http or https, and follows no
// redirection. Returns false with one line unless the answer is 200 to 299.
// Waits half a minute at the most.
[[nodiscard]] bool PostToWebhook(const std::string& address,
                                 const std::string& json, std::string* error);

// Gives a mail to the server. An address smtps:// is encrypted from the start,
// and smtp:// must offer STARTTLS unless `mail_tls` is false. The password is
// the environment's PINODE_MAIL_PASSWORD. Returns false with one line if the
// server does not take the mail for all receivers.
[[nodiscard]] bool SendMail(const NotifyOptions& options,
                            const std::string& mail, std::string* error);

}  // namespace pinode

#endif  // PINODE_WATCH_COURIER_H_
