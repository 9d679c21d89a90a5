// Unpacks compressed data as a whole.

#ifndef PINODE_BASE_COMPRESSION_H_
#define PINODE_BASE_COMPRESSION_H_

#include <cstddef>
#include <string>
#include <string_view>

namespace pinode {

enum class CompressedFormat {
  kZlib,  // RFC 1950
  kGzip,  // RFC 1952; several members in a row are one content, as gzip has it
};

// Unpacks all of `packed` into *unpacked. Fails with a clause in *what, and
// leaves *unpacked unchanged, if the data are damaged, cut off or followed by
// other data. Also fails if the result would be larger than `largest` bytes: a
// small file can announce any size.
[[nodiscard]] bool Unpack(CompressedFormat format, std::string_view packed,
                          size_t largest, std::string* unpacked,
                          std::string* what);

}  // namespace pinode

#endif  // PINODE_BASE_COMPRESSION_H_
