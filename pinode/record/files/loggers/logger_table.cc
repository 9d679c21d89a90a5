#include "pinode/record/files/loggers/logger_table.h"

#include <algorithm>
#include <array>
#include <filesystem>
#include <fstream>
#include <set>
#include <string_view>
#include <utility>

#include "pinode/base/file.h"
#include "pinode/base/file_text.h"
#include "pinode/base/logging.h"
#include "pinode/base/text_encoding.h"
#include "pinode/base/unit_names.h"
#include "pinode/record/files/loggers/bhrc.h"
#include "pinode/record/files/loggers/knet.h"
#include "pinode/record/files/loggers/lvm.h"
#include "pinode/record/files/loggers/mini_seed.h"
#include "pinode/record/files/loggers/sac.h"
#include "pinode/record/files/loggers/strong_motion.h"
#include "pinode/record/files/loggers/tdms.h"

namespace pinode {
namespace {

// Longest beginning that a format needs to be known.
constexpr size_t kLoggerBeginning = 512;

bool BeginsWith(std::string_view text, std::string_view begin) {
  return text.substr(0, begin.size()) == begin;
}

LoggerFormat FormatOfBeginning(std::string_view begin) {
  if (BeginsWith(begin, "TDSm") || BeginsWith(begin, "TDSh")) {
    return LoggerFormat::kTdms;
  }
  if (BeginsWith(begin, "Origin Time ")) return LoggerFormat::kKnet;
  if (BeginsWith(begin, "LabVIEW Measurement")) return LoggerFormat::kLvm;
  if (IsMiniSeedHeader(begin)) return LoggerFormat::kMiniSeed;
  if (IsSacHeader(begin)) return LoggerFormat::kSac;
  const std::string_view title = begin.substr(0, begin.find('\n'));
  if (IsStrongMotionTitle(title) || IsBhrcTitle(title)) {
    return LoggerFormat::kStrongMotion;
  }
  return LoggerFormat::kNone;
}

LoggerFormat FormatOfExtension(const std::string& path) {
  static const std::array<std::pair<const char*, LoggerFormat>, 14>
      kExtensions = {{{".tdms", LoggerFormat::kTdms},
                      {".mseed", LoggerFormat::kMiniSeed},
                      {".miniseed", LoggerFormat::kMiniSeed},
                      {".msd", LoggerFormat::kMiniSeed},
                      {".sac", LoggerFormat::kSac},
                      {".lvm", LoggerFormat::kLvm},
                      {".v1", LoggerFormat::kStrongMotion},
                      {".v2", LoggerFormat::kStrongMotion},
                      {".v1c", LoggerFormat::kStrongMotion},
                      {".v2c", LoggerFormat::kStrongMotion},
                      {".knet", LoggerFormat::kKnet},
                      {".ew", LoggerFormat::kKnet},
                      {".ns", LoggerFormat::kKnet},
                      {".ud", LoggerFormat::kKnet}}};
  const std::string extension =
      LowerCase(std::filesystem::path(WithoutGz(path)).extension().string());
  for (const auto& [known, format] : kExtensions) {
    if (extension == known) return format;
  }
  return LoggerFormat::kNone;
}

// Parses a file whose text, if it is one, is in UTF-8.
bool ParseBytesOrText(const std::string& bytes, const std::string& text,
                      const std::string& path, LoggerFormat format,
                      const ChannelFilter& wanted, LoggedFile* file,
                      std::string* error) {
  switch (format) {
    case LoggerFormat::kKnet:
      return ParseKnet(text, path, wanted, file, error);
    case LoggerFormat::kStrongMotion:
      return IsBhrcTitle(std::string_view(text).substr(0, text.find('\n')))
                 ? ParseBhrc(text, path, wanted, file, error)
                 : ParseStrongMotion(text, path, wanted, file, error);
    case LoggerFormat::kLvm:
      return ParseLvm(text, path, wanted, file, error);
    case LoggerFormat::kTdms:
      return ParseTdms(bytes, path, wanted, file, error);
    case LoggerFormat::kMiniSeed:
      return ParseMiniSeed(bytes, path, wanted, file, error);
    case LoggerFormat::kSac:
      return ParseSac(bytes, path, wanted, file, error);
    case LoggerFormat::kNone:
      break;
  }
  *error = path + ": is not a file of a known data logger";
  return false;
}

}  // namespace

bool IsLoggerText(LoggerFormat format) {
  return format == LoggerFormat::kKnet || format == LoggerFormat::kLvm ||
         format == LoggerFormat::kStrongMotion;
}

LoggerFormat FindLoggerFormat(const std::string& path) {
  std::error_code code;
  if (!std::filesystem::is_regular_file(path, code)) return LoggerFormat::kNone;
  std::array<char, kLoggerBeginning> begin;
  std::ifstream file(path, std::ios::binary);
  file.read(begin.data(), begin.size());
  const LoggerFormat format = FormatOfBeginning(
      std::string_view(begin.data(), static_cast<size_t>(file.gcount())));
  return format != LoggerFormat::kNone ? format : FormatOfExtension(path);
}

bool ReadLoggedFile(const std::string& path, LoggerFormat format,
                    const std::string& encoding, const ChannelFilter& wanted,
                    LoggedFile* file, std::string* error) {
  std::string bytes;
  return ReadTextOfAnyEncoding(path, &bytes, error) &&
         ParseLoggedFile(bytes, path, format, encoding, wanted, file, error);
}

bool ParseLoggedFile(const std::string& bytes, const std::string& path,
                     LoggerFormat format, const std::string& encoding,
                     const ChannelFilter& wanted, LoggedFile* file,
                     std::string* error) {
  CHECK(file != nullptr);
  CHECK(error != nullptr);
  std::string text;
  TextEncoding found;
  if (IsLoggerText(format)) {
    text = bytes;
    std::string what;
    if (!ConvertToUtf8(encoding, &text, &found, &what)) {
      *error = path + ": " + what;
      return false;
    }
  }
  if (!ParseBytesOrText(bytes, text, path, format, wanted, file, error)) {
    return false;
  }
  if (found.name != "UTF-8") {
    file->remarks.push_back("text in " + found.AsText());
  }
  return true;
}

bool ReadLoggerTable(const std::string& path, LoggerFormat format,
                     const std::string& encoding,
                     const std::vector<std::string>& wanted, Table* table,
                     std::string* error) {
  std::set<std::string> names(wanted.begin(), wanted.end());
  // Names that occur again are numbered after this: "a[2]".
  for (const std::string& name : wanted) {
    names.insert(name.substr(0, name.rfind('[')));
  }
  const auto is_wanted = [&](const LoggerChannel& channel) {
    return names.empty() || names.count(channel.name) > 0 ||
           names.count(channel.short_name) > 0;
  };
  LoggedFile file;
  return ReadLoggedFile(path, format, encoding, is_wanted, &file, error) &&
         MakeLoggerTable(file, path, wanted, table, error);
}

std::string UnitOfLoggerChannel(const std::string& path, LoggerFormat format,
                                const std::string& encoding,
                                const std::string& name) {
  LoggedFile file;
  std::string error;
  const auto none = [](const LoggerChannel&) { return false; };
  if (!ReadLoggedFile(path, format, encoding, none, &file, &error)) return "";
  std::string unit;
  for (const LoggerChannel& channel : file.channels) {
    if (channel.name == name) return CanonicalUnit(channel.unit);
    if (channel.short_name == name) unit = CanonicalUnit(channel.unit);
  }
  return unit;
}

}  // namespace pinode
