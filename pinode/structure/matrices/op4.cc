#include "pinode/structure/matrices/op4.h"

#include <utility>

#include "pinode/base/file.h"
#include "pinode/base/logging.h"
#include "pinode/base/strings.h"
#include "pinode/structure/matrices/op4_ascii.h"
#include "pinode/structure/matrices/op4_binary.h"

namespace pinode {

bool ReadOp4Content(const std::string& path, const std::string& content,
                    MatrixContainer* container, std::string* error) {
  CHECK(container != nullptr);
  CHECK(error != nullptr);
  MatrixContainer result;
  if (IsOp4Binary(content)) {
    if (!ReadOp4Binary(path, content, &result, error)) return false;
    *container = std::move(result);
    return true;
  }
  const size_t bad = FirstInvalidUtf8(content);
  if (bad != std::string::npos) {
    *error = path + ": byte " + std::to_string(bad) +
             " is not text, and the file does not begin with a record of 24 or "
             "48 bytes. Give an OP4 file, ASCII or binary";
    return false;
  }
  if (!ReadOp4Ascii(path, content, &result, error)) return false;
  if (result.matrices.empty()) {
    *error = path + ":1: the file is empty, expected a matrix";
    return false;
  }
  *container = std::move(result);
  return true;
}

bool ReadOp4(const std::string& path, MatrixContainer* container,
             std::string* error) {
  CHECK(error != nullptr);
  std::string content;
  return ReadBinaryFile(path, &content, error) &&
         ReadOp4Content(path, content, container, error);
}

}  // namespace pinode
