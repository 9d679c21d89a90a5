#include "pinode/app/request_guard.h"

#include <gtest/gtest.h>

#include <set>
#include <string>

#include "pinode/base/file.h"

namespace pinode {
namespace {

RequestRules Rules() {
  RequestRules rules;
  rules.token = "0123456789abcdef0123456789abcdef";
  rules.upload_bytes = 200000000;
  return rules;
}

RequestFacts Good(const std::string& rest) {
  RequestFacts facts;
  facts.method = "GET";
  facts.path = "/" + Rules().token + "/" + rest;
  facts.host = "127.0.0.1:8080";
  return facts;
}

int StatusOf(const RequestFacts& facts) {
  const Refusal refusal = GuardRequest(facts, Rules());
  EXPECT_EQ(refusal.status == 0, refusal.message.empty());
  return refusal.status;
}

TEST(Token, IsRandomAndLong) {
  std::set<std::string> tokens;
  for (int i = 0; i < 100; ++i) {
    std::string token;
    std::string error;
    ASSERT_TRUE(MakeToken(&token, &error)) << error;
    EXPECT_EQ(token.size(), 32u);
    EXPECT_EQ(token.find_first_not_of("0123456789abcdef"), std::string::npos);
    tokens.insert(token);
  }
  EXPECT_EQ(tokens.size(), 100u);
}

TEST(Token, IsCompared) {
  EXPECT_TRUE(SameToken("abc", "abc"));
  EXPECT_FALSE(SameToken("abc", "abd"));
  EXPECT_FALSE(SameToken("abc", "abcd"));
  EXPECT_FALSE(SameToken("", "a"));
}

TEST(GuardRequest, WantsTheToken) {
  EXPECT_EQ(StatusOf(Good("")), 0);
  EXPECT_EQ(StatusOf(Good("state")), 0);
  RequestFacts facts = Good("state");
  for (const std::string path :
       {"/", "/state", "//state", "", "/0123456789abcdef0123456789abcdeF/state",
        "/0123456789abcdef0123456789abcdef", "/0123456789abcdef/state"}) {
    facts.path = path;
    EXPECT_EQ(StatusOf(facts), 403) << path;
  }
  RequestRules rules;
  facts.path = "//state";
  EXPECT_EQ(GuardRequest(facts, rules).status, 403) << "no token is no key";
}

TEST(GuardRequest, RefusesOtherHosts) {
  RequestFacts facts = Good("state");
  for (const std::string host :
       {"127.0.0.1", "localhost", "localhost:1", "[::1]:8080", "[::1]"}) {
    facts.host = host;
    EXPECT_EQ(StatusOf(facts), 0) << host;
  }
  for (const std::string host :
       {"", "evil.example", "evil.example:8080", "127.0.0.1.evil.example",
        "localhost.evil.example:80", "127.0.0.1:80:80", "127.0.0.1:x",
        "192.168.0.7:8080", "127.0.0.1:", "user@127.0.0.1"}) {
    facts.host = host;
    EXPECT_EQ(StatusOf(facts), 403) << host;
  }
}

TEST(GuardRequest, RefusesOtherOrigins) {
  RequestFacts facts = Good("state");
  facts.origin = "http://127.0.0.1:8080";
  EXPECT_EQ(StatusOf(facts), 0);
  for (const std::string origin :
       {"null", "http://evil.example", "https://127.0.0.1:8080",
        "http://127.0.0.1:8081", "http://localhost:8080"}) {
    facts.origin = origin;
    EXPECT_EQ(StatusOf(facts), 403) << origin;
  }
}

TEST(GuardRequest, LimitsBodies) {
  RequestFacts facts = Good(kUploadPath);
  facts.method = "POST";
  EXPECT_EQ(StatusOf(facts), 411);
  facts.content_length = "200000000";
  EXPECT_EQ(StatusOf(facts), 0);
  facts.content_length = "200000001";
  EXPECT_EQ(StatusOf(facts), 413);
  EXPECT_NE(GuardRequest(facts, Rules()).message.find("200 MB"),
            std::string::npos);
  for (const std::string length :
       {"-1", "x", "99999999999999999999999999", "1 2"}) {
    facts.content_length = length;
    EXPECT_EQ(StatusOf(facts), 411) << length;
  }
  facts = Good("answers");
  facts.method = "POST";
  facts.content_length = "2000000";
  EXPECT_EQ(StatusOf(facts), 413) << "the larger limit is that of uploads";
  facts.content_length = "20";
  EXPECT_EQ(StatusOf(facts), 0);
  facts.method = "PUT";
  EXPECT_EQ(StatusOf(facts), 405);
}

TEST(SafeFileName, KeepsTheLastPart) {
  EXPECT_EQ(SafeFileName("before.csv"), "before.csv");
  EXPECT_EQ(SafeFileName("../../etc/passwd"), "passwd");
  EXPECT_EQ(SafeFileName("C:\\logs\\a b.csv"), "a b.csv");
  EXPECT_EQ(SafeFileName("/"), "file");
  EXPECT_EQ(SafeFileName(""), "file");
  EXPECT_EQ(SafeFileName(".."), "file");
  EXPECT_EQ(SafeFileName("..."), "file");
  EXPECT_EQ(SafeFileName(".bashrc"), "bashrc");
  EXPECT_EQ(SafeFileName(std::string("a\0b\n\x7f.csv", 9)), "ab.csv");
  EXPECT_EQ(SafeFileName("a,b.csv"), "a_b.csv");
  EXPECT_EQ(SafeFileName("<img src=x onerror=alert(1)>.csv"),
            "<img src=x onerror=alert(1)>.csv")
      << "the page shows it as text";
  EXPECT_EQ(SafeFileName("stra\xC3\x9F"
                         "e.csv"),
            "stra\xC3\x9F"
            "e.csv");
  EXPECT_EQ(SafeFileName("stra\xDF"
                         "e.csv"),
            "stra_e.csv");
}

TEST(SafeFileName, ShortensButKeepsTheFormat) {
  for (const std::string letter : {"a", "\xC3\xA4", "\xE2\x82\xAC"}) {
    std::string name;
    for (int i = 0; i < 300; ++i) name += letter;
    const std::string safe = SafeFileName(name + ".csv");
    EXPECT_LE(safe.size(), 120u);
    EXPECT_GE(safe.size(), 100u);
    EXPECT_EQ(safe.substr(safe.size() - 4), ".csv");
    EXPECT_EQ(FirstInvalidUtf8(safe), std::string::npos);
  }
}

}  // namespace
}  // namespace pinode
