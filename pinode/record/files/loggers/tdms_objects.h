// Structure of a TDMS file: its objects, their properties, and the places of
// their numbers.

#ifndef PINODE_RECORD_FILES_LOGGERS_TDMS_OBJECTS_H_
#define PINODE_RECORD_FILES_LOGGERS_TDMS_OBJECTS_H_

#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "pinode/record/files/loggers/logged_file.h"

namespace pinode {

// Types of numbers, as the format counts them.
enum class TdmsType : uint32_t {
  kVoid = 0,
  kInt8 = 1,
  kInt16 = 2,
  kInt32 = 3,
  kInt64 = 4,
  kUint8 = 5,
  kUint16 = 6,
  kUint32 = 7,
  kUint64 = 8,
  kFloat = 9,
  kDouble = 10,
  kExtended = 11,
  kFloatWithUnit = 0x19,
  kDoubleWithUnit = 0x1A,
  kString = 0x20,
  kBoolean = 0x21,
  kTimestamp = 0x44,
  kComplexFloat = 0x08000C,
  kComplexDouble = 0x10000D
};

// Returns the bytes of a value; 0 for strings and unknown types.
size_t TdmsTypeSize(TdmsType type);
// Returns true for real numbers that TdmsNumberAt reads.
bool IsTdmsNumber(TdmsType type);
double TdmsNumberAt(TdmsType type, const char* bytes, bool is_big_endian);
// Returns the clock time of the 16 bytes of a timestamp.
StartTime TdmsTimeAt(const char* bytes, bool is_big_endian);

// Value of a property: a number, a text or a time.
struct TdmsProperty {
  double number = 0.0;
  bool is_number = false;
  std::string text;
  StartTime time;
};

// Equally spaced values of one channel.
struct TdmsRun {
  size_t position = 0;  // of the first value, in the file
  uint64_t count = 0;
  uint64_t stride = 0;  // bytes from one value to the next
  bool is_big_endian = false;
};

// Scale of numbers that stand in the file for themselves.
constexpr uint32_t kTdmsRawSeries = 0xFFFFFFFF;

// Numbers of a channel as they stand in the file.
struct TdmsSeries {
  // Number of the scale that takes them. Only DAQmx has others than
  // kTdmsRawSeries.
  uint32_t scale = kTdmsRawSeries;
  TdmsType type = TdmsType::kVoid;
  int bit = -1;  // the one that counts, of a digital line; -1: all
  bool is_daqmx = false;
  bool has_several_types = false;
  std::vector<TdmsRun> runs;
  uint64_t count = 0;  // of all values
};

struct TdmsObject {
  // Parts of the path: none for the file, a group, a group and a channel.
  std::vector<std::string> path;
  std::map<std::string, TdmsProperty> properties;
  // One for most channels, several for some of DAQmx.
  std::vector<TdmsSeries> series;

  // Returns the number of values that all series have. In a segment that was
  // not finished some may have more.
  uint64_t count() const;
};

struct TdmsStructure {
  std::vector<TdmsObject> objects;  // in the order of the file
  // True if the last segment was not finished.
  bool is_unfinished = false;
};

// Reads the structure, without the numbers. Fails with `path: ...`.
[[nodiscard]] bool ReadTdmsStructure(std::string_view bytes,
                                     const std::string& path,
                                     TdmsStructure* structure,
                                     std::string* error);

}  // namespace pinode

#endif  // PINODE_RECORD_FILES_LOGGERS_TDMS_OBJECTS_H_
