// For tests only, hence not installed. Counts every call of the C allocation
// functions in the program; Eigen, operator new and the standard library all
// use them. This header defines those functions, so exactly one source of a
// test program includes it. With sanitizers, which have their own functions,
// nothing is counted.

#ifndef TESTS_SUPPORT_ALLOCATION_TESTING_H_
#define TESTS_SUPPORT_ALLOCATION_TESTING_H_

#include <cstddef>

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
#define PINODE_SANITIZED 1
#elif defined(__has_feature)
#if __has_feature(address_sanitizer) || __has_feature(thread_sanitizer)
#define PINODE_SANITIZED 1
#endif
#endif
#if defined(__GLIBC__) && !defined(PINODE_SANITIZED)
#define PINODE_COUNTS_ALLOCATIONS 1
#endif

namespace pinode {
namespace testing {

#ifdef PINODE_COUNTS_ALLOCATIONS
constexpr bool kCountsAllocations = true;
#else
constexpr bool kCountsAllocations = false;
#endif

// volatile: compilers may take malloc() to change no variable of the program.
inline volatile std::size_t allocation_count = 0;

}  // namespace testing
}  // namespace pinode

#ifdef PINODE_COUNTS_ALLOCATIONS
extern "C" {
void* __libc_malloc(std::size_t size);
void* __libc_calloc(std::size_t count, std::size_t size);
void* __libc_realloc(void* block, std::size_t size);
void* __libc_memalign(std::size_t alignment, std::size_t size);

void* malloc(std::size_t size) {
  ++pinode::testing::allocation_count;
  return __libc_malloc(size);
}
void* calloc(std::size_t count, std::size_t size) {
  ++pinode::testing::allocation_count;
  return __libc_calloc(count, size);
}
void* realloc(void* block, std::size_t size) {
  ++pinode::testing::allocation_count;
  return __libc_realloc(block, size);
}
void* aligned_alloc(std::size_t alignment, std::size_t size) {
  ++pinode::testing::allocation_count;
  return __libc_memalign(alignment, size);
}
}  // extern "C"
#endif

#endif  // TESTS_SUPPORT_ALLOCATION_TESTING_H_
