#include "pinode/base/arrays/mat5_structure.h"

#include <cstdint>
#include <cstring>
#include <string_view>
#include <vector>

#include "pinode/base/compression.h"

namespace pinode {
namespace {

constexpr size_t kHeaderSize = 128;
constexpr uint32_t kInt8 = 1;
constexpr uint32_t kInt32 = 5;
constexpr uint32_t kUint32 = 6;
constexpr uint32_t kMatrix = 14;
constexpr uint32_t kCompressed = 15;
constexpr size_t kLargestMat5Element = size_t{4} << 30;
// Deepest level of cells in cells. Deeper ones are not matrices of a structure.
constexpr int kDeepest = 8;

constexpr uint32_t kClassCell = 1;
constexpr uint32_t kClassStruct = 2;
constexpr uint32_t kClassObject = 3;
constexpr uint32_t kClassText = 4;
constexpr uint32_t kClassSparse = 5;
constexpr uint32_t kClassDouble = 6;
constexpr uint32_t kClassUint64 = 15;
constexpr uint32_t kClassFunction = 16;
constexpr uint32_t kComplexFlag = 0x800;

// Returns the bytes of a number of each type of data, or 0 for another type.
size_t TypeSize(uint32_t type) {
  static constexpr size_t kSizes[] = {0, 1, 1, 2, 2, 4, 4, 4, 0, 8,
                                      0, 0, 8, 8, 0, 0, 1, 2, 4};
  return type < sizeof(kSizes) / sizeof(kSizes[0]) ? kSizes[type] : 0;
}

struct Element {
  uint32_t type = 0;
  std::string_view data;
};

class Walker {
 public:
  Walker(bool swapped, std::string* what) : swapped_(swapped), what_(what) {}

  bool WalkFile(std::string_view rest) {
    while (!rest.empty()) {
      Element element;
      if (!Next(&rest, /*padded=*/false, &element)) return false;
      if (element.type == kCompressed) {
        std::string unpacked;
        std::string what;
        if (!Unpack(CompressedFormat::kZlib, element.data, kLargestMat5Element,
                    &unpacked, &what)) {
          return Fail("a compressed element is broken");
        }
        std::string_view inner = unpacked;
        Element matrix;
        if (!Next(&inner, /*padded=*/false, &matrix)) return false;
        if (matrix.type != kMatrix || !inner.empty()) {
          return Fail("a compressed element holds no single variable");
        }
        if (!WalkVariable(matrix)) return false;
      } else if (!WalkVariable(element)) {
        return false;
      }
    }
    return true;
  }

 private:
  bool Fail(const char* message) {
    *what_ = message;
    return false;
  }

  uint32_t WordAt(std::string_view data, size_t offset) const {
    uint32_t word = 0;
    std::memcpy(&word, data.data() + offset, sizeof(word));
    return swapped_ ? __builtin_bswap32(word) : word;
  }

  // Takes the next element from *rest: a tag of type and length, or both in one
  // word followed by up to four bytes. `padded`: the element is padded to eight
  // bytes.
  bool Next(std::string_view* rest, bool padded, Element* element) {
    if (rest->size() < 8) return Fail("the file ends inside an element's tag");
    const uint32_t first = WordAt(*rest, 0);
    if (first >> 16 != 0) {
      const size_t length = first >> 16;
      if (length > 4) return Fail("an element of at most 4 bytes has more");
      element->type = first & 0xFFFF;
      element->data = rest->substr(4, length);
      rest->remove_prefix(8);
      return true;
    }
    const size_t length = WordAt(*rest, 4);
    const size_t taken = padded ? (length + 7) / 8 * 8 : length;
    if (taken > rest->size() - 8) {
      return Fail("an element is longer than the rest of the file");
    }
    element->type = first;
    element->data = rest->substr(8, length);
    rest->remove_prefix(8 + taken);
    return true;
  }

  bool WalkVariable(const Element& element) {
    if (element.type != kMatrix || element.data.empty()) {
      return Fail("an element is not a variable");
    }
    return WalkMatrix(element.data, 0);
  }

  // The parts of a variable: flags, dimensions, name, data.
  bool WalkMatrix(std::string_view rest, int depth) {
    if (rest.empty()) return true;  // an empty cell
    std::vector<Element> parts;
    while (!rest.empty()) {
      Element part;
      if (!Next(&rest, /*padded=*/true, &part)) return false;
      if (part.type == kMatrix && depth < kDeepest &&
          !WalkMatrix(part.data, depth + 1)) {
        return false;
      }
      parts.push_back(part);
    }
    // A reader would skip a part of another type and take its content for the
    // next tag.
    if (parts.size() < 3 || parts[0].data.size() != 8 ||
        parts[0].type != kUint32 || parts[1].type != kInt32 ||
        parts[2].type != kInt8) {
      return Fail("a variable lacks its flags, dimensions or name");
    }
    const uint32_t flags = WordAt(parts[0].data, 0);
    const uint32_t kind = flags & 0xFF;
    if (kind > kClassFunction) {
      return Fail(
          "a variable is an object of MATLAB (string, table); save matrices "
          "and cell arrays of characters");
    }
    if (parts[1].data.size() % 4 != 0) {
      return Fail("a variable lacks its flags, dimensions or name");
    }
    const size_t numeric_parts = (flags & kComplexFlag) != 0 ? 2 : 1;
    // Announced number of items, as a double, which cannot overflow.
    double count = 1.0;
    for (size_t at = 0; at < parts[1].data.size(); at += 4) {
      count *= WordAt(parts[1].data, at);
    }
    if (kind == kClassSparse) {
      bool whole = parts.size() == 5 + numeric_parts;
      for (size_t i = 3; whole && i < 5; ++i) {
        whole = (parts[i].type == kInt32 || parts[i].type == kUint32) &&
                parts[i].data.size() % 4 == 0;
      }
      for (size_t i = 5; whole && i < parts.size(); ++i) {
        whole = TypeSize(parts[i].type) > 0;
      }
      return whole || Fail("a sparse matrix lacks its indices or numbers");
    }
    if (kind < kClassDouble || kind > kClassUint64) {
      return IsContainerWhole(kind, count, parts) ||
             Fail(
                 "a variable has another number of parts than its dimensions "
                 "say");
    }
    if (parts.size() != 3 + numeric_parts) {
      return Fail("an array lacks its numbers");
    }
    for (size_t i = 3; i < parts.size(); ++i) {
      const size_t size = TypeSize(parts[i].type);
      if (size == 0 || static_cast<double>(parts[i].data.size()) !=
                           count * static_cast<double>(size)) {
        return Fail(
            "an array has another number of values than its dimensions say");
      }
    }
    return true;
  }

  // Returns true if there are cells, fields and letters for all announced
  // dimensions. A reader then allocates no more of them than the file has.
  bool IsContainerWhole(uint32_t kind, double count,
                        const std::vector<Element>& parts) const {
    if (kind == kClassText) {
      return count == 0.0 ||
             (parts.size() == 4 && TypeSize(parts[3].type) > 0 &&
              count <= static_cast<double>(parts[3].data.size()));
    }
    size_t fixed = 3;
    double fields = 1.0;
    if (kind == kClassStruct || kind == kClassObject) {
      // Behind the name: an object's class, the length of a field's name, the
      // names.
      fixed = kind == kClassStruct ? 5 : 6;
      if (parts.size() < fixed || parts[fixed - 2].data.size() != 4 ||
          parts[fixed - 2].type != kInt32 || parts[fixed - 1].type != kInt8) {
        return false;
      }
      const uint32_t length = WordAt(parts[fixed - 2].data, 0);
      if (length == 0) return false;
      const size_t num_fields = parts[fixed - 1].data.size() / length;
      fields = static_cast<double>(num_fields);
    } else if (kind != kClassCell) {
      return count <= 1.0;
    }
    return count * fields <= static_cast<double>(parts.size() - fixed);
  }

  const bool swapped_;
  std::string* const what_;
};

}  // namespace

bool IsMat5(const std::string& content) {
  if (content.size() < kHeaderSize) return false;
  // The version (1.0) and "MI", in the byte order of the file.
  const std::string_view end =
      std::string_view(content).substr(kHeaderSize - 4, 4);
  return end == std::string_view("\x00\x01IM", 4) ||
         end == std::string_view("\x01\x00MI", 4);
}

bool IsWholeMat5(const std::string& content, std::string* what) {
  if (!IsMat5(content)) {
    *what = "the file does not begin as MATLAB's version 5 does";
    return false;
  }
  const bool big = content[kHeaderSize - 2] == 'M';
  const uint16_t one = 1;
  unsigned char first_byte = 0;
  std::memcpy(&first_byte, &one, 1);
  const bool host_is_big = first_byte == 0;
  Walker walker(big != host_is_big, what);
  return walker.WalkFile(std::string_view(content).substr(kHeaderSize));
}

}  // namespace pinode
