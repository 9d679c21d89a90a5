#include "pinode/base/fnv.h"

#include "gtest/gtest.h"

namespace pinode {
namespace {

// The authors' own test vectors.
TEST(Fnv1aTest, IsThatOfItsAuthors) {
  EXPECT_EQ(Fnv1a("", 0), 0xcbf29ce484222325u);
  EXPECT_EQ(Fnv1a("a", 1), 0xaf63dc4c8601ec8cu);
  EXPECT_EQ(Fnv1a("foobar", 6), 0x85944171f73967e8u);
  EXPECT_EQ(Fnv1a("bar", 3, Fnv1a("foo", 3)), Fnv1a("foobar", 6));
}

}  // namespace
}  // namespace pinode
