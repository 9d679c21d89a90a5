#include "pinode/case/results/updated_deck.h"

#include <filesystem>
#include <vector>

#include "pinode/base/file.h"
#include "pinode/base/file_text.h"
#include "pinode/base/strings.h"
#include "pinode/case/results/result_files.h"
#include "pinode/structure/decks/deck_properties.h"
#include "pinode/study/picture/structure_picture.h"
#include "pinode/study/reduction/finite_element_result.h"

namespace pinode {
namespace {

// Factor for the check of a deck. It is not one, so that every property that
// would be changed is checked.
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

// Returns the groups whose change no property of a deck can express: of a
// matrix of their own, between two DOFs, of damping, following time or a
// covariate.
std::vector<std::string> GroupsLeftOut(const ReducedStructure& structure,
                                       const StructuralDynamics& dynamics) {
  std::vector<std::string> left_out;
  for (size_t j = 0; j < structure.groups.size(); ++j) {
    const GroupTerm& term = dynamics.groups()[j];
    const bool in_deck = structure.groups[j].is_element_set &&
                         term.follows == GroupTerm::Follows::kNothing &&
                         term.group.target != MatrixGroup::Target::kDamping;
    if (in_deck || term.alpha.value == 0.0) continue;
    left_out.push_back(Quote(term.group.name));
  }
  return left_out;
}

// Returns remarks for a reader of the deck alone, one line per group: decks do
// not allow long lines.
std::string HeadOf(const IdentificationSummary& summary,
                   const std::vector<std::string>& left_out) {
  std::string head;
  if (!summary.usable()) {
    head = "** The fit is not usable: see the report beside this deck.\n";
  }
  if (left_out.empty()) return head;
  head +=
      "** Not in this deck: changes of these groups, which are not factors of "
      "element sets:\n";
  for (const std::string& group : left_out) head += "**   " + group + "\n";
  return head;
}

// Adds the head with the deck's line ends.
std::string WithHead(std::string head, const std::string& deck) {
  const size_t end = deck.find('\n');
  if (end != std::string::npos && end > 0 && deck[end - 1] == '\r') {
    ReplaceAll("\n", "\r\n", &head);
  }
  return head + deck;
}

}  // namespace

bool CheckDeck(const Case& c, const std::string& path, std::string* error) {
  if (c.finite_element == nullptr) {
    *error = c.path + ": there is no [model.finite_element]; --deck needs it";
    return false;
  }
  std::vector<ElementFactor> factors =
      ElementFactors(*c.finite_element, *c.problem.dynamics, {});
  for (ElementFactor& factor : factors) factor.factor = kTriedFactor;
  const std::vector<DeckFactor> of_deck = DeckFactorsOf(c, factors);
  if (of_deck.empty()) {
    *error =
        c.path + ": no group is the export of an element set; --deck needs one";
    return false;
  }
  std::string content, scaled;
  return ReadTextOfAnyEncoding(path, &content, error) &&
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
              "' is not positive, but a deck needs positive numbers.";
    return true;
  }
  namespace fs = std::filesystem;
  const fs::path updated =
      fs::path(folder) / (fs::path(path).stem().string() + "_updated.inp");
  const std::vector<std::string> left_out =
      GroupsLeftOut(*c.finite_element, dynamics);
  std::string content, scaled;
  if (!ReadTextOfAnyEncoding(path, &content, error) ||
      !ScaleDeck(path, content, factors, &scaled, error) ||
      !WriteFileAtomically(updated.string(),
                           WithHead(HeadOf(summary, left_out), scaled),
                           error)) {
    return false;
  }
  if (!left_out.empty()) {
    *remark =
        "The updated deck does not have the change of " + Join(left_out, ", ") +
        ": a deck takes only factors on stiffness and mass of element sets.";
  }
  return true;
}

}  // namespace pinode
