#include "pinode/base/compression.h"

#include <zlib.h>

#include <algorithm>
#include <limits>
#include <utility>
#include <vector>

#include "pinode/base/logging.h"

namespace pinode {
namespace {

// zlib's code for the format: the largest window, plus 16 for gzip.
int WindowBits(CompressedFormat format) {
  return format == CompressedFormat::kGzip ? 15 + 16 : 15;
}

class Stream {
 public:
  explicit Stream(CompressedFormat format)
      : is_open_(inflateInit2(&stream_, WindowBits(format)) == Z_OK) {}
  ~Stream() {
    if (is_open_) inflateEnd(&stream_);
  }
  Stream(const Stream&) = delete;
  Stream& operator=(const Stream&) = delete;

  bool is_open() const { return is_open_; }
  z_stream* get() { return &stream_; }

 private:
  z_stream stream_ = {};
  bool is_open_;
};

}  // namespace

bool Unpack(CompressedFormat format, std::string_view packed, size_t largest,
            std::string* unpacked, std::string* what) {
  CHECK(unpacked != nullptr);
  CHECK(what != nullptr);
  Stream stream(format);
  if (!stream.is_open()) {
    *what = "zlib cannot start";
    return false;
  }
  z_stream* z = stream.get();
  std::string result;
  std::vector<char> buffer(65536);
  size_t taken = 0;
  int status = Z_OK;
  while (status == Z_OK) {
    const size_t offered = std::min<size_t>(packed.size() - taken,
                                            std::numeric_limits<uInt>::max());
    // zlib does not write to its input.
    z->next_in =
        reinterpret_cast<Bytef*>(const_cast<char*>(packed.data() + taken));
    z->avail_in = static_cast<uInt>(offered);
    z->next_out = reinterpret_cast<Bytef*>(buffer.data());
    z->avail_out = static_cast<uInt>(buffer.size());
    status = inflate(z, Z_NO_FLUSH);
    taken += offered - z->avail_in;
    const size_t made = buffer.size() - z->avail_out;
    if (made > largest - result.size()) {
      *what = "the compressed data hold more than " + std::to_string(largest) +
              " bytes";
      return false;
    }
    result.append(buffer.data(), made);
    if (format == CompressedFormat::kGzip && status == Z_STREAM_END &&
        taken < packed.size()) {
      status = inflateReset(z);
    }
  }
  if (status != Z_STREAM_END || taken != packed.size()) {
    *what = "the compressed data are damaged or cut off";
    return false;
  }
  *unpacked = std::move(result);
  return true;
}

}  // namespace pinode
