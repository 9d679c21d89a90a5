// Reads numbers of either byte order from memory, within its bounds.

#ifndef PINODE_RECORD_FILES_LOGGERS_BYTE_READER_H_
#define PINODE_RECORD_FILES_LOGGERS_BYTE_READER_H_

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <string_view>

namespace pinode {

inline bool HostIsBigEndian() {
  const uint16_t one = 1;
  unsigned char first = 0;
  std::memcpy(&first, &one, 1);
  return first == 0;
}

// Returns the number at `bytes`, which must hold all of it.
template <typename T>
T NumberAt(const char* bytes, bool is_big_endian) {
  std::array<char, sizeof(T)> own;
  std::memcpy(own.data(), bytes, sizeof(T));
  if (is_big_endian != HostIsBigEndian()) {
    std::reverse(own.begin(), own.end());
  }
  T value;
  std::memcpy(&value, own.data(), sizeof(T));
  return value;
}

// A position that moves through bytes. A read past the end gives zero, and ok()
// is false from then on.
class ByteReader {
 public:
  explicit ByteReader(std::string_view bytes, bool is_big_endian = false)
      : bytes_(bytes), is_big_endian_(is_big_endian) {}

  bool ok() const { return ok_; }
  bool is_big_endian() const { return is_big_endian_; }
  size_t position() const { return position_; }
  size_t left() const { return bytes_.size() - position_; }

  template <typename T>
  T Read() {
    const std::string_view bytes = Bytes(sizeof(T));
    return ok_ ? NumberAt<T>(bytes.data(), is_big_endian_) : T{};
  }

  std::string_view Bytes(uint64_t count) {
    if (!ok_ || count > left()) {
      ok_ = false;
      return {};
    }
    const std::string_view bytes =
        bytes_.substr(position_, static_cast<size_t>(count));
    position_ += static_cast<size_t>(count);
    return bytes;
  }

 private:
  std::string_view bytes_;
  bool is_big_endian_;
  size_t position_ = 0;
  bool ok_ = true;
};

}  // namespace pinode

#endif  // PINODE_RECORD_FILES_LOGGERS_BYTE_READER_H_
