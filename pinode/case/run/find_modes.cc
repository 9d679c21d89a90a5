#include "pinode/case/run/find_modes.h"

#include <map>
#include <utility>

#include "pinode/case/text/toml_table.h"
#include "pinode/modal/merge_setups.h"
#include "pinode/modal/resolve_dofs.h"

namespace pinode {
namespace {

// 0: nobody knows.
int LineOf(const std::map<std::string, int>& lines, const std::string& name) {
  const auto place = lines.find(name);
  return place == lines.end() ? 0 : place->second;
}

// Of what is at fault: an option, or else the record.
bool Fail(const ModesCase& c, const std::string& option,
          const std::string& record, const std::string& message,
          std::string* error) {
  CaseErrors errors(c.path, error);
  return option.empty() ? errors.Fail(LineOf(c.record_lines, record), message)
                        : errors.Fail(LineOf(c.option_lines, option),
                                      "[modes] " + option + ": " + message);
}

}  // namespace

bool FindModes(const ModesCase& c, FoundModes* found, std::string* error) {
  *found = FoundModes();
  if (c.frf.has_value()) {
    return Fail(c, "frf", "",
                "frequency response functions are estimated by pinode_modes "
                "and pinode.estimate_frfs alone; leave it out here",
                error);
  }
  ModesResult& result = found->result;
  result.remarks = c.remarks;
  result.keep_harmonics = c.keep_harmonics;
  std::vector<SetupModes> setups;
  std::string message;
  for (const ResponseRecord& record : c.records) {
    ModesOfRecord modes;
    std::string option;
    if (!IdentifyModes(record, c.options, &modes, &message, &option)) {
      return Fail(c, option, record.name, message, error);
    }
    for (const std::string& remark : modes.remarks) {
      result.remarks.push_back("Record '" + record.name + "': " + remark);
    }
    SetupModes setup;
    setup.name = record.name;
    for (const ResponseChannel& channel : record.channels) {
      setup.places.push_back(channel.name);
    }
    setup.modes = modes.modes;
    result.setups.push_back(record.name);
    setups.push_back(std::move(setup));
    found->by_record.push_back(std::move(modes));
  }
  if (!MergeSetups(setups, c.merge, &result.merged, &message)) {
    return Fail(c, c.merge.references.empty() ? "" : "references", "", message,
                error);
  }
  PlaceModes(c, found);
  return true;
}

void PlaceModes(const ModesCase& c, FoundModes* found) {
  ModesResult& result = found->result;
  std::vector<PlaceOfShape> places = c.places;
  ResolveDofs(&places, &result.merged);
  result.remarks.insert(result.remarks.end(), result.merged.remarks.begin(),
                        result.merged.remarks.end());
  if (c.geometry != nullptr) {
    found->picture =
        MakeModesPicture(*c.geometry, c.places, places, result.merged);
    result.geometry = c.geometry->geometry;
    result.motions = MotionsOfNodes(*c.geometry, places, result.merged);
  }
}

}  // namespace pinode
