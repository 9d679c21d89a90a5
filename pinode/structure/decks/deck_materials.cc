// Implements ScaleDeckMaterials of deck_contents.h.

#include <algorithm>
#include <iterator>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "pinode/structure/decks/deck_contents.h"

namespace pinode {
namespace {

// Characters of a name that decks allow.
constexpr size_t kLongestDeckName = 80;

using Factors = std::pair<double, double>;  // of stiffness and mass

bool IsQuotedName(const std::string& name) {
  return WithoutDeckQuotes(name) != name;
}

void SetMaterialOf(const std::string& name, DeckBlock* section) {
  std::string head = section->keyword.name;
  for (const auto& [key, value] : section->keyword.parameters) {
    head += "," + key;
    if (DeckKey(key) == "MATERIAL") {
      head += "=" + name;
    } else if (!value.empty()) {
      head += "=" + value;
    }
  }
  section->head = {head + DeckLineEnd(section->head[0])};
}

class MaterialScaling {
 public:
  MaterialScaling(DeckContents* contents, std::string* error)
      : contents_(contents), blocks_(contents->blocks), error_(error) {}

  bool Run() {
    for (size_t o = 0; o < contents_->owners.size(); ++o) {
      const DeckOwner& owner = contents_->owners[o];
      if (owner.material.empty()) continue;
      by_material_[owner.material][{owner.stiffness, owner.mass}].push_back(o);
    }
    // From the end to the beginning, so that copies do not move blocks that are
    // still to be handled.
    std::vector<std::pair<size_t, std::string>> order;
    for (const auto& entry : by_material_) {
      order.emplace_back(contents_->materials.at(entry.first).first,
                         entry.first);
    }
    std::sort(order.rbegin(), order.rend());
    for (const auto& [first, key] : order) {
      if (!ScaleMaterial(key)) return false;
    }
    for (const auto& [o, name] : renamed_) {
      SetMaterialOf(name, &blocks_[contents_->owners[o].block]);
    }
    for (auto& [end, added] : copies_) {
      blocks_.insert(blocks_.begin() + static_cast<long>(end),
                     std::make_move_iterator(added.begin()),
                     std::make_move_iterator(added.end()));
    }
    return true;
  }

 private:
  bool ScaleMaterial(const std::string& key) {
    const DeckMaterial material = contents_->materials.at(key);
    std::map<Factors, std::vector<size_t>>& kinds = by_material_[key];
    if (!material.unknown_uses.empty() &&
        (kinds.size() > 1 || kinds.count({1.0, 1.0}) == 0)) {
      const DeckBlock& user = blocks_[material.unknown_uses[0]];
      return FailInDeckBlock(
          user,
          user.keyword.name + " uses material '" + material.name +
              "', which is to be changed; only sections may use it",
          error_);
    }
    // Composites and general sections need it unchanged.
    if (!material.sections.empty()) kinds[{1.0, 1.0}];
    auto kept = kinds.find({1.0, 1.0});
    if (kept == kinds.end()) kept = kinds.begin();
    if (kinds.size() > 1 && !CanBeCopied(material)) return false;
    std::vector<DeckBlock> added;
    for (const auto& kind : kinds) {
      if (kind.first == kept->first) continue;
      const std::string copy =
          NewName(material.name, contents_->owners[kind.second[0]].set);
      std::vector<DeckBlock> blocks(
          blocks_.begin() + static_cast<long>(material.first),
          blocks_.begin() + static_cast<long>(material.end));
      blocks[0].head = {"*MATERIAL,NAME=" + copy +
                        DeckLineEnd(blocks[0].head[0])};
      for (DeckBlock& block : blocks) {
        if (!Scale(kind.first, &block)) return false;
        added.push_back(std::move(block));
      }
      for (const size_t o : kind.second) renamed_[o] = copy;
    }
    for (const size_t b : material.numbers) {
      if (!Scale(kept->first, &blocks_[b])) return false;
    }
    copies_.emplace_back(material.end, std::move(added));
    return true;
  }

  bool Scale(const Factors& factors, DeckBlock* block) {
    return ScaleDeckBlock(factors.first, factors.second, SpringStart::kUnknown,
                          block, error_);
  }

  // Returns true if the copy would include every block that may belong to the
  // material, and no other.
  bool CanBeCopied(const DeckMaterial& material) const {
    if (material.in_the_way.empty()) return true;
    const DeckBlock& block = blocks_[material.in_the_way[0]];
    return FailInDeckBlock(
        block,
        block.keyword.name +
            " after a material that several sections share; give the sets that "
            "differ a material of their own",
        error_);
  }

  std::string NewName(const std::string& material, const std::string& set) {
    const std::string quote =
        IsQuotedName(material) || IsQuotedName(set) ? "\"" : "";
    const std::string wish = WithoutDeckQuotes(material) + "_" +
                             DeckUpperCase(WithoutDeckQuotes(set));
    std::string name;
    for (int n = 1; name.empty() || contents_->materials.count(DeckKey(name));
         ++n) {
      const std::string end = n == 1 ? quote : "_" + std::to_string(n) + quote;
      name = quote +
             wish.substr(0, kLongestDeckName - quote.size() - end.size()) + end;
    }
    contents_->materials[DeckKey(name)] = DeckMaterial();
    return name;
  }

  DeckContents* contents_;
  std::vector<DeckBlock>& blocks_;
  std::string* error_;
  // Owners of each material by their factors.
  std::map<std::string, std::map<Factors, std::vector<size_t>>> by_material_;
  std::map<size_t, std::string> renamed_;  // owner: new material
  // Copies: the block before which each is inserted, and its own blocks.
  std::vector<std::pair<size_t, std::vector<DeckBlock>>> copies_;
};

}  // namespace

bool ScaleDeckBlock(double stiffness, double mass, SpringStart spring,
                    DeckBlock* block, std::string* error) {
  const DeckKeyword& keyword = block->keyword;
  double factor = 1.0;
  if (keyword.Is("*ELASTIC") || keyword.Is("*SPRING")) factor = stiffness;
  for (const char* of_mass :
       {"*DENSITY", "*MASS", "*ROTARY INERTIA", "*NONSTRUCTURAL MASS"}) {
    if (keyword.Is(of_mass)) factor = mass;
  }
  if (factor == 1.0) return true;
  std::vector<DeckNumber> numbers;
  if (!FindDeckNumbers(*block, spring, &numbers, error)) return false;
  ScaleDeckNumbers(numbers, factor, block);
  return true;
}

bool ScaleDeckMaterials(DeckContents* contents, std::string* error) {
  return MaterialScaling(contents, error).Run();
}

}  // namespace pinode
