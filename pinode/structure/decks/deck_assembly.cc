#include "pinode/structure/decks/deck_assembly.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cstdint>
#include <iterator>
#include <set>

#include "pinode/base/constants.h"
#include "pinode/base/file_text.h"
#include "pinode/base/strings.h"

namespace pinode {
namespace {

// Largest number of entries of all sets together: sets may name each other.
constexpr size_t kMostSetEntries = 10 * kMostDeckItems;

constexpr char kAssemblyName[] = "ASSEMBLY";

std::string InInstance(const std::string& name) {
  return name.empty() ? "" : " in instance '" + name + "'";
}

void SortAndReduce(std::vector<int>* elements) {
  std::sort(elements->begin(), elements->end());
  elements->erase(std::unique(elements->begin(), elements->end()),
                  elements->end());
}

Eigen::Vector3d Moved(const DeckInstance* instance,
                      const std::array<double, 3>& position) {
  Eigen::Vector3d moved(position[0], position[1], position[2]);
  if (instance == nullptr) return moved;
  const auto& turn = instance->turn;
  moved += Eigen::Vector3d(instance->shift[0], instance->shift[1],
                           instance->shift[2]);
  const double angle = turn[6] * kPi / 180.0;
  if (angle == 0.0) return moved;
  const Eigen::Vector3d from(turn[0], turn[1], turn[2]);
  const Eigen::Vector3d to(turn[3], turn[4], turn[5]);
  return from +
         Eigen::AngleAxisd(angle, (to - from).normalized()) * (moved - from);
}

}  // namespace

bool DeckAssembly::Read(const std::string& path, const std::string& content,
                        std::string* error) {
  path_ = path;
  geometry_ = StructureGeometry();
  types_.clear();
  copies_.clear();
  sets_.clear();
  ambiguous_.clear();
  if (!ReadDeckParts(path, content, &parts_, error) ||
      !MakeCopies(path, error) || !AddNodes(path, error) ||
      !AddElements(path, error) || !AddSets(error)) {
    return false;
  }
  NameSets();
  for (const std::string& file : parts_.outside) {
    geometry_.notes.push_back("the deck includes " + file +
                              ", which is not in its folder");
  }
  for (const auto& [type, count] : parts_.unknown_types) {
    geometry_.notes.push_back(
        std::to_string(count) + " elements of type " + type +
        " are not drawn, because the pictures do not know it.");
  }
  return true;
}

bool DeckAssembly::MakeCopies(const std::string& path, std::string* error) {
  if (parts_.instances.empty() && parts_.parts.size() > 1) {
    *error = path + ": it has " + std::to_string(parts_.parts.size()) +
             " parts and no *INSTANCE, expected an assembly of them";
    return false;
  }
  size_t nodes = 0, elements = 0;
  const auto add = [&](Copy copy) {
    for (Copy::Piece& piece : copy.pieces) {
      piece.first_node = static_cast<int>(nodes);
      piece.first_element = static_cast<int>(elements);
      nodes += piece.scope->positions.size();
      elements += piece.scope->elements.size();
    }
    copies_.push_back(std::move(copy));
    return nodes <= kMostDeckItems && elements <= kMostDeckItems;
  };
  bool good = true;
  for (size_t i = 0; good && i < parts_.instances.size(); ++i) {
    const DeckInstance& instance = parts_.instances[i];
    const DeckScope& part = parts_.parts[static_cast<size_t>(instance.part)];
    good = add({instance.own.name,
                instance.part,
                static_cast<int>(i),
                {{&part}, {&instance.own}}});
  }
  Copy rest = {"", -1, -1, {{&parts_.assembly}}};
  // Solvers without assemblies take a part as it is.
  if (parts_.instances.empty() && !parts_.parts.empty()) {
    rest.part = 0;
    rest.pieces.push_back({&parts_.parts[0]});
  }
  good = good && add(std::move(rest));
  if (good && nodes > 0) return true;
  *error = path + (good ? ": it has no *NODE, expected an input deck"
                        : ": its instances have more than " +
                              std::to_string(kMostDeckItems) +
                              " nodes or elements, expected fewer");
  return false;
}

int DeckAssembly::Find(const Copy& copy, int number, NumberIndex index,
                       int Copy::Piece::*first) {
  for (const Copy::Piece& piece : copy.pieces) {
    const auto place = (piece.scope->*index).find(number);
    if (place != (piece.scope->*index).end()) {
      return piece.*first + place->second;
    }
  }
  return -1;
}

int DeckAssembly::FindNode(const Copy& copy, int number) {
  return Find(copy, number, &DeckScope::node_index, &Copy::Piece::first_node);
}

int DeckAssembly::FindElement(const Copy& copy, int number) {
  return Find(copy, number, &DeckScope::element_index,
              &Copy::Piece::first_element);
}

size_t DeckAssembly::CopyOf(size_t from, int instance) {
  return instance < 0 ? from : static_cast<size_t>(instance);
}

bool DeckAssembly::AddNodes(const std::string& path, std::string* error) {
  const Copy::Piece& last = copies_.back().pieces.back();
  geometry_.positions.resize(
      last.first_node + static_cast<Eigen::Index>(last.scope->positions.size()),
      3);
  Eigen::Index row = 0;
  // One instance needs no name before its numbers.
  const bool plain = copies_.size() <= 2;
  for (const Copy& copy : copies_) {
    const DeckInstance* instance =
        copy.instance < 0
            ? nullptr
            : &parts_.instances[static_cast<size_t>(copy.instance)];
    for (const Copy::Piece& piece : copy.pieces) {
      for (size_t i = 0; i < piece.scope->positions.size(); ++i, ++row) {
        const int number = piece.scope->node_numbers[i];
        if (FindNode(copy, number) != row) {
          *error = path + ": node " + std::to_string(number) +
                   " is given twice" + InInstance(copy.name) +
                   ", expected different numbers";
          return false;
        }
        std::string name = std::to_string(number);
        if (!copy.name.empty() && !plain) {
          name = copy.name + "." + name;
        } else if (copy.name.empty() && copies_.size() == 2 &&
                   FindNode(copies_[0], number) >= 0) {
          name = std::string(kAssemblyName) + "." + name;
        }
        geometry_.node_names.push_back(std::move(name));
        geometry_.positions.row(row) =
            Moved(instance, piece.scope->positions[i]).transpose();
      }
    }
  }
  return true;
}

bool DeckAssembly::AddElements(const std::string& path, std::string* error) {
  for (size_t c = 0; c < copies_.size(); ++c) {
    for (const Copy::Piece& piece : copies_[c].pieces) {
      for (size_t i = 0; i < piece.scope->elements.size(); ++i) {
        const DeckElement& own = piece.scope->elements[i];
        const int number = piece.scope->element_numbers[i];
        const auto index = static_cast<int>(geometry_.elements.size());
        if (FindElement(copies_[c], number) != index) {
          *error = path + ": element " + std::to_string(number) +
                   " is given twice" + InInstance(copies_[c].name) +
                   ", expected different numbers";
          return false;
        }
        StructureGeometry::Element element;
        element.shape = own.type->shape;
        for (const DeckReference& node : own.nodes) {
          const int place =
              FindNode(copies_[CopyOf(c, node.instance)], node.number);
          if (place < 0) {
            *error = path + ": element " + std::to_string(number) +
                     " has node " + std::to_string(node.number) +
                     ", which has no *NODE";
            return false;
          }
          element.nodes.push_back(place);
        }
        geometry_.elements.push_back(std::move(element));
        types_.push_back(own.type);
      }
    }
  }
  return true;
}

bool DeckAssembly::IsSet(size_t copy, const std::string& key) const {
  const auto& pieces = copies_[copy].pieces;
  return std::any_of(pieces.begin(), pieces.end(), [&](const auto& piece) {
    return piece.scope->set_index.count(key) > 0;
  });
}

void DeckAssembly::AddRange(const Copy& copy, const DeckSet::Range& range,
                            std::vector<int>* elements) const {
  const auto steps = (static_cast<int64_t>(range.last) - range.first) /
                     static_cast<int64_t>(range.step);
  // Uses the elements that exist, even if the range goes further.
  for (const Copy::Piece& piece : copy.pieces) {
    const auto& index = piece.scope->element_index;
    if (steps < static_cast<int64_t>(index.size())) {
      for (int64_t k = 0; k <= steps; ++k) {
        const auto place =
            index.find(static_cast<int>(range.first + k * range.step));
        if (place == index.end()) continue;
        elements->push_back(piece.first_element + place->second);
      }
      continue;
    }
    for (const auto& [number, place] : index) {
      if (number >= range.first && number <= range.last &&
          (static_cast<int64_t>(number) - range.first) % range.step == 0) {
        elements->push_back(piece.first_element + place);
      }
    }
  }
}

bool DeckAssembly::AddRanges(size_t copy, const DeckSet& set,
                             std::vector<int>* elements,
                             std::string* error) const {
  for (const DeckSet::Range& range : set.ranges) {
    const size_t before = elements->size();
    AddRange(copies_[CopyOf(copy, range.instance)], range, elements);
    // In an assembly, plain numbers mean its own elements, whatever the
    // instances have. Elements of unknown types are missing from the lists.
    if (elements->size() == before && copies_[copy].part < 0 &&
        range.instance < 0 && !parts_.instances.empty() &&
        parts_.unknown_types.empty()) {
      *error = path_ + ": set '" + set.name + "' of the assembly has element " +
               std::to_string(range.first) +
               ", which is none of its own, expected INSTANCE=... for others";
      return false;
    }
    if (elements->size() > 2 * kMostDeckItems) SortAndReduce(elements);
  }
  return true;
}

bool DeckAssembly::AddNamed(size_t copy, const DeckSet& set,
                            const DeckSet::Name& name,
                            std::vector<SetKey>* further,
                            std::vector<int>* elements,
                            std::string* error) const {
  const size_t there = CopyOf(copy, name.instance);
  std::string key = DeckKey(name.text);
  if (IsSet(there, key)) {
    further->emplace_back(there, std::move(key));
    return true;
  }
  const size_t point = name.text.rfind('.');
  const int instance = point == std::string::npos || name.instance >= 0
                           ? -1
                           : parts_.FindInstance(name.text.substr(0, point));
  if (instance >= 0) {
    const std::string rest = name.text.substr(point + 1);
    int number = 0;
    if (ParseInt(rest, &number)) {
      const int element =
          FindElement(copies_[static_cast<size_t>(instance)], number);
      if (element >= 0) elements->push_back(element);
      return true;
    }
    key = DeckKey(rest);
    if (IsSet(static_cast<size_t>(instance), key)) {
      further->emplace_back(static_cast<size_t>(instance), std::move(key));
      return true;
    }
  }
  *error = name.place + ": set '" + set.name + "' has " + Quote(name.text) +
           ", expected elements or a set";
  return false;
}

bool DeckAssembly::Collect(const SetKey& wanted, std::vector<int>* elements,
                           std::string* error) const {
  // Sets may name each other in any order, even in circles.
  std::vector<SetKey> open = {wanted};
  std::set<SetKey> seen = {wanted};
  while (!open.empty()) {
    const SetKey key = std::move(open.back());
    open.pop_back();
    const auto known = sets_.find(key);
    if (known != sets_.end()) {
      elements->insert(elements->end(), known->second.begin(),
                       known->second.end());
      continue;
    }
    const Copy& copy = copies_[key.first];
    for (const Copy::Piece& piece : copy.pieces) {
      const auto place = piece.scope->set_index.find(key.second);
      if (place == piece.scope->set_index.end()) continue;
      const DeckSet& set = piece.scope->sets[place->second];
      for (const int own : set.own) {
        elements->push_back(piece.first_element + own);
      }
      if (!AddRanges(key.first, set, elements, error)) return false;
      for (const DeckSet::Name& name : set.names) {
        std::vector<SetKey> further;
        if (!AddNamed(key.first, set, name, &further, elements, error)) {
          return false;
        }
        for (SetKey& other : further) {
          if (seen.insert(other).second) open.push_back(std::move(other));
        }
      }
    }
  }
  SortAndReduce(elements);
  return true;
}

bool DeckAssembly::AddSets(std::string* error) {
  size_t entries = 0;
  for (const auto& [key, name] : SetNames()) {
    std::vector<int> elements;
    if (!Collect(key, &elements, error)) return false;
    entries += elements.size();
    if (entries > kMostSetEntries) {
      *error = "set '" + name + "' and those before it have more than " +
               std::to_string(kMostSetEntries) +
               " elements together, expected fewer";
      return false;
    }
    sets_[key] = std::move(elements);
  }
  return true;
}

void DeckAssembly::NameSets() {
  // Meaning of a name alone: a set of the assembly, or a set of a part in all
  // of its instances.
  struct Meaning {
    int part = -1;
    std::vector<int> elements;
    std::vector<std::string> full_names;
  };
  std::map<std::string, std::vector<Meaning>> by_name;
  std::vector<std::pair<std::string, std::string>> order;  // key, name
  std::vector<StructureGeometry::Set> of_instances;
  for (const auto& [key, name] : SetNames()) {
    const Copy& copy = copies_[key.first];
    const std::vector<int>& elements = sets_.at(key);
    std::vector<Meaning>& meanings = by_name[key.second];
    if (meanings.empty()) order.emplace_back(key.second, name);
    auto meaning = std::find_if(
        meanings.begin(), meanings.end(),
        [&copy](const Meaning& known) { return known.part == copy.part; });
    if (meaning == meanings.end()) {
      meaning = meanings.insert(meaning, {copy.part, {}, {}});
    }
    meaning->elements.insert(meaning->elements.end(), elements.begin(),
                             elements.end());
    const std::string full =
        (copy.name.empty() ? kAssemblyName : copy.name) + "." + name;
    meaning->full_names.push_back(full);
    if (copy.instance >= 0) of_instances.push_back({full, elements});
  }
  for (const auto& [key, name] : order) {
    std::vector<Meaning>& meanings = by_name[key];
    // Copies are in order, and so are the elements of several copies.
    const bool same = std::all_of(
        meanings.begin(), meanings.end(), [&meanings](const Meaning& other) {
          return other.elements == meanings[0].elements;
        });
    if (same) {
      geometry_.sets.push_back({name, std::move(meanings[0].elements)});
      continue;
    }
    for (Meaning& meaning : meanings) {
      for (const std::string& full : meaning.full_names) {
        ambiguous_[key].push_back(full);
      }
      const bool listed = meaning.part >= 0;
      if (listed) continue;
      of_instances.push_back(
          {meaning.full_names[0], std::move(meaning.elements)});
    }
  }
  std::move(of_instances.begin(), of_instances.end(),
            std::back_inserter(geometry_.sets));
}

std::vector<std::pair<DeckAssembly::SetKey, std::string>>
DeckAssembly::SetNames() const {
  std::vector<std::pair<SetKey, std::string>> names;
  std::set<SetKey> seen;
  for (size_t c = 0; c < copies_.size(); ++c) {
    for (const Copy::Piece& piece : copies_[c].pieces) {
      for (const DeckSet& set : piece.scope->sets) {
        SetKey key(c, DeckKey(set.name));
        if (seen.insert(key).second) names.emplace_back(key, set.name);
      }
    }
  }
  return names;
}

bool DeckAssembly::FindSet(const DeckPlace& place, const std::string& name,
                           std::vector<int>* elements) const {
  elements->clear();
  bool found = false;
  const auto add = [&](size_t copy, const std::string& key) {
    const auto set = sets_.find({copy, key});
    if (set == sets_.end()) return;
    found = true;
    elements->insert(elements->end(), set->second.begin(), set->second.end());
  };
  const std::string key = DeckKey(name);
  if (place.kind == DeckPlace::Kind::kInstance) {
    add(static_cast<size_t>(place.index), key);
  } else if (place.kind == DeckPlace::Kind::kPart) {
    for (size_t c = 0; c < copies_.size(); ++c) {
      if (copies_[c].part == place.index) add(c, key);
    }
  } else {
    add(copies_.size() - 1, key);
    const size_t point = name.rfind('.');
    const int instance = found || point == std::string::npos
                             ? -1
                             : parts_.FindInstance(name.substr(0, point));
    if (instance >= 0) {
      add(static_cast<size_t>(instance), DeckKey(name.substr(point + 1)));
    }
  }
  return found;
}

int DeckAssembly::SetIndex(const std::string& name) const {
  const std::string key = DeckKey(name);
  for (size_t i = 0; i < geometry_.sets.size(); ++i) {
    if (DeckKey(geometry_.sets[i].name) == key) return static_cast<int>(i);
  }
  return -1;
}

std::string DeckAssembly::WhyNoSet(const std::string& name) const {
  const auto several = ambiguous_.find(DeckKey(name));
  if (several == ambiguous_.end()) return "there is no such set";
  constexpr size_t kMostNamed = 4;
  std::vector<std::string> names;
  for (const std::string& full : several->second) {
    if (names.size() == kMostNamed) break;
    names.push_back("'" + full + "'");
  }
  return "several sets have this name, expected one of " + Join(names, ", ") +
         (names.size() < several->second.size() ? ", ..." : "");
}

}  // namespace pinode
