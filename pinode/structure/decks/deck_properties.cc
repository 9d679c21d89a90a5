#include "pinode/structure/decks/deck_properties.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <utility>

#include "pinode/structure/decks/deck_contents.h"

namespace pinode {
namespace {

// Gives owners their factors.
class FactorsOfSets {
 public:
  FactorsOfSets(DeckContents* deck, std::string* error)
      : deck_(deck), error_(error) {
    // Other owners may have no mass, if their material has none.
    for (const DeckOwner& owner : deck->owners) {
      if (owner.material.empty() || !deck->BlocksOf(owner, true).empty()) {
        continue;
      }
      without_mass_.insert(owner.elements.begin(), owner.elements.end());
    }
  }

  bool Assign(const DeckFactor& factor) {
    factor_ = &factor;
    const DeckAssembly& assembly = deck_->assembly;
    const int index = assembly.SetIndex(factor.set);
    if (index < 0) return Fail(assembly.WhyNoSet(factor.set));
    if (!std::isfinite(factor.factor) || !(factor.factor > 0.0)) {
      return Fail("its factor is not positive");
    }
    const std::vector<size_t>& added =
        factor.is_mass ? deck_->added_mass : deck_->added_stiffness;
    if (!added.empty()) return FailForKept(added[0], "the deck");
    const std::vector<int>& wanted =
        assembly.geometry().sets[static_cast<size_t>(index)].elements;
    const std::set<int> inside(wanted.begin(), wanted.end());
    std::set<int> covered;
    for (DeckOwner& owner : deck_->owners) {
      if (!AssignTo(inside, &owner, &covered)) return false;
    }
    for (const int e : wanted) {
      if (covered.count(e) > 0 || !HasIt(e)) continue;
      return Fail(
          "it has elements without a section with material, spring or "
          "mass");
    }
    return !covered.empty() || Fail("it has nothing of that kind");
  }

 private:
  bool AssignTo(const std::set<int>& wanted, DeckOwner* owner,
                std::set<int>* covered) {
    const bool mass = factor_->is_mass;
    if (owner->elements.empty() || deck_->BlocksOf(*owner, mass).empty()) {
      return true;
    }
    size_t inside = 0;
    for (const int e : owner->elements) inside += wanted.count(e);
    if (inside == 0) return true;
    const std::string what = "'" + owner->set + "'";
    if (inside < owner->elements.size()) {
      return Fail(what +
                  " has elements outside of it, expected properties of whole "
                  "sets");
    }
    const std::vector<size_t>& kept =
        mass ? owner->kept_mass : owner->kept_stiffness;
    if (!kept.empty()) {
      return FailForKept(kept[0], "the section of " + what);
    }
    bool& done = mass ? owner->scaled_mass : owner->scaled_stiffness;
    if (done) return Fail(what + " has another factor already");
    done = true;
    (mass ? owner->mass : owner->stiffness) = factor_->factor;
    covered->insert(owner->elements.begin(), owner->elements.end());
    return true;
  }

  // Returns true if an element has stiffness or mass.
  bool HasIt(int element) const {
    const DeckElementType& type = deck_->assembly.type(element);
    return factor_->is_mass
               ? type.HasMass() && without_mass_.count(element) == 0
               : type.HasStiffness();
  }

  bool FailForKept(size_t b, const std::string& what) {
    const DeckBlock& block = deck_->blocks[b];
    return Fail(what + " has " + block.keyword.name + " (" + block.place +
                "), which would not change; leave it out of the set");
  }

  bool Fail(const std::string& why) {
    *error_ = deck_->path + ": the " +
              (factor_->is_mass ? "mass" : "stiffness") + " of element set '" +
              factor_->set + "' cannot be changed: " + why;
    return false;
  }

  DeckContents* deck_;
  std::string* error_;
  const DeckFactor* factor_ = nullptr;
  std::set<int> without_mass_;  // elements
};

}  // namespace

bool ReadDeckProperties(const std::string& path, const std::string& content,
                        std::vector<DeckProperty>* properties,
                        std::string* error) {
  properties->clear();
  DeckContents deck;
  if (!ReadDeckContents(path, content, &deck, error)) return false;
  for (const DeckOwner& owner : deck.owners) {
    DeckProperty property;
    property.set = owner.set;
    for (const bool mass : {false, true}) {
      std::vector<double>& values = mass ? property.mass : property.stiffness;
      for (const size_t b : deck.BlocksOf(owner, mass)) {
        std::vector<DeckNumber> numbers;
        if (!FindDeckNumbers(deck.blocks[b], owner.spring, &numbers, error)) {
          return false;
        }
        for (const double value : DeckValues(numbers, deck.blocks[b])) {
          values.push_back(value);
        }
      }
    }
    properties->push_back(std::move(property));
  }
  return true;
}

bool ScaleDeck(const std::string& path, const std::string& content,
               const std::vector<DeckFactor>& factors, std::string* scaled,
               std::string* error) {
  DeckContents deck;
  if (!ReadDeckContents(path, content, &deck, error)) return false;
  const std::vector<std::string>& notes = deck.assembly.geometry().notes;
  if (!notes.empty()) {
    *error = path + ": " + notes.front() +
             " An updated deck needs known types of elements";
    return false;
  }
  FactorsOfSets assigned(&deck, error);
  for (const DeckFactor& factor : factors) {
    if (!assigned.Assign(factor)) return false;
  }
  for (const DeckOwner& owner : deck.owners) {
    if (owner.material.empty() &&
        !ScaleDeckBlock(owner.stiffness, owner.mass, owner.spring,
                        &deck.blocks[owner.block], error)) {
      return false;
    }
  }
  if (!ScaleDeckMaterials(&deck, error)) return false;
  *scaled = FormatDeckBlocks(deck.blocks);
  return true;
}

}  // namespace pinode
