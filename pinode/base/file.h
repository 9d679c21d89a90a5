// Files are read as a whole, and written completely or not at all.

#ifndef PINODE_BASE_FILE_H_
#define PINODE_BASE_FILE_H_

#include <functional>
#include <string>

namespace pinode {

// Reads the whole file at `path` into *content, byte for byte. Fails with a
// message in *error if the file is missing, cannot be read or is not a regular
// file. *content is unchanged on failure.
[[nodiscard]] bool ReadBinaryFile(const std::string& path, std::string* content,
                                  std::string* error);

// Reads the whole text file at `path`. Does what ReadBinaryFile does, and also
// fails if the file is not valid UTF-8 (`path:line: ...`, the line of the first
// bad byte). Unpacks a file whose name ends in .gz, as far as unpacked_size.h
// grants it.
[[nodiscard]] bool ReadTextFile(const std::string& path, std::string* content,
                                std::string* error);

// Does what ReadTextFile does, for text in any encoding.
[[nodiscard]] bool ReadTextOfAnyEncoding(const std::string& path,
                                         std::string* content,
                                         std::string* error);

// Returns `path` without .gz at its end. Readers find the format of a
// compressed file from this name.
std::string WithoutGz(const std::string& path);

// Writes `content` to `path` so that a reader sees either the old file or the
// whole new file, even after a crash. The function writes a temporary file in
// the same folder, flushes it to the disk, and renames it to `path`. On failure
// it removes the temporary file, leaves an existing file at `path` unchanged,
// and sets *error to the reason.
[[nodiscard]] bool WriteFileAtomically(const std::string& path,
                                       const std::string& content,
                                       std::string* error);

// Does the same for content that is produced in chunks. `next` receives an
// empty chunk and fills it. The file ends when it leaves the chunk empty.
[[nodiscard]] bool WriteFileAtomically(
    const std::string& path, const std::function<void(std::string*)>& next,
    std::string* error);

// Returns the offset of the first byte of `text` that is not part of a valid
// UTF-8 sequence (RFC 3629: no overlong forms, no surrogates, at most
// U+10FFFF). Returns std::string::npos if all of `text` is valid.
size_t FirstInvalidUtf8(const std::string& text);

}  // namespace pinode

#endif  // PINODE_BASE_FILE_H_
