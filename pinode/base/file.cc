#include "pinode/base/file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <string_view>
#include <system_error>
#include <utility>

#include "pinode/base/compression.h"
#include "pinode/base/logging.h"
#include "pinode/base/unpacked_size.h"

namespace pinode {
namespace {

std::string ErrorText(int error_number) {
  return std::generic_category().message(error_number);
}

// Owns a file descriptor until Close() or destruction.
class Descriptor {
 public:
  explicit Descriptor(int fd) : fd_(fd) {}
  ~Descriptor() {
    if (fd_ >= 0) close(fd_);
  }
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;

  int get() const { return fd_; }
  // Some file systems report a failed write only here.
  bool Close() { return close(std::exchange(fd_, -1)) == 0; }

 private:
  int fd_;
};

bool WriteAll(int fd, const std::string& content) {
  size_t done = 0;
  while (done < content.size()) {
    const ssize_t count =
        write(fd, content.data() + done, content.size() - done);
    if (count < 0) {
      if (errno == EINTR) continue;
      return false;
    }
    done += static_cast<size_t>(count);
  }
  return true;
}

// The permissions that a plain open() would have given a new file; mkstemp
// makes its files private.
mode_t PermissionsFor(const std::string& path) {
  struct stat status;
  if (stat(path.c_str(), &status) == 0) return status.st_mode & 07777;
  const mode_t mask = umask(0);
  umask(mask);
  return 0666 & ~mask;
}

// Files from this size on are looked at before they are read, and the number of
// bytes that are looked at. Text that is all zeros would be taken apart at
// three times its size in memory.
constexpr off_t kLargeFile = off_t{100} << 20;
constexpr size_t kLook = 4096;
constexpr char kZeros[] = " begins with 4096 zeros, expected data";

// True if as many zeros begin `text`, which no format that is read here does.
bool BeginsWithZeros(std::string_view text) {
  text = text.substr(0, kLook);
  return text.size() == kLook &&
         text.find_first_not_of('\0') == std::string_view::npos;
}

std::string FolderOf(const std::string& path) {
  const size_t slash = path.rfind('/');
  if (slash == std::string::npos) return ".";
  return slash == 0 ? "/" : path.substr(0, slash);
}

}  // namespace

size_t FirstInvalidUtf8(const std::string& text) {
  const size_t size = text.size();
  auto byte = [&text](size_t i) { return static_cast<unsigned char>(text[i]); };
  size_t i = 0;
  while (i < size) {
    const unsigned lead = byte(i);
    if (lead < 0x80) {
      ++i;
      // Eight letters of ASCII at a time: long records are made of them.
      uint64_t letters = 0;
      while (i + sizeof letters <= size) {
        std::memcpy(&letters, text.data() + i, sizeof letters);
        if ((letters & 0x8080808080808080U) != 0) break;
        i += sizeof letters;
      }
      continue;
    }
    size_t length;
    // Range of the second byte; the later ones are always 80..BF.
    unsigned low = 0x80;
    unsigned high = 0xBF;
    if (lead >= 0xC2 && lead <= 0xDF) {
      length = 2;
    } else if (lead >= 0xE0 && lead <= 0xEF) {
      length = 3;
      if (lead == 0xE0) low = 0xA0;
      if (lead == 0xED) high = 0x9F;
    } else if (lead >= 0xF0 && lead <= 0xF4) {
      length = 4;
      if (lead == 0xF0) low = 0x90;
      if (lead == 0xF4) high = 0x8F;
    } else {
      return i;
    }
    if (i + length > size) return i;
    if (byte(i + 1) < low || byte(i + 1) > high) return i;
    for (size_t k = 2; k < length; ++k) {
      if ((byte(i + k) & 0xC0) != 0x80) return i;
    }
    i += length;
  }
  return std::string::npos;
}

bool ReadBinaryFile(const std::string& path, std::string* content,
                    std::string* error) {
  CHECK(content != nullptr);
  CHECK(error != nullptr);
  // Without O_NONBLOCK, opening a named pipe would wait for its writer.
  Descriptor file(open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK));
  if (file.get() < 0) {
    *error = path + ": cannot open the file: " + ErrorText(errno);
    return false;
  }
  struct stat status;
  if (fstat(file.get(), &status) != 0) {
    *error = path + ": cannot read the file: " + ErrorText(errno);
    return false;
  }
  if (S_ISDIR(status.st_mode)) {
    *error = path + ": is a folder, expected a file";
    return false;
  }
  if (!S_ISREG(status.st_mode)) {
    *error = path + ": is not a regular file";
    return false;
  }
  // A file with holes states any size and takes no place on the disk.
  constexpr double kBlock = 512.0;
  std::string what;
  if (!UnpackedSize(kBlock * static_cast<double>(status.st_blocks))
           .Take(static_cast<double>(status.st_size), &what)) {
    *error = path + ": the file " + what;
    return false;
  }
  std::string text;
  if (status.st_size >= kLargeFile) {
    text.resize(kLook);
    const ssize_t count = pread(file.get(), text.data(), kLook, 0);
    if (count == static_cast<ssize_t>(kLook) && BeginsWithZeros(text)) {
      *error = path + ": the file" + kZeros;
      return false;
    }
  }
  // One byte more than expected, to detect the end without another allocation.
  text.resize(static_cast<size_t>(status.st_size) + 1);
  size_t done = 0;
  // The size may be out of date (or 0, under /proc): read up to the end.
  for (;;) {
    if (done == text.size()) text.resize(text.size() + 4096);
    const ssize_t count = read(file.get(), &text[done], text.size() - done);
    if (count < 0) {
      if (errno == EINTR) continue;
      *error = path + ": cannot read the file: " + ErrorText(errno);
      return false;
    }
    if (count == 0) break;
    done += static_cast<size_t>(count);
  }
  text.resize(done);
  *content = std::move(text);
  return true;
}

std::string WithoutGz(const std::string& path) {
  constexpr char kEnd[] = ".gz";
  constexpr size_t kLength = sizeof(kEnd) - 1;
  const bool ends = path.size() > kLength &&
                    path.compare(path.size() - kLength, kLength, kEnd) == 0;
  return ends ? path.substr(0, path.size() - kLength) : path;
}

bool ReadTextOfAnyEncoding(const std::string& path, std::string* content,
                           std::string* error) {
  std::string text;
  if (!ReadBinaryFile(path, &text, error)) return false;
  if (WithoutGz(path) != path) {
    std::string what;
    const UnpackedSize memory(static_cast<double>(text.size()));
    if (!Unpack(CompressedFormat::kGzip, text,
                static_cast<size_t>(memory.largest()), &text, &what)) {
      *error = path + ": " + what + ", expected a file of gzip";
      return false;
    }
    if (static_cast<off_t>(text.size()) >= kLargeFile &&
        BeginsWithZeros(text)) {
      *error = path + ": the unpacked file" + kZeros;
      return false;
    }
  }
  *content = std::move(text);
  return true;
}

bool ReadTextFile(const std::string& path, std::string* content,
                  std::string* error) {
  std::string text;
  if (!ReadTextOfAnyEncoding(path, &text, error)) return false;
  const size_t bad = FirstInvalidUtf8(text);
  if (bad != std::string::npos) {
    const auto line =
        1 + std::count(text.begin(),
                       text.begin() + static_cast<std::ptrdiff_t>(bad), '\n');
    char hex[8];
    std::snprintf(hex, sizeof(hex), "0x%02X",
                  static_cast<unsigned char>(text[bad]));
    *error = path + ":" + std::to_string(line) + ": byte " + hex +
             " is not valid UTF-8, expected a text file in UTF-8 (or ASCII)";
    return false;
  }
  *content = std::move(text);
  return true;
}

bool WriteFileAtomically(const std::string& path, const std::string& content,
                         std::string* error) {
  bool done = false;
  return WriteFileAtomically(
      path,
      [&](std::string* chunk) {
        if (!done) *chunk = content;
        done = true;
      },
      error);
}

bool WriteFileAtomically(const std::string& path,
                         const std::function<void(std::string*)>& next,
                         std::string* error) {
  CHECK(error != nullptr);
  CHECK(!path.empty()) << "the path of the file to write is empty";
  struct stat status;
  if (stat(path.c_str(), &status) == 0 && S_ISDIR(status.st_mode)) {
    *error = path + ": cannot write the file: a folder of that name exists";
    return false;
  }
  const std::string folder = FolderOf(path);
  std::string temporary = path + ".XXXXXX";
  Descriptor file(mkstemp(temporary.data()));
  if (file.get() < 0) {
    *error = path + ": cannot write the file: " + ErrorText(errno);
    return false;
  }
  const auto write_chunks = [&]() {
    std::string chunk;
    for (;;) {
      chunk.clear();
      next(&chunk);
      if (chunk.empty()) return true;
      if (!WriteAll(file.get(), chunk)) return false;
    }
  };
  if (fchmod(file.get(), PermissionsFor(path)) != 0 || !write_chunks() ||
      fsync(file.get()) != 0 || !file.Close() ||
      rename(temporary.c_str(), path.c_str()) != 0) {
    *error = path + ": cannot write the file: " + ErrorText(errno);
    unlink(temporary.c_str());
    return false;
  }
  // Makes the new name itself durable. Not every file system can do this for a
  // folder; the content is already safe, so a refusal is no failure.
  Descriptor folder_descriptor(
      open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
  if (folder_descriptor.get() >= 0) (void)fsync(folder_descriptor.get());
  return true;
}

}  // namespace pinode
