#include "pinode/watch/watch_message.h"

#include <algorithm>
#include <array>
#include <cstdio>
#include <ctime>
#include <nlohmann/json.hpp>

#include "pinode/base/fnv.h"
#include "pinode/base/logging.h"
#include "pinode/base/strings.h"
#include "pinode/watch/watch.h"

namespace pinode {
namespace {

using Json = nlohmann::ordered_json;

constexpr size_t kMostLines = 20;
constexpr size_t kLongestSubject = 150;
// A line of a head with encoded words has at most 76 characters (RFC 2047),
// "Subject: =?UTF-8?Q?" and "?=" among them.
constexpr size_t kLongestWord = 50;
// A line of a mail has at most 998 bytes (RFC 5322).
constexpr size_t kLongestLine = 900;

// Returns the text in one line: a name must not begin a line of its own in the
// head of a mail.
std::string OneLine(const std::string& text) {
  std::string line;
  for (const char c : text) {
    const auto byte = static_cast<unsigned char>(c);
    line += byte < 0x20 || byte == 0x7f ? ' ' : c;
  }
  return line;
}

// Cuts a text between two characters of UTF-8.
std::string Clipped(const std::string& text, size_t longest) {
  if (text.size() <= longest) return text;
  size_t end = longest - 3;
  while (end > 0 && (static_cast<unsigned char>(text[end]) & 0xc0) == 0x80) {
    --end;
  }
  return text.substr(0, end) + "...";
}

// Encodes a word of a head line by RFC 2047, as "Q". Such a word has at most 75
// characters, so a longer text becomes several.
std::string HeadText(const std::string& text) {
  const bool is_plain = std::all_of(text.begin(), text.end(), [](char c) {
    return static_cast<unsigned char>(c) < 0x80;
  });
  if (is_plain) return text;
  std::string head, word;
  const auto close = [&head, &word] {
    if (word.empty()) return;
    head +=
        std::string(head.empty() ? "" : "\r\n ") + "=?UTF-8?Q?" + word + "?=";
    word.clear();
  };
  for (size_t i = 0; i < text.size();) {
    size_t length = 1;
    while (i + length < text.size() &&
           (static_cast<unsigned char>(text[i + length]) & 0xc0) == 0x80) {
      ++length;
    }
    std::string encoded;
    for (size_t k = i; k < i + length; ++k) {
      char hex[4];
      std::snprintf(hex, sizeof(hex), "=%02X",
                    static_cast<unsigned>(static_cast<unsigned char>(text[k])));
      encoded += hex;
    }
    const char c = text[i];
    if (length == 1 && ((c >= '0' && c <= '9') || (c >= 'a' && c <= 'z') ||
                        (c >= 'A' && c <= 'Z'))) {
      encoded = c;
    } else if (length == 1 && c == ' ') {
      encoded = "_";
    }
    if (word.size() + encoded.size() > kLongestWord) close();
    word += encoded;
    i += length;
  }
  close();
  return head;
}

// Breaks long lines at blanks, or between two characters of UTF-8.
std::string WithShortLines(const std::string& text) {
  std::string lines;
  size_t length = 0;
  for (const char c : text) {
    const bool is_inside = (static_cast<unsigned char>(c) & 0xc0) == 0x80;
    if (c == '\n' || (length >= kLongestLine && c == ' ') ||
        (length >= kLongestLine + 50 && !is_inside)) {
      lines += "\r\n";
      length = 0;
      if (c == '\n' || c == ' ') continue;
    }
    lines += c;
    ++length;
  }
  return lines;
}

// Returns a date as in the head of a mail, in UTC and in no locale's language.
std::string MailDate(double now) {
  static constexpr std::array<const char*, 7> kDays = {
      "Sun", "Mon", "Tue", "Wed", "Thu", "Fri", "Sat"};
  static constexpr std::array<const char*, 12> kMonths = {
      "Jan", "Feb", "Mar", "Apr", "May", "Jun",
      "Jul", "Aug", "Sep", "Oct", "Nov", "Dec"};
  const auto seconds = static_cast<std::time_t>(now);
  std::tm fields = {};
  gmtime_r(&seconds, &fields);
  char text[64];
  std::snprintf(text, sizeof(text), "%s, %d %s %d %02d:%02d:%02d +0000",
                kDays[static_cast<size_t>(fields.tm_wday)], fields.tm_mday,
                kMonths[static_cast<size_t>(fields.tm_mon)],
                fields.tm_year + 1900, fields.tm_hour, fields.tm_min,
                fields.tm_sec);
  return text;
}

}  // namespace

WatchMessage ComposeMessage(const std::string& structure,
                            std::vector<StoredEvent> events) {
  CHECK(!events.empty()) << "a message is about events";
  std::stable_sort(events.begin(), events.end(),
                   [](const StoredEvent& a, const StoredEvent& b) {
                     return a.time > b.time;
                   });
  const std::string name = OneLine(structure);
  WatchMessage message;
  message.subject = Clipped(name + ": " + OneLine(events.front().kind) +
                                " of " + DateText(events.front().time),
                            kLongestSubject);
  Json list = Json::array();
  std::string all = structure;
  for (size_t i = 0; i < events.size(); ++i) {
    const StoredEvent& event = events[i];
    all += "\n" + FormatNumber(event.time, 17) + event.kind + event.text;
    list.push_back({{"time", DateText(event.time) + " UTC"},
                    {"kind", event.kind},
                    {"text", event.text}});
    if (i >= kMostLines) continue;
    message.text += DateText(event.time) + " UTC, " + OneLine(event.kind) +
                    ": " + OneLine(event.text) + "\n";
  }
  if (events.size() > kMostLines) {
    message.text +=
        std::to_string(events.size() - kMostLines) + " earlier ones.\n";
  }
  char identity[24];
  std::snprintf(identity, sizeof(identity), "%016llx",
                static_cast<unsigned long long>(Fnv1a(all.data(), all.size())));
  message.identity = identity;
  Json json;
  json["structure"] = structure;
  json["text"] = name + "\n" + message.text;
  json["events"] = std::move(list);
  // Names from files may hold bytes that are no UTF-8.
  message.json = json.dump(-1, ' ', false, Json::error_handler_t::replace);
  return message;
}

std::string MailText(const WatchMessage& message, const NotifyOptions& options,
                     double now) {
  std::string text = "Date: " + MailDate(now) + "\r\n";
  text += "From: " + options.from + "\r\n";
  text += "To: " + Join(options.to, ",\r\n ") + "\r\n";
  text += "Subject: " + HeadText(message.subject) + "\r\n";
  text += "Message-ID: <" + message.identity + "@pinode.invalid>\r\n";
  text +=
      "MIME-Version: 1.0\r\nContent-Type: text/plain; charset=utf-8\r\n"
      "Content-Transfer-Encoding: 8bit\r\n\r\n";
  text += WithShortLines(message.text);
  return text;
}

}  // namespace pinode
