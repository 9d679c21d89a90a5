#include "pinode/watch/watch_message.h"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "gmock/gmock.h"
#include "gtest/gtest.h"

namespace pinode {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::StartsWith;

// 1 January 2024, 12:00 UTC.
constexpr double kNoon = 1704110400.0;

TEST(WatchMessage, NamesTheNewestEventFirst) {
  const WatchMessage message =
      ComposeMessage("bridge", {{kNoon, "alarm", "mode 2 fell"},
                                {kNoon + 86400.0, "all-clear", "for 7 days"}});
  EXPECT_EQ(message.subject, "bridge: all-clear of 2024-01-02 12:00");
  EXPECT_EQ(message.text,
            "2024-01-02 12:00 UTC, all-clear: for 7 days\n"
            "2024-01-01 12:00 UTC, alarm: mode 2 fell\n");
  const auto json = nlohmann::json::parse(message.json);
  EXPECT_EQ(json["structure"], "bridge");
  EXPECT_EQ(json["text"], "bridge\n" + message.text);
  ASSERT_EQ(json["events"].size(), 2u);
  EXPECT_EQ(json["events"][1]["kind"], "alarm");
  EXPECT_EQ(json["events"][1]["time"], "2024-01-01 12:00 UTC");
}

TEST(WatchMessage, ManyEventsAreCounted) {
  std::vector<StoredEvent> events;
  for (int i = 0; i < 25; ++i) events.push_back({kNoon + i, "alarm", "x"});
  const WatchMessage message = ComposeMessage("bridge", events);
  EXPECT_THAT(message.text, HasSubstr("5 earlier ones.\n"));
  EXPECT_EQ(std::count(message.text.begin(), message.text.end(), '\n'), 21);
  EXPECT_EQ(nlohmann::json::parse(message.json)["events"].size(), 25u);
}

TEST(WatchMessage, EqualEventsHaveOneIdentity) {
  const std::vector<StoredEvent> events = {{kNoon, "alarm", "mode 2 fell"}};
  EXPECT_EQ(ComposeMessage("bridge", events).identity,
            ComposeMessage("bridge", events).identity);
  EXPECT_NE(ComposeMessage("bridge", events).identity,
            ComposeMessage("tower", events).identity);
}

// A name from a file must not add lines to the head of a mail, and a broken one
// must not lose an alarm.
TEST(WatchMessage, HostileNamesStayInTheirLine) {
  NotifyOptions options;
  options.from = "bridge@example.org";
  options.to = {"a@example.org", "b@example.org"};
  const WatchMessage message =
      ComposeMessage("bridge\r\nBcc: c@example.org\xff" + std::string(500, 'x'),
                     {{kNoon, "alarm", "mode 2\r\n.\r\nfell"}});
  EXPECT_LE(message.subject.size(), 150u);
  EXPECT_FALSE(nlohmann::json::parse(message.json).empty());
  const std::string mail = MailText(message, options, kNoon);
  EXPECT_THAT(mail, StartsWith("Date: Mon, 1 Jan 2024 12:00:00 +0000\r\n"
                               "From: bridge@example.org\r\n"
                               "To: a@example.org,\r\n b@example.org\r\n"
                               "Subject: "));
  EXPECT_THAT(mail, Not(HasSubstr("\nBcc")));
  EXPECT_THAT(mail, Not(HasSubstr("\n.\r\n")));
}

TEST(WatchMessage, LinesOfAMailAreShort) {
  NotifyOptions options;
  options.from = "bridge@example.org";
  for (int i = 0; i < 60; ++i) {
    options.to.push_back("person" + std::to_string(i) + "@example.org");
  }
  std::string text;
  for (int i = 0; i < 300; ++i) text += "channel a" + std::to_string(i) + ", ";
  for (const std::string& reason : {text, std::string(3000, 'x')}) {
    const std::string mail = MailText(
        ComposeMessage("bridge", {{kNoon, "alarm", reason}}), options, kNoon);
    size_t begin = 0;
    for (size_t end = 0; (end = mail.find("\r\n", begin)) != mail.npos;
         begin = end + 2) {
      EXPECT_LE(end - begin, 998u);
    }
  }
}

TEST(WatchMessage, OtherLettersAreEncodedInTheSubject) {
  NotifyOptions options;
  options.from = options.to.emplace_back("a@example.org");
  const std::string mail =
      MailText(ComposeMessage("Brücke 7", {{kNoon, "alarm", "Mode 2 fiel"}}),
               options, kNoon);
  EXPECT_THAT(mail, HasSubstr("Subject: =?UTF-8?Q?Br=C3=BCcke_7=3A_alarm_of_"));
  // RFC 2047: 76 characters in each of these lines.
  std::string name;
  for (int i = 0; i < 40; ++i) name += "ü";
  const std::string more =
      MailText(ComposeMessage(name, {{kNoon, "alarm", "x"}}), options, kNoon);
  size_t begin = more.find("Subject:");
  for (size_t end = begin; more.compare(begin, 11, "Message-ID:") != 0;
       begin = end + 2) {
    end = more.find("\r\n", begin);
    ASSERT_NE(end, std::string::npos);
    EXPECT_LE(end - begin, 76u) << more.substr(begin, end - begin);
  }
}

}  // namespace
}  // namespace pinode
