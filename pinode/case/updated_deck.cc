#include "pinode/case/updated_deck.h"

#include <filesystem>
#include <vector>

#include "pinode/base/file.h"
#include "pinode/case/result_files.h"
#include "pinode/structure/deck_properties.h"
#include "pinode/study/finite_element_result.h"
#include "pinode/study/structure_picture.h"

namespace pinode {
namespace {

// Not one, so that every property that would be changed is looked at.
constexpr double kTriedFactor = 1.5;

std::vector<DeckFactor> DeckFactorsOf(
    const Case& c, const std::vector<ElementFactor>& factors) {
  std::vector<DeckFactor> of_deck;
  for (const ElementFactor& factor : factors) {
    if (factor.target == MatrixGroup::Target::kDamping) continue;
    std::vector<std::string> sets = {factor.group};
    if (c.geometry != nullptr) {
      const auto named = c.geometry->groups.find(factor.group);
      if (named != c.geometry->groups.end()) sets = named->second;
    }
    for (const std::string& set : sets) {
      of_deck.push_back(
          {set, factor.target == MatrixGroup::Target::kMass, factor.factor});
    }
  }
  return of_deck;
}

// What a reader of the deck alone would not know.
std::string HeadOf(const IdentificationSummary& summary) {
  return summary.usable ? std::string()
                        : "** From a fit that is not usable: see the report "
                          "beside this deck.\n";
}

}  // namespace

bool CheckDeck(const Case& c, const std::string& path, std::string* error) {
  if (c.finite_element == nullptr) {
    *error = c.path +
             ": no [model.finite_element], expected one for the deck that is "
             "to be updated";
    return false;
  }
  std::vector<ElementFactor> factors =
      ElementFactors(*c.finite_element, *c.problem.dynamics, {});
  for (ElementFactor& factor : factors) factor.factor = kTriedFactor;
  const std::vector<DeckFactor> of_deck = DeckFactorsOf(c, factors);
  if (of_deck.empty()) {
    *error = c.path +
             ": no group is an element set's export, expected one for the deck "
             "that is to be updated";
    return false;
  }
  std::string content, scaled;
  return ReadTextFile(path, &content, error) &&
         ScaleDeck(path, content, of_deck, &scaled, error);
}

bool WriteUpdatedDeck(const Case& c, const IdentificationSummary& summary,
                      const IdentifiedModel& model, const std::string& path,
                      const std::string& folder, std::string* remark,
                      std::string* error) {
  remark->clear();
  StructuralDynamics dynamics = *c.problem.dynamics;
  dynamics.SetParameters(CompleteModel(c.problem, model)
                             .parameters.head(dynamics.num_parameters()));
  const std::vector<DeckFactor> factors =
      DeckFactorsOf(c, ElementFactors(*c.finite_element, dynamics, summary));
  for (const DeckFactor& factor : factors) {
    if (factor.factor > 0.0) continue;
    *remark = "No updated deck: the " +
              std::string(factor.is_mass ? "mass" : "stiffness") +
              " of element set '" + factor.set +
              "' is lost, and a deck takes positive numbers alone.";
    return true;
  }
  namespace fs = std::filesystem;
  const fs::path updated =
      fs::path(folder) / (fs::path(path).stem().string() + "_updated.inp");
  std::string content, scaled;
  return ReadTextFile(path, &content, error) &&
         ScaleDeck(path, content, factors, &scaled, error) &&
         WriteFileAtomically(updated.string(), HeadOf(summary) + scaled, error);
}

}  // namespace pinode
