#include "pinode/case/results/case_picture.h"

#include "pinode/base/file.h"
#include "pinode/case/results/result_files.h"

namespace pinode {
namespace {

// The picture has the lowest modes only.
constexpr int kNumDrawnModes = 8;

}  // namespace

std::optional<StructurePicture> PictureOfCase(
    const Case& c, const IdentificationSummary& summary,
    const IdentifiedModel& model, const DamageResult* damage) {
  if (c.geometry == nullptr) return std::nullopt;
  // A failed fit may have no model.
  const IdentifiedModel complete = CompleteModel(c.problem, model);
  return MakeStructurePicture(*c.geometry, c.problem, c.finite_element.get(),
                              &summary, &complete, damage, kNumDrawnModes);
}

bool WriteVtu(const std::optional<StructurePicture>& picture,
              const std::string& folder, std::string* error) {
  return !picture.has_value() ||
         WriteFileAtomically(folder + "/structure.vtu", FormatVtu(*picture),
                             error);
}

}  // namespace pinode
