#include "pinode/watch/notify.h"

#include <algorithm>
#include <ctime>
#include <vector>

#include "pinode/watch/courier.h"

namespace pinode {
namespace {

bool SendOver(const std::string& way, const Couriers::Courier& courier,
              const WatchedStructure& structure, int64_t id, Store* store,
              std::string* error) {
  if (!courier) return true;
  std::vector<StoredEvent> events;
  if (!store->UnsentEvents(id, way, &events, error)) return false;
  const std::vector<std::string>& kinds = structure.notify.kinds;
  events.erase(std::remove_if(events.begin(), events.end(),
                              [&kinds](const StoredEvent& event) {
                                return std::find(kinds.begin(), kinds.end(),
                                                 event.kind) == kinds.end();
                              }),
               events.end());
  if (events.empty()) return true;
  return courier(ComposeMessage(structure.name, events), error) &&
         store->MarkSent(id, way, events, error);
}

}  // namespace

Couriers CouriersOf(const NotifyOptions& options) {
  Couriers couriers;
  if (!options.webhook.empty()) {
    couriers.webhook = [options](const WatchMessage& message,
                                 std::string* error) {
      return PostToWebhook(options.webhook, message.json, error);
    };
  }
  if (!options.mail.empty()) {
    couriers.mail = [options](const WatchMessage& message, std::string* error) {
      const auto now = static_cast<double>(std::time(nullptr));
      return SendMail(options, MailText(message, options, now), error);
    };
  }
  return couriers;
}

bool SendNewEvents(const WatchedStructure& structure, int64_t id,
                   const Couriers& couriers, Store* store, std::string* error) {
  // A way that fails does not keep the other one from being tried.
  std::string of_webhook, of_mail;
  const bool posted =
      SendOver("webhook", couriers.webhook, structure, id, store, &of_webhook);
  const bool mailed =
      SendOver("mail", couriers.mail, structure, id, store, &of_mail);
  if (posted && mailed) return true;
  *error = posted ? of_mail : mailed ? of_webhook : of_webhook + "; " + of_mail;
  return false;
}

}  // namespace pinode
