// Run by mpirun with several ranks, each of which runs all tests. A number as
// the argument: so many numbers are sent at a time.

#include "pinode/mpi/mpi_communicator.h"

#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <string>
#include <vector>

namespace pinode {
namespace {

MpiCommunicator* ranks = nullptr;

TEST(MpiCommunicator, SumsTheSameBitsOnEveryRank) {
  const int size = ranks->size();
  Vector values(100000);
  for (int i = 0; i < values.size(); ++i) {
    values[i] = std::sin(1.0 + i + 0.1 * ranks->rank());
  }
  ASSERT_TRUE(ranks->Sum(&values));
  for (int i = 0; i < values.size(); i += 997) {
    double expected = 0.0;
    for (int r = 0; r < size; ++r) expected += std::sin(1.0 + i + 0.1 * r);
    EXPECT_NEAR(values[i], expected, 1e-12);
  }
  Vector of_first = values;
  ASSERT_TRUE(ranks->Broadcast(0, &of_first));
  EXPECT_EQ(values, of_first);
}

TEST(MpiCommunicator, BroadcastsWhatEachRankHas) {
  for (int root = 0; root < ranks->size(); ++root) {
    const bool is_root = root == ranks->rank();
    std::string text = is_root ? "of " + std::to_string(root) : "";
    ASSERT_TRUE(ranks->Broadcast(root, &text));
    EXPECT_EQ(text, "of " + std::to_string(root));
    Vector values = is_root ? Vector(Vector::LinSpaced(root, 0, 1)) : Vector();
    ASSERT_TRUE(ranks->Broadcast(root, &values));
    EXPECT_EQ(values.size(), root);
  }
}

TEST(MpiCommunicator, GathersDifferentNumbersOfNumbers) {
  std::vector<int64_t> sizes;
  int64_t total = 0;
  int64_t own = 0;
  for (int r = 0; r < ranks->size(); ++r) {
    if (r == ranks->rank()) own = total;
    sizes.push_back(1000 * r);
    total += sizes.back();
  }
  Vector all = Vector::Constant(total, -1.0);
  all.segment(own, 1000 * ranks->rank()).setConstant(ranks->rank());
  ASSERT_TRUE(ranks->Gather(sizes, all.data()));
  for (int64_t at = 0, r = 0; r < ranks->size(); at += 1000 * r, ++r) {
    EXPECT_TRUE(
        (all.segment(at, 1000 * r).array() == static_cast<double>(r)).all());
  }
}

TEST(MpiCommunicator, OneDissenterIsEnough) {
  EXPECT_TRUE(ranks->AllTrue(true));
  EXPECT_EQ(ranks->AllTrue(ranks->rank() != 0), false);
  EXPECT_EQ(ranks->AllTrue(ranks->rank() + 1 != ranks->size()), false);
}

}  // namespace
}  // namespace pinode

int main(int argc, char** argv) {
  testing::InitGoogleTest(&argc, argv);
  std::string error;
  pinode::MpiCommunicator::Options options;
  if (argc > 1) options.most_at_once = std::stoll(argv[1]);
  const std::unique_ptr<pinode::MpiCommunicator> owned =
      pinode::MpiCommunicator::Begin(options, &error);
  if (owned == nullptr) {
    std::fprintf(stderr, "%s\n", error.c_str());
    return 1;
  }
  pinode::ranks = owned.get();
  return RUN_ALL_TESTS();
}
