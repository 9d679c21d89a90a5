#include "pinode/problem/verdict.h"

#include <gtest/gtest.h>

#include <vector>

namespace pinode {
namespace {

TEST(Verdict, IsNotUsableBeforeItIsMade) {
  const Verdict verdict;
  EXPECT_EQ(verdict.grade(), Grade::kNotUsable);
  EXPECT_FALSE(verdict.usable());
  ASSERT_EQ(verdict.findings().size(), 1u);
  EXPECT_EQ(verdict.findings()[0].check, "not_judged");
}

TEST(Verdict, IsTheBestGradeThatAllFindingsAllow) {
  const Verdict good(std::vector<Finding>{});
  EXPECT_EQ(good.grade(), Grade::kGood);
  EXPECT_TRUE(good.usable());
  Finding harmless{"a", "something"};
  harmless.grade = Grade::kGood;
  EXPECT_TRUE(Verdict(std::vector<Finding>{harmless}).usable());
  EXPECT_FALSE(Verdict(std::vector<Finding>{harmless, {"b", "worse"}, harmless})
                   .usable());
}

TEST(Finding, IsASentenceWithItsAdvice) {
  Finding finding{"a", "something is wrong"};
  EXPECT_EQ(finding.Sentence(), "something is wrong");
  finding.advice = "mend it";
  EXPECT_EQ(finding.Sentence(), "something is wrong; mend it");
}

}  // namespace
}  // namespace pinode
