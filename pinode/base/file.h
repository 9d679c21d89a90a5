// Files, read whole and written all or nothing.

#ifndef PINODE_BASE_FILE_H_
#define PINODE_BASE_FILE_H_

#include <functional>
#include <string>

namespace pinode {

// Reads the whole file at `path` into *content, byte for byte. Fails with a
// message in *error if the file is missing, cannot be read or is not a regular
// file. *content is untouched on failure.
[[nodiscard]] bool ReadBinaryFile(const std::string& path, std::string* content,
                                  std::string* error);

// The same for text: fails also if the file is not valid UTF-8 (`path:line:
// ...`, the line of the first bad byte). A file whose name ends in .gz is
// unpacked on the way, up to 4 GiB.
[[nodiscard]] bool ReadTextFile(const std::string& path, std::string* content,
                                std::string* error);

// As ReadTextFile, of any encoding.
[[nodiscard]] bool ReadTextOfAnyEncoding(const std::string& path,
                                         std::string* content,
                                         std::string* error);

// `path` without .gz at its end, by which a reader tells what a compressed file
// holds.
std::string WithoutGz(const std::string& path);

// Writes `content` to `path` so that a reader sees the old file or the whole
// new one, whatever happens in between: a temporary file in the same folder is
// written, flushed to the disk, and renamed over `path`. On failure the
// temporary file is removed, an existing file at `path` is untouched, and
// *error says what went wrong.
[[nodiscard]] bool WriteFileAtomically(const std::string& path,
                                       const std::string& content,
                                       std::string* error);

// The same for what is not to be held as a whole: `next` is called until it
// leaves its chunk, which is empty before, empty.
[[nodiscard]] bool WriteFileAtomically(
    const std::string& path, const std::function<void(std::string*)>& next,
    std::string* error);

// Offset of the first byte of `text` that is not part of a valid UTF-8
// sequence (RFC 3629: no overlong forms, no surrogates, at most U+10FFFF), or
// std::string::npos if all of it is valid.
size_t FirstInvalidUtf8(const std::string& text);

}  // namespace pinode

#endif  // PINODE_BASE_FILE_H_
