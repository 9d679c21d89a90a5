#include "pinode/base/unpacked_size.h"

#include <algorithm>

#include "pinode/base/strings.h"

namespace pinode {
namespace {

double largest_unpacked_bytes = 2e9;

}  // namespace

double LargestUnpackedBytes() { return largest_unpacked_bytes; }

void SetLargestUnpackedBytes(double bytes) { largest_unpacked_bytes = bytes; }

UnpackedSize::UnpackedSize(double file_bytes)
    : largest_(
          std::max(LargestUnpackedBytes(), kLargestExpansion * file_bytes)) {}

bool UnpackedSize::Take(double bytes, std::string* what) {
  taken_ += bytes;
  if (taken_ <= largest_) return true;
  *what = "takes more than " + FormatNumber(largest_ / 1e9, 3) +
          " GB of memory, which is more than its file is trusted with; if the "
          "file is right, raise --unpacked_gb";
  return false;
}

}  // namespace pinode
