// Checks of requests before they reach a session: who asks, and how much.

#ifndef PINODE_APP_REQUEST_GUARD_H_
#define PINODE_APP_REQUEST_GUARD_H_

#include <cstdint>
#include <string>

namespace pinode {

// Makes a token of 128 random bits from the system, as 32 hexadecimal digits.
[[nodiscard]] bool MakeToken(std::string* token, std::string* error);

// True if both texts are equal. The time that it takes does not depend on where
// they differ.
bool SameToken(const std::string& a, const std::string& b);

// Parts of a request that are checked. Texts that the request lacks are empty.
struct RequestFacts {
  std::string method;          // "GET", "POST"
  std::string path;            // decoded, without parameters
  std::string host;            // header Host
  std::string origin;          // header Origin
  std::string content_length;  // header Content-Length
};

struct RequestRules {
  // First folder of every address.
  std::string token;
  // Largest body of an upload, and of all other requests.
  std::int64_t upload_bytes = 0;
  std::int64_t other_bytes = 1 << 20;
};

// Path of uploads, below the token.
inline constexpr char kUploadPath[] = "upload";

struct Refusal {
  int status = 0;  // of HTTP; 0: the request is not refused
  std::string message;
};

// Refuses a request
// - with another Host than 127.0.0.1, localhost or [::1]: another site's name
//   leads here (DNS rebinding),
// - with another Origin than that host: another site's page asks,
// - without the token,
// - whose body is larger than the rules allow, or of unknown size.
Refusal GuardRequest(const RequestFacts& facts, const RequestRules& rules);

// Returns `path` without the token's folder: "state" of "/TOKEN/state".
std::string PathBelowToken(const std::string& path);

// Returns a name for a file of a user: the last part of `name`, without control
// characters, commas and dots at its beginning, in valid UTF-8, at most 120
// bytes long. "file" if nothing is left.
std::string SafeFileName(const std::string& name);

}  // namespace pinode

#endif  // PINODE_APP_REQUEST_GUARD_H_
