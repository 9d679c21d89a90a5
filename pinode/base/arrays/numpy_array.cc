#include "pinode/base/arrays/numpy_array.h"

#include <algorithm>
#include <cstring>
#include <string_view>
#include <utility>

#include "pinode/base/file_text.h"
#include "pinode/base/strings.h"

namespace pinode {
namespace {

template <typename T>
T ItemAt(const NumpyArray& array, int64_t index) {
  char raw[sizeof(T)];
  std::memcpy(raw, array.data.data() + static_cast<size_t>(index) * sizeof(T),
              sizeof(T));
  if (array.swapped) std::reverse(raw, raw + sizeof(T));
  T value;
  std::memcpy(&value, raw, sizeof(T));
  return value;
}

void AppendUtf8(uint32_t code, std::string* text) {
  const auto byte = [text](uint32_t value) {
    text->push_back(static_cast<char>(value));
  };
  if (code < 0x80) {
    byte(code);
  } else if (code < 0x800) {
    byte(0xC0 | (code >> 6));
    byte(0x80 | (code & 0x3F));
  } else if (code < 0x10000) {
    byte(0xE0 | (code >> 12));
    byte(0x80 | ((code >> 6) & 0x3F));
    byte(0x80 | (code & 0x3F));
  } else {
    byte(0xF0 | (code >> 18));
    byte(0x80 | ((code >> 12) & 0x3F));
    byte(0x80 | ((code >> 6) & 0x3F));
    byte(0x80 | (code & 0x3F));
  }
}

// Returns the text behind `'key':` in the header, empty if there is none. The
// header is a Python dictionary: {'descr': '<f8', 'fortran_order': False,
// 'shape': (3, 3), }.
std::string_view ValueOf(std::string_view header, const std::string& key) {
  size_t at = header.find("'" + key + "'");
  if (at == std::string_view::npos) return {};
  at = header.find(':', at);
  if (at == std::string_view::npos) return {};
  return StripBlanks(header.substr(at + 1));
}

bool ParseType(std::string_view descr, NumpyArray* array) {
  if (descr.size() < 5 || descr[0] != '\'') return false;
  const size_t end = descr.find('\'', 1);
  if (end == std::string_view::npos) return false;
  descr = descr.substr(1, end - 1);
  if (descr.size() < 3) return false;
  const char order = descr[0];
  if (order != '<' && order != '>' && order != '|' && order != '=') {
    return false;
  }
  array->swapped = order == '>';
  array->kind = descr[1];
  int size = 0;
  if (!ParseInt(descr.substr(2), &size) || size < 1 || size > 100000) {
    return false;
  }
  array->item_size = static_cast<size_t>(size);
  switch (array->kind) {
    case 'f':
      return size == 4 || size == 8;
    case 'i':
    case 'u':
      return size == 1 || size == 2 || size == 4 || size == 8;
    case 'b':
      return size == 1;
    case 'S':
      return true;
    case 'U':
      array->item_size *= 4;
      return true;
    default:
      return false;
  }
}

bool ParseShape(std::string_view text, std::vector<int64_t>* shape) {
  if (text.empty() || text[0] != '(') return false;
  const size_t end = text.find(')');
  if (end == std::string_view::npos) return false;
  for (const std::string_view part : Split(text.substr(1, end - 1), ',')) {
    if (part.empty()) continue;  // (3,) and ()
    int length = 0;
    if (!ParseInt(part, &length) || length < 0) return false;
    shape->push_back(length);
  }
  return shape->size() <= 8;
}

// Parses the header, and finds where the data begin.
NumpyArrayKind ParseHeader(const std::string& bytes, NumpyArray* array,
                           size_t* data_begin, std::string* what) {
  constexpr std::string_view kMagic = "\x93NUMPY";
  const std::string_view view = bytes;
  if (view.size() < 10 || view.substr(0, kMagic.size()) != kMagic) {
    *what = "is not a NumPy array, because its first bytes are wrong";
    return NumpyArrayKind::kBroken;
  }
  const auto byte_at = [&view](size_t i) {
    return static_cast<size_t>(static_cast<unsigned char>(view[i]));
  };
  const size_t version = byte_at(6);
  size_t begin = 10;
  size_t length = byte_at(8) + 256 * byte_at(9);
  if (version == 2 || version == 3) {
    if (view.size() < 12) {
      *what = "ends inside its header";
      return NumpyArrayKind::kBroken;
    }
    begin = 12;
    length += 65536 * byte_at(10) + 16777216 * byte_at(11);
  } else if (version != 1) {
    *what =
        "has format version " + std::to_string(version) + ", expected 1 to 3";
    return NumpyArrayKind::kBroken;
  }
  if (length > view.size() - begin) {
    *what = "ends inside its header of " + std::to_string(length) + " bytes";
    return NumpyArrayKind::kBroken;
  }
  const std::string_view header = view.substr(begin, length);
  const std::string_view order = ValueOf(header, "fortran_order");
  if (!ParseType(ValueOf(header, "descr"), array))
    return NumpyArrayKind::kOther;
  if ((order.substr(0, 4) != "True" && order.substr(0, 5) != "False") ||
      !ParseShape(ValueOf(header, "shape"), &array->shape)) {
    *what = "has the header " + Quote(header) +
            ", expected descr, fortran_order and shape";
    return NumpyArrayKind::kBroken;
  }
  array->fortran_order = order[0] == 'T';
  *data_begin = begin + length;
  return NumpyArrayKind::kUsable;
}

}  // namespace

double NumpyArray::NumberAt(int64_t index) const {
  switch (kind) {
    case 'f':
      return item_size == 4 ? ItemAt<float>(*this, index)
                            : ItemAt<double>(*this, index);
    case 'i':
      switch (item_size) {
        case 1:
          return ItemAt<int8_t>(*this, index);
        case 2:
          return ItemAt<int16_t>(*this, index);
        case 4:
          return ItemAt<int32_t>(*this, index);
        default:
          return static_cast<double>(ItemAt<int64_t>(*this, index));
      }
    default:
      switch (item_size) {
        case 1:
          return ItemAt<uint8_t>(*this, index);
        case 2:
          return ItemAt<uint16_t>(*this, index);
        case 4:
          return ItemAt<uint32_t>(*this, index);
        default:
          return static_cast<double>(ItemAt<uint64_t>(*this, index));
      }
  }
}

int64_t NumpyArray::IndexAt(int64_t index) const {
  const double value = NumberAt(index);
  if (!(value >= 0.0 && value <= 1e15)) return -1;
  return static_cast<int64_t>(value);
}

std::string NumpyArray::TextAt(int64_t index) const {
  std::string text;
  if (kind == 'S') {
    text = data.substr(static_cast<size_t>(index) * item_size, item_size);
  } else {
    const int64_t letters = static_cast<int64_t>(item_size) / 4;
    for (int64_t i = 0; i < letters; ++i) {
      const auto code = ItemAt<uint32_t>(*this, index * letters + i);
      if (code > 0x10FFFF) return "";
      if (code == 0) break;
      AppendUtf8(code, &text);
    }
  }
  const size_t end = text.find_last_not_of('\0');
  text.resize(end == std::string::npos ? 0 : end + 1);
  return text;
}

NumpyArrayKind ParseNumpyHeader(const std::string& bytes, NumpyArray* array,
                                std::string* what) {
  size_t data_begin = 0;
  return ParseHeader(bytes, array, &data_begin, what);
}

NumpyArrayKind ParseNumpyArray(std::string bytes, NumpyArray* array,
                               std::string* what) {
  size_t begin = 0;
  const NumpyArrayKind kind = ParseHeader(bytes, array, &begin, what);
  if (kind != NumpyArrayKind::kUsable) return kind;
  const size_t available = bytes.size() - begin;
  // The product may be very large; as a double it does not overflow.
  double expected = static_cast<double>(array->item_size);
  for (const int64_t size : array->shape) expected *= static_cast<double>(size);
  if (expected != static_cast<double>(available)) {
    *what = "has " + std::to_string(available) + " bytes of data, expected " +
            FormatNumber(expected, 15) + " by its header";
    return NumpyArrayKind::kBroken;
  }
  bytes.erase(0, begin);
  array->data = std::move(bytes);
  return NumpyArrayKind::kUsable;
}

}  // namespace pinode
