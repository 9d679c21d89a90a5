// The hot functions allocate nothing once their workspace exists.
//
// Counts every call of the C allocation functions in this program: Eigen,
// operator new and the standard library all end there. The sanitizers bring
// their own functions, so that the test is skipped under them.

#include <cstddef>
#include <vector>

#include "gtest/gtest.h"
#include "pinode/network/network.h"

#if defined(__GLIBC__) && !defined(__SANITIZE_ADDRESS__) && \
    !defined(__SANITIZE_THREAD__)
#define PINODE_COUNTS_ALLOCATIONS 1
#endif

namespace {
std::size_t allocation_count = 0;
}  // namespace

#ifdef PINODE_COUNTS_ALLOCATIONS
extern "C" {
void* __libc_malloc(std::size_t size);
void* __libc_calloc(std::size_t count, std::size_t size);
void* __libc_realloc(void* block, std::size_t size);
void* __libc_memalign(std::size_t alignment, std::size_t size);

void* malloc(std::size_t size) {
  ++allocation_count;
  return __libc_malloc(size);
}
void* calloc(std::size_t count, std::size_t size) {
  ++allocation_count;
  return __libc_calloc(count, size);
}
void* realloc(void* block, std::size_t size) {
  ++allocation_count;
  return __libc_realloc(block, size);
}
void* aligned_alloc(std::size_t alignment, std::size_t size) {
  ++allocation_count;
  return __libc_memalign(alignment, size);
}
}  // extern "C"
#endif

namespace pinode {
namespace {

class AllocationTest : public testing::Test {
 protected:
  void SetUp() override {
#ifndef PINODE_COUNTS_ALLOCATIONS
    GTEST_SKIP() << "Allocations are counted with glibc, without sanitizers.";
#endif
  }
};

TEST_F(AllocationTest, IsCounted) {
  const std::size_t before = allocation_count;
  const Matrix matrix = Matrix::Random(20, 20);
  EXPECT_GT(allocation_count, before);
  const std::size_t between = allocation_count;
  const std::vector<int> numbers(100, static_cast<int>(matrix.size()));
  EXPECT_GT(allocation_count, between);
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

        const std::size_t before = allocation_count;
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
        const std::size_t after = allocation_count;
        EXPECT_EQ(after, before)
            << ActivationName(activation) << ", " << hidden_widths.size()
            << " hidden layers, gauge " << gauge;
        // What has been computed is used.
        EXPECT_TRUE(B.allFinite() && y.allFinite());
      }
    }
  }
}

}  // namespace
}  // namespace pinode
