#include "pinode/app/request_guard.h"

#include <sys/random.h>

#include <array>
#include <cerrno>
#include <cstring>

#include "pinode/base/file.h"
#include "pinode/base/strings.h"

namespace pinode {
namespace {

// Random bytes of a token, and characters of a file's name that are kept.
constexpr size_t kTokenBytes = 16;
constexpr size_t kLongestName = 120;

bool IsOwnHost(const std::string& host) {
  std::string name = host;
  const size_t colon = name.rfind(':');
  const bool has_port = colon != std::string::npos && colon > 0 &&
                        name.find(']', colon) == std::string::npos;
  if (has_port) {
    const std::string port = name.substr(colon + 1);
    if (port.empty() ||
        port.find_first_not_of("0123456789") != std::string::npos) {
      return false;
    }
    name.resize(colon);
  }
  return name == "127.0.0.1" || name == "localhost" || name == "[::1]";
}

// Returns the first folder of "/TOKEN/rest".
std::string FirstFolder(const std::string& path) {
  if (path.empty() || path[0] != '/') return "";
  const size_t end = path.find('/', 1);
  return end == std::string::npos ? "" : path.substr(1, end - 1);
}

Refusal GuardBody(const RequestFacts& facts, const RequestRules& rules) {
  if (facts.method != "POST") return {};
  std::int64_t bytes = 0;
  if (!ParseInt(facts.content_length, &bytes) || bytes < 0) {
    return {411, "The size of the request is not stated."};
  }
  const bool is_upload = PathBelowToken(facts.path) == kUploadPath;
  const std::int64_t most = is_upload ? rules.upload_bytes : rules.other_bytes;
  if (bytes <= most) return {};
  return {413, (is_upload ? "The file has " : "The request has ") +
                   FormatNumber(static_cast<double>(bytes) / 1e6, 4) +
                   " MB, more than the " +
                   FormatNumber(static_cast<double>(most) / 1e6, 4) +
                   " MB that are allowed" +
                   (is_upload ? ". Start pinode_app with a larger --upload_mb."
                              : ".")};
}

}  // namespace

bool MakeToken(std::string* token, std::string* error) {
  std::array<unsigned char, kTokenBytes> bytes;
  if (getrandom(bytes.data(), bytes.size(), 0) !=
      static_cast<ssize_t>(bytes.size())) {
    *error = std::string("no random numbers from the system: ") +
             std::strerror(errno);
    return false;
  }
  constexpr char kDigits[] = "0123456789abcdef";
  token->clear();
  for (const unsigned char byte : bytes) {
    *token += kDigits[byte >> 4];
    *token += kDigits[byte & 15];
  }
  return true;
}

bool SameToken(const std::string& a, const std::string& b) {
  if (a.size() != b.size()) return false;
  int difference = 0;
  for (size_t i = 0; i < a.size(); ++i) difference |= a[i] ^ b[i];
  return difference == 0;
}

Refusal GuardRequest(const RequestFacts& facts, const RequestRules& rules) {
  if (!IsOwnHost(facts.host)) {
    return {403,
            "This page is for this computer only: use the address that "
            "pinode_app printed."};
  }
  if (!facts.origin.empty() && facts.origin != "http://" + facts.host) {
    return {403, "Requests from other sites are refused."};
  }
  if (rules.token.empty() || !SameToken(FirstFolder(facts.path), rules.token)) {
    return {403,
            "The address lacks its token: use the whole address that "
            "pinode_app printed."};
  }
  if (facts.method != "GET" && facts.method != "POST") {
    return {405, "Only GET and POST are served."};
  }
  return GuardBody(facts, rules);
}

std::string PathBelowToken(const std::string& path) {
  const size_t end = path.find('/', 1);
  return end == std::string::npos ? "" : path.substr(end + 1);
}

std::string SafeFileName(const std::string& name) {
  const size_t slash = name.find_last_of("/\\");
  std::string safe;
  for (const char c :
       slash == std::string::npos ? name : name.substr(slash + 1)) {
    const unsigned char byte = static_cast<unsigned char>(c);
    if (byte >= 0x20 && byte != 0x7f) safe += c == ',' ? '_' : c;
  }
  for (size_t bad = FirstInvalidUtf8(safe); bad != std::string::npos;
       bad = FirstInvalidUtf8(safe)) {
    safe[bad] = '_';
  }
  safe = std::string(StripBlanks(safe));
  safe.erase(0, safe.find_first_not_of('.'));
  if (safe.size() > kLongestName) {
    // The end tells the format.
    size_t keep = 20;
    while (keep > 0 && FirstInvalidUtf8(safe.substr(safe.size() - keep)) == 0) {
      --keep;
    }
    size_t head = kLongestName - 20;
    while (head > 0 &&
           FirstInvalidUtf8(safe.substr(0, head)) != std::string::npos) {
      --head;
    }
    safe = safe.substr(0, head) + safe.substr(safe.size() - keep);
  }
  return safe.empty() ? "file" : safe;
}

}  // namespace pinode
