#include "pinode/watch/notify.h"

#include <memory>
#include <string>
#include <vector>

#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "pinode/watch/courier.h"
#include "tests/support/temporary_folder_testing.h"

namespace pinode {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

class NotifyTest : public ::testing::Test {
 protected:
  void SetUp() override {
    ASSERT_TRUE(Store::Open(folder_.Path("w.db"), Store::Access::kReadAndWrite,
                            &store_, &error_));
    ASSERT_TRUE(store_->OpenStructure("bridge", "", &id_, &error_));
    structure_.name = "bridge";
    couriers_.webhook = [this](const WatchMessage& message,
                               std::string* error) {
      *error = "no network";
      if (has_network_) posted_.push_back(message.text);
      return has_network_;
    };
    couriers_.mail = [this](const WatchMessage& message, std::string*) {
      mailed_.push_back(message.text);
      return true;
    };
  }
  void Set(const std::vector<StoredEvent>& events) {
    ASSERT_TRUE(store_->SetEvents(id_, events, {}, &error_)) << error_;
  }
  bool Send() {
    return SendNewEvents(structure_, id_, couriers_, store_.get(), &error_);
  }

  TemporaryFolder folder_;
  std::string error_;
  std::unique_ptr<Store> store_;
  int64_t id_ = 0;
  WatchedStructure structure_;
  Couriers couriers_;
  bool has_network_ = true;
  std::vector<std::string> posted_, mailed_;
};

const StoredEvent kAlarm = {1e9, "alarm", "mode 2 fell"};
const StoredEvent kNotice = {1.1e9, "notice", "mode 3 rose"};
const StoredEvent kClear = {1.2e9, "all-clear", "for 7 days"};

TEST_F(NotifyTest, EachEventIsToldOnce) {
  EXPECT_TRUE(Send());
  EXPECT_TRUE(posted_.empty());
  Set({kAlarm, kNotice});
  EXPECT_TRUE(Send());
  EXPECT_TRUE(Send());
  ASSERT_EQ(posted_.size(), 1u);
  EXPECT_THAT(posted_[0], HasSubstr("mode 2"));
  EXPECT_THAT(posted_[0], Not(HasSubstr("mode 3")));
  // Another process, and a later analysis that words the alarm differently.
  store_.reset();
  ASSERT_TRUE(Store::Open(folder_.Path("w.db"), Store::Access::kReadAndWrite,
                          &store_, &error_));
  Set({{kAlarm.time, kAlarm.kind, "mode 2 fell by 3 %"}, kNotice, kClear});
  EXPECT_TRUE(Send());
  ASSERT_EQ(posted_.size(), 2u);
  EXPECT_THAT(posted_[1], HasSubstr("for 7 days"));
  EXPECT_THAT(posted_[1], Not(HasSubstr("mode 2")));
  EXPECT_EQ(mailed_, posted_);
}

TEST_F(NotifyTest, WhatIsNotTakenIsTriedAgain) {
  Set({kAlarm});
  has_network_ = false;
  EXPECT_FALSE(Send());
  EXPECT_EQ(error_, "no network");
  EXPECT_EQ(mailed_.size(), 1u);
  Set({kAlarm, kClear});
  has_network_ = true;
  EXPECT_TRUE(Send());
  ASSERT_EQ(posted_.size(), 1u);
  EXPECT_THAT(posted_[0], HasSubstr("mode 2"));
  EXPECT_THAT(posted_[0], HasSubstr("for 7 days"));
  ASSERT_EQ(mailed_.size(), 2u);
  EXPECT_THAT(mailed_[1], Not(HasSubstr("mode 2")));
}

TEST_F(NotifyTest, NoticesAreToldOnRequest) {
  structure_.notify.kinds = {"notice"};
  Set({kAlarm, kNotice});
  EXPECT_TRUE(Send());
  ASSERT_EQ(posted_.size(), 1u);
  EXPECT_THAT(posted_[0], Not(HasSubstr("mode 2")));
}

// Port 1 of this machine: it has no listener. Secrets of the address stay out
// of messages.
TEST(Courier, SaysWhereNothingWasTaken) {
  std::string error;
  EXPECT_FALSE(PostToWebhook("http://user:secret@127.0.0.1:1/token?key=secret",
                             "{}", &error));
  EXPECT_THAT(error, HasSubstr("no message could be sent to 127.0.0.1:1: "));
  EXPECT_THAT(error, Not(HasSubstr("secret")));
  EXPECT_FALSE(PostToWebhook("file:///etc/passwd", "{}", &error));
  NotifyOptions options;
  options.mail = "smtp://127.0.0.1:1";
  options.from = "a@example.org";
  options.to = {"b@example.org"};
  EXPECT_FALSE(SendMail(options, "Subject: x\r\n\r\nx\r\n", &error));
  EXPECT_THAT(error, HasSubstr("127.0.0.1:1"));
}

}  // namespace
}  // namespace pinode
