#include "pinode/watch/courier.h"

#include <curl/curl.h>

#include <algorithm>
#include <cstdlib>
#include <cstring>
#include <memory>

namespace pinode {
namespace {

constexpr long kLongestSeconds = 30;

struct EndTransfer {
  void operator()(CURL* transfer) const { curl_easy_cleanup(transfer); }
};
using Transfer = std::unique_ptr<CURL, EndTransfer>;

struct FreeList {
  void operator()(curl_slist* list) const { curl_slist_free_all(list); }
};
using List = std::unique_ptr<curl_slist, FreeList>;

size_t Ignore(const char* /*data*/, size_t size, size_t count,
              void* /*unused*/) {
  return size * count;
}

// Rest of a text that is being sent.
struct Upload {
  const std::string* text;
  size_t sent = 0;
};

size_t Take(char* buffer, size_t size, size_t count, void* user) {
  auto* upload = static_cast<Upload*>(user);
  const size_t length =
      std::min(size * count, upload->text->size() - upload->sent);
  std::memcpy(buffer, upload->text->data() + upload->sent, length);
  upload->sent += length;
  return length;
}

Transfer Begin(const std::string& address, const char* protocols) {
  static const CURLcode initialised = curl_global_init(CURL_GLOBAL_DEFAULT);
  if (initialised != CURLE_OK) return nullptr;
  Transfer transfer(curl_easy_init());
  if (transfer == nullptr) return nullptr;
  CURL* const handle = transfer.get();
  curl_easy_setopt(handle, CURLOPT_URL, address.c_str());
  curl_easy_setopt(handle, CURLOPT_PROTOCOLS_STR, protocols);
  curl_easy_setopt(handle, CURLOPT_NOSIGNAL, 1L);
  curl_easy_setopt(handle, CURLOPT_TIMEOUT, kLongestSeconds);
  curl_easy_setopt(handle, CURLOPT_WRITEFUNCTION, Ignore);
  return transfer;
}

// Returns false with a line that has the address without user and query, which
// may be secret.
bool Fail(const std::string& address, const std::string& reason,
          std::string* error) {
  const size_t name = address.find("://");
  const size_t begin = name == std::string::npos ? 0 : name + 3;
  const size_t end =
      std::min(address.find_first_of("/?#", begin), address.size());
  std::string host = address.substr(begin, end - begin);
  const size_t user = host.find_last_of('@');
  if (user != std::string::npos) host = host.substr(user + 1);
  *error = "no message could be sent to " + host + ": " + reason;
  return false;
}

}  // namespace

bool PostToWebhook(const std::string& address, const std::string& json,
                   std::string* error) {
  const Transfer transfer = Begin(address, "http,https");
  if (transfer == nullptr)
    return Fail(address, "libcurl does not start", error);
  CURL* const handle = transfer.get();
  const List head(curl_slist_append(nullptr, "Content-Type: application/json"));
  curl_easy_setopt(handle, CURLOPT_HTTPHEADER, head.get());
  curl_easy_setopt(handle, CURLOPT_POSTFIELDSIZE,
                   static_cast<long>(json.size()));
  curl_easy_setopt(handle, CURLOPT_POSTFIELDS, json.c_str());
  const CURLcode code = curl_easy_perform(handle);
  if (code != CURLE_OK) return Fail(address, curl_easy_strerror(code), error);
  long status = 0;
  curl_easy_getinfo(handle, CURLINFO_RESPONSE_CODE, &status);
  return (status >= 200 && status < 300) ||
         Fail(address, "it answered with status " + std::to_string(status),
              error);
}

bool SendMail(const NotifyOptions& options, const std::string& mail,
              std::string* error) {
  const std::string& address = options.mail;
  // Without a receiver libcurl sends nothing and reports no error.
  if (options.to.empty()) {
    return Fail(address, "[notify] names no receivers; set `to`", error);
  }
  const Transfer transfer = Begin(address, "smtp,smtps");
  if (transfer == nullptr)
    return Fail(address, "libcurl does not start", error);
  CURL* const handle = transfer.get();
  const char* const password = std::getenv("PINODE_MAIL_PASSWORD");
  if (!options.user.empty()) {
    if (password == nullptr) {
      return Fail(address,
                  "[notify] names a user; set PINODE_MAIL_PASSWORD in the "
                  "environment",
                  error);
    }
    curl_easy_setopt(handle, CURLOPT_USERNAME, options.user.c_str());
    curl_easy_setopt(handle, CURLOPT_PASSWORD, password);
  }
  if (options.mail_tls) {
    curl_easy_setopt(handle, CURLOPT_USE_SSL,
                     static_cast<long>(CURLUSESSL_ALL));
  }
  List receivers;
  for (const std::string& to : options.to) {
    curl_slist* const longer =
        curl_slist_append(receivers.get(), ("<" + to + ">").c_str());
    if (longer == nullptr) return Fail(address, "no memory", error);
    (void)receivers.release();
    receivers.reset(longer);
  }
  Upload upload{&mail};
  curl_easy_setopt(handle, CURLOPT_MAIL_FROM,
                   ("<" + options.from + ">").c_str());
  curl_easy_setopt(handle, CURLOPT_MAIL_RCPT, receivers.get());
  curl_easy_setopt(handle, CURLOPT_UPLOAD, 1L);
  curl_easy_setopt(handle, CURLOPT_READFUNCTION, Take);
  curl_easy_setopt(handle, CURLOPT_READDATA, &upload);
  const CURLcode code = curl_easy_perform(handle);
  return code == CURLE_OK || Fail(address, curl_easy_strerror(code), error);
}

}  // namespace pinode
