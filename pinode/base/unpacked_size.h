// Limit of what a small file may become in memory.

#ifndef PINODE_BASE_UNPACKED_SIZE_H_
#define PINODE_BASE_UNPACKED_SIZE_H_

#include <string>

namespace pinode {

// Bytes that the content of any file may take in memory, however small the file
// is. 2e9 unless set. Set it before threads start.
double LargestUnpackedBytes();
void SetLargestUnpackedBytes(double bytes);

// Counts what is taken from one file. Compressed files and those with holes can
// announce a thousand times their size, and a machine that takes them at their
// word ends the program. LargestUnpackedBytes() is always granted, and
// kLargestExpansion times the file.
class UnpackedSize {
 public:
  // Measured files of loggers, compressed by zlib, unpack to 2 to 11 times
  // their size.
  static constexpr double kLargestExpansion = 16.0;

  explicit UnpackedSize(double file_bytes);

  // Largest number of bytes that are granted in all.
  double largest() const { return largest_; }

  // Counts `bytes` more. Returns false, with the end of a sentence in *what, if
  // they are too many.
  [[nodiscard]] bool Take(double bytes, std::string* what);

 private:
  const double largest_;
  double taken_ = 0.0;
};

}  // namespace pinode

#endif  // PINODE_BASE_UNPACKED_SIZE_H_
