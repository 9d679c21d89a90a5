// The hot functions allocate nothing once their workspace exists.

#include <cstddef>
#include <vector>

#include "gtest/gtest.h"
#include "pinode/network/activation.h"
#include "pinode/network/network.h"
#include "tests/support/allocation_testing.h"

namespace pinode {
namespace {

class AllocationTest : public ::testing::Test {
 protected:
  void SetUp() override {
    if (!testing::kCountsAllocations) {
      GTEST_SKIP() << "Allocations are counted with glibc, without sanitizers.";
    }
  }
};

TEST_F(AllocationTest, IsCounted) {
  const std::size_t before = testing::allocation_count;
  const Matrix matrix = Matrix::Random(20, 20);
  EXPECT_GT(testing::allocation_count, before);
  const std::size_t between = testing::allocation_count;
  std::vector<int> numbers(100, static_cast<int>(matrix.size()));
  // Compilers may leave out memory that nobody sees.
  int* volatile seen = numbers.data();
  EXPECT_EQ(*seen, 400);
  EXPECT_GT(testing::allocation_count, between);
  EXPECT_EQ(numbers.back(), 400);
}

TEST_F(AllocationTest, HotFunctionsAllocateNothing) {
  for (const std::vector<int>& hidden_widths :
       std::vector<std::vector<int>>{{}, {30}, {40, 25}, {300, 7, 150}}) {
    for (const bool gauge : {false, true}) {
      if (gauge && hidden_widths.empty()) continue;
      NetworkArchitecture architecture;
      architecture.num_inputs = 8;
      architecture.num_outputs = 4;
      architecture.hidden_widths = hidden_widths;
      architecture.gauge = gauge;
      architecture.skip = !gauge;
      for (const Activation activation :
           {Activation::kTanh, Activation::kSigmoid, Activation::kRelu,
            Activation::kLeakyRelu, Activation::kSoftplus, Activation::kSine,
            Activation::kIdentity}) {
        architecture.activation = activation;
        const Network network(architecture);
        const Vector weights = Vector::Random(network.num_weights());
        const Vector q = Vector::Random(8);
        Vector y(4);
        NetworkWorkspace workspace(network, 24, 4);
        const std::vector<Matrix> lefts(4, Matrix::Random(24, 4));
        std::vector<NetworkTangent> tangents(4, NetworkTangent(network));
        Matrix B = Matrix::Zero(24, network.num_weights());

        const std::size_t before = testing::allocation_count;
        network.Evaluate(q.data(), weights.data(), y.data(), &workspace);
        const NetworkTangent* stages[4];
        const Matrix* left_pointers[4];
        for (int s = 0; s < 4; ++s) {
          network.Linearize(q.data(), weights.data(), &tangents[s]);
          network.AddWeightTangent(tangents[s], lefts[s], &workspace, B.data());
          stages[s] = &tangents[s];
          left_pointers[s] = &lefts[s];
        }
        network.AddWeightTangents(stages, left_pointers, 4, &workspace,
                                  B.data());
        const std::size_t after = testing::allocation_count;
        EXPECT_EQ(after, before)
            << ActivationName(activation) << ", " << hidden_widths.size()
            << " hidden layers, gauge " << gauge;
        // Use the results, so that the compiler keeps the computation.
        EXPECT_TRUE(B.allFinite() && y.allFinite());
      }
    }
  }
}

}  // namespace
}  // namespace pinode
