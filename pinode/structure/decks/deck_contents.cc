#include "pinode/structure/decks/deck_contents.h"

#include <algorithm>
#include <string_view>
#include <utility>

#include "pinode/base/file_text.h"
#include "pinode/base/strings.h"

namespace pinode {
namespace {

// Keywords below *MATERIAL that belong to it.
constexpr const char* kMaterialKeywords[] = {"*ELASTIC",
                                             "*DENSITY",
                                             "*DAMPING",
                                             "*PLASTIC",
                                             "*CYCLIC HARDENING",
                                             "*RATE DEPENDENT",
                                             "*EXPANSION",
                                             "*CONDUCTIVITY",
                                             "*SPECIFIC HEAT",
                                             "*CREEP",
                                             "*DEPVAR",
                                             "*DEFORMATION PLASTICITY",
                                             "*VISCOELASTIC",
                                             "*FAIL STRAIN",
                                             "*FAIL STRESS",
                                             "*BRITTLE CRACKING",
                                             "*BRITTLE FAILURE",
                                             "*BRITTLE SHEAR",
                                             "*CAP PLASTICITY",
                                             "*CAP HARDENING",
                                             "*CAST IRON PLASTICITY",
                                             "*CAST IRON COMPRESSION HARDENING",
                                             "*CAST IRON TENSION HARDENING",
                                             "*CLAY PLASTICITY",
                                             "*CLAY HARDENING",
                                             "*CONCRETE",
                                             "*CONCRETE COMPRESSION DAMAGE",
                                             "*CONCRETE COMPRESSION HARDENING",
                                             "*CONCRETE DAMAGED PLASTICITY",
                                             "*CONCRETE TENSION DAMAGE",
                                             "*CONCRETE TENSION STIFFENING",
                                             "*CRUSHABLE FOAM",
                                             "*CRUSHABLE FOAM HARDENING",
                                             "*DAMAGE EVOLUTION",
                                             "*DAMAGE INITIATION",
                                             "*DAMAGE STABILIZATION",
                                             "*DRUCKER PRAGER",
                                             "*DRUCKER PRAGER CREEP",
                                             "*DRUCKER PRAGER HARDENING",
                                             "*ELECTRICAL CONDUCTIVITY",
                                             "*FAILURE RATIOS",
                                             "*INELASTIC HEAT FRACTION",
                                             "*LATENT HEAT",
                                             "*MOHR COULOMB",
                                             "*MOHR COULOMB HARDENING",
                                             "*NO COMPRESSION",
                                             "*NO TENSION",
                                             "*PERMEABILITY",
                                             "*POTENTIAL",
                                             "*SHEAR FAILURE",
                                             "*SHEAR RETENTION",
                                             "*SWELLING",
                                             "*TENSILE FAILURE",
                                             "*TENSION CUTOFF",
                                             "*TENSION STIFFENING",
                                             "*TRS",
                                             "*USER DEFINED FIELD",
                                             "*USER OUTPUT VARIABLES",
                                             "*VISCOUS"};
// Keywords that end a material. Sections, and all keywords that begin with
// *END, end it too.
constexpr const char* kBehindMaterials[] = {"*SPRING",
                                            "*MASS",
                                            "*ROTARY INERTIA",
                                            "*NONSTRUCTURAL MASS",
                                            "*DASHPOT",
                                            "*GAP",
                                            "*BOUNDARY",
                                            "*NSET",
                                            "*ELSET",
                                            "*NODE",
                                            "*ELEMENT",
                                            "*ORIENTATION",
                                            "*TRANSFORM",
                                            "*AMPLITUDE",
                                            "*INITIAL CONDITIONS",
                                            "*SURFACE",
                                            "*SURFACE INTERACTION",
                                            "*CONTACT",
                                            "*CONTACT PAIR",
                                            "*TIE",
                                            "*EQUATION",
                                            "*MPC",
                                            "*COUPLING",
                                            "*RIGID BODY",
                                            "*PART",
                                            "*ASSEMBLY",
                                            "*INSTANCE"};
constexpr const char* kSections[] = {"*SOLID SECTION", "*SHELL SECTION",
                                     "*MEMBRANE SECTION", "*BEAM SECTION",
                                     "*TRUSS SECTION"};

// Masses by element set. A mass that is spread over a set is distributed in
// proportion to the set's own mass or volume. Factors on the whole set do not
// change that distribution.
constexpr const char* kMasses[] = {"*MASS", "*ROTARY INERTIA",
                                   "*NONSTRUCTURAL MASS"};

// Keywords below a section that have their own numbers.
constexpr const char* kStiffnessOfSections[] = {
    "*TRANSVERSE SHEAR STIFFNESS", "*HOURGLASS STIFFNESS", "*REBAR LAYER"};
constexpr const char* kMassOfSections[] = {
    "*BEAM ADDED INERTIA", "*BEAM FLUID INERTIA", "*REBAR LAYER"};
// Keywords at any place, for elements that their data name.
constexpr const char* kAddedStiffness[] = {"*REBAR"};
constexpr const char* kAddedMass[] = {"*REBAR", "*MASS ADJUST",
                                      "*FIXED MASS SCALING"};

template <size_t N>
bool IsAmong(const char* const (&names)[N], const DeckKeyword& keyword) {
  return std::any_of(std::begin(names), std::end(names),
                     [&](const char* own) { return keyword.Is(own); });
}

bool IsSection(const DeckKeyword& keyword) {
  const std::string_view end = "SECTION";
  return keyword.name.size() > end.size() + 1 &&
         keyword.name.compare(keyword.name.size() - end.size(), end.size(),
                              end) == 0;
}

bool EndsMaterial(const DeckKeyword& keyword) {
  return IsAmong(kBehindMaterials, keyword) || IsSection(keyword) ||
         keyword.name.compare(0, 4, "*END") == 0;
}

class ContentsReader {
 public:
  ContentsReader(DeckContents* contents, std::string* error)
      : contents_(contents), blocks_(contents->blocks), error_(error) {}

  bool Read() {
    DeckPlace place;
    int section = -1;  // the owner that the last one is
    for (size_t b = 0; b < blocks_.size(); ++b) {
      const DeckKeyword& keyword = blocks_[b].keyword;
      place.Pass(keyword);
      places_.push_back(place);
      if (keyword.Is("*MATERIAL") && !AddMaterial(b)) return false;
      if (IsSection(keyword) || keyword.Is("*SPRING") ||
          IsAmong(kMasses, keyword)) {
        section = AddOwner(b);
      }
      NoteWhatIsKept(b, section);
    }
    for (size_t b = 0; b < blocks_.size(); ++b) AddOtherUses(b);
    for (const DeckOwner& owner : contents_->owners) {
      if (!owner.material.empty() &&
          contents_->materials.count(owner.material) == 0) {
        return FailInDeckBlock(blocks_[owner.block],
                               "there is no *MATERIAL of that name", error_);
      }
    }
    return true;
  }

 private:
  // Adds all blocks up to the next material, including unknown keywords:
  // solvers assign numbers to the last material.
  bool AddMaterial(size_t b) {
    const std::string* name = blocks_[b].keyword.Find("NAME");
    if (name == nullptr || name->empty()) {
      return FailInDeckBlock(blocks_[b], "*MATERIAL without NAME", error_);
    }
    DeckMaterial material;
    material.name = DeckUpperCase(*name);
    material.first = b;
    material.end = b + 1;
    bool ended = false;
    for (size_t k = b + 1; k < blocks_.size(); ++k) {
      const DeckKeyword& keyword = blocks_[k].keyword;
      if (keyword.Is("*MATERIAL") || keyword.Is("*STEP")) break;
      ended = ended || EndsMaterial(keyword);
      if (!ended) material.end = k + 1;
      const bool numbers = keyword.Is("*ELASTIC") || keyword.Is("*DENSITY");
      if (numbers) material.numbers.push_back(k);
      if (ended ? numbers : !IsAmong(kMaterialKeywords, keyword)) {
        material.in_the_way.push_back(k);
      }
    }
    return contents_->materials.emplace(DeckKey(*name), std::move(material))
               .second ||
           FailInDeckBlock(blocks_[b],
                           "material '" + *name + "' is given twice", error_);
  }

  // Returns the position of the owner. -1: it has no elements here, so nothing
  // changes it.
  int AddOwner(size_t b) {
    const DeckKeyword& keyword = blocks_[b].keyword;
    const std::string* material = keyword.Find("MATERIAL");
    if (IsSection(keyword) &&
        (material == nullptr || !IsAmong(kSections, keyword))) {
      return -1;
    }
    DeckOwner owner;
    if (!ElementsOf(b, &owner.elements)) return -1;
    owner.block = b;
    owner.set = *keyword.Find("ELSET");
    if (IsSection(keyword)) owner.material = DeckKey(*material);
    if (keyword.Is("*SPRING")) owner.spring = SpringOf(owner.elements);
    contents_->owners.push_back(std::move(owner));
    return static_cast<int>(contents_->owners.size()) - 1;
  }

  // Finds the elements of the set that a keyword names. Returns false if there
  // is none.
  bool ElementsOf(size_t b, std::vector<int>* elements) const {
    const std::string* set = blocks_[b].keyword.Find("ELSET");
    return set != nullptr &&
           contents_->assembly.FindSet(places_[b], *set, elements);
  }

  SpringStart SpringOf(const std::vector<int>& elements) const {
    SpringStart start = SpringStart::kUnknown;
    for (const int e : elements) {
      const DeckElementKind kind = contents_->assembly.type(e).kind;
      const SpringStart own = kind == DeckElementKind::kSpringOfItsLength
                                  ? SpringStart::kConstants
                              : kind == DeckElementKind::kSpringOfDirections
                                  ? SpringStart::kDirections
                                  : SpringStart::kUnknown;
      if (own == SpringStart::kUnknown) return own;
      if (start != SpringStart::kUnknown && start != own) {
        return SpringStart::kUnknown;
      }
      start = own;
    }
    return start;
  }

  void NoteWhatIsKept(size_t b, int section) {
    const DeckKeyword& keyword = blocks_[b].keyword;
    if (IsAmong(kAddedStiffness, keyword)) {
      contents_->added_stiffness.push_back(b);
    }
    if (IsAmong(kAddedMass, keyword)) contents_->added_mass.push_back(b);
    if (section < 0) return;
    DeckOwner& owner = contents_->owners[static_cast<size_t>(section)];
    if (IsAmong(kStiffnessOfSections, keyword)) {
      owner.kept_stiffness.push_back(b);
    }
    if (IsAmong(kMassOfSections, keyword)) owner.kept_mass.push_back(b);
  }

  // Adds uses of materials by users without a factor: composites and general
  // sections, which need them unchanged, and unknown keywords.
  void AddOtherUses(size_t b) {
    const DeckKeyword& keyword = blocks_[b].keyword;
    const bool known = IsAmong(kSections, keyword);
    std::vector<std::string> names;
    if (const std::string* material = keyword.Find("MATERIAL")) {
      names.push_back(*material);
    } else if (known || IsSection(keyword)) {
      for (const size_t line : blocks_[b].DataLines()) {
        const std::vector<std::string_view> fields =
            Split(blocks_[b].lines[line], ',');
        // Composites have thickness, points, material, orientation.
        for (size_t k = known ? 2 : 0; k < (known ? 3 : fields.size()); ++k) {
          if (k < fields.size()) names.emplace_back(StripBlanks(fields[k]));
        }
      }
    } else if (keyword.name.compare(0, 7, "*CHANGE") == 0 &&
               keyword.Find("NAME") != nullptr) {
      names.push_back(*keyword.Find("NAME"));
    }
    std::vector<int> elements;
    const bool owned = known && keyword.Find("MATERIAL") != nullptr &&
                       ElementsOf(b, &elements);
    if (owned) return;
    for (const std::string& name : names) {
      const auto material = contents_->materials.find(DeckKey(name));
      if (material == contents_->materials.end()) continue;
      std::vector<size_t>& uses = IsSection(keyword)
                                      ? material->second.sections
                                      : material->second.unknown_uses;
      uses.push_back(b);
    }
  }

  DeckContents* contents_;
  const std::vector<DeckBlock>& blocks_;
  std::vector<DeckPlace> places_;  // of the blocks
  std::string* error_;
};

}  // namespace

std::vector<size_t> DeckContents::BlocksOf(const DeckOwner& owner,
                                           bool mass) const {
  std::vector<size_t> own;
  if (owner.material.empty()) {
    const bool is_mass = !blocks[owner.block].keyword.Is("*SPRING");
    if (is_mass == mass) own.push_back(owner.block);
    return own;
  }
  for (const size_t b : materials.at(owner.material).numbers) {
    if (blocks[b].keyword.Is(mass ? "*DENSITY" : "*ELASTIC")) own.push_back(b);
  }
  return own;
}

bool ReadDeckContents(const std::string& path, const std::string& content,
                      DeckContents* contents, std::string* error) {
  contents->path = path;
  return contents->assembly.Read(path, content, error) &&
         ReadDeckBlocks(path, content, &contents->blocks, error) &&
         ContentsReader(contents, error).Read();
}

}  // namespace pinode
