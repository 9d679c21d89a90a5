// A hash that distinguishes contents. It does not protect against deliberate
// collisions.

#ifndef PINODE_BASE_FNV_H_
#define PINODE_BASE_FNV_H_

#include <cstddef>
#include <cstdint>

namespace pinode {

inline constexpr std::uint64_t kFnvStart = 0xcbf29ce484222325u;

// Returns the FNV-1a hash, 64 bits (G. Fowler, L. C. Noll, K.-P. Vo), of `size`
// bytes that follow the bytes already hashed in `hash`.
inline std::uint64_t Fnv1a(const void* data, std::size_t size,
                           std::uint64_t hash = kFnvStart) {
  const auto* bytes = static_cast<const unsigned char*>(data);
  for (std::size_t i = 0; i < size; ++i) {
    hash = (hash ^ bytes[i]) * 0x100000001b3u;
  }
  return hash;
}

}  // namespace pinode

#endif  // PINODE_BASE_FNV_H_
