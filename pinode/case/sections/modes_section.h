// A case read for its measured responses alone: pinode_modes.

#ifndef PINODE_CASE_SECTIONS_MODES_SECTION_H_
#define PINODE_CASE_SECTIONS_MODES_SECTION_H_

#include <map>
#include <memory>
#include <string>
#include <vector>

#include "pinode/base/units.h"
#include "pinode/modal/identify_modes.h"
#include "pinode/modal/merge_setups.h"
#include "pinode/modal/resolve_dofs.h"
#include "pinode/modal/response_record.h"

namespace pinode {

struct CaseData;
struct PlacedGeometry;
struct TomlValue;

// What pinode_modes needs of a case: [modes], and of each [[record]] the
// channels. A model need not be there and is not read where it is.
struct ModesCase {
  std::string path;
  std::string title;
  UnitSystem units;
  // Each a set-up: its channels' names are places, a channel's `dof` or, where
  // it has none, its own name.
  std::vector<ResponseRecord> records;
  // What each place of the records means, once.
  std::vector<PlaceOfShape> places;
  // [geometry]; null where the case does not say.
  std::shared_ptr<const PlacedGeometry> geometry;
  std::vector<std::string> remarks;
  ModeIdentificationOptions options;
  MergeOptions merge;
  // Lines of the file: of the keys of [modes], of the [[record]] of each name.
  std::map<std::string, int> option_lines;
  std::map<std::string, int> record_lines;
};

// A data file by itself, in the place of a case.
struct ModesDataFile {
  std::string path;
  // Channels; "all" alone: every column but the time.
  std::vector<std::string> columns;
  // What they measure: displacement, velocity, acceleration or strain; one for
  // all, or one for each. Default: acceleration.
  std::vector<std::string> quantities;
  // Default, where there is no rate: "t" or "time", in seconds.
  std::string time_column;
  double sampling_rate_hz = 0.0;
};

// The modes' case of that file: channels are places. Fails with one line in
// *error, *c is untouched then.
[[nodiscard]] bool ReadModesDataFile(const ModesDataFile& file, ModesCase* c,
                                     std::string* error);

// Reads the case file at `path` with the records that it names. Fails with one
// line in *error, *c is untouched then.
[[nodiscard]] bool ReadModesCase(const std::string& path, ModesCase* c,
                                 std::string* error);

// [modes] of `source` alone, for records that are in memory already.
[[nodiscard]] bool ReadModesOptions(const TomlValue& source, ModesCase* c,
                                    std::string* error);

// The case that `source` says, with `data` in place of files that it names, as
// ReadCaseTree has it; `path` is where it would stand, or empty.
[[nodiscard]] bool ReadModesTree(const TomlValue& source,
                                 const std::string& path, const CaseData& data,
                                 ModesCase* c, std::string* error);

}  // namespace pinode

#endif  // PINODE_CASE_SECTIONS_MODES_SECTION_H_
