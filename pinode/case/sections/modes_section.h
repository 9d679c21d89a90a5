// Cases read for their measured responses alone, for pinode_modes.

#ifndef PINODE_CASE_SECTIONS_MODES_SECTION_H_
#define PINODE_CASE_SECTIONS_MODES_SECTION_H_

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "pinode/base/units.h"
#include "pinode/case/sections/modes_frf_section.h"
#include "pinode/modal/identify_modes.h"
#include "pinode/modal/merge_setups.h"
#include "pinode/modal/resolve_dofs.h"
#include "pinode/modal/response_record.h"

namespace pinode {

struct CaseData;
struct PlacedGeometry;
struct TomlValue;

// Data of a case for pinode_modes: [modes], and the channels of each
// [[record]]. A model is not needed and not read.
struct ModesCase {
  std::string path;
  std::string title;
  UnitSystem units;
  // One record per set-up. Its channels' names are places: a channel's `dof`
  // or, without one, its own name.
  std::vector<ResponseRecord> records;
  // Places of the measured loads of each record; empty text: a load that is no
  // force.
  std::vector<std::vector<std::string>> loads;
  // [modes.frf]: frequency response functions are estimated first.
  std::optional<ModesFrfSection> frf;
  // Places of the records, each once.
  std::vector<PlaceOfShape> places;
  // [geometry]; null if the case has none.
  std::shared_ptr<const PlacedGeometry> geometry;
  std::vector<std::string> remarks;
  ModeIdentificationOptions options;
  MergeOptions merge;
  bool keep_harmonics = false;  // in modes.toml
  // Line numbers in the file: of the keys of [modes], and of each [[record]] by
  // name.
  std::map<std::string, int> option_lines;
  std::map<std::string, int> record_lines;
};

// Reads the case file at `path` with the records that it names. On failure
// *error is one line and *c is untouched.
[[nodiscard]] bool ReadModesCase(const std::string& path, ModesCase* c,
                                 std::string* error);

// Reads [modes] of `source` alone, for records that are in memory already.
// Messages begin with `path`, unless it is empty.
[[nodiscard]] bool ReadModesOptions(const TomlValue& source,
                                    const std::string& path, ModesCase* c,
                                    std::string* error);

// Reads the case `source`, with `data` in place of files that it names, as
// ReadCaseTree does; nullptr: all are files. `path` is the case's path, or
// empty.
[[nodiscard]] bool ReadModesTree(const TomlValue& source,
                                 const std::string& path, const CaseData* data,
                                 ModesCase* c, std::string* error);

}  // namespace pinode

#endif  // PINODE_CASE_SECTIONS_MODES_SECTION_H_
