#include "pinode/structure/decks/matrix_choice.h"

#include <algorithm>

#include "pinode/base/file_text.h"
#include "pinode/base/strings.h"
#include "pinode/structure/decks/finite_element_files.h"

namespace pinode {
namespace {

// Returns the usual names of a matrix, in lower case.
const std::vector<std::string>& UsualNames(int role) {
  static const std::vector<std::string> kUsual[] = {
      {"m", "mass", "mgg", "maa", "mff", "mhh", "mxx", "maax"},
      {"c", "damping", "d", "bgg", "baa", "bff", "damp", "baax"},
      {"k", "stiffness", "kgg", "kaa", "kff", "khh", "kxx", "stiff", "kaax"}};
  return kUsual[role];
}

constexpr size_t kNone = static_cast<size_t>(-1);

}  // namespace

const char* RoleName(int role) {
  static const char* const kNames[] = {"mass", "damping", "stiffness"};
  return kNames[role];
}

bool ChooseMatrix(int role, const MatrixSource& source,
                  const std::vector<std::string>& names, bool may_be_only,
                  size_t* chosen, std::string* error) {
  const auto fail = [&source, error](const std::string& message) {
    *error = source.path + ": " + message;
    return false;
  };
  const std::vector<std::string> wanted =
      source.variable.empty()
          ? UsualNames(role)
          : std::vector<std::string>{LowerCase(source.variable)};
  size_t found = kNone;
  int count = 0;  // matrices with the chosen name
  for (size_t i = 0; i < names.size(); ++i) {
    if (std::find(wanted.begin(), wanted.end(), LowerCase(names[i])) ==
        wanted.end()) {
      continue;
    }
    if (found != kNone && names[found] == names[i]) {
      if (++count == source.occurrence) found = i;
      continue;
    }
    if (found != kNone) {
      return fail("the " + std::string(RoleName(role)) + " matrix may be " +
                  Quote(names[found]) + " or " + Quote(names[i]) +
                  ", expected the name of one");
    }
    found = i;
    count = 1;
  }
  if (found != kNone && source.occurrence > count) {
    return fail(
        Quote(names[found]) + " occurs " +
        (count == 1 ? std::string("once") : std::to_string(count) + " times") +
        ", and occurrence = " + std::to_string(source.occurrence) +
        " is beyond that");
  }
  if (count > 1 && source.occurrence == 0) {
    return fail(Quote(names[found]) + " occurs " + std::to_string(count) +
                " times, expected occurrence = 1 to " + std::to_string(count) +
                " beside its name");
  }
  if (found == kNone && source.variable.empty() && names.size() == 1 &&
      may_be_only) {
    found = 0;
  }
  if (found == kNone) {
    return fail("no matrix " +
                (source.variable.empty()
                     ? "with a usual name of the " +
                           std::string(RoleName(role)) + " matrix (" +
                           Join(wanted, ", ") + ")"
                     : Quote(source.variable)) +
                ", expected one of these: " +
                (names.empty() ? "(the file has none)" : Join(names, ", ")));
  }
  *chosen = found;
  return true;
}

}  // namespace pinode
